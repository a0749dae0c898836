#include "cli_fixture.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "paths.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

}  // namespace

ProcessOutput rigproof_command(const std::vector<std::string>& arguments, const std::string& folder) {
  std::vector<std::string> argv = {program_path()};
  argv.insert(argv.end(), arguments.begin(), arguments.end());
  return run_process(argv, folder);
}

fs::path small_run() {
  const fs::path folder = RIGPROOF_SMALL_RUN;
  if (fs::exists(folder / "run.yaml")) return folder;
  const ProcessOutput output =
      rigproof_command({"generate", "plain", "-o", folder.string(), "--set", "name=small", "--set", "poses=10", "--set",
                        "image_scale=0.5", "--set", "sensor_noise=none", "--set", "odometry.lambda=0", "--set",
                        "viewpoints.planner=sampled", "--set", "board.place=scene"});
  if (output.exit_code != 0) throw std::runtime_error("the small run could not be generated: " + output.err);
  return folder;
}

fs::path copy_of_recording(const TempFolder& scratch) {
  const fs::path copy = scratch / "recording";
  fs::copy(small_run() / "recording", copy, fs::copy_options::recursive);
  return copy;
}

std::string read_whole_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void write_whole_file(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
}

void edit_file(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = read_whole_file(file);
  const std::size_t place = text.find(from);
  ASSERT_NE(place, std::string::npos) << file << " does not hold \"" << from << "\":\n" << text.substr(0, 2000);
  text.replace(place, from.size(), to);
  write_whole_file(file, text);
}

std::vector<std::pair<std::string, std::string>> tree_content(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> content;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      content.emplace_back(fs::relative(entry.path(), folder).string(), read_whole_file(entry.path()));
  std::sort(content.begin(), content.end());
  return content;
}

}  // namespace rigproof
