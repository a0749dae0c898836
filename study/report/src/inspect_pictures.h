// One function a picture; each returns the file it wrote, or nothing where there was nothing to show.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "corner_fit.h"
#include "inspect_canvas.h"
#include "rigproof/study/report/inspect.h"
#include "rigproof/truth/stop_at.h"

namespace rigproof::inspect_detail {

using Written = std::optional<std::filesystem::path>;

Written draw_mosaic(const InspectInput& input, const InspectOptions& options, const std::filesystem::path& folder);
Written draw_coverage(const InspectInput& input, const std::filesystem::path& folder);
Written draw_drive(const InspectInput& input, const std::filesystem::path& folder);
Written draw_rig_in_space(const InspectInput& input, const std::filesystem::path& folder);
Written draw_corners(const InspectInput& input, std::size_t camera, const std::filesystem::path& folder);
/// Against the boards that fit best; of a camera that the result has the pose of.
Written draw_fitted_corners(const InspectInput& input, const Result& result, const CornerFit& fit, std::size_t camera,
                            const std::filesystem::path& folder);
Written draw_reprojection(const InspectInput& input, const Result& result, std::size_t camera,
                          const std::filesystem::path& folder);
Written draw_excluded(const InspectInput& input, const InspectOptions& options, const std::filesystem::path& folder);

/// A difference between two places of one corner.
struct Residual {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector2d difference = Eigen::Vector2d::Zero();  ///< [px]
};
struct ResidualPicture {
  std::string title;
  std::string subtitle;
  std::size_t camera = 0;
  Camera image;
  std::vector<Residual> residuals;
  double stated_sigma_px = 0.0;  ///< drawn as a circle and a curve; 0 = none

  /// Of both axes, rms over the stated sigma, which is not 0.
  double rms_over_stated() const;
};
/// The image plane with magnified arrows, a scatter plot and a histogram of each axis.
std::filesystem::path draw_residuals(const ResidualPicture& picture, const std::filesystem::path& file);

/// A camera's residuals of the fit with what detector and lens let expect of them.
ResidualPicture fitted_corners(const Observations& observations, const Result& result, const CornerFit& fit,
                               std::size_t camera);

std::vector<std::string> camera_names(const Observations& observations);
/// Height of a camera's images that are drawn so wide.
double height_at(double width, const Camera& camera);
/// An image of the recording in its frame, or that it cannot be read; an empty frame without a recording. Returns
/// the image, as BGR, empty where there is none.
cv::Mat draw_image(const InspectInput& input, const std::string& file, const Eigen::Vector2d& corner,
                   const Eigen::Vector2d& size, Canvas* canvas);
std::optional<std::size_t> index_in_truth(const Truth& truth, const std::string& camera);
/// Its pose in the robot frame, if the result answers all of it; else null.
const EstimatedTransform* pose_of_camera(const Result& result, const std::string& camera);
/// Rays through the image's corners at z = 1: top left, top right, bottom right, bottom left. Of a lens that has no ray
/// there, those of a pinhole.
std::array<Eigen::Vector3d, 4> image_corner_rays(const Camera& camera);
/// Camera pose in the robot frame: the truth's, else the first result's that has it completely.
std::optional<Rigid3> camera_pose(const InspectInput& input, const std::string& camera);
/// "2.31": metres from the camera to the board's middle, if truth tells.
std::optional<double> distance_to_board(const InspectInput& input, const BoardView& view);

}  // namespace rigproof::inspect_detail
