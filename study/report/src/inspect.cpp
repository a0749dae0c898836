#include "rigproof/study/report/inspect.h"

#include <algorithm>

#include "inspect_pictures.h"

namespace rigproof {
namespace inspect_detail {

std::vector<std::string> camera_names(const Observations& observations) {
  std::vector<std::string> names;
  for (const RigCamera& camera : observations.cameras) names.push_back(camera.name);
  return names;
}

double height_at(double width, const Camera& camera) { return width * camera.height_px / std::max(1, camera.width_px); }

cv::Mat draw_image(const InspectInput& input, const std::string& file, const Eigen::Vector2d& corner,
                   const Eigen::Vector2d& size, Canvas* canvas) {
  canvas->rectangle(corner, size, kRule.pale(0.5));
  if (!input.input.recording || input.input.recording->folder.empty()) return {};
  cv::Mat picture = read_color(input.input.recording->folder, file);
  if (!picture.empty())
    canvas->image(picture, corner, size);
  else
    canvas->text(corner + 0.5 * size, "image cannot be read", 9.0, kGrey, Align::kCentre);
  return picture;
}

std::optional<std::size_t> index_in_truth(const Truth& truth, const std::string& camera) {
  for (std::size_t i = 0; i < truth.cameras.size(); ++i)
    if (truth.cameras[i].name == camera) return i;
  return std::nullopt;
}

const EstimatedTransform* pose_of_camera(const Result& result, const std::string& camera) {
  for (const EstimatedTransform& estimate : result.camera_to_robot)
    if (estimate.child == camera && estimate.fully_observable()) return &estimate;
  return nullptr;
}

std::array<Eigen::Vector3d, 4> image_corner_rays(const Camera& camera) {
  const double right = camera.width_px - 1.0, bottom = camera.height_px - 1.0;
  const auto ray_at = [&camera](double u, double v) {
    Eigen::Vector3d ray((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px, 1.0);
    camera.unproject({u, v}, &ray);
    return ray;
  };
  return {ray_at(0.0, 0.0), ray_at(right, 0.0), ray_at(right, bottom), ray_at(0.0, bottom)};
}

std::optional<Rigid3> camera_pose(const InspectInput& input, const std::string& camera) {
  if (input.truth)
    if (const auto i = index_in_truth(*input.truth, camera)) return input.truth->cameras[*i].T_robot_camera;
  for (const Result& result : input.results)
    if (const EstimatedTransform* estimate = pose_of_camera(result, camera)) return estimate->T_parent_child;
  return std::nullopt;
}

std::optional<double> distance_to_board(const InspectInput& input, const BoardView& view) {
  if (!input.truth || view.board >= input.truth->boards()) return std::nullopt;
  const TrueBoard& board = input.truth->board_at(view.board);
  const auto camera =
      index_in_truth(*input.truth, input.observations.cameras[static_cast<std::size_t>(view.camera)].name);
  if (!camera) return std::nullopt;
  const std::vector<TrueStop>& stops = input.truth->stops_of(*camera);
  const auto stop = stop_at(stops, view.stamp_s);
  if (!stop) return std::nullopt;
  const Rigid3 T_world_camera = stops[*stop].T_world_robot * input.truth->cameras[*camera].T_robot_camera;
  return (T_world_camera.inverse() * (board.T_world_board * board.board.centre())).norm();
}

}  // namespace inspect_detail

std::vector<std::filesystem::path> write_pictures(const InspectInput& input, const std::filesystem::path& folder,
                                                  const InspectOptions& options) {
  using namespace inspect_detail;
  std::vector<std::filesystem::path> files;
  const auto keep = [&files](const Written& written) {
    if (written) files.push_back(*written);
  };
  const std::size_t cameras = input.observations.cameras.size();
  keep(draw_mosaic(input, options, folder));
  keep(draw_coverage(input, folder));
  keep(draw_drive(input, folder));
  keep(draw_rig_in_space(input, folder));
  for (std::size_t camera = 0; camera < cameras; ++camera) keep(draw_corners(input, camera, folder));
  for (const Result& result : input.results) {
    if (!input.truth) {
      const CornerFit fit = fit_corners(input.observations, result);
      for (std::size_t camera = 0; camera < cameras; ++camera)
        keep(draw_fitted_corners(input, result, fit, camera, folder));
    }
    for (std::size_t camera = 0; camera < cameras; ++camera) keep(draw_reprojection(input, result, camera, folder));
  }
  keep(draw_excluded(input, options, folder));
  return files;
}

}  // namespace rigproof
