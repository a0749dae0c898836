// What lies in a folder, and generations that are killed.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "rigproof/core/files.h"

namespace rigproof {

/// Hash of every file below a folder, temporary ones included, by path relative to it.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    hashes[std::filesystem::relative(entry.path(), folder).generic_string()] = sha256_hex_of_file(entry.path());
  }
  return hashes;
}

/// Runs a task in a process group of its own.
inline pid_t in_background(const std::function<void()>& task) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::setpgid(0, 0);
    try {
      task();
    } catch (const std::exception&) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  ::setpgid(pid, pid);
  return pid;
}

/// Ends a whole process group and waits for its leader.
inline void kill_group(pid_t leader) {
  ::kill(-leader, SIGKILL);
  ::waitpid(leader, nullptr, 0);
}

}  // namespace rigproof
