// MEMROC as the authors' program computes it. What looks like a mistake here is one of theirs, and tested as such.
#include <Eigen/SVD>
#include <algorithm>
#include <map>
#include <opencv2/calib3d.hpp>

#include "memroc_reference_cost.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_files.h"
#include "rigproof/calib/vision/image_findings.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/recall.h"
#include "rigproof/calib/vision/reference_cloud_plane.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rival_result.h"

namespace rigproof {
namespace {

using rivals::CloudPlane;
using rivals::ReferenceProblem;

constexpr double kRansacPixels = 15.0;
constexpr double kLevelNormal = 0.995;
// As many points as a thinned cloud of the program's own data has.
constexpr int kCloudPoints = 12000;

// By stop; a frame whose board was not wholly an inlier is absent.
using BoardPoses = std::map<int, Rigid3>;

std::optional<Rigid3> ransac_pose(const BoardView& view, const Board& board, const Camera& camera) {
  if (static_cast<int>(view.corners.size()) != board.corner_count()) return std::nullopt;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const CornerObservation& corner : view.corners) {
    Eigen::Vector3d ray;
    if (!camera.unproject(corner.pixel, &ray)) return std::nullopt;
    const Eigen::Vector3d p = board.corner(corner.id);
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(camera.fx_px * ray.x(), camera.fx_px * ray.y());
  }
  cv::Mat K = cv::Mat::eye(3, 3, CV_64F), rotation, translation, inliers;
  K.at<double>(0, 0) = K.at<double>(1, 1) = camera.fx_px;
  try {
    if (!cv::solvePnPRansac(points, pixels, K, cv::noArray(), rotation, translation, false, 100,
                            static_cast<float>(kRansacPixels), 0.99, inliers))
      return std::nullopt;
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (inliers.total() != points.size()) return std::nullopt;
  const auto vector = [](const cv::Mat& m) {
    return Eigen::Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
  };
  const Eigen::Vector3d phi = vector(rotation), t = vector(translation);
  if (!phi.allFinite() || !t.allFinite()) return std::nullopt;
  return Rigid3(so3_exp(phi), t);
}

Rigid3 odometry_at(const Observations& observations, int stop) {
  const Stop& at = observations.stops[static_cast<std::size_t>(stop)];
  return planar_pose(at.x_m, at.y_m, at.yaw_rad);
}

// R_world_board that best lays the camera's path in the board frame onto the robot's path: the program leaves out that
// camera and robot move differently when the robot turns.
Eigen::Matrix3d align_paths(const Observations& observations, const BoardPoses& boards) {
  Eigen::Vector3d mean_robot = Eigen::Vector3d::Zero(), mean_camera = Eigen::Vector3d::Zero();
  for (const auto& [stop, T_camera_board] : boards) {
    mean_robot += odometry_at(observations, stop).translation;
    mean_camera += camera_position_in_board(T_camera_board);
  }
  mean_robot /= static_cast<double>(boards.size());
  mean_camera /= static_cast<double>(boards.size());
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (const auto& [stop, T_camera_board] : boards)
    H += (camera_position_in_board(T_camera_board) - mean_camera) *
         (odometry_at(observations, stop).translation - mean_robot).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d R = svd.matrixV() * svd.matrixU().transpose();
  if (R.determinant() < 0.0) {
    Eigen::Matrix3d V = svd.matrixV();
    V.col(2) *= -1.0;
    R = V * svd.matrixU().transpose();
  }
  return R;
}

bool has_clouds(const Observations& observations, const Recording& recording) {
  for (std::size_t k = 0; k < std::min(observations.cameras.size(), recording.frames.size()); ++k)
    for (const CameraFrame& frame : recording.frames[k])
      if (!frame.cloud_file.empty() || (!frame.depth_file.empty() && observations.cameras[k].depth)) return true;
  return false;
}

class ReferenceSolver {
 public:
  ReferenceSolver(const MethodInput& input, bool joint)
      : input_(input), observations_(input.observations), joint_(joint), pnp_(estimate_view_poses(observations_)) {}

  Result solve() {
    find_boards();
    for (int k = 0; k < camera_count(); ++k) add_camera(k);
    if (joint_) add_pairs();
    rivals::minimise_reference(&problem_);
    report();
    return std::move(result_);
  }

 private:
  int camera_count() const { return static_cast<int>(observations_.cameras.size()); }
  const RigCamera& camera(int k) const { return observations_.cameras[static_cast<std::size_t>(k)]; }

