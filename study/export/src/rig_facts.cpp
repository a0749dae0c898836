#include <algorithm>

#include "rigproof/core/bag_name.h"
#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

std::vector<fs::path> results_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& place : {folder / "results", folder}) {
    for (const fs::directory_entry& entry : folder_entries(place))
      if (const fs::path& file = entry.path();
          file.extension() == ".yaml" && file.filename() != "rig.yaml" && file.filename() != "run.yaml")
        files.push_back(file);
    if (!files.empty()) break;
  }
  return files;
}

FrameTree frames_in(const fs::path& folder) {
  std::error_code ignored;
  const fs::path file = folder / kFrameTreeFile;
  return fs::is_regular_file(file, ignored) ? load_frame_tree(file) : FrameTree();
}

}  // namespace

RigFacts read_rig_facts(const fs::path& path) {
  std::error_code ignored;
  if (path.extension() == ".yaml" && fs::is_regular_file(path, ignored))
    return {path.string(), load_rig(path).cameras, frames_in(folder_of(path))};
  const Input input = open_input(path);
  if (!input.recording) return {path.string(), input.observations.value().cameras, {}};
  return {path.string(), input.recording->rig.cameras, frames_in(input.recording->folder)};
}

RigFacts find_rig_facts(const fs::path& result_file) {
  const fs::path here = folder_of(result_file), above = here / "..";
  for (const fs::path& file : {here / "rig.yaml", above / "rig.yaml", above / "recording" / "rig.yaml",
                               here / "observations.json", above / "observations.json"}) {
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) return read_rig_facts(file.lexically_normal());
  }
  return {};
}

fs::path find_result_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return path;
  const std::vector<fs::path> files = results_in(path);
  if (files.size() == 1) return files.front();
  if (files.empty()) refuse_bag(path);
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(for_message(file.filename().string()));
  throw Error(path.string() + (files.empty() ? ": holds no result; `rigproof calibrate` writes one"
                                             : ": holds several results; name one of " + joined(names)));
}

}  // namespace rigproof
