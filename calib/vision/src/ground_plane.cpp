#include "rigproof/calib/vision/ground_plane.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/sac_model_plane.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/median.h"

namespace rigproof {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Points that RANSAC sees: enough to find a plane of a tenth of the image, few enough for a millisecond.
constexpr std::size_t kRansacPoints = 1200;
constexpr int kRansacIterations = 600;
// Stretches image directions against inverse depth, so that distance to a plane is nearly its inverse-depth residual.
constexpr float kDirectionScale = 10.0F;
constexpr int kMaxPlanes = 5;
// Without a known vertical, a plane whose normal is nearer than this to the image's up is "below the camera".
constexpr double kBelowCamera_rad = 1.2;
// A lower parallel plane is the floor if it has at least this share of the largest one's points; and what so many
// points lie below is none.
constexpr double kFloorShare = 0.2;
// A better sensor than stated drops what lies beyond three of its own sigmas, but near points, which rounding governs,
// must stay.
constexpr double kMinScale = 0.3;
// A sensor that is noisier than it says keeps its inliers, up to this many times.
constexpr double kMaxScale = 3.0;
// Residual noise is never believed to be less than this share of the sensor's.
constexpr double kMinNoiseShare = 0.05;

// A depth measurement as 1/z over its ray (x/z, y/z, 1).
struct Measurement {
  Vector3d ray;
  double inverse_depth;
  double sigma;
};

// Of point i; none where it has no depth.
std::optional<Measurement> measurement_of(const DepthPoints& points, std::size_t i, const DepthNoise& noise) {
  const Vector3d p = points.points[i].cast<double>();
  if (!p.allFinite() || !(p.z() > 0.0)) return std::nullopt;
  const std::vector<double>& own_sigmas = points.inverse_depth_sigmas_per_m;
  const double sensor = own_sigmas.empty() ? noise.inverse_depth_sigma(p.z()) : own_sigmas[i];
  const double rounding = points.unit_m * points.unit_m / 12.0 / std::pow(p.z(), 4);
  // An exact sensor still has a scale to tell inliers by.
  const double sigma = std::max(1e-6, std::sqrt(sensor * sensor + rounding));
  return Measurement{Vector3d(p.x() / p.z(), p.y() / p.z(), 1.0), 1.0 / p.z(), sigma};
}

std::vector<Measurement> measurements_of(const DepthPoints& points, const DepthNoise& noise) {
  std::vector<Measurement> measurements;
  measurements.reserve(points.points.size());
  for (std::size_t i = 0; i < points.points.size(); ++i)
    if (const auto measurement = measurement_of(points, i, noise)) measurements.push_back(*measurement);
  return measurements;
}

double residual_sigmas(const Measurement& m, const Vector3d& a) { return (m.inverse_depth - a.dot(m.ray)) / m.sigma; }

// Which normals a plane may have.
struct NormalCone {
  Vector3d up;
  double max_angle_rad;

  bool contains(const Vector3d& a) const {
    return -a.dot(up) >= std::cos(max_angle_rad) * a.norm() && a.allFinite() && a.norm() > 0.0;
  }
};

// From n . (s u, s v, w) + d = 0 to w = a . (u, v, 1).
Vector3d inverse_depth_plane(const Eigen::VectorXf& plane) {
  const Eigen::Vector4d p = plane.head<4>().cast<double>();
  return Vector3d(kDirectionScale * p(0), kDirectionScale * p(1), p(3)) / -p(2);
}

// PCL's plane model, restricted to planes that may be the ground. Samples of others are no model at all, so that they
// cost no count.
class GroundModel : public pcl::SampleConsensusModelPlane<pcl::PointXYZ> {
 public:
  GroundModel(const PointCloudConstPtr& cloud, const NormalCone& cone)
      : SampleConsensusModelPlane(cloud, false), cone_(cone) {}

  bool computeModelCoefficients(const pcl::Indices& samples, Eigen::VectorXf& coefficients) const override {
    const Eigen::Vector3f normal = normal_of(samples).normalized();
    coefficients.resize(4);
    for (Eigen::Index i = 0; i < 3; ++i) coefficients(i) = normal(i);
    coefficients(3) = -normal.dot(point(samples[0]));
    return std::abs(coefficients(2)) > 1e-6F && cone_.contains(inverse_depth_plane(coefficients));
  }

