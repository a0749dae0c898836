#include "rigproof/formats/camchain.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

bool is_camera(const std::pair<std::string, YamlTree>& entry) {
  const std::string& key = entry.first;
  return key.size() > 3 && key.rfind("cam", 0) == 0 && key.find_first_not_of("0123456789", 3) == std::string::npos &&
         entry.second.is_map();
}

// Four rows of four numbers: a rotation and a translation above 0 0 0 1.
std::optional<Rigid3> read_pose(const std::string& key, MapReader& map) {
  constexpr double kMaxOff = 1e-3;  // of matrices that people round
  const YamlTree* rows = map.find(key);
  if (rows == nullptr) return std::nullopt;
  Problems of_rows;
  Eigen::Matrix4d T = Eigen::Matrix4d::Zero();
  for (std::size_t row = 0; row < 4 && rows->items.size() == 4; ++row)
    if (const auto numbers = read_numbers(rows->items[row], key, 4, 4, {}, &of_rows))
      T.row(static_cast<Eigen::Index>(row)) = Eigen::Map<const Eigen::RowVector4d>(numbers->data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < kMaxOff && R.determinant() > 0.0 &&
      (T.row(3) - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)).norm() < kMaxOff)
    return Rigid3::from_matrix(T);
  map.problem(key, "must be four rows of four numbers, a rotation and a translation above 0 0 0 1");
  return std::nullopt;
}

CamchainCamera read_camera(const std::string& name, const YamlTree& tree, Problems* problems) {
  constexpr double kMaxSide = 32768.0, kMaxPixel = 1e6;
  CamchainCamera camera;
  camera.name = name;
  MapReader map(tree, name, problems);
  map.text("camera_model", {"pinhole"});
  map.require("intrinsics", "fu fv pu pv");
  const auto K = map.numbers("intrinsics", 4, 4, {-kMaxPixel, kMaxPixel}).value_or(std::vector<double>(4));
  camera.info.k = {K[0], 0.0, K[2], 0.0, K[1], K[3], 0.0, 0.0, 1.0};
  map.require("resolution", "width and height in pixels");
  const auto size = map.numbers("resolution", 2, 2, {1.0, kMaxSide}).value_or(std::vector<double>(2));
  if (std::any_of(size.begin(), size.end(), [](double side) { return side != std::floor(side); }))
    map.problem("resolution", "must be whole numbers of pixels");
  camera.info.width = static_cast<std::uint32_t>(size[0]);
  camera.info.height = static_cast<std::uint32_t>(size[1]);
  map.require("distortion_model", "radtan, equidistant or none");
  camera.info.distortion_model = map.text("distortion_model", {"radtan", "equidistant", "none"}).value_or("none");
  const bool distorts = camera.info.distortion_model != "none";
  if (distorts) map.require("distortion_coeffs", "four coefficients");
  if (distorts) camera.info.d = map.numbers("distortion_coeffs", 4, 4, {}).value_or(std::vector<double>());
  camera.rostopic = map.text("rostopic").value_or("");
  camera.T_this_previous = read_pose("T_cn_cnm1", map);
  return camera;
}

std::optional<YamlTree> yaml_of(const fs::path& file) {
  try {
    return read_yaml_file(file);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    return std::nullopt;
  }
}

}  // namespace

std::optional<std::vector<CamchainCamera>> read_camchain(const fs::path& file) {
  const std::optional<YamlTree> tree = yaml_of(file);
  if (!tree || std::none_of(tree->entries.begin(), tree->entries.end(), is_camera)) return std::nullopt;
  std::vector<CamchainCamera> cameras;
  Problems problems;
  for (const auto& entry : tree->entries)
    if (is_camera(entry)) cameras.push_back(read_camera(entry.first, entry.second, &problems));
  problems.throw_if_any();
  return cameras;
}

}  // namespace rigproof
