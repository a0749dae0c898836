// MEMROC as the authors' program computes it. What looks like a mistake here is one of theirs, and tested as such.
#include <Eigen/SVD>
#include <algorithm>
#include <map>

#include "memroc_reference_cost.h"
#include "reference_boards.h"
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

using rivals::BoardPoses;
using rivals::CloudPlane;
using rivals::ReferenceMotion;
using rivals::ReferencePair;
using rivals::ReferenceProblem;

constexpr double kLevelNormal = 0.995;
// Of a depth image: as `convert` gives it to the program.
constexpr int kCloudPoints = 12000;

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

std::vector<Eigen::Vector3f> read_cloud(const Recording& recording, const CameraFrame& frame, const RigCamera& camera) {
  if (!frame.cloud_file.empty()) {
    auto cloud = read_point_cloud(path_inside(recording.folder, frame.cloud_file));
    if (auto* points = std::get_if<std::vector<Eigen::Vector3f>>(&cloud)) return std::move(*points);
    return {};
  }
  if (frame.depth_file.empty() || !camera.depth) return {};
  const auto depth = read_depth_image(path_inside(recording.folder, frame.depth_file));
  const auto* image = std::get_if<Image16>(&depth);
  return image == nullptr ? std::vector<Eigen::Vector3f>() : sampled_depth(*image, camera, kCloudPoints).points;
}

/// The planes of the clouds, or of what was observed where there is no recording.
class PlaneSource {
 public:
  PlaneSource(const MethodInput& input, const rivals::FramesByStop& frames) : input_(input), frames_(frames) {}

  // Without a recording the observed plane is what the cloud would have shown.
  std::optional<CloudPlane> at(int stop, int k) const {
    if (input_.recording != nullptr) return plane_of_cloud(stop, k);
    for (const PlaneObservation& plane : input_.observations.ground_planes) {
      if (plane.stop != stop || plane.camera != k) continue;
      const double size = plane.inverse_depth_plane.norm();
      return CloudPlane{-plane.inverse_depth_plane / size, 1.0 / size};
    }
    return std::nullopt;
  }

 private:
  // None where the recording has neither clouds nor depth, or they cannot be read.
  std::vector<Eigen::Vector3f> cloud_of(const CameraFrame& frame, const RigCamera& camera) const {
    try {
      return read_cloud(*input_.recording, frame, camera);
    } catch (const Error&) {
      return {};
    }
  }

  std::optional<CloudPlane> plane_of_cloud(int stop, int k) const {
    throw_if_interrupted(input_);
    const CameraFrame* frame = rivals::frame_of(frames_, stop, k);
    if (frame == nullptr) return std::nullopt;
    const RigCamera& camera = input_.observations.cameras[static_cast<std::size_t>(k)];
    const std::string content =
        detection::content_of(input_.memory, frame->cloud_file.empty() ? frame->depth_file : frame->cloud_file);
    const std::string key = content.empty() ? content : rivals::cloud_key(content, camera, kCloudPoints);
    std::optional<CloudPlane> plane;
    detection::recall_or(input_.memory, PictureMemory::Finding::kClouds, key, &plane, [&] {
      const std::vector<Eigen::Vector3f> cloud = cloud_of(*frame, camera);
      plane = rivals::largest_plane(cloud);
      return !cloud.empty();
    });
    return plane;
  }

  const MethodInput& input_;
  const rivals::FramesByStop& frames_;
};

// |d| of a plane whose normal is up; a ceiling's may be, too.
std::optional<double> height_of(const std::optional<CloudPlane>& plane, const Eigen::Quaterniond& R_camera_board,
                                const Eigen::Matrix3d& R_world_board) {
  if (!plane) return std::nullopt;
  const Eigen::Vector3d normal = R_world_board * (R_camera_board.conjugate() * plane->normal);
  if (normal.z() < kLevelNormal) return std::nullopt;
  return std::abs(plane->d);
}

