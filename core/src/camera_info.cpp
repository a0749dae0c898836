#include "camera_info.h"

#include <algorithm>

namespace rigproof {
namespace {

constexpr double kMaxSize = 32768.0;

// The first of the spellings that the file has: camera_calibration's, then those of ROS 1 and ROS 2 messages.
std::string present_key(MapReader& map, const std::vector<std::string>& spellings) {
  for (const std::string& key : spellings)
    if (map.has(key)) return key;
  return spellings.front();
}

int read_size(MapReader& map, const std::vector<std::string>& spellings) {
  const std::string key = present_key(map, spellings);
  map.require(key, "the image size in pixels");
  return static_cast<int>(map.integer(key, {1.0, kMaxSize}).value_or(0));
}

// {rows, cols, data: [..]} or a plain list.
std::optional<std::vector<double>> read_array(MapReader& map, const std::vector<std::string>& spellings,
                                              std::size_t size_min, std::size_t size_max) {
  const std::string key = present_key(map, spellings);
  const YamlTree* value = map.find(key);
  if (value == nullptr || !value->is_map()) {
    map.require(key, "a list of numbers");
    return map.numbers(key, size_min, size_max, {});
  }
  MapReader block(*value, map.path_of(key), &map.problems());
  block.require("data", "a list of numbers");
  return block.numbers("data", size_min, size_max, {});
}

void read_matrix(MapReader& map, Camera* camera) {
  const std::vector<std::string> spellings = {"camera_matrix", "K", "k"};
  const auto K = read_array(map, spellings, 9, 9);
  if (!K) return;
  camera->fx_px = (*K)[0];
  camera->cx_px = (*K)[2];
  camera->fy_px = (*K)[4];
  camera->cy_px = (*K)[5];
  const bool upper = (*K)[1] == 0.0 && (*K)[3] == 0.0 && (*K)[6] == 0.0 && (*K)[7] == 0.0 && (*K)[8] == 1.0;
  if (!upper || !(camera->fx_px > 0.0) || !(camera->fy_px > 0.0))
    map.problem(present_key(map, spellings), "must be fx 0 cx 0 fy cy 0 0 1 with fx, fy > 0; skew is not supported");
}

bool all_zero(const std::vector<double>& values, std::size_t from) {
  return std::all_of(values.begin() + static_cast<std::ptrdiff_t>(std::min(from, values.size())), values.end(),
                     [](double value) { return value == 0.0; });
}

void read_distortion(MapReader& map, Camera* camera) {
  const std::string model = map.text("distortion_model").value_or("plumb_bob");
  const std::vector<std::string> spellings = {"distortion_coefficients", "D", "d"};
  const auto coefficients = read_array(map, spellings, 0, 14);
  if (!coefficients) return;
  const bool fisheye = model == "equidistant" || model == "fisheye";
  if (!fisheye && model != "plumb_bob" && model != "rational_polynomial") {
    map.problem("distortion_model",
                "is not supported; allowed are plumb_bob (k1 k2 p1 p2 k3) and equidistant (k1..k4)");
    return;
  }
  const std::size_t used = fisheye ? 4 : 5;
  if (!all_zero(*coefficients, used)) {
    map.problem(present_key(map, spellings), "only the first " + std::to_string(used) +
                                                 " coefficients of this model are supported; the others must be 0");
    return;
  }
  std::copy_n(coefficients->begin(), std::min(used, coefficients->size()), camera->distortion.begin());
  if (fisheye)
    camera->lens = Lens::kKannalaBrandt;
  else
    camera->lens = all_zero(*coefficients, 0) ? Lens::kPinhole : Lens::kBrownConrady;
}

}  // namespace

Camera read_camera_info(const YamlTree& tree, Problems* problems) {
  Camera camera;
  MapReader map(tree, "", problems);
  camera.width_px = read_size(map, {"image_width", "width"});
  camera.height_px = read_size(map, {"image_height", "height"});
  read_matrix(map, &camera);
  read_distortion(map, &camera);
  return camera;
}

}  // namespace rigproof
