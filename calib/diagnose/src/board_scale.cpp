#include "rigproof/calib/diagnose/board_scale.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "rigproof/core/median.h"

namespace rigproof::ml {
namespace {

constexpr double kDepthScaleSigma = 0.01;
constexpr double kOdometryScaleSigma = 0.02;
constexpr double kMaxDepthAlone = 4.0;  // standard deviations
constexpr double kMinDepthOfBoth = 2.5;
constexpr double kMaxBoth = 4.0;
// Of what is called a unit rather than an error of scale.
constexpr double kUnit = 0.4;

struct Ratio {
  double value = 0.0;  // ln of measured over expected depth
  double sigma = 0.0;
  int planes = 0;
};

// One plane against the pose that the corners give; at the board's centre, where a wrong tilt of either matters least.
std::optional<Ratio> ratio_of(const PlaneObservation& plane, const ViewPose& view, const Board& board) {
  const Eigen::Vector3d centre = view.T_camera_board * board.centre();
  if (!(centre.z() > 0.0)) return std::nullopt;
  const Eigen::Vector3d ray = centre / centre.z();
  const double inverse_depth = plane.inverse_depth_plane.dot(ray);
  if (!(inverse_depth > 0.0) || !std::isfinite(inverse_depth)) return std::nullopt;
  // The centre moves with the pose's translation and, seen from the board's origin, with its rotation.
  const Eigen::Vector3d arm = view.T_camera_board.rotation * board.centre();
  Vector6d by_pose;
  by_pose << 0.0, 0.0, 1.0, arm.y(), -arm.x(), 0.0;
  const double own = ray.dot(plane.covariance_per_m2 * ray) / (inverse_depth * inverse_depth);
  const double pose = by_pose.dot(view.covariance * by_pose) / (centre.z() * centre.z());
  return Ratio{-std::log(inverse_depth * centre.z()), std::sqrt(own + pose), 1};
}

Ratio combined(const std::vector<Ratio>& ratios) {
  constexpr double kMedianLoss = 1.2533;  // sigma of a median over that of a mean
  constexpr double kMadToSigma = 1.4826;
  std::vector<double> values, deviations;
  double stated = 0.0;
  for (const Ratio& ratio : ratios) {
    values.push_back(ratio.value);
    stated += ratio.sigma * ratio.sigma;
  }
  Ratio result;
  result.value = median(values);
  for (const double value : values) deviations.push_back(std::abs(value - result.value));
  const double n = static_cast<double>(ratios.size());
  result.sigma = kMedianLoss * std::max(std::sqrt(stated / n), kMadToSigma * median(deviations)) / std::sqrt(n);
  result.planes = static_cast<int>(ratios.size());
  return result;
}

// Per camera; without planes where there is no depth on the board.
std::vector<Ratio> ratios_of(const Observations& observations, const std::vector<ViewPose>& views) {
  std::map<std::pair<int, int>, const ViewPose*> view_at;
  for (const ViewPose& view : views) view_at[{view.stop, view.camera}] = &view;
  std::vector<std::vector<Ratio>> all(observations.cameras.size());
  for (const PlaneObservation& plane : observations.board_planes) {
    const auto view = view_at.find({plane.stop, plane.camera});
    if (view == view_at.end()) continue;
    const std::optional<Ratio> ratio = ratio_of(plane, *view->second, observations.board);
    if (ratio) all[static_cast<std::size_t>(plane.camera)].push_back(*ratio);
  }
  std::vector<Ratio> ratios;
  for (const std::vector<Ratio>& camera : all) ratios.push_back(camera.empty() ? Ratio() : combined(camera));
  return ratios;
}

double depth_prior(const RigCamera& camera) {
  return std::max(kDepthScaleSigma, camera.depth ? camera.depth->noise.scale_sigma : 0.0);
}

class Check {
 public:
  Check(const Observations& observations, const std::vector<ViewPose>& views,
        const std::optional<OdometryScale>& odometry)
      : observations_(observations), odometry_(odometry), ratios_(ratios_of(observations, views)) {}

  BoardScale run() {
    for (std::size_t c = 0; c < ratios_.size(); ++c)
      if (ratios_[c].planes > 0) with_depth_.push_back(c);
    if (with_depth_.empty()) {
      note_no_depth();
      return std::move(result_);
    }
    leave_out_odd_cameras();
    combine();
    judge();
    return std::move(result_);
  }

 private:
  double stated_mm() const { return 1e3 * observations_.board.square_m; }

  // With the squares' size by the odometry, where it says any.
  Finding with_odometry(const Finding& finding) const {
    return odometry_ ? finding.with({{"odometry_mm", stated_mm() * odometry_->scale}}) : finding;
  }

  void note_no_depth() {
    Finding note("board.scale_on_trust", {{"stated_mm", stated_mm()}});
    if (odometry_) {
      const double sigma = std::hypot(kOdometryScaleSigma, odometry_->sigma);
      const bool off = std::abs(std::log(odometry_->scale)) > 3.0 * sigma;
      note =
          with_odometry(note).with({{"odometry_sigma_mm", stated_mm() * sigma}, {"odometry", off ? "off" : "agrees"}});
    }
    result_.notes.push_back(note);
  }

