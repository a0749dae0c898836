// The rig: cameras of a robot, the board they look at, and what the user accepts. On disk: recording/rig.yaml.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/camera.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Standard deviation of one depth pixel as a function of depth.
struct DepthNoise {
  enum class Law {
    kStereo,       ///< sigma of 1/z is constant: sigma_z = z^2 * inverse_depth_sigma_per_m
    kTimeOfFlight  ///< sigma_z = constant_m + proportional * z
  };
  Law law = Law::kStereo;
  /// s / (f B): sub-pixel disparity noise over focal length times baseline [1/m]. D455 at W = 848: 0.0019.
  double inverse_depth_sigma_per_m = 0.0019;
  double constant_m = 0.0;
  double proportional = 0.0;
  /// Pixels whose noise is one and the same: side of the square that holds one independent measurement [px].
  double correlation_px = 1.0;
  /// Prior of the relative error of the depth scale, one sigma.
  double scale_sigma = 0.003;
  /// The same of what depth cameras of one make share: data sheets promise 2 %.
  double common_scale_sigma = 0.01;
  /// Prior of an error of all depth alike [m], and of a tilt of the depth camera against the colour camera about x and
  /// y of the latter [rad], one sigma each. Assumed: time of flight is off by less than 5 mm at a metre (librealsense
  /// #5808), a registration by some 1.5 px of 640.
  double offset_sigma_m = 0.005;
  double tilt_sigma_rad = 0.0025;
  /// Prior of a shift of the depth image against the colour image, along x and along y, one sigma. Assumed: conventions
  /// of where a pixel's centre lies differ by half a pixel, and registration takes the nearest.
  double shift_sigma_px = 1.0;
  /// The device's fixed, smooth error over its view, one sigma, as the law says: of 1/z (stereo) or of z (time of
  /// flight). 0 = none is known of. It falls off over an angle as a Gaussian with 0.82 bias_cell_deg does.
  double bias_inverse_depth_per_m = 0.0;
  double bias_m = 0.0;
  double bias_cell_deg = 15.0;

  /// From now on without an error that cameras share, an offset, a tilt or a shift.
  void believe_place_and_common_scale() { common_scale_sigma = offset_sigma_m = tilt_sigma_rad = shift_sigma_px = 0.0; }
  /// With the usual ones.
  void doubt_place_and_common_scale();
  double sigma_m(double depth_m) const;
  /// Standard deviation of 1/z at the given depth [1/m].
  double inverse_depth_sigma(double depth_m) const;
  /// One sigma of the fixed error of 1/z where 1/z is as given [1/m].
  double inverse_depth_bias(double inverse_depth_per_m) const;
  bool has_bias() const { return law == Law::kStereo ? bias_inverse_depth_per_m > 0.0 : bias_m > 0.0; }
};

/// The depth stream of an RGB-D camera. Without its own block it is registered to colour: same size, intrinsics,
/// distortion, nearest resampling.
struct DepthStream {
  double unit_m = 0.001;  ///< metres of one count of the 16-bit image
  double min_m = 0.4;
  double max_m = 6.0;
  DepthNoise noise;
  struct OwnCamera {
    Camera camera;
    Rigid3 T_color_depth;
  };
  std::optional<OwnCamera> own_camera;
};

/// How well the stated intrinsics of a camera are known, one sigma each; all zero: they are exact. The defaults are
/// what a careful calibration leaves of a camera that then travels, warms up and is focused anew.
struct IntrinsicsSigma {
  double focal_relative = 0.005;    ///< of fx and fy together
  double focal_ratio = 0.0005;      ///< of fx / fy
  double principal_point_px = 2.0;  ///< along x and along y
  double distortion_px = 0.3;       ///< radially, in the farthest corner of the image
  double residual_px = 0.15;        ///< of the smooth field that no model follows, rms over the image

  static IntrinsicsSigma exact() { return {0.0, 0.0, 0.0, 0.0, 0.0}; }
  bool operator==(const IntrinsicsSigma& other) const {
    return focal_relative == other.focal_relative && focal_ratio == other.focal_ratio &&
           principal_point_px == other.principal_point_px && distortion_px == other.distortion_px &&
           residual_px == other.residual_px;
  }
};

