// The whitened least-squares problem: its cost, its normal equations and what each group of residuals contributes.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "ml/arrow_system.h"
#include "ml/clock.h"
#include "ml/noise.h"
#include "ml/residuals.h"
#include "ml/state.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// How a block of residuals counts in the normal equations.
enum class Weighting {
  kRobust,  ///< by the loss: steps of the solver
  kSlope,   ///< by the loss's expected slope: one step from afar; odometry, of which few stops have none to spare, by
            ///< the loss
  kInformation,  ///< by the information that the loss keeps: covariance
  kUnit,         ///< fully, whatever the residual: the bound at the truth
};

enum class Group { kCorners, kGround, kBoardPlane, kOdometryXy, kOdometryYaw, kSuspensionHeight, kSuspensionTilt };
inline constexpr std::size_t kGroupCount = 7;

/// Sums over the residuals of a group, whitened by the current noise levels.
struct GroupSum {
  double square = 0.0;                   ///< of r
  double weighted_square = 0.0;          ///< of w r^2
  double weight = 0.0;                   ///< of w, a dimension
  double leverage = 0.0;                 ///< dimensions that the unknowns absorb
  double dimensions = 0.0;               ///< of correlated residuals each group has its share
  double outlier_weighted_square = 0.0;  ///< the part of residuals that no noise explains
  double outlier_dimensions = 0.0;

  GroupSum& operator+=(const GroupSum& other);
  /// Dimensions that the unknowns do not absorb.
  double redundancy() const { return dimensions - leverage; }
  /// Without the outliers, as long as they are few: even a bounded loss lets each count for several residuals.
  GroupSum without_outliers() const;
};
/// [group][camera]; groups that know no cameras use camera 0.
using GroupSums = std::array<std::vector<GroupSum>, kGroupCount>;
inline GroupSum& sum_of(GroupSums& sums, Group group, int camera = 0) {
  return sums[static_cast<std::size_t>(group)][static_cast<std::size_t>(camera)];
}
inline const GroupSum& sum_of(const GroupSums& sums, Group group, int camera = 0) {
  return sums[static_cast<std::size_t>(group)][static_cast<std::size_t>(camera)];
}

/// Observations, whitened once, with the noise levels that may change between solutions.
class Problem {
 public:
  explicit Problem(const Observations& observations, const Priors& priors, const NoiseLevels& noise);

  const Layout& layout() const { return layout_; }
  const Observations& observations() const { return observations_; }
  const Priors& priors() const { return priors_; }
  NoiseLevels noise;
  CauchyLoss loss;

  /// Normal equations at the state, with cost and sums where wanted.
  ArrowSystem linearise(const State& state, Weighting weighting, double* cost, GroupSums* sums) const;
  /// Dimensions of each group that the estimate absorbs: its leverage.
  void add_leverage(const State& state, const EliminatedSystem::PoseCovariance& poses, const Eigen::MatrixXd& globals,
                    GroupSums* sums) const;
  /// Sums of all groups with leverage, weighted by the information that the loss keeps; absent if the poses are not
  /// determined.
  std::optional<GroupSums> sums_with_leverage(const State& state) const;
  /// -2 ln of the normalisation of the residuals: sum of 2 ln sigma over every residual whose sigma may be estimated.
  double log_normalisation() const;
  /// Root mean square of the reprojection error of a view, and the mean weight of its corners.
  struct ViewFit {
    double rms_px = 0.0;
    double mean_weight = 0.0;
  };
  ViewFit view_fit(const State& state, std::size_t view) const;
  /// Views that are left out from now on.
  std::vector<bool> view_left_out;
  /// Cameras that saw nothing stay where they are.
  std::vector<bool> camera_fixed;

  GroupSums empty_sums() const;

 private:
  struct Corner {
    Eigen::Vector3d point_board;
    Eigen::Vector2d pixel;
    Eigen::Matrix2d whitening;
  };
  struct View {
    int stop, camera;
    double after_stop_s;  // by the stamps
    std::vector<Corner> corners;
  };
  struct Plane {
    int stop, camera;
    double after_stop_s;
    Eigen::Vector3d measured;
    Eigen::Matrix3d whitening;
    bool registered;  // errs with the intrinsics
  };
  // Three neighbouring unknowns of a pose; the residuals of the first `split` are one group, the others another.
  struct PosePart {
    int pose, offset, split;
    Group first, second;
  };

  /// @param biases added to the planes' covariances [1/m^2]; empty: none
  std::vector<Plane> prepare(const std::vector<PlaneObservation>& planes,
                             const std::vector<Eigen::Matrix3d>& biases) const;
  /// Where the robot was when a camera took what its stamp says was taken so long after the stop.
  PoseAtImage pose_at_image(const State& state, int stop, int camera, double after_stop_s) const;
  Camera lens(const State& state, int camera) const;
  /// A plane as its depth image shows it through the intrinsics of the state, and its derivative by them.
  struct MeasuredPlane {
    Eigen::Vector3d value;
    Eigen::Matrix3d by_intrinsics = Eigen::Matrix3d::Zero();
  };
  MeasuredPlane measured_plane(const State& state, const Plane& plane) const;
  Eigen::Vector3d odometry_sigmas(std::size_t stop) const;
  double log_odometry_variance(std::size_t stop) const;
  /// What is known of the time of an image.
  enum class ImageTime {
    kOfStop,   // that of its stop
    kByStamp,  // another one, while the robot moved: its stamp is believed
    kByClock   // that of a clock whose error is estimated
  };
  ImageTime time_of(double after_stop_s) const;
  template <bool kLens, typename Sink>
  void visit_view_at_its_time(const State& state, Weighting weighting, const View& view, Sink& sink) const;
  template <bool kLens, ImageTime kTime, typename Sink>
  void visit_view(const State& state, Weighting weighting, const View& view, Sink& sink) const;
  template <bool kLens, typename Sink>
  void visit_board_plane_at_its_time(const State& state, Weighting weighting, const Plane& plane, Sink& sink) const;
  template <bool kLens, ImageTime kTime, typename Sink>
  void visit_board_plane(const State& state, Weighting weighting, const Plane& plane, Sink& sink) const;
  template <typename Sink>
  void visit_ground_plane(const State& state, Weighting weighting, const Plane& plane, Sink& sink) const;
  template <typename Sink>
  void visit_increment(const State& state, Weighting weighting, int to, Sink& sink) const;
  template <typename Sink>
  void visit_way(const State& state, Weighting weighting, int to, Sink& sink) const;
  template <typename Sink>
  void visit_diagonal(const Eigen::Vector3d& value, const Eigen::Vector3d& inverse_sigmas, Weighting weighting,
                      const PosePart& part, Sink& sink) const;
  template <typename Sink>
  void visit_poses(const State& state, Weighting weighting, Sink& sink) const;
  template <typename Sink>
  void visit_blocks(const State& state, Weighting weighting, Sink&& sink) const;
  bool has_ground_offset(int camera) const {
    return layout_.with_ground_offsets && priors_.ground_offset[static_cast<std::size_t>(camera)].norm() > 0.0;
  }
  void add_priors(const State& state, ArrowSystem* system, double* cost) const;
  void fix_unknowns(ArrowSystem* system) const;

  const Observations& observations_;
  Layout layout_;
  Priors priors_;
  std::vector<View> views_;
  std::vector<Plane> ground_planes_;
  std::vector<Plane> board_planes_;
  std::vector<Eigen::Vector3d> increments_;  // [i]: from stop i to i + 1
  std::vector<OdometryWay> ways_;            // the same; only if the noise is that of the way
};

}  // namespace rigproof::ml
