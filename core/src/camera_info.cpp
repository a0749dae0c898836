#include "rigproof/core/camera_info.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "rigproof/core/files.h"
#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxSize = 32768.0;
constexpr double kMaxBinning = 64.0;
constexpr const char* kWhatIsRead =
    "; a file of intrinsics is YAML of camera_calibration, of `ros2 topic echo`, or OpenCV's FileStorage with "
    "image_width, image_height, camera_matrix and distortion_coefficients";

// camera_calibration's, those of ROS 1 and ROS 2 messages, and OpenCV's, by the names of CameraInfo.
const std::vector<std::string>& spellings(const std::string& field) {
  static const std::map<std::string, std::vector<std::string>> all = {
      {"width", {"image_width", "width", "image_Width"}},
      {"height", {"image_height", "height", "image_Height"}},
      {"k", {"camera_matrix", "K", "k", "Camera_Matrix"}},
      {"d", {"distortion_coefficients", "D", "d", "Distortion_Coefficients"}},
      {"r", {"rectification_matrix", "R", "r"}},
      {"p", {"projection_matrix", "P", "p"}},
      {"distortion_model", {"distortion_model"}},
      {"roi", {"roi"}}};
  return all.at(field);
}

// The first of the spellings that the file has.
std::string present_key(const YamlTree& tree, const std::string& field) {
  for (const std::string& key : spellings(field))
    if (tree.find(key) != nullptr) return key;
  return spellings(field).front();
}

bool has(const YamlTree& tree, const std::string& field) { return tree.find(present_key(tree, field)) != nullptr; }

std::uint32_t read_count(MapReader& map, const std::string& key, const NumberRange& range) {
  return static_cast<std::uint32_t>(map.integer(key, range).value_or(0));
}

std::uint32_t read_side(MapReader& map, const std::string& field) {
  const std::string key = present_key(map.tree(), field);
  map.require(key, "the image size in pixels");
  return read_count(map, key, {1.0, kMaxSize});
}

bool is_whole(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == std::floor(number); });
}

void read_size(MapReader& map, CameraInfo* info) {
  if (map.has("imageSize")) {
    const auto size = map.numbers("imageSize", 2, 2, {1.0, kMaxSize});
    if (size && !is_whole(*size)) map.problem("imageSize", "must be whole numbers of pixels");
    if (size) info->width = static_cast<std::uint32_t>((*size)[0]);
    if (size) info->height = static_cast<std::uint32_t>((*size)[1]);
    return;
  }
  info->width = read_side(map, "width");
  info->height = read_side(map, "height");
}

// {rows, cols, data: [..]} or a plain list.
std::vector<double> read_array(MapReader& map, const std::string& field, std::size_t size_min, std::size_t size_max) {
  const std::string key = present_key(map.tree(), field);
  map.require(key, "a list of numbers");
  const YamlTree* value = map.find(key);
  if (value == nullptr || !value->is_map())
    return map.numbers(key, size_min, size_max, {}).value_or(std::vector<double>());
  MapReader block(*value, map.path_of(key), &map.problems());
  block.require("data", "a list of numbers");
  return block.numbers("data", size_min, size_max, {}).value_or(std::vector<double>());
}

template <std::size_t kSize>
void read_matrix(MapReader& map, const std::string& field, bool is_needed, std::array<double, kSize>* to) {
  if (!is_needed && !has(map.tree(), field)) return;
  const std::vector<double> values = read_array(map, field, kSize, kSize);
  std::copy(values.begin(), values.end(), to->begin());
}

// OpenCV's calibration sample has a flag in place of the model's name.
std::string read_model(MapReader& map) {
  const std::string flag = map.text("fisheye_model").value_or("0");
  const bool fisheye = flag == "1" || flag == "true";
  return map.text("distortion_model").value_or(fisheye ? "equidistant" : "plumb_bob");
}

void read_region(MapReader& map, CameraInfo* info) {
  info->binning_x = read_count(map, "binning_x", {0.0, kMaxBinning});
  info->binning_y = read_count(map, "binning_y", {0.0, kMaxBinning});
  const YamlTree* tree = map.find("roi");
  if (tree == nullptr || !tree->is_map()) return;  // OpenCV's list of that name is of undistorted images
  MapReader block(*tree, map.path_of("roi"), &map.problems());
  info->roi.x_offset = read_count(block, "x_offset", {0.0, kMaxSize});
  info->roi.y_offset = read_count(block, "y_offset", {0.0, kMaxSize});
  info->roi.height = read_count(block, "height", {0.0, kMaxSize});
  info->roi.width = read_count(block, "width", {0.0, kMaxSize});
}

void read_rectification(MapReader& map, CameraInfo* info) {
  read_matrix(map, "r", false, &info->r);
  if (has(map.tree(), "p")) return read_matrix(map, "p", true, &info->p);
  map.problem("",
              "has no projection_matrix (P), with which images of a topic image_rect* go: "
              "they are rectified, and camera_matrix and distortion are of the raw ones");
}

CameraInfo read_fields(MapReader& map, bool rectified) {
  CameraInfo info;
  read_size(map, &info);
  read_matrix(map, "k", true, &info.k);
  info.d = read_array(map, "d", 0, 14);
  info.distortion_model = read_model(map);
  if (rectified) read_rectification(map, &info);
  read_region(map, &info);
  return info;
}

// `ros2 topic echo` ends each message with ---, of which the first one counts.
std::string first_message(const std::string& text) {
  std::istringstream lines(text);
  std::string message, line;
  for (bool begun = false; std::getline(lines, line);) {
    if (begun && line.rfind("---", 0) == 0) break;
    if (message.empty() && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);  // the mark of UTF-8
    const bool is_blank = line.find_first_not_of(" \t\r") == std::string::npos;
    begun = begun || (!is_blank && line[0] != '%' && line[0] != '#' && line.rfind("---", 0) != 0);
    message += line + "\n";
  }
  return message;
}

YamlTree parse_info(const fs::path& file) {
  constexpr std::uintmax_t kMaxBytes = 4U << 20U;
  const std::string text = read_text_file(file, kMaxBytes);
  try {
    return parse_yaml(first_message(text), file);
  } catch (const Error& error) {
    throw Error(error.what() + std::string(kWhatIsRead));
  }
}

}  // namespace

std::optional<InfoReading> read_camera_info(const fs::path& file, bool rectified, Problems* problems) {
  const YamlTree tree = parse_info(file);
  if (!has(tree, "k") && !has(tree, "d")) {
    problems->add({file.string(), 0, "", "", std::string("holds no intrinsics that can be read") + kWhatIsRead});
    return std::nullopt;
  }
  MapReader map(tree, "", problems);
  const std::size_t before = problems->all().size();
  const CameraInfo info = read_fields(map, rectified);
  if (problems->all().size() > before) return std::nullopt;
  try {
    return camera_of_info(info, rectified);
  } catch (const CameraInfoError& error) {
    map.problem(present_key(tree, error.field()), error.what());
    return std::nullopt;
  }
}

}  // namespace rigproof