 protected:
  // As PCL's own, but for the message on the console.
  bool isSampleGood(const pcl::Indices& samples) const override {
    const float lengths =
        (point(samples[1]) - point(samples[0])).norm() * (point(samples[2]) - point(samples[0])).norm();
    return normal_of(samples).norm() > 1e-3F * lengths;
  }

 private:
  Eigen::Vector3f point(pcl::index_t index) const {
    return (*input_)[static_cast<std::size_t>(index)].getVector3fMap();
  }
  Eigen::Vector3f normal_of(const pcl::Indices& samples) const {
    return (point(samples[1]) - point(samples[0])).cross(point(samples[2]) - point(samples[0]));
  }

  NormalCone cone_;
};

// RANSAC with PCL's seeded sampling. PCL's own loop writes to the console where it finds nothing; a library must not.
std::optional<Eigen::VectorXf> best_model(GroundModel* model, double threshold, std::size_t points) {
  constexpr double kLogMissProbability = -6.9;  // one in a thousand
  std::optional<Eigen::VectorXf> best;
  std::size_t best_count = 0;
  int iterations = 0, wanted = kRansacIterations;
  for (int draws = 0; iterations < wanted && draws < 10 * kRansacIterations; ++draws) {
    pcl::Indices samples;
    model->getSamples(iterations, samples);
    if (samples.empty()) break;
    Eigen::VectorXf coefficients;
    if (!model->computeModelCoefficients(samples, coefficients)) continue;
    ++iterations;
    const std::size_t count = model->countWithinDistance(coefficients, threshold);
    if (count <= best_count) continue;
    best_count = count;
    best = coefficients;
    const double share = static_cast<double>(count) / static_cast<double>(points);
    const double needed = kLogMissProbability / std::log1p(-std::min(0.999, share * share * share));
    wanted = std::min(wanted, 1 + static_cast<int>(needed));
  }
  return best;
}

// Spread evenly over the list whatever its rows are: multiples of the golden section.
std::vector<std::size_t> sample_indices(std::size_t size) {
  const std::size_t count = std::min(size, kRansacPoints);
  std::vector<std::size_t> indices;
  indices.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double fraction = count == size ? static_cast<double>(i) / static_cast<double>(size)
                                          : std::fmod(static_cast<double>(i) * 0.6180339887498949, 1.0);
    const std::size_t index = count == size ? i : static_cast<std::size_t>(fraction * static_cast<double>(size));
    indices.push_back(std::min(index, size - 1));
  }
  return indices;
}

double median_sigma(const std::vector<Measurement>& measurements) {
  std::vector<double> sigmas;
  sigmas.reserve(measurements.size());
  for (const Measurement& m : measurements) sigmas.push_back(m.sigma);
  return median(std::move(sigmas));
}

// The largest plane inside the cone, as RANSAC sees it.
std::optional<Vector3d> ransac_plane(const std::vector<Measurement>& measurements, const NormalCone& cone,
                                     double inlier_sigmas) {
  if (measurements.size() < 3) return std::nullopt;
  const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const std::size_t index : sample_indices(measurements.size())) {
    const Measurement& m = measurements[index];
    cloud->push_back({kDirectionScale * static_cast<float>(m.ray.x()), kDirectionScale * static_cast<float>(m.ray.y()),
                      static_cast<float>(m.inverse_depth)});
  }
  GroundModel model(cloud, cone);
  const std::optional<Eigen::VectorXf> best =
      best_model(&model, inlier_sigmas * median_sigma(measurements), cloud->size());
  if (!best) return std::nullopt;
  return inverse_depth_plane(*best);
}

struct Refined {
  Vector3d a = Vector3d::Zero();
  Matrix3d information = Matrix3d::Zero();  // under the stated sigmas, all points independent
  std::vector<const Measurement*> inliers;  // in the order of the image
  double rms = 0.0;                         // in sigmas
  double scale = 1.0;                       // of the noise over the stated sigmas, robust
  // Where depth has no error but its rounding: what that does to this plane.
  std::optional<Matrix3d> rounding_covariance;
  // That the inliers point into: what is left of the measurements without clutter; none if that is too little.
  std::shared_ptr<const std::vector<Measurement>> uncluttered;
};

