#include "topic_names.h"

#include <algorithm>
#include <set>

#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

const std::set<std::string> kTransports = {"compressed", "compressedDepth"};
// Words of drivers, not of the place where a camera sits.
const std::set<std::string> kCommonWords = {"camera",    "color",      "colour",           "rgb",        "image",
                                            "image_raw", "image_rect", "image_rect_color", "image_mono", "image_color",
                                            "raw",       "rect",       "sensors",          "zed_node",   "driver"};

// Words, between underscores, that name one picture of a camera among others, and CameraInfo.
const std::set<std::string> kPictureWords = {"image", "img",  "raw",  "rect", "rectified", "color",  "colour", "rgb",
                                             "bgr",   "mono", "gray", "grey", "bayer",     "camera", "info"};

std::string joined_path(const std::vector<std::string>& parts) { return "/" + joined(parts, "/"); }

bool contains(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

// Letters that a frame's name may have.
std::string frame_name(std::string text) {
  for (char& c : text)
    if (!is_frame_name(std::string("a") + c)) c = '_';
  while (!text.empty() && text.front() == '.') text.erase(0, 1);
  return text.substr(0, 64);
}

std::vector<std::string> telling_parts(const std::string& topic) {
  std::vector<std::string> telling;
  for (const std::string& part : parts_of(without_transport(topic)))
    if (kCommonWords.count(part) == 0) telling.push_back(part);
  return telling;
}

std::string name_of(const std::vector<std::string>& parts) {
  return parts.empty() ? "camera" : frame_name(joined(parts, "_"));
}

// Without empty ones.
std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::string part;
  for (const char c : text + separator) {
    if (c != separator) {
      part += c;
    } else if (!part.empty()) {
      parts.push_back(part);
      part.clear();
    }
  }
  return parts;
}

}  // namespace

std::vector<std::string> parts_of(const std::string& topic) { return split(topic, '/'); }

std::string without_transport(const std::string& topic) {
  std::vector<std::string> parts = parts_of(topic);
  if (!parts.empty() && kTransports.count(parts.back()) > 0) parts.pop_back();
  return joined_path(parts);
}

std::string namespace_of(const std::string& topic) {
  std::vector<std::string> parts = parts_of(without_transport(topic));
  if (!parts.empty()) parts.pop_back();
  return parts.empty() ? "" : joined_path(parts);
}

std::string place_in(const std::string& topic) {
  const std::vector<std::string> parts = parts_of(without_transport(topic));
  std::vector<std::string> telling;
  if (!parts.empty())
    for (const std::string& word : split(parts.back(), '_'))
      if (kPictureWords.count(word) == 0) telling.push_back(word);
  return joined(telling, "_");
}

std::size_t shared_parts(const std::string& a, const std::string& b) {
  const std::vector<std::string> one = parts_of(a), other = parts_of(b);
  std::size_t shared = 0;
  while (shared < std::min(one.size(), other.size()) && one[shared] == other[shared]) ++shared;
  return shared;
}

bool is_rectified(const std::string& topic) {
  const std::vector<std::string> parts = parts_of(without_transport(topic));
  return !parts.empty() && contains(parts.back(), "rect");
}

bool is_side_product(const std::string& topic) {
  static const char* const kWords[] = {"infra",   "disparity", "confidence", "mask",   "debug",
                                       "overlay", "annotated", "detection",  "marked", "depth"};
  const std::vector<std::string> parts = parts_of(without_transport(topic));
  return std::any_of(parts.begin(), parts.end(), [](const std::string& part) {
    return part == "ir" || std::any_of(std::begin(kWords), std::end(kWords),
                                       [&part](const char* word) { return contains(part, word); });
  });
}

std::vector<std::string> camera_names(const std::vector<std::string>& topics) {
  std::vector<std::vector<std::string>> parts;
  for (const std::string& topic : topics) parts.push_back(telling_parts(topic));
  const auto share_first = [&parts] {
    return parts.size() > 1 && std::all_of(parts.begin(), parts.end(), [&parts](const auto& some) {
             return some.size() > 1 && some.front() == parts.front().front();
           });
  };
  while (share_first())
    for (auto& some : parts) some.erase(some.begin());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    std::string name = name_of(parts[i]);
    if (std::find(names.begin(), names.end(), name) != names.end())
      name = name_of(parts_of(without_transport(topics[i])));
    for (int count = 2; std::find(names.begin(), names.end(), name) != names.end(); ++count)
      name = name_of(parts[i]) + "_" + std::to_string(count);
    names.push_back(name);
  }
  return names;
}

}  // namespace rigproof
