// OpenCV's hand-eye solvers, as a user would call them: each camera by itself, every view.
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "rigproof/calib/diagnose/method.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"
#include "rival_result.h"

namespace rigproof {
namespace {

struct Solver {
  const char* name;
  const char* authors;
  cv::HandEyeCalibrationMethod method;
};

constexpr std::array<Solver, 5> kSolvers = {{
    {"opencv_tsai", "Tsai and Lenz 1989", cv::CALIB_HAND_EYE_TSAI},
    {"opencv_park", "Park and Martin 1994", cv::CALIB_HAND_EYE_PARK},
    {"opencv_horaud", "Horaud and Dornaika 1995", cv::CALIB_HAND_EYE_HORAUD},
    {"opencv_andreff", "Andreff, Horaud and Espiau 1999", cv::CALIB_HAND_EYE_ANDREFF},
    {"opencv_daniilidis", "Daniilidis 1999", cv::CALIB_HAND_EYE_DANIILIDIS},
}};

// Fewer give no second motion.
constexpr std::size_t kMinViews = 3;
// A matrix further from a rotation than this is none: the solver had nothing to hold on to.
constexpr double kRotationTolerance = 0.05;

cv::Mat mat_of(const Eigen::Matrix3d& R) {
  cv::Mat mat(3, 3, CV_64F);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) mat.at<double>(r, c) = R(r, c);
  return mat;
}

cv::Mat mat_of(const Eigen::Vector3d& t) {
  cv::Mat mat(3, 1, CV_64F);
  for (int r = 0; r < 3; ++r) mat.at<double>(r) = t(r);
  return mat;
}

std::optional<Rigid3> rigid_from(const cv::Mat& R, const cv::Mat& t) {
  if (R.rows != 3 || R.cols != 3 || t.total() != 3) return std::nullopt;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) matrix(r, c) = R.at<double>(r, c);
    matrix(r, 3) = t.at<double>(r);
  }
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const double off = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!matrix.allFinite() || !(off < kRotationTolerance) || !(rotation.determinant() > 0.0)) return std::nullopt;
  return Rigid3::from_matrix(matrix);
}

// OpenCV's calibrateHandEye: Tsai-Lenz, Park, Horaud, Andreff, Daniilidis. A robot that turns about one axis only is
// outside of what they are made for, and the numbers show it.
class OpenCvHandEye : public Method {
 public:
  explicit OpenCvHandEye(const Solver& solver) : solver_(solver) {}

  MethodTraits traits() const override {
    return {solver_.name,
            std::string("OpenCV's calibrateHandEye, ") + solver_.authors + "; made for arms, not wheels",
            "board, odometry",
            "camera to robot (6, the height only by chance), camera to camera",
            MethodReads::kObservations,
            5e-5};
  }

  std::optional<Finding> why_not(const MethodInput& input) const override {
    for (std::size_t k = 0; k < input.observations.cameras.size(); ++k) {
      std::size_t views = 0;
      for (const BoardView& view : input.observations.board_views) views += view.camera == static_cast<int>(k);
      if (views >= kMinViews) return {};
    }
    return Finding("method.too_few_views");
  }

  Result solve(const Observations& observations) const override {
    Result result;
    result.method = solver_.name;
    const ViewPoses views = estimate_view_poses(observations);
    rivals::UsedViews used;
    for (std::size_t k = 0; k < observations.cameras.size(); ++k)
      solve_camera(observations, views.poses, static_cast<int>(k), &used, &result);
    rivals::add_pairs_from_robot(observations, &result);
    rivals::report_use(observations, views.poses, used, Finding("view.camera_unsolved"), &result);
    rivals::conclude_by_cameras(observations, &result);
    if (!result.camera_to_robot.empty()) result.notes.emplace_back("camera.height_by_chance");
    return result;
  }

 private:
  void solve_camera(const Observations& observations, const std::vector<ViewPose>& views, int k,
                    rivals::UsedViews* used, Result* result) const {
    std::vector<cv::Mat> R_robot, t_robot, R_board, t_board;
    for (const ViewPose& view : views) {
      if (view.camera != k) continue;
      const Stop& stop = observations.stops[static_cast<std::size_t>(view.stop)];
      const Rigid3 T_odom_robot = planar_pose(stop.x_m, stop.y_m, stop.yaw_rad);
      R_robot.push_back(mat_of(T_odom_robot.rotation_matrix()));
      t_robot.push_back(mat_of(T_odom_robot.translation));
      R_board.push_back(mat_of(view.T_camera_board.rotation_matrix()));
      t_board.push_back(mat_of(view.T_camera_board.translation));
    }
    const std::string& name = observations.cameras[static_cast<std::size_t>(k)].name;
    if (R_robot.size() < kMinViews) {
      result->reasons.push_back(Finding("camera.few_views", {{"views", R_robot.size()}}).of(name));
      return;
    }
    cv::Mat R, t;
    try {
      cv::calibrateHandEye(R_robot, t_robot, R_board, t_board, R, t, solver_.method);
    } catch (const cv::Exception&) {
      result->reasons.push_back(Finding("camera.solver_gave_up").of(name));
      return;
    }
    const std::optional<Rigid3> X = rigid_from(R, t);
    if (!X) {
      result->reasons.push_back(Finding("camera.no_rigid_transform").of(name));
      return;
    }
    for (const ViewPose& view : views)
      if (view.camera == k) used->insert({view.stop, k});
    result->camera_to_robot.push_back(rivals::camera_in_robot(observations, k, *X));
  }

  Solver solver_;
};

}  // namespace

std::vector<const Method*> opencv_hand_eye_methods() {
  static const std::array<OpenCvHandEye, 5> methods = {OpenCvHandEye(kSolvers[0]), OpenCvHandEye(kSolvers[1]),
                                                       OpenCvHandEye(kSolvers[2]), OpenCvHandEye(kSolvers[3]),
                                                       OpenCvHandEye(kSolvers[4])};
  std::vector<const Method*> list;
  for (const OpenCvHandEye& method : methods) list.push_back(&method);
  return list;
}

}  // namespace rigproof
