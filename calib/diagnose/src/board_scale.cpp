#include "rigproof/calib/diagnose/board_scale.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "rigproof/calib/geometry/depth_unit.h"
#include "rigproof/core/median.h"

namespace rigproof::ml {
namespace {

constexpr double kOdometryScaleSigma = 0.02;
constexpr double kMaxDepthAlone = 4.0;  // standard deviations
constexpr double kMinDepthOfBoth = 2.5;
constexpr double kMaxBoth = 4.0;
// Of what is called a unit rather than an error of scale.
constexpr double kUnit = 0.4;

struct Ratio {
  double value = 0.0;  // ln of measured over expected depth
  double sigma = 0.0;
  double depth_m = 0.0;
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
  return Ratio{-std::log(inverse_depth * centre.z()), std::sqrt(own + pose), centre.z()};
}

Ratio combined(const std::vector<Ratio>& ratios) {
  constexpr double kMedianLoss = 1.2533;  // sigma of a median over that of a mean
  constexpr double kMadToSigma = 1.4826;
  std::vector<double> values, deviations, depths;
  double stated = 0.0;
  for (const Ratio& ratio : ratios) {
    values.push_back(ratio.value);
    depths.push_back(ratio.depth_m);
    stated += ratio.sigma * ratio.sigma;
  }
  Ratio result;
  result.value = median(values);
  result.depth_m = median(std::move(depths));
  for (const double value : values) deviations.push_back(std::abs(value - result.value));
  const double n = static_cast<double>(ratios.size());
  result.sigma = kMedianLoss * std::max(std::sqrt(stated / n), kMadToSigma * median(deviations)) / std::sqrt(n);
  return result;
}

// What the depth of one camera tells about the board's size.
struct CameraRatio {
  std::string camera;
  int index;
  double value, measured_sigma;  // of ln of measured over expected depth
  double own_prior;              // of the depth and the focal length
  double board_prior;            // of the board's size
  double unit_m;

  double sigma() const { return std::hypot(own_prior, board_prior, measured_sigma); }
  // Of the difference to another camera, before the same board.
  double sigma_against(const CameraRatio& other) const {
    return std::hypot(std::hypot(own_prior, measured_sigma), std::hypot(other.own_prior, other.measured_sigma));
  }
};

// By which a camera's depth may be off at a distance, as a share of it: the priors that the estimate has (unknowns.h),
// and what no depth is free of, whatever is stated.
double depth_prior(const RigCamera& camera, double depth_m) {
  constexpr double kLeast = 0.001;
  const DepthNoise noise = camera.depth ? camera.depth->noise : DepthNoise();
  return std::hypot(std::hypot(kLeast, noise.scale_sigma, noise.common_scale_sigma), noise.offset_sigma_m / depth_m,
                    noise.inverse_depth_bias(1.0 / depth_m) * depth_m);
}

// Of the cameras with depth on one of the boards.
std::vector<CameraRatio> ratios_of(const Observations& observations, const std::vector<ViewPose>& views, int index) {
  const Board& board = observations.board_at(index);
  std::map<std::pair<int, int>, const ViewPose*> view_at;
  for (const ViewPose& view : views)
    if (view.board == index) view_at[{view.stop, view.camera}] = &view;
  std::map<int, std::vector<Ratio>> all;
  for (const PlaneObservation& plane : observations.board_planes) {
    const auto view = view_at.find({plane.stop, plane.camera});
    if (view == view_at.end()) continue;
    const std::optional<Ratio> ratio = ratio_of(plane, *view->second, board);
    if (ratio) all[plane.camera].push_back(*ratio);
  }
  std::vector<CameraRatio> ratios;
  for (const auto& [c, of_camera] : all) {
    const RigCamera& camera = observations.cameras[static_cast<std::size_t>(c)];
    const Ratio ratio = combined(of_camera);
    const double prior = std::hypot(depth_prior(camera, ratio.depth_m), camera.intrinsics_sigma.focal_relative);
    ratios.push_back({camera.name, c, ratio.value, ratio.sigma, prior, board.square_sigma_relative(),
                      camera.depth ? camera.depth->unit_m : 1.0});
  }
  return ratios;
}

// The board's stated size, and what the odometry says about it.
struct Stated {
  double square_mm;
  const std::optional<OdometryScale>& odometry;

