#include "rig_files.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

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

bool ends_in(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Calibrated with these images, perhaps before a namespace was put before their topic, or taken from it.
bool is_of_topic(const CamchainCamera& camera, const std::string& topic) {
  if (topic.empty() || camera.rostopic.empty()) return false;
  const std::string then = "/" + joined(parts_of(without_transport(camera.rostopic)), "/"),
                    now = "/" + joined(parts_of(without_transport(topic)), "/");
  return ends_in(now, then) || ends_in(then, now);
}

using Chain = std::vector<CamchainCamera>;

// The one that was calibrated with these images, or that has the camera's name, or the only one there is.
Chain::const_iterator find_in_chain(const Chain& chain, const std::string& name, const std::string& topic) {
  auto found = std::find_if(chain.begin(), chain.end(),
                            [&topic](const CamchainCamera& some) { return is_of_topic(some, topic); });
  if (found == chain.end())
    found = std::find_if(chain.begin(), chain.end(), [&name](const CamchainCamera& some) { return some.name == name; });
  return found == chain.end() && chain.size() == 1 ? chain.begin() : found;
}

// "cam1" of "cam2", wherever it stands in the file.
Chain::const_iterator find_previous(const Chain& chain, const CamchainCamera& camera) {
  const auto number = [](const std::string& name) {
    return std::strtoull(name.c_str() + std::strlen("cam"), nullptr, 10);
  };
  return std::find_if(chain.begin(), chain.end(),
                      [&](const CamchainCamera& other) { return number(other.name) == number(camera.name) - 1; });
}

// Every camera in the one before it, by the chain's names.
FrameTree tree_of_chain(const Chain& chain) {
  FrameTree tree;
  for (const CamchainCamera& camera : chain) {
    const auto previous = find_previous(chain, camera);
    if (previous != chain.end() && camera.T_this_previous)
      tree.add(previous->name, camera.name, camera.T_this_previous->inverse());
  }
  return tree;
}

InfoReading camera_of_chain(const fs::path& file, const Chain& chain, const std::string& name,
                            const std::string& topic) {
  const auto found = find_in_chain(chain, name, topic);
  const bool by_topic = found != chain.end() && is_of_topic(*found, topic);
  std::vector<std::string> known;
  for (const CamchainCamera& camera : chain)
    known.push_back(camera.name + (camera.rostopic.empty() ? "" : " (" + for_message(camera.rostopic) + ")"));
  if (found == chain.end())
    throw Error(file.string() + ": which of its cameras is " + name + "? It has " + joined(known) + "; name " + name +
                " as one of them: " + (topic.empty() ? "rename its folder" : "--topic cam0=" + topic));
  if (is_rectified(topic) && !by_topic)
    throw Error(file.string() + ": " + found->name + ": is of other images than " + topic +
                ", which are rectified; take those that it was calibrated with: --topic " + name + "=" +
                (found->rostopic.empty() ? "TOPIC" : for_message(found->rostopic)));
  try {
    InfoReading reading = camera_of_info(found->info, false);
    if (!by_topic && !topic.empty() && !found->rostopic.empty())
      reading.notes.push_back("the intrinsics are those of " + found->name + " in " + file.filename().string() +
                              ", which was calibrated with " + for_message(found->rostopic));
    return reading;
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
  std::error_code ignored;
  std::size_t for_all = 0;
  for (const std::string& text : texts) {
    if (text.find('=') != std::string::npos) continue;
    if (!fs::is_regular_file(text, ignored)) throw Error("--camera-info: " + for_message(text) + ": no such file");
    if (++for_all > 1)
      throw Error("--camera-info: " + for_message(text) + ": a camchain for all cameras was given before");
    if (read_camchain(text)) continue;
    read_yaml_file(text);  // what is no YAML says so
    throw Error("--camera-info: " + for_message(text) +
                ": must be CAMERA=FILE; only a camchain of Kalibr is for all cameras at once");
  }
  return values_by_camera(texts, "--camera-info", cameras, true);
}

FrameTree poses_of_chain(const std::vector<InitCamera>& cameras, bool of_topics) {
  struct Names {
    std::string here, there;  // in rig.yaml and in the chain
  };
  std::map<std::string, Names> first_of;  // by file
  FrameTree poses;
  std::error_code ignored;
  for (const InitCamera& camera : cameras) {
    if (!fs::is_regular_file(camera.camera_info, ignored)) continue;
    const std::optional<Chain> chain = read_camchain(camera.camera_info);
    if (!chain) continue;
    const auto found = find_in_chain(*chain, camera.name, of_topics ? camera.images : "");
    if (found == chain->end()) continue;
    const auto [first, is_first] = first_of.emplace(camera.camera_info, Names{camera.name, found->name});
    if (is_first || found->name == first->second.there) continue;
    if (const auto T = tree_of_chain(*chain).between(first->second.there, found->name))
      poses.add(first->second.here, camera.name, *T);
  }
  return poses;
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