/// One camera as the user describes it.
struct RigCamera {
  std::string name;                     ///< frame name of the optical frame in results, unique
  std::string sensor;                   ///< preset in models/sensors, e.g. "d455"; may be empty
  std::string link;                     ///< the camera in the user's TF tree; may be empty
  std::string optical_frame;            ///< the optical frame there; may be empty
  std::optional<Rigid3> T_link_camera;  ///< of the optical frame in `link`, where that is another frame and known
  std::string folder;                   ///< folder inside the recording, relative
  Camera camera;
  IntrinsicsSigma intrinsics_sigma;
  /// Rolling shutter: from the first row's time to the last one's, and how well that is known (one sigma). An image's
  /// stamp is that of its middle row. Published readouts reach from none to some 30 ms.
  double readout_s = 0.0;
  double readout_sigma_s = 0.015;
  /// Of how late or early its stamps are against the odometry's clock, one sigma; 0: they are believed.
  double clock_offset_sigma_s = 0.0;
  std::optional<DepthStream> depth;

  /// Through which the depth images see: of their own camera, or of the colour camera that they are registered to.
  const Camera& depth_optics() const { return depth && depth->own_camera ? depth->own_camera->camera : camera; }
};

/// The first camera with depth of the make of a camera with depth: that names the same sensor. Of cameras that name
/// none nothing is known: each is of a make of its own, which is the safer mistake.
int first_of_make(const std::vector<RigCamera>& cameras, int camera);

/// Limits on the stated uncertainty that the user wants to see met (one sigma).
struct AcceptLimits {
  double xy_m = 0.0;
  double z_m = 0.0;
  double angle_rad = 0.0;
};

/// How odometry noise is distributed.
enum class OdometryModel {
  kUnknown,       ///< decided from the data
  kPerPose,       ///< independent on every absolute pose: no drift
  kPerIncrement,  ///< independent on every increment: drift
};
const char* odometry_model_name(OdometryModel model);

/// What the user declares about the odometry; sigmas that are absent are estimated.
struct OdometryNoise {
  OdometryModel model = OdometryModel::kUnknown;
  std::optional<double> sigma_xy_m;
  std::optional<double> sigma_yaw_rad;
  /// One sigma of where the point lies about which the robot turns, along x and along y, and of how much higher the
  /// robot rides while it moves; absent: as the method assumes.
  std::optional<double> rotation_centre_sigma_m = std::nullopt;
  std::optional<double> riding_height_sigma_m = std::nullopt;
  /// Where that point lies in the robot's frame, along x and y: wheels tell its motion.
  Eigen::Vector2d rotation_centre_m = Eigen::Vector2d::Zero();
  /// One sigma of what increments have wrong in common, of which wheels are the cause: the factors of translations and
  /// of turns (relative), the heading that is gained with every metre, and by how much the body turns later than its
  /// wheels; absent: as the method assumes.
  std::optional<double> scale_sigma = std::nullopt;
  std::optional<double> yaw_factor_sigma = std::nullopt;
  std::optional<double> veer_sigma_rad_per_m = std::nullopt;
  std::optional<double> turn_lag_sigma_s = std::nullopt;
};

/// Odometry (x, y [m], yaw [rad]) of one point of the robot, carried over to another one that lies at `offset_m` from
/// it along the robot's x and y.
Eigen::Vector3d odometry_of_point(const Eigen::Vector3d& odometry, const Eigen::Vector2d& offset_m);

struct Rig {
  std::string name;
  std::string robot_frame = "base_footprint";
  Board board;
  std::vector<RigCamera> cameras;
  std::string odometry_file = "odometry.csv";
  OdometryNoise odometry_noise;
  std::optional<AcceptLimits> accept;
  /// Boards that stand elsewhere, each wherever: an image shows whichever its camera looks at.
  std::vector<Board> more_boards;

  int boards() const { return 1 + static_cast<int>(more_boards.size()); }
  const Board& board_at(int index) const {
    return index == 0 ? board : more_boards[static_cast<std::size_t>(index) - 1];
  }
};

}  // namespace rigproof