  void find_boards() {
    boards_.resize(observations_.cameras.size());
    for (const BoardView& view : observations_.board_views) {
      const std::optional<Rigid3> pose = ransac_pose(view, observations_.board, camera(view.camera).camera);
      if (!pose) continue;
      boards_[static_cast<std::size_t>(view.camera)][view.stop] = *pose;
      used_.insert({view.stop, view.camera});
    }
  }

  // Points of the camera's cloud; none where the recording has neither clouds nor depth, or they cannot be read.
  std::vector<Eigen::Vector3f> cloud_of(const CameraFrame& frame, int k) const {
    try {
      return read_cloud(frame, k);
    } catch (const Error&) {
      return {};
    }
  }

  std::vector<Eigen::Vector3f> read_cloud(const CameraFrame& frame, int k) const {
    const std::filesystem::path& folder = input_.recording->folder;
    if (!frame.cloud_file.empty()) {
      auto cloud = read_point_cloud(path_inside(folder, frame.cloud_file));
      if (auto* points = std::get_if<std::vector<Eigen::Vector3f>>(&cloud)) return std::move(*points);
      return {};
    }
    if (frame.depth_file.empty() || !camera(k).depth) return {};
    const auto depth = read_depth_image(path_inside(folder, frame.depth_file));
    const auto* image = std::get_if<Image16>(&depth);
    if (image == nullptr) return {};
    int stride = 1;
    while ((image->width / stride) * (image->height / stride) > kCloudPoints) ++stride;
    return points_from_depth(*image, camera(k), stride).points;
  }

  std::optional<CloudPlane> plane_of_cloud(int stop, int k) const {
    throw_if_interrupted(input_);
    const CameraFrame* frame = frames_.empty() ? nullptr : rivals::frame_of(frames_, stop, k);
    if (frame == nullptr) return std::nullopt;
    const std::string content =
        detection::content_of(input_.memory, frame->cloud_file.empty() ? frame->depth_file : frame->cloud_file);
    const std::string key = content.empty() ? content : rivals::cloud_key(content, camera(k), kCloudPoints, stop, k);
    std::optional<CloudPlane> plane;
    detection::recall_or(input_.memory, PictureMemory::Finding::kClouds, key, &plane, [&] {
      const std::vector<Eigen::Vector3f> cloud = cloud_of(*frame, k);
      plane = rivals::largest_plane(cloud, RandomStream(0, "memroc_reference plane", stop, k));
      return !cloud.empty();
    });
    return plane;
  }

  // Without a recording the observed plane is what the cloud would have shown.
  std::optional<CloudPlane> plane_at(int stop, int k) const {
    if (input_.recording != nullptr) return plane_of_cloud(stop, k);
    for (const PlaneObservation& plane : observations_.ground_planes) {
      if (plane.stop != stop || plane.camera != k) continue;
      const double size = plane.inverse_depth_plane.norm();
      return CloudPlane{-plane.inverse_depth_plane / size, 1.0 / size};
    }
    return std::nullopt;
  }

  // |d| of a plane whose normal is up; a ceiling's may be, too.
  std::optional<double> height_at(int stop, int k, const Eigen::Matrix3d& R_world_board) const {
    const std::optional<CloudPlane> plane = plane_at(stop, k);
    if (!plane) return std::nullopt;
    const Rigid3& T_camera_board = boards_[static_cast<std::size_t>(k)].at(stop);
    const Eigen::Vector3d normal = R_world_board * (T_camera_board.rotation.conjugate() * plane->normal);
    if (normal.z() < kLevelNormal) return std::nullopt;
    return std::abs(plane->d);
  }

  void add_camera(int k) {
    const BoardPoses& boards = boards_[static_cast<std::size_t>(k)];
    if (boards.empty()) {
      result_.reasons.push_back(Finding("camera.no_whole_board").of(camera(k).name));
      return;
    }
    if (input_.recording != nullptr && frames_.empty())
      frames_ = rivals::frames_by_stop(observations_, *input_.recording);
    const std::size_t index = problem_.X.size();
    solved_.push_back(k);
    const auto& [first_stop, first_board] = *boards.begin();
    problem_.X.push_back(first_board * odometry_at(observations_, first_stop).inverse());
    const Eigen::Matrix3d R_world_board = align_paths(observations_, boards);
    std::size_t motions = 0, heights = 0;
    for (auto to = std::next(boards.begin()); to != boards.end(); ++to) {
      const auto from = std::prev(to);
      if (to->first != from->first + 1) continue;
      rivals::ReferenceMotion motion;
      motion.camera = index;
      motion.A = odometry_at(observations_, from->first).inverse() * odometry_at(observations_, to->first);
      motion.B = from->second * to->second.inverse();
      motion.height_m = height_at(to->first, k, R_world_board);
      heights += motion.height_m.has_value();
      ++motions;
      problem_.motions.push_back(motion);
    }
    note_missing(k, motions, heights);
  }

