#include "rig_files.h"

#include <algorithm>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/yaml.h"
#include "rigproof/formats/format.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

YamlTree& entry(YamlTree& map, const std::string& key) {
  return std::find_if(map.entries.begin(), map.entries.end(), [&key](const auto& some) { return some.first == key; })
      ->second;
}

void remove_entry(YamlTree& map, const std::string& key) {
  map.entries.erase(
      std::remove_if(map.entries.begin(), map.entries.end(), [&key](const auto& some) { return some.first == key; }),
      map.entries.end());
}

// What a sensor preset would say is left to it.
void shorten_depth(const RigCamera& camera, YamlTree& tree) {
  if (!camera.depth || !camera.sensor.empty()) return;
  YamlTree& depth = entry(tree, "depth");
  for (const char* key : {"min_m", "max_m", "noise"}) remove_entry(depth, key);
}

}  // namespace

std::string rig_yaml_text(const RigText& text) {
  Rig rig = text.rig;
  YamlTree tree = tree_of_fields([&rig](FieldVisitor& visitor) { visit_rig(visitor, {}, rig); });
  if (!text.has_board) remove_entry(tree, "board");
  YamlTree& cameras = entry(tree, "cameras");
  for (const RigCamera& camera : rig.cameras) shorten_depth(camera, entry(cameras, camera.name));
  std::string comments;
  for (const std::string& comment : text.comments) comments += "# " + comment + "\n";
  return comments + emit_yaml(tree);
}

InfoReading camera_of_file(const fs::path& file, bool rectified) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) throw Error(file.string() + ": no such file");
  Problems problems;
  std::optional<InfoReading> reading = read_camera_info(file, rectified, &problems);
  problems.throw_if_any();
  return std::move(reading).value();
}

}  // namespace rigproof
