#include "mcalib_result.h"

#include <Eigen/LU>
#include <filesystem>

#include "rigproof/core/files.h"

namespace rigproof {
namespace {

constexpr std::uintmax_t kMaxBytes = 1U << 20U;
constexpr double kRotationTolerance = 1e-3;
constexpr double kMaxCameras = 1000.0;
constexpr double kFarthestM = 1e6;  // as in a result's file

std::string camera_key(std::int64_t k) { return "camera_" + std::to_string(k); }

// As the export of the same folder names them.
std::vector<std::string> names_beside(const std::filesystem::path& file, std::int64_t count) {
  std::vector<std::string> names;
  for (std::int64_t k = 0; k < count; ++k) names.push_back(camera_key(k));
  const std::filesystem::path lenses = file.parent_path() / "camera_params.yml";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(lenses, ignored)) return names;
  const YamlTree tree = read_yaml_file(lenses, kMaxBytes);
  for (std::string& name : names)
    if (const YamlTree* camera = tree.find(name))
      if (const YamlTree* text = camera->is_map() ? camera->find("name") : nullptr)
        if (text->is_scalar() && !text->scalar.empty()) name = text->scalar;
  return names;
}

std::optional<Rigid3> read_pose(MapReader* camera) {
  camera->require("camera_pose_matrix", "a matrix of four rows and columns");
  const YamlTree* tree = camera->find("camera_pose_matrix");
  if (tree == nullptr) return std::nullopt;
  MapReader reader(*tree, camera->path_of("camera_pose_matrix"), &camera->problems());
  reader.require("data", "sixteen numbers, row by row");
  const auto numbers = reader.numbers("data", 16, 16, {-kFarthestM, kFarthestM});
  if (!numbers) return std::nullopt;
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers->data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < kRotationTolerance) || !(R.determinant() > 0.0)) {
    reader.problem("data", "its first three rows and columns must be a rotation");
    return std::nullopt;
  }
  return Rigid3::from_matrix(matrix);
}

}  // namespace

bool is_mcalib_result(const YamlTree& tree) {
  return tree.is_map() && tree.find("nb_camera") != nullptr && tree.find(camera_key(0)) != nullptr;
}

Result read_mcalib_result(const YamlTree& tree, Problems* problems) {
  Result result;
  result.method = "mcalib";
  result.status = ResultStatus::kSolved;
  MapReader map(tree, "", problems);
  const std::int64_t count = map.integer("nb_camera", {1.0, kMaxCameras}).value_or(0);
  const std::vector<std::string> names = names_beside(tree.file, count);
  std::optional<Rigid3> T_first_inverse;
  std::int64_t group_of_first = 0;
  for (std::int64_t k = 0; k < count; ++k) {
    map.require(camera_key(k), "a camera");
    const YamlTree* block = map.find(camera_key(k));
    if (block == nullptr) continue;
    MapReader camera(*block, camera_key(k), problems);
    const std::int64_t group = camera.integer("camera_group").value_or(0);
    const std::optional<Rigid3> T = read_pose(&camera);
    if (!T) continue;
    const std::string& name = names[static_cast<std::size_t>(k)];
    if (k == 0) {
      T_first_inverse = T->inverse();
      group_of_first = group;
    } else if (group != group_of_first) {
      result.status = ResultStatus::kPartial;
      result.reasons.push_back(Finding("cameras.apart", {{"groups", names.front() + " | " + name}}));
    } else if (T_first_inverse) {
      result.camera_to_camera.push_back({names.front(), name, *T_first_inverse * *T, std::nullopt});
    }
  }
  return result;
}

}  // namespace rigproof
