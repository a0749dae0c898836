#include "process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

#include "temp_folder.h"

namespace rigproof {
namespace {

void redirect(const std::string& file, int descriptor) {
  const int opened = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
}

[[noreturn]] void become(const std::vector<std::string>& argv, const std::string& folder, const std::string& scratch) {
  redirect(scratch + "/out", STDOUT_FILENO);
  redirect(scratch + "/err", STDERR_FILENO);
  if (!folder.empty() && chdir(folder.c_str()) != 0) _exit(126);
  std::vector<char*> pointers;
  for (const std::string& word : argv) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  execvp(pointers[0], pointers.data());
  _exit(127);
}

}  // namespace

ProcessOutput run_process(const std::vector<std::string>& argv, const std::string& folder) {
  const TempFolder scratch;
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become(argv, folder, scratch.path().string());
  int status = 0;
  waitpid(child, &status, 0);
  ProcessOutput output;
  output.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  output.out = scratch.read("out");
  output.err = scratch.read("err");
  return output;
}

}  // namespace rigproof