std::vector<ReferenceMotion> motions_of(const Observations& observations, const PlaneSource& planes, int k,
                                        std::size_t index, const BoardPoses& boards) {
  const Eigen::Matrix3d R_world_board = align_paths(observations, boards);
  std::vector<ReferenceMotion> motions;
  for (auto to = std::next(boards.begin()); to != boards.end(); ++to) {
    const auto from = std::prev(to);
    if (to->first != from->first + 1) continue;
    motions.push_back({index, odometry_at(observations, from->first).inverse() * odometry_at(observations, to->first),
                       from->second * to->second.inverse(),
                       height_of(planes.at(to->first, k), to->second.rotation, R_world_board)});
  }
  return motions;
}

// Both orders, so that each pair counts twice.
std::vector<ReferencePair> pairs_of(const std::vector<BoardPoses>& boards, const std::vector<int>& cameras) {
  std::vector<ReferencePair> pairs;
  for (std::size_t j = 0; j < cameras.size(); ++j) {
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      const BoardPoses &of_j = boards[static_cast<std::size_t>(cameras[j])],
                       &of_k = boards[static_cast<std::size_t>(cameras[k])];
      for (const auto& [stop, from_j] : of_j) {
        const auto to_j = of_j.find(stop + 1), from_k = of_k.find(stop), to_k = of_k.find(stop + 1);
        if (j == k || to_j == of_j.end() || from_k == of_k.end() || to_k == of_k.end()) continue;
        pairs.push_back({j, k, from_j * to_j->second.inverse(), from_k->second * to_k->second.inverse()});
      }
    }
  }
  return pairs;
}

Result solve_reference(const MethodInput& input, bool joint) {
  const Observations& observations = input.observations;
  rivals::FramesByStop frames;
  if (input.recording != nullptr) frames = rivals::frames_by_stop(observations, *input.recording);
  const rivals::ReferenceBoards boards = rivals::reference_boards(input, frames);
  const PlaneSource planes(input, frames);
  ReferenceProblem problem;
  std::vector<int> solved;  // cameras, in the order of problem.X
  Result result;
  result.use = boards.use;
  for (int k = 0; k < static_cast<int>(observations.cameras.size()); ++k) {
    const BoardPoses& seen = boards.poses[static_cast<std::size_t>(k)];
    const std::string& name = observations.cameras[static_cast<std::size_t>(k)].name;
    if (seen.empty()) {
      result.reasons.push_back(Finding("camera.no_whole_board").of(name));
      continue;
    }
    const std::vector<ReferenceMotion> motions = motions_of(observations, planes, k, solved.size(), seen);
    const auto has_height = [](const ReferenceMotion& motion) { return motion.height_m.has_value(); };
    if (motions.empty())
      result.notes.push_back(Finding("camera.at_start").of(name));
    else if (std::none_of(motions.begin(), motions.end(), has_height))
      result.notes.push_back(Finding("camera.height_free").of(name));
    solved.push_back(k);
    problem.X.push_back(seen.begin()->second * odometry_at(observations, seen.begin()->first).inverse());
    problem.motions.insert(problem.motions.end(), motions.begin(), motions.end());
  }
  if (joint) problem.pairs = pairs_of(boards.poses, solved);
  rivals::minimise_reference(&problem);
  for (std::size_t i = 0; i < solved.size(); ++i)
    result.camera_to_robot.push_back(rivals::camera_in_robot(observations, solved[i], problem.X[i]));
  rivals::add_pairs_from_robot(observations, &result);
  rivals::conclude_by_cameras(observations, &result);
  return result;
}

// MEMROC as the authors' program computes it, from the images and clouds on, with its known failures: corners of
// OpenCV's search, a start that takes the board's axes for the robot's, rotations compared as rotation vectors,
// consecutive stops only, heights of the first stop never read, and any level plane taken for the ground, a ceiling
// too. Where there is no recording the observed corners and planes are taken.
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
    Result result = solve_reference(input, joint_);
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
