#include "reference_boards.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <set>
#include <utility>

#include "rigproof/calib/vision/image_findings.h"
#include "rigproof/calib/vision/recall.h"
#include "rigproof/calib/vision/reference_corners.h"

namespace rigproof::rivals {
namespace {

constexpr float kRansacPixels = 15.0F;
constexpr int kRansacIterations = 100;
constexpr double kRansacConfidence = 0.99;

/// What is known of a view before its pose.
struct View {
  std::string file;
  std::optional<ChessboardCorners> corners = {};
  Finding why_not = Finding("board.not_found");  ///< where there are none
};
using Views = std::map<std::pair<int, int>, View>;  // by (stop, camera)

/// What OpenCV is told of a camera. It has no pinhole with a fisheye's distortion: there pixels are those that a
/// pinhole of the same focal length would have seen.
struct OpenCvView {
  std::vector<cv::Point2f> pixels;
  cv::Mat K = cv::Mat::eye(3, 3, CV_64F), distortion;
};

std::optional<OpenCvView> opencv_view(const ChessboardCorners& corners, const Camera& camera) {
  OpenCvView view;
  const bool fisheye = camera.lens == Lens::kKannalaBrandt;
  view.K.at<double>(0, 0) = camera.fx_px;
  view.K.at<double>(1, 1) = fisheye ? camera.fx_px : camera.fy_px;
  view.K.at<double>(0, 2) = fisheye ? 0.0 : camera.cx_px;
  view.K.at<double>(1, 2) = fisheye ? 0.0 : camera.cy_px;
  if (camera.lens == Lens::kBrownConrady)
    view.distortion = cv::Mat(1, 5, CV_64F, const_cast<double*>(camera.distortion.data())).clone();
  for (const Eigen::Vector2f& pixel : corners.pixels) {
    Eigen::Vector3d ray;
    if (!camera.unproject(pixel.cast<double>(), &ray)) return std::nullopt;
    const Eigen::Vector2f p = fisheye ? Eigen::Vector2f((camera.fx_px * ray.head<2>()).cast<float>()) : pixel;
    view.pixels.emplace_back(p.x(), p.y());
  }
  return view;
}

double mean_squared_px(const ChessboardCorners& corners, const Board& board, const Camera& camera,
                       const Rigid3& T_camera_board) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.pixels.size(); ++i) {
    Eigen::Vector2d pixel;
    if (camera.project(T_camera_board * board.corner(static_cast<int>(i)), &pixel))
      sum += (pixel - corners.pixels[i].cast<double>()).squaredNorm();
  }
  return sum / static_cast<double>(corners.pixels.size());
}

std::optional<ReferencePose> ransac_pose(const ChessboardCorners& corners, const Board& board, const Camera& camera) {
  const std::optional<OpenCvView> view = opencv_view(corners, camera);
  if (!view) return std::nullopt;
  std::vector<cv::Point3f> points;
  for (const Eigen::Vector3d& p : board.corners())
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
  cv::Mat rotation, translation, inliers;
  try {
    if (!cv::solvePnPRansac(points, view->pixels, view->K, view->distortion, rotation, translation, false,
                            kRansacIterations, kRansacPixels, kRansacConfidence, inliers))
      return std::nullopt;
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (inliers.total() != points.size()) return std::nullopt;
  const Eigen::Vector3d phi(rotation.ptr<double>()), t(translation.ptr<double>());
  if (!phi.allFinite() || !t.allFinite()) return std::nullopt;
  const Rigid3 T_camera_board(so3_exp(phi), t);
  return ReferencePose{T_camera_board, mean_squared_px(corners, board, camera, T_camera_board)};
}

// A hundred samples of EPnP take a hundred times as long as the rest of the method takes for a view, and the odometry
// does not enter.
std::optional<ReferencePose> pose_of(const ChessboardCorners& corners, const MethodInput& input, std::size_t camera) {
  const Board& board = input.observations.board;
  const Camera& lens = input.observations.cameras[camera].camera;
  const std::string key = input.memory == nullptr ? std::string() : reference_pose_key(corners, lens, board);
  std::optional<ReferencePose> pose;
  detection::recall_or(input.memory, PictureMemory::Finding::kBoardPoses, key, &pose, [&] {
    pose = ransac_pose(corners, board, lens);
    return true;
  });
  return pose;
}

// In the order of ids, if all were seen.
std::optional<ChessboardCorners> whole_board(const BoardView& view, const Board& board) {
  if (static_cast<int>(view.corners.size()) != board.corner_count()) return std::nullopt;
  ChessboardCorners corners;
  corners.pixels.resize(view.corners.size());
  for (const CornerObservation& corner : view.corners)
    corners.pixels[static_cast<std::size_t>(corner.id)] = corner.pixel.cast<float>();
  return corners;
}

// Why a view without all of its corners is left out.
Finding why_no_corners(const BoardView& view, const Board& board) {
  if (board.type == "checkerboard") return Finding("view.corner_outliers");
  return Finding("board.partly_hidden", {{"corners", view.corners.size()}, {"of", board.corner_count()}});
}

Views views_of(const MethodInput& input, const FramesByStop& frames) {
  const Observations& observations = input.observations;
  Views views;
  for (const BoardView& view : observations.board_views)
    views[{view.stop, view.camera}] = {view.file, whole_board(view, observations.board),
                                       why_no_corners(view, observations.board)};
  if (observations.board.type != "checkerboard") return views;
  for (auto& [at, corners] : reference_chessboards(input, frames))
    views[at] = {frames.at(at)->color_file, std::move(corners)};
  return views;
}

// What observing left out stands, but for images that were searched here.
std::vector<Exclusion> left_out_before(const Observations& observations, const Views& views, int camera) {
  std::vector<Exclusion> left_out;
  for (const Exclusion& exclusion : observations.exclusions)
    if (exclusion.camera == camera && (exclusion.depth || views.count({exclusion.stop, camera}) == 0))
      left_out.push_back(exclusion);
  return left_out;
}

}  // namespace

ReferenceBoards reference_boards(const MethodInput& input, const FramesByStop& frames) {
  const Observations& observations = input.observations;
  const Views views = views_of(input, frames);
  const std::size_t cameras = observations.cameras.size();
  ReferenceBoards boards{std::vector<BoardPoses>(cameras), std::vector<CameraUse>(cameras)};
  for (std::size_t k = 0; k < cameras; ++k) {
    boards.use[k].camera = observations.cameras[k].name;
    boards.use[k].left_out = left_out_before(observations, views, static_cast<int>(k));
  }
  std::vector<double> squared_px(cameras, 0.0);
  for (const auto& [at, view] : views) {
    const auto k = static_cast<std::size_t>(at.second);
    std::optional<ReferencePose> pose;
    if (view.corners) pose = pose_of(*view.corners, input, k);
    if (!pose) {
      const Finding why = view.corners ? Finding("view.corner_outliers") : view.why_not;
      boards.use[k].left_out.push_back({at.second, at.first, view.file, why});
      continue;
    }
    boards.poses[k][at.first] = pose->T_camera_board;
    ++boards.use[k].used;
    squared_px[k] += pose->squared_px;
  }
  for (std::size_t k = 0; k < cameras; ++k) {
    CameraUse& use = boards.use[k];
    std::stable_sort(use.left_out.begin(), use.left_out.end(),
                     [](const Exclusion& a, const Exclusion& b) { return a.stop < b.stop; });
    use.reprojection_rms_px = use.used > 0 ? std::sqrt(squared_px[k] / use.used) : 0.0;
  }
  return boards;
}

}  // namespace rigproof::rivals
