// What a calibration method answers. On disk: results/METHOD.yaml.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// The pose of `child` in `parent`, with what is known about it.
struct EstimatedTransform {
  std::string parent;
  std::string child;
  Rigid3 T_parent_child;
  /// In the chart of transform_error(): tx ty tz rx ry rz, metres and radians. Absent if the method has none.
  std::optional<Matrix6d> covariance;
  /// Degrees of freedom that the data determine, in the same order. A degree that is not observable is absent on
  /// disk; rotations are then given as roll/pitch/yaw of R = Rz(yaw) Ry(pitch) Rx(roll) of camera's body axes.
  std::array<bool, 6> observable = {true, true, true, true, true, true};
  /// What each variance on the covariance's diagonal is made of; the shares of a degree of freedom sum up to one.
  struct Share {
    std::string source;  ///< "corners", "odometry", "lens", "board", ..
    std::array<double, 6> share{};
  };
  std::vector<Share> budget = {};

  bool fully_observable() const;
};

/// The estimate in axes in which its yaw is zero: the parent's, turned about z by the estimated yaw. For a camera in
/// the robot whose heading is not observable: roll, pitch and their covariance mean something in these axes only, and
/// results are written in them. Any other estimate is returned as it is.
EstimatedTransform heading_free(EstimatedTransform estimate);

/// How much of a camera's data a method used.
struct CameraUse {
  std::string camera;
  int used = 0;
  std::vector<Exclusion> left_out;
  double reprojection_rms_px = 0.0;  ///< over the frames used
};

/// A named group of residuals.
struct ResidualSummary {
  std::string name;  ///< "corners", "odometry", "ground"
  std::string unit;  ///< "px", "m", "sigma", ...
  int count = 0;
  double rms = 0.0;
};

/// Something else that a method estimated, with what it believed beforehand.
struct EstimatedQuantity {
  std::string camera;  ///< empty: of the whole rig, or of the board
  std::string name;    ///< with its unit: "focal_length_percent", "principal_point_x_px", "clock_offset_ms"
  double value = 0.0;
  double sigma = 0.0;
  double prior_sigma = 0.0;
};

/// The intrinsics that an estimated pose goes with.
struct EstimatedLens {
  std::string camera;
  Camera intrinsics;
};

/// Errors of lenses, boards and depth that another drive of the same robot meets again, as this one left them.
struct LastingErrors {
  struct Owner {
    std::string camera;  ///< empty: of a board
    int board = 0;       ///< 1 is the first
    bool operator==(const Owner& other) const { return camera == other.camera && board == other.board; }
  };
  struct Unknown {
    Owner of;
    std::string name;    ///< with its unit: "focal_length_percent"
    double value = 0.0;  ///< zero where all is as stated
  };
  std::vector<Unknown> unknowns;
  Eigen::MatrixXd covariance;  ///< a row and a column for each
  Eigen::MatrixXd
      with_cameras;  ///< of camera_to_robot, six rows a camera as in the joint covariance, with each unknown
  /// By how much no polynomial follows a camera's lens: on a grid of so many cells across the image.
  struct FineGrid {
    std::string camera;
    int cells = 0;
    double sigma_px = 0.0;  ///< root mean square of its coefficients
    double share = 0.0;     ///< how likely it is
  };
  std::vector<FineGrid> fine_fields;
  /// A hash of what was stated of a camera or board, which its errors go with.
  struct Stated {
    Owner of;
    std::string hash;
  };
  std::vector<Stated> stated;
};

/// Where a board stands, of several.
struct EstimatedBoard {
  int number = 2;  ///< 1 is the first board
  Rigid3 T_first_board;
  std::array<double, 6> sigma{};  ///< of the translation's parts [m], and of a turn about each axis of this board [rad]
};

enum class ResultStatus {
  kSolved,
  kPartial,  ///< some degrees of freedom are refused
  kRefused,  ///< nothing that was asked for can be answered
};
const char* result_status_name(ResultStatus status);

struct Result {
  std::string method;
  ResultStatus status = ResultStatus::kRefused;
  std::vector<Finding> reasons;                      ///< why it is partial or refused, the likely cause first
  std::vector<Finding> notes;                        ///< what the user should know
  std::vector<EstimatedTransform> camera_to_robot;   ///< parent robot_frame, child camera
  std::vector<EstimatedTransform> camera_to_camera;  ///< parent camera j, child camera k, j < k
  /// Covariance of all of camera_to_robot together, six rows a camera in that order, in the chart of
  /// transform_error(); 6n x 6n. Absent if the method has none. It also holds what the cameras share (odometry).
  std::optional<Eigen::MatrixXd> joint_covariance;
  std::vector<CameraUse> use;
  std::vector<ResidualSummary> residuals;
  std::vector<EstimatedQuantity> also_estimated;  ///< camera by camera, then of the rig
  /// Where they were estimated: the poses go with these, not with the stated ones.
  std::vector<EstimatedLens> lenses;
  std::vector<EstimatedBoard> boards;    ///< all but the first, where the drive tells
  std::optional<LastingErrors> lasting;  ///< only with a joint covariance
  /// Where in the robot's frame the rig states that the robot turns, along x and y, and how well (one sigma; absent: it
  /// does not say): the poses go with that, too.
  Eigen::Vector2d rotation_centre_m = Eigen::Vector2d::Zero();
  std::optional<double> rotation_centre_sigma_m = std::nullopt;
  double solve_s = 0.0;  ///< not written to disk: results are byte-identical across runs

  const EstimatedTransform* find(const std::string& parent, const std::string& child) const;
};

/// Reads a result, ours or the smallest one that somebody else wrote: a list or map of
/// {parent, child, translation_m, quaternion_xyzw}. Throws Error with every problem found.
Result load_result(const std::filesystem::path& file);
/// A result as its file has it. `wording` adds sentences for people, which nothing reads.
std::string result_text(const Result& result, const Wording& wording = {});
/// Writes the same atomically.
void save_result(const Result& result, const std::filesystem::path& file, const Wording& wording = {});
/// "pose of left in robot".
std::string sentence_of(const EstimatedTransform& transform);

/// "ml-told_exact": a method whose settings (key and value) are others than its usual ones, in tables and as its
/// result's file, so that it never replaces the method as it usually is. Any file system takes it: at most 80
/// characters, where a long name ends in a hash of the whole, and only letters, digits, _, -, + and . of the settings.
std::string name_with_settings(const std::string& method,
                               const std::vector<std::pair<std::string, std::string>>& settings);

}  // namespace rigproof