// Range limits cut the noise off on one side, so points are chosen by where the plane is, not by what was measured.
struct RangeLimits {
  double min_inverse_m, max_inverse_m;

  bool safe(const Measurement& m, const Vector3d& a, double margin_sigmas) const {
    const double predicted = a.dot(m.ray);
    return predicted - margin_sigmas * m.sigma > min_inverse_m && predicted + margin_sigmas * m.sigma < max_inverse_m;
  }
};

// 1.4826 times the median of |residual| is sigma for a Gaussian.
double robust_scale(const std::vector<const Measurement*>& inliers, const Vector3d& a) {
  std::vector<double> sizes;
  sizes.reserve(inliers.size());
  for (const Measurement* m : inliers) sizes.push_back(std::abs(residual_sigmas(*m, a)));
  if (sizes.empty()) return 1.0;
  return 1.4826 * median(std::move(sizes));
}

std::vector<const Measurement*> select_inliers(const std::vector<Measurement>& measurements, const Vector3d& a,
                                               double width_sigmas, const RangeLimits& limits) {
  std::vector<const Measurement*> inliers;
  for (const Measurement& m : measurements)
    if (std::abs(residual_sigmas(m, a)) < width_sigmas && limits.safe(m, a, width_sigmas)) inliers.push_back(&m);
  return inliers;
}

// Weighted least squares of 1/z = a . ray.
bool fit(Refined* refined) {
  Matrix3d H = Matrix3d::Zero();
  Vector3d g = Vector3d::Zero();
  for (const Measurement* m : refined->inliers) {
    const double weight = 1.0 / (m->sigma * m->sigma);
    H += weight * m->ray * m->ray.transpose();
    g += weight * m->inverse_depth * m->ray;
  }
  const Eigen::LDLT<Matrix3d> solver(H);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-12)) return false;
  refined->a = solver.solve(g);
  refined->information = H;
  double sum = 0.0;
  for (const Measurement* m : refined->inliers) sum += std::pow(residual_sigmas(*m, refined->a), 2);
  refined->rms = std::sqrt(sum / static_cast<double>(refined->inliers.size()));
  return true;
}

// Where something stands on the plane, its foot lies within the noise of the plane and pulls it up: by 0.1 mm and
// 0.004 deg in a furnished room, ten times the standard deviation. Such places are told by the points above the foot,
// so no point of a cell of the image that also shows something else, or of a cell beside such a one, is fitted.
class UnclutteredCells {
 public:
  UnclutteredCells(const std::vector<Measurement>& measurements, const Vector3d& a, double width_sigmas) {
    for (const Measurement& m : measurements) {
      const bool on_plane = std::abs(residual_sigmas(m, a)) < width_sigmas;
      ++(on_plane ? counts_[cell_of(m)].on_plane : counts_[cell_of(m)].elsewhere);
    }
  }

  std::vector<Measurement> clear_of_clutter(const std::vector<Measurement>& measurements) const {
    std::vector<Measurement> clear;
    clear.reserve(measurements.size());
    for (const Measurement& m : measurements)
      if (!near_clutter(cell_of(m))) clear.push_back(m);
    return clear;
  }

 private:
  using Cell = std::pair<int, int>;
  struct Count {
    int on_plane = 0, elsewhere = 0;
    // Noise alone puts one point in 370 beyond three sigma.
    bool cluttered() const { return elsewhere > 2 && 20 * elsewhere > on_plane + elsewhere; }
  };
  // In x/z and y/z: 3 degrees, 32 px at a focal length of 640.
  static constexpr double kCellSize = 0.05;

  static Cell cell_of(const Measurement& m) {
    return {static_cast<int>(std::floor(m.ray.x() / kCellSize)), static_cast<int>(std::floor(m.ray.y() / kCellSize))};
  }
  bool near_clutter(const Cell& cell) const {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto count = counts_.find({cell.first + dx, cell.second + dy});
        if (count != counts_.end() && count->second.cluttered()) return true;
      }
    }
    return false;
  }

  std::map<Cell, Count> counts_;
};