  // With the squares' size by the odometry, where it says any.
  Finding with_odometry(const Finding& finding) const {
    return odometry ? finding.with({{"odometry_mm", square_mm * odometry->scale}}) : finding;
  }
};

Finding note_without_depth(const Stated& stated) {
  const Finding note("board.scale_on_trust", {{"stated_mm", stated.square_mm}});
  if (!stated.odometry) return note;
  const double sigma = std::hypot(kOdometryScaleSigma, stated.odometry->sigma);
  const bool off = std::abs(std::log(stated.odometry->scale)) > 3.0 * sigma;
  return stated.with_odometry(note).with(
      {{"odometry_sigma_mm", stated.square_mm * sigma}, {"odometry", off ? "off" : "agrees"}});
}

double centre_of(const std::vector<CameraRatio>& ratios) {
  std::vector<double> values;
  for (const CameraRatio& ratio : ratios) values.push_back(ratio.value);
  // With two that differ the one that agrees with the stated size is right.
  std::sort(values.begin(), values.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  return values.size() == 2 ? values.front() : median(values);
}

// A camera that differs from the others has itself to blame: its depth's scale or its focal length.
Finding odd_camera(const CameraRatio& ratio, double off, double limit) {
  const double factor = std::exp(off);
  if (std::abs(off) > kUnit)
    return Finding(unit_explains(factor, ratio.unit_m) ? "depth.unit" : "depth.scale", {{"factor", factor}})
        .of(ratio.camera);
  return Finding("depth.differs", {{"off_percent", 100.0 * std::abs(factor - 1.0)},
                                   {"side", off > 0.0 ? "farther" : "nearer"},
                                   {"limit_percent", 100.0 * limit}})
      .of(ratio.camera);
}

// The cameras' mean; absent without any.
std::optional<CameraRatio> mean_of(const std::vector<CameraRatio>& ratios) {
  double weight = 0.0, sum = 0.0, variance = 0.0, own = 0.0, board = 0.0;
  for (const CameraRatio& ratio : ratios) {
    const double w = 1.0 / (ratio.sigma() * ratio.sigma());
    weight += w;
    sum += w * ratio.value;
    own = std::max(own, ratio.own_prior);
    board = ratio.board_prior;
  }
  if (weight <= 0.0) return std::nullopt;
  for (const CameraRatio& ratio : ratios) {
    const double share = 1.0 / (ratio.sigma() * ratio.sigma() * weight);
    variance += share * share * ratio.measured_sigma * ratio.measured_sigma;
  }
  return CameraRatio{"", -1, sum / weight, std::sqrt(variance), own, board, ratios.front().unit_m};
}

Finding cause(const CameraRatio& depth, double wheels, double wheels_sigma, const Stated& stated) {
  const double factor = std::exp(depth.value);
  const bool unit_fits = unit_explains(factor, depth.unit_m);
  const Finding unit(unit_fits ? "depth.unit_of_all" : "depth.scale_of_all", {{"factor", factor}});
  if (std::abs(depth.value) > kUnit && stated.odometry && std::abs(depth.value - wheels) > 3.0 * wheels_sigma)
    return stated.with_odometry(unit);
  if (std::abs(depth.value) > kUnit && !stated.odometry && unit_fits)
    return unit.with({{"squares_mm", stated.square_mm * factor}});
  const FindingValues sizes = {{"measured_mm", stated.square_mm * factor}, {"stated_mm", stated.square_mm}};
  const bool doubted =
      stated.odometry && std::abs(depth.value - wheels) > 3.0 * std::hypot(wheels_sigma, depth.sigma());
  // For the board to be wrong, odometry that sees the stated size would have to be wrong as well.
  if (doubted && std::abs(wheels) < 3.0 * wheels_sigma) return stated.with_odometry(Finding("depth.board_size", sizes));
  const Finding size = stated.with_odometry(Finding("board.size", sizes)
                                                .with({{"off_percent", 100.0 * (1.0 / factor - 1.0)},
                                                       {"plausible_percent", 100.0 * kMaxDepthAlone * depth.sigma()}}));
  return doubted ? size.with({{"depth_doubted", 1}}) : size;
}

void judge(const CameraRatio& depth, const Stated& stated, BoardScale* result) {
  const double z = std::abs(depth.value) / depth.sigma();
  const double wheels = stated.odometry ? std::log(stated.odometry->scale) : 0.0;
  const double wheels_sigma = stated.odometry ? std::hypot(kOdometryScaleSigma, stated.odometry->sigma) : 1e9;
  const bool both =
      depth.value * wheels > 0.0 && z > kMinDepthOfBoth && std::hypot(z, wheels / wheels_sigma) > kMaxBoth;
  if (z > kMaxDepthAlone || both)
    result->contradictions.push_back(cause(depth, wheels, wheels_sigma, stated));
  else if (z > kMinDepthOfBoth)
    result->notes.push_back(Finding("board.measure", {{"measured_mm", stated.square_mm * std::exp(depth.value)},
                                                      {"sigma_mm", stated.square_mm * depth.sigma()},
                                                      {"stated_mm", stated.square_mm}}));
}

// Up to which a camera may differ from the others, whose middle errs as most of them do.
double most_off(const CameraRatio& ratio, const std::vector<CameraRatio>& ratios) {
  std::vector<double> sigmas;
  for (const CameraRatio& other : ratios)
    if (other.index != ratio.index) sigmas.push_back(ratio.sigma_against(other));
  return sigmas.empty() ? 0.0 : kMaxDepthAlone * median(std::move(sigmas));
}

// Takes out the cameras that differ from the others.
std::vector<CameraRatio> without_odd(const std::vector<CameraRatio>& ratios, BoardScale* result) {
  const double centre = centre_of(ratios);
  std::vector<CameraRatio> agreeing;
  for (const CameraRatio& ratio : ratios) {
    const double off = ratio.value - centre, limit = most_off(ratio, ratios);
    if (std::abs(off) <= limit) {
      agreeing.push_back(ratio);
      continue;
    }
    result->contradictions.push_back(odd_camera(ratio, off, limit));
    result->depth_unit = result->depth_unit || std::abs(off) > kUnit;
  }
  return agreeing;
}

void judge_board(int board, const std::vector<CameraRatio>& agreeing, const Stated& stated, BoardScale* result) {
  const std::optional<CameraRatio> depth = mean_of(agreeing);
  if (!depth) return;
  result->ratios.push_back({board, depth->value, {}});
  for (const CameraRatio& ratio : agreeing) result->ratios.back().cameras.push_back(ratio.index);
  judge(*depth, stated, result);
}

BoardScale check_one_board(const Observations& observations, const std::vector<ViewPose>& views,
                           const std::optional<OdometryScale>& odometry) {
  const Stated stated{1e3 * observations.board.square_m, odometry};
  const std::vector<CameraRatio> ratios = ratios_of(observations, views, 0);
  BoardScale result;
  if (ratios.empty())
    result.notes.push_back(note_without_depth(stated));
  else
    judge_board(0, without_odd(ratios, &result), stated, &result);
  return result;
}

// Says of each board which it is.
void append(const std::vector<Finding>& of_board, int board, std::vector<Finding>* findings) {
  for (const Finding& finding : of_board) findings->push_back(finding.with({{"board", board + 1}}));
}

BoardScale check_boards(const Observations& observations, const std::vector<ViewPose>& views) {
  std::vector<std::vector<CameraRatio>> ratios;
  std::set<int> odd;
  BoardScale all;
  for (int b = 0; b < observations.boards(); ++b) {
    ratios.push_back(ratios_of(observations, views, b));
    std::vector<CameraRatio> fresh;
    for (const CameraRatio& ratio : ratios.back())
      if (odd.count(ratio.index) == 0) fresh.push_back(ratio);
    if (fresh.empty()) continue;
    BoardScale of_cameras;
    std::set<int> agree;
    for (const CameraRatio& ratio : without_odd(fresh, &of_cameras)) agree.insert(ratio.index);
    for (const CameraRatio& ratio : fresh)
      if (agree.count(ratio.index) == 0) odd.insert(ratio.index);
    append(of_cameras.contradictions, b, &all.contradictions);
    all.depth_unit = all.depth_unit || of_cameras.depth_unit;
  }
  for (int b = 0; b < observations.boards(); ++b) {
    const auto is_seen = [b](const ViewPose& view) { return view.board == b; };
    if (std::none_of(views.begin(), views.end(), is_seen)) continue;
    const std::optional<OdometryScale> none;
    const Stated stated{1e3 * observations.board_at(b).square_m, none};
    std::vector<CameraRatio> agreeing;
    for (const CameraRatio& ratio : ratios[static_cast<std::size_t>(b)])
      if (odd.count(ratio.index) == 0) agreeing.push_back(ratio);
    BoardScale of_board;
    if (agreeing.empty())
      of_board.notes.push_back(note_without_depth(stated));
    else
      judge_board(b, agreeing, stated, &of_board);
    append(of_board.contradictions, b, &all.contradictions);
    append(of_board.notes, b, &all.notes);
    all.ratios.insert(all.ratios.end(), of_board.ratios.begin(), of_board.ratios.end());
  }
  return all;
}

}  // namespace

BoardScale check_board_scale(const Observations& observations, const std::vector<ViewPose>& views,
                             const std::optional<OdometryScale>& odometry) {
  return observations.boards() == 1 ? check_one_board(observations, views, odometry)
                                    : check_boards(observations, views);
}

}  // namespace rigproof::ml
