#include "rig_files.h"

#include <algorithm>

#include "import_words.h"
#include "rigproof/core/error.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"
#include "rigproof/formats/camchain.h"
#include "topic_names.h"

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

// The one that was calibrated with these images, or that has the camera's name.
InfoReading camera_of_chain(const fs::path& file, const std::vector<CamchainCamera>& chain, const std::string& name,
                            const std::string& topic) {
  const auto same_topic = [&topic](const CamchainCamera& camera) {
    return !topic.empty() && !camera.rostopic.empty() && without_transport(camera.rostopic) == without_transport(topic);
  };
  auto found = std::find_if(chain.begin(), chain.end(), same_topic);
  const bool by_topic = found != chain.end();
  if (!by_topic)
    found = std::find_if(chain.begin(), chain.end(), [&name](const CamchainCamera& some) { return some.name == name; });
  std::vector<std::string> known;
  for (const CamchainCamera& camera : chain)
    known.push_back(camera.name + (camera.rostopic.empty() ? "" : " (" + for_message(camera.rostopic) + ")"));
  if (found == chain.end())
    throw Error(file.string() + ": which of its cameras is " + name + "? It has " + joined(known) + "; call it so" +
                (topic.empty() ? ": rename its folder" : ": --topic camN=" + topic));
  if (is_rectified(topic) && !by_topic)
    throw Error(file.string() + ": " + found->name + ": is of other images than " + topic +
                ", which are rectified; take those that it was calibrated with: --topic " + name + "=" +
                (found->rostopic.empty() ? "TOPIC" : for_message(found->rostopic)));
  try {
    return camera_of_info(found->info, false);
  } catch (const CameraInfoError& error) {
    throw Error(file.string() + ": " + found->name + ": " + error.what());
  }
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

std::map<std::string, std::string> intrinsics_files(const std::vector<std::string>& texts,
                                                    const std::vector<std::string>& cameras) {
  for (const std::string& text : texts)
    if (text.find('=') == std::string::npos && !read_camchain(text))
      throw Error("--camera-info: " + for_message(text) +
                  ": must be CAMERA=FILE; only a camchain of Kalibr is for all cameras at once");
  return values_by_camera(texts, "--camera-info", cameras, true);
}

InfoReading camera_of_file(const fs::path& file, const std::string& name, const std::string& topic) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) throw Error(file.string() + ": no such file");
  if (const auto chain = read_camchain(file)) return camera_of_chain(file, *chain, name, topic);
  Problems problems;
  std::optional<InfoReading> reading = read_camera_info(file, is_rectified(topic), &problems);
  problems.throw_if_any();
  return std::move(reading).value();
}

}  // namespace rigproof