std::optional<Refined> refine(const std::vector<Measurement>& measurements, const Vector3d& seed,
                              const RangeLimits& limits, double inlier_sigmas, double min_scale) {
  Refined refined;
  refined.a = seed;
  for (int round = 0; round < 12; ++round) {
    std::vector<const Measurement*> inliers =
        select_inliers(measurements, refined.a, inlier_sigmas * refined.scale, limits);
    const bool settled = round > 0 && inliers == refined.inliers;
    refined.inliers = std::move(inliers);
    if (refined.inliers.size() < 3) return std::nullopt;
    if (settled) break;
    if (!fit(&refined)) return std::nullopt;
    refined.scale = std::clamp(robust_scale(refined.inliers, refined.a), min_scale, kMaxScale);
  }
  return refined;
}

// Refined once with everything, then without the places where something stands on the plane, if enough remains.
std::optional<Refined> refine_without_clutter(const std::vector<Measurement>& measurements, const Vector3d& seed,
                                              const RangeLimits& limits, const GroundPlaneOptions& options) {
  std::optional<Refined> all = refine(measurements, seed, limits, options.inlier_sigmas, 1.0);
  if (!all) return all;
  const UnclutteredCells cells(measurements, all->a, 2.0 * options.inlier_sigmas);
  const auto clear = std::make_shared<const std::vector<Measurement>>(cells.clear_of_clutter(measurements));
  std::optional<Refined> free = refine(*clear, all->a, limits, options.inlier_sigmas, kMinScale);
  if (free) free->uncluttered = clear;
  const bool enough = free && free->inliers.size() >= static_cast<std::size_t>(options.min_inliers) &&
                      4 * free->inliers.size() >= all->inliers.size();
  return enough ? free : all;
}

// Measurements as if the sensor's noise were `share` of what it states; rounding stays.
std::vector<Measurement> with_noise_share(const std::vector<Measurement>& measurements, double share, double unit_m) {
  std::vector<Measurement> result = measurements;
  for (Measurement& m : result) {
    const double rounding2 = std::pow(unit_m * m.inverse_depth * m.inverse_depth, 2) / 12.0;
    const double sensor2 = std::max(0.0, m.sigma * m.sigma - rounding2);
    m.sigma = std::sqrt(share * share * sensor2 + rounding2);
  }
  return result;
}

// Covariance of the plane where rounding is the only error. Neighbouring pixels of a floor are rounded alike, in a
// level camera whole rows, and the rounding of all of them repeats at every stop: it does not average out. So it is
// played through, at heights about the fitted one at which every pixel meets all phases of a count.
Matrix3d covariance_by_rounding(const Refined& refined, double unit_m) {
  constexpr int kHeights = 64;
  constexpr double kRange = 0.003;  // of the height: two counts of a millimetre at 0.7 m, more beyond
  const Eigen::LDLT<Matrix3d> solver(refined.information);
  // Where symmetry cancels the rounding (left against right in a level camera), half of what independent rounding does.
  constexpr double kLeastShare = 0.5;
  Matrix3d covariance = kLeastShare * kLeastShare * solver.solve(Matrix3d::Identity());
  for (int k = 0; k < kHeights; ++k) {
    const Vector3d a = (1.0 + kRange * ((2.0 * k + 1.0) / kHeights - 1.0)) * refined.a;
    Vector3d g = Vector3d::Zero();
    for (const Measurement* m : refined.inliers) {
      const double inverse_depth = a.dot(m->ray);
      const double rounded_m = unit_m * std::round(1.0 / (inverse_depth * unit_m));
      g += (1.0 / rounded_m - inverse_depth) / (m->sigma * m->sigma) * m->ray;
    }
    const Vector3d error = solver.solve(g);
    covariance += error * error.transpose() / kHeights;
  }
  return covariance;
}