  void note_missing(int k, std::size_t motions, std::size_t heights) {
    if (motions == 0)
      result_.notes.push_back(Finding("camera.at_start").of(camera(k).name));
    else if (heights == 0)
      result_.notes.push_back(Finding("camera.height_free").of(camera(k).name));
  }

  // Both orders, so that each pair counts twice.
  void add_pairs() {
    for (std::size_t j = 0; j < solved_.size(); ++j)
      for (std::size_t k = 0; k < solved_.size(); ++k)
        if (j != k) add_pair(j, k);
  }

  void add_pair(std::size_t j, std::size_t k) {
    const BoardPoses& boards_j = boards_[static_cast<std::size_t>(solved_[j])];
    const BoardPoses& boards_k = boards_[static_cast<std::size_t>(solved_[k])];
    for (const auto& [stop, from_j] : boards_j) {
      const auto to_j = boards_j.find(stop + 1), from_k = boards_k.find(stop), to_k = boards_k.find(stop + 1);
      if (to_j == boards_j.end() || from_k == boards_k.end() || to_k == boards_k.end()) continue;
      problem_.pairs.push_back({j, k, from_j * to_j->second.inverse(), from_k->second * to_k->second.inverse()});
    }
  }

  void report() {
    for (std::size_t i = 0; i < solved_.size(); ++i)
      result_.camera_to_robot.push_back(rivals::camera_in_robot(observations_, solved_[i], problem_.X[i]));
    rivals::add_pairs_from_robot(observations_, &result_);
    rivals::report_use(observations_, pnp_.poses, used_, Finding("view.corner_outliers"), &result_);
    rivals::conclude_by_cameras(observations_, &result_);
  }

  const MethodInput& input_;
  const Observations& observations_;
  const bool joint_;
  const ViewPoses pnp_;
  rivals::FramesByStop frames_;
  std::vector<BoardPoses> boards_;
  std::vector<int> solved_;  ///< cameras, in the order of problem_.X
  ReferenceProblem problem_;
  rivals::UsedViews used_;
  Result result_;
};

// MEMROC as the authors' program computes it, with its known failures: a start that takes the board's axes for the
// robot's, rotations compared as rotation vectors, consecutive stops only, heights of the first stop never read, and
// any level plane taken for the ground, a ceiling too. Reads clouds or depth images where the recording has them, else
// the observed planes.
class MemrocReference : public Method {
 public:
  explicit MemrocReference(bool joint) : joint_(joint) {}

  MethodTraits traits() const override {
    const std::string gives = "camera to robot (6), camera to camera";
    const std::string needs = "board, odometry, depth or clouds; every camera at two stops in a row";
    if (joint_)
      return {"joint_memroc_reference",
              "Joint-MEMROC as its authors' program computes it, known failures included",
              needs,
              gives,
              MethodReads::kFiles,
              6e-4};
    return {"memroc_reference",
            "MEMROC as its authors' program computes it, known failures included",
            needs,
            gives,
            MethodReads::kFiles,
            4e-4};
  }
  std::optional<Finding> why_not(const MethodInput& input) const override {
    const bool has_height = input.recording == nullptr ? !input.observations.ground_planes.empty()
                                                       : has_clouds(input.observations, *input.recording);
    if (has_height) return {};
    return Finding("method.no_depth");
  }
  Result solve(const Observations& observations) const override { return solve_recording({observations}); }
  Result solve_recording(const MethodInput& input) const override {
    Result result = ReferenceSolver(input, joint_).solve();
    result.method = traits().name;
    return result;
  }

 private:
  bool joint_;
};

}  // namespace

std::vector<const Method*> memroc_reference_methods() {
  static const MemrocReference alone(false), joint(true);
  return {&alone, &joint};
}

}  // namespace rigproof