  double sigma_of(std::size_t c) const { return std::hypot(depth_prior(observations_.cameras[c]), ratios_[c].sigma); }

  // Of one camera against others that are no better.
  double difference_sigma(std::size_t c) const { return std::sqrt(2.0) * sigma_of(c); }

  // A camera that differs from the others has itself to blame: its depth's scale or its focal length.
  void leave_out_odd_cameras() {
    std::vector<double> values;
    for (const std::size_t c : with_depth_) values.push_back(ratios_[c].value);
    // With two that differ the one that agrees with the stated size is right.
    std::sort(values.begin(), values.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    const double centre = values.size() == 2 ? values.front() : median(values);
    std::vector<std::size_t> agreeing;
    for (const std::size_t c : with_depth_) {
      const double off = ratios_[c].value - centre;
      if (std::abs(off) <= kMaxDepthAlone * difference_sigma(c)) {
        agreeing.push_back(c);
        continue;
      }
      result_.contradictions.push_back(odd_camera(c, off));
    }
    with_depth_ = agreeing;
  }

  Finding odd_camera(std::size_t c, double off) {
    const std::string& name = observations_.cameras[c].name;
    const double factor = std::exp(off);
    result_.depth_unit = result_.depth_unit || std::abs(off) > kUnit;
    if (std::abs(off) > kUnit) return Finding("depth.unit", {{"factor", factor}}).of(name);
    return Finding("depth.differs", {{"off_percent", 100.0 * std::abs(factor - 1.0)},
                                     {"side", off > 0.0 ? "farther" : "nearer"},
                                     {"limit_percent", 100.0 * kMaxDepthAlone * difference_sigma(c)}})
        .of(name);
  }

  void combine() {
    double weight = 0.0, sum = 0.0;
    for (const std::size_t c : with_depth_) {
      const double w = 1.0 / (sigma_of(c) * sigma_of(c));
      weight += w;
      sum += w * ratios_[c].value;
      prior_ = std::max(prior_, depth_prior(observations_.cameras[c]));
    }
    if (weight <= 0.0) return;
    result_.log_depth_ratio = sum / weight;
    double variance = 0.0;
    for (const std::size_t c : with_depth_) {
      const double share = 1.0 / (sigma_of(c) * sigma_of(c) * weight);
      variance += share * share * ratios_[c].sigma * ratios_[c].sigma;
    }
    result_.sigma = std::sqrt(variance);
  }

  void judge() {
    if (!result_.log_depth_ratio) return;
    const double depth = *result_.log_depth_ratio, depth_sigma = std::hypot(prior_, result_.sigma);
    const double depth_z = std::abs(depth) / depth_sigma;
    const double wheels = odometry_ ? std::log(odometry_->scale) : 0.0;
    const double wheels_sigma = odometry_ ? std::hypot(kOdometryScaleSigma, odometry_->sigma) : 1e9;
    const bool both =
        depth * wheels > 0.0 && depth_z > kMinDepthOfBoth && std::hypot(depth_z, wheels / wheels_sigma) > kMaxBoth;
    if (depth_z > kMaxDepthAlone || both) {
      result_.contradictions.push_back(cause(depth, wheels, wheels_sigma));
      return;
    }
    if (depth_z > kMinDepthOfBoth)
      result_.notes.push_back(Finding("board.measure", {{"measured_mm", stated_mm() * std::exp(depth)},
                                                        {"sigma_mm", stated_mm() * depth_sigma},
                                                        {"stated_mm", stated_mm()}}));
  }

  Finding cause(double depth, double wheels, double wheels_sigma) const {
    const double factor = std::exp(depth);
    const Finding unit("depth.unit_of_all", {{"factor", factor}});
    if (std::abs(depth) > kUnit && odometry_ && std::abs(depth - wheels) > 3.0 * wheels_sigma)
      return with_odometry(unit);
    if (std::abs(depth) > kUnit && !odometry_) return unit.with({{"squares_mm", stated_mm() * factor}});
    const Finding size =
        with_odometry(Finding("board.size", {{"measured_mm", stated_mm() * factor},
                                             {"stated_mm", stated_mm()},
                                             {"off_percent", 100.0 * (1.0 / factor - 1.0)},
                                             {"plausible_percent", 100.0 * kMaxDepthAlone * depth_sigma()}}));
    // The odometry that sees the stated size speaks for the sensors' own scale.
    const bool doubted = odometry_ && std::abs(depth - wheels) > 3.0 * std::hypot(wheels_sigma, depth_sigma());
    return doubted ? size.with({{"depth_doubted", 1}}) : size;
  }

  double depth_sigma() const { return std::hypot(prior_, result_.sigma); }

  const Observations& observations_;
  const std::optional<OdometryScale>& odometry_;
  std::vector<Ratio> ratios_;
  std::vector<std::size_t> with_depth_;
  double prior_ = 0.0;
  BoardScale result_;
};

}  // namespace

BoardScale check_board_scale(const Observations& observations, const std::vector<ViewPose>& views,
                             const std::optional<OdometryScale>& odometry) {
  return Check(observations, views, odometry).run();
}

}  // namespace rigproof::ml