// Depth without noise is known to a fraction of a count everywhere: to a hundredth of the stated noise far away. There
// what stands on the floor shows that lies within the stated noise of it. The noise is taken for less and less, as long
// as the measurements agree; absent where the sensor does have noise.
std::optional<Refined> refine_as_rounded(const Refined& coarse, const RangeLimits& limits, double unit_m,
                                         double inlier_sigmas) {
  constexpr double kStep = 3.0, kNoNoise = 0.004, kAgrees = 1.4;
  if (!(unit_m > 0.0) || coarse.uncluttered == nullptr || coarse.rms * kStep > 1.0) return std::nullopt;
  Refined refined = coarse;
  for (double share = 1.0 / kStep; share > kNoNoise; share /= kStep) {
    const auto measurements =
        std::make_shared<const std::vector<Measurement>>(with_noise_share(*coarse.uncluttered, share, unit_m));
    refined.inliers = select_inliers(*measurements, refined.a, inlier_sigmas, limits);
    refined.uncluttered = measurements;
    if (4 * refined.inliers.size() < coarse.inliers.size() || !fit(&refined)) return std::nullopt;
    refined.scale = robust_scale(refined.inliers, refined.a);
    if (refined.scale > kAgrees) return std::nullopt;
  }
  // A runner of half a millimetre lies within a count nearby. Rounding alone leaves no more than half a count, 1.73 of
  // its standard deviations: cells with more show something else.
  for (const double width : {3.0, 2.1}) {
    const UnclutteredCells cells(*refined.uncluttered, refined.a, width);
    const auto clear = std::make_shared<const std::vector<Measurement>>(cells.clear_of_clutter(*refined.uncluttered));
    refined.inliers = select_inliers(*clear, refined.a, inlier_sigmas, limits);
    refined.uncluttered = clear;
    if (4 * refined.inliers.size() < coarse.inliers.size() || !fit(&refined)) return std::nullopt;
  }
  refined.rounding_covariance = covariance_by_rounding(refined, unit_m);
  return refined;
}

// Points that share one measurement, from the residuals' autocorrelation along rows: the sum over lags gives the
// length in points, and noise is taken to be as long down the columns.
double correlated_points(const Refined& refined) {
  constexpr std::size_t kMaxLag = 30;
  constexpr double kNoCorrelation = 0.1;
  std::vector<double> residuals;
  std::vector<int> rows;
  double square = 0.0;
  for (const Measurement* m : refined.inliers) {
    const bool new_row = !residuals.empty() && m->ray.x() <= refined.inliers[residuals.size() - 1]->ray.x();
    rows.push_back(rows.empty() ? 0 : rows.back() + (new_row ? 1 : 0));
    residuals.push_back(residual_sigmas(*m, refined.a));
    square += residuals.back() * residuals.back();
  }
  if (!(square > 0.0)) return 1.0;
  const double mean_square = square / static_cast<double>(residuals.size());
  double length = 1.0;
  for (std::size_t lag = 1; lag <= kMaxLag && lag < residuals.size(); ++lag) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = lag; i < residuals.size(); ++i) {
      if (rows[i] != rows[i - lag]) continue;
      sum += residuals[i] * residuals[i - lag];
      ++count;
    }
    if (count < 50 || sum / static_cast<double>(count) < kNoCorrelation * mean_square) break;
    length += 2.0 * sum / (static_cast<double>(count) * mean_square);
  }
  return length * length;
}

PlaneObservation to_observation(const Refined& refined, double points_per_measurement) {
  PlaneObservation plane;
  const double shared = std::max({1.0, points_per_measurement, correlated_points(refined)});
  // Residuals cut at three sigma have 0.973 of a Gaussian's variance.
  const double noise = std::max(kMinNoiseShare * kMinNoiseShare, refined.rms * refined.rms / 0.973);
  plane.inverse_depth_plane = refined.a;
  plane.covariance_per_m2 = noise * shared * refined.information.ldlt().solve(Matrix3d::Identity());
  if (refined.rounding_covariance) plane.covariance_per_m2 = std::max(1.0, noise) * *refined.rounding_covariance;
  plane.inlier_points = static_cast<int>(refined.inliers.size());
  plane.effective_points = static_cast<double>(refined.inliers.size()) / shared;
  plane.residual_rms = refined.rms;
  return plane;
}

std::size_t most_inliers(const std::vector<Refined>& planes) {
  std::size_t most = 0;
  for (const Refined& plane : planes) most = std::max(most, plane.inliers.size());
  return most;
}

// Points well below a plane, on rays that meet it where the sensor would see it.
std::size_t points_below(const std::vector<Measurement>& measurements, const Vector3d& a, const RangeLimits& limits) {
  constexpr double kWellBelow = 1.2;  // times the camera's height over the plane
  return static_cast<std::size_t>(std::count_if(measurements.begin(), measurements.end(), [&](const Measurement& m) {
    const double on_plane = a.dot(m.ray);
    return on_plane > limits.min_inverse_m && on_plane > kWellBelow * m.inverse_depth;
  }));
}

// Planes of the cone, each found among the points below those before it.
std::vector<Refined> find_planes(const std::vector<Measurement>& measurements, const NormalCone& cone,
                                 const RangeLimits& limits, const GroundPlaneOptions& options, int max_planes) {
  std::vector<Refined> planes;
  std::vector<Measurement> rest = measurements;
  while (static_cast<int>(planes.size()) < max_planes) {
    const std::optional<Vector3d> seed = ransac_plane(rest, cone, options.inlier_sigmas);
    if (!seed) break;
    std::optional<Refined> plane = refine_without_clutter(measurements, *seed, limits, options);
    if (!plane || static_cast<int>(plane->inliers.size()) < options.min_inliers || !cone.contains(plane->a)) break;
    const Vector3d a = plane->a;
    planes.push_back(std::move(*plane));
    // Only a lower plane can still be the floor: its points are farther away than this one along their rays.
    const auto not_below = [&](const Measurement& m) { return residual_sigmas(m, a) > -2.0 * options.inlier_sigmas; };
    rest.erase(std::remove_if(rest.begin(), rest.end(), not_below), rest.end());
    const double share = kFloorShare * static_cast<double>(most_inliers(planes));
    if (static_cast<double>(rest.size()) < std::max<double>(options.min_inliers, share)) break;
  }
  return planes;
}

// The lowest plane that is neither a mere speck nor a chance alignment of points that belong to other things. What is
// seen past the robot's deck, a table or a platform's edge lies below it: those are left to lower planes, which may
// then be cluttered, or to none.
const Refined* floor_of(const std::vector<Refined>& planes, const std::vector<Measurement>& measurements,
                        const RangeLimits& limits) {
  const double most = static_cast<double>(most_inliers(planes));
  const auto is_seen_past = [&](const Refined& plane) {
    return static_cast<double>(points_below(measurements, plane.a, limits)) >
           kFloorShare * static_cast<double>(plane.inliers.size());
  };
  const Refined *lowest = nullptr, *cluttered = nullptr;
  for (const Refined& plane : planes) {
    if (is_seen_past(plane)) continue;
    const bool large = static_cast<double>(plane.inliers.size()) >= kFloorShare * most;
    const bool whole = plane.uncluttered != nullptr && large;
    if (whole && (lowest == nullptr || plane.a.norm() < lowest->a.norm())) lowest = &plane;
    if (cluttered == nullptr && (&plane == &planes.front() || (large && plane.rms < kMaxScale))) cluttered = &plane;
  }
  return lowest != nullptr ? lowest : cluttered;
}

void check_size(const Image16& depth, const Camera& camera, const std::string& name) {
  if (depth.width == camera.width_px && depth.height == camera.height_px) return;
  throw Error("camera " + name + ": depth image is " + std::to_string(depth.width) + "x" +
              std::to_string(depth.height) + ", its intrinsics are for " + std::to_string(camera.width_px) + "x" +
              std::to_string(camera.height_px));
}

}  // namespace

DepthPoints points_from_depth(const Image16& depth, const RigCamera& camera, int stride) {
  if (!camera.depth) throw Error("camera " + camera.name + ": has no depth stream");
  if (stride < 1) throw Error("stride: " + std::to_string(stride) + ": allowed is 1 and more");
  const DepthStream& stream = *camera.depth;
  const Camera& optics = camera.depth_optics();
  check_size(depth, optics, camera.name);
  DepthPoints result;
  result.points_per_measurement = std::max(1.0, std::pow(stream.noise.correlation_px / stride, 2));
  result.unit_m = stream.unit_m;
  result.min_m = stream.min_m;
  result.max_m = stream.max_m;
  for (int y = stride / 2; y < depth.height; y += stride) {
    for (int x = stride / 2; x < depth.width; x += stride) {
      const double z = stream.unit_m * depth.at(x, y);
      Vector3d ray;
      if (!(z > 0.0)) continue;
      result.nearest_m = result.farthest_m > 0.0 ? std::min(result.nearest_m, z) : z;
      result.farthest_m = std::max(result.farthest_m, z);
      if (z < stream.min_m || z > stream.max_m || !optics.unproject(Eigen::Vector2d(x, y), &ray)) continue;
      Vector3d point = z * ray;
      if (stream.own_camera) point = stream.own_camera->T_color_depth * point;
      if (point.z() > 0.0) result.points.push_back(point.cast<float>());
    }
  }
  return result;
}

int sampling_stride(int width, int height, int most) {
  int stride = 1;
  while ((width / stride) * (height / stride) > most) ++stride;
  return stride;
}

DepthPoints sampled_depth(const Image16& depth, const RigCamera& camera, int most) {
  return points_from_depth(depth, camera, sampling_stride(depth.width, depth.height, most));
}

DepthPoints points_from_cloud(std::vector<Eigen::Vector3f> cloud, const DepthStream& depth, int most) {
  const auto min = static_cast<float>(depth.min_m), max = static_cast<float>(depth.max_m);
  cloud.erase(std::remove_if(cloud.begin(), cloud.end(),
                             [&](const Eigen::Vector3f& p) { return !(p.z() >= min && p.z() <= max); }),
              cloud.end());
  DepthPoints points;
  points.min_m = depth.min_m;
  points.max_m = depth.max_m;
  const std::size_t step = cloud.size() / static_cast<std::size_t>(most) + 1;
  for (std::size_t i = 0; i < cloud.size(); i += step) points.points.push_back(cloud[i]);
  return points;
}

namespace {

Finding too_few(const DepthPoints& points, std::size_t measurements) {
  const Finding finding("plane.too_few_points", {{"points", measurements}});
  if (!(points.farthest_m > 0.0)) return finding;
  return finding.with({{"min_m", points.min_m},
                       {"max_m", points.max_m},
                       {"nearest_m", points.nearest_m},
                       {"farthest_m", points.farthest_m}});
}

Finding seen_past(const Refined& plane, const std::vector<Measurement>& measurements, const RangeLimits& limits) {
  return Finding("plane.seen_past", {{"above_m", 1.0 / plane.a.norm()},
                                     {"below", points_below(measurements, plane.a, limits)},
                                     {"on", plane.inliers.size()}});
}

}  // namespace

GroundPlaneFit fit_ground_plane(const DepthPoints& points, const DepthNoise& noise,
                                const std::optional<Vector3d>& up_camera, const GroundPlaneOptions& options) {
  const std::vector<Measurement> measurements = measurements_of(points, noise);
  if (static_cast<int>(measurements.size()) < options.min_inliers)
    return {std::nullopt, too_few(points, measurements.size())};
  const RangeLimits limits{1.0 / points.max_m, points.min_m > 0.0 ? 1.0 / points.min_m : 1e9};
  std::vector<Refined> planes;
  if (up_camera) {
    planes = find_planes(measurements, {up_camera->normalized(), options.max_tilt_rad}, limits, options, kMaxPlanes);
    if (planes.empty()) return {std::nullopt, Finding("plane.not_level")};
  } else {
    const Vector3d image_up = -Vector3d::UnitY();
    planes = find_planes(measurements, {image_up, kBelowCamera_rad}, limits, options, 1);
    if (planes.empty()) planes = find_planes(measurements, {image_up, kPi}, limits, options, 1);
    if (planes.empty()) return {std::nullopt, Finding("plane.none")};
  }
  // Without a vertical the plane may be a wall, which things stand behind.
  const Refined* floor = up_camera ? floor_of(planes, measurements, limits) : &planes.front();
  if (floor == nullptr) return {std::nullopt, seen_past(planes.front(), measurements, limits)};
  const std::optional<Refined> rounded = refine_as_rounded(*floor, limits, points.unit_m, options.inlier_sigmas);
  return {to_observation(rounded ? *rounded : *floor, points.points_per_measurement), {}};
}

std::vector<bool> lie_on_plane(const DepthPoints& points, const DepthNoise& noise, const PlaneObservation& plane,
                               double sigmas) {
  const double width = sigmas * std::clamp(plane.residual_rms, kMinScale, kMaxScale);
  std::vector<bool> on(points.points.size(), false);
  for (std::size_t i = 0; i < on.size(); ++i) {
    const auto measurement = measurement_of(points, i, noise);
    on[i] = measurement && std::abs(residual_sigmas(*measurement, plane.inverse_depth_plane)) < width;
  }
  return on;
}

}  // namespace rigproof
