#include "ground_misfit.h"

#include <algorithm>
#include <cmath>

namespace rigproof::ml {
namespace {

// Times what is explained: beyond the first it is suspected, beyond the second nothing can be trusted.
constexpr double kSuspect = 4.0, kContradicts = 23.0;
constexpr int kDimensions = 3;  // of a plane
constexpr double kLeastRedundancy = 3.0;

// Root mean square of what the noise of a camera's planes can be, over what is stated of it. On uneven ground a camera
// sees another floor than the wheels stand on: height and slope differ like those of the robot from stop to stop do.
double explained(const Preparation& prepared, const NoiseLevels& noise, int camera) {
  constexpr double kFloorOfSuspension = 2.0;
  const NoiseLevels usual;
  const double height_m = kFloorOfSuspension * std::max(noise.suspension_height_m, usual.suspension_height_m);
  const double tilt_rad = kFloorOfSuspension * std::max(noise.suspension_tilt_rad, usual.suspension_tilt_rad);
  const Eigen::Matrix3d known = prepared.priors.covariance(Nuisance::kGroundOffset, camera);
  double sum = 0.0, planes = 0.0;
  for (const WhitenedPlane& plane : prepared.whitened->ground_planes) {
    if (plane.camera != camera) continue;
    // The normal over the height.
    const Eigen::Vector3d& a = plane.measured;
    const Eigen::Matrix3d along = a * a.transpose(), square = a.squaredNorm() * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d floor =
        height_m * height_m * a.squaredNorm() * along + tilt_rad * tilt_rad * (square - along);
    sum += 1.0 + (plane.whitening * (known + floor) * plane.whitening.transpose()).trace() / kDimensions;
    ++planes;
  }
  return planes > 0.0 ? std::sqrt(sum / planes) : 1.0;
}

// Root mean square of a camera's planes over what is stated of them.
struct Misfit {
  double most = 0.0;  // of all but a few outliers
  double all = 0.0;   // of all of them
};

Misfit misfit_of(const GroupSum& all, double scale) {
  const GroupSum without = all.without_outliers();
  const double of_loss = cauchy_moments(kDimensions).weighted_square;
  const double level = scale * std::sqrt(without.weighted_square / (of_loss * without.redundancy()));
  const double rms = scale * std::sqrt(all.square / all.redundancy());
  // The loss hides outliers, which are none where they are many.
  const bool few = without.dimensions < all.dimensions;
  return {few ? level : std::max(level, rms), rms};
}

}  // namespace

std::vector<Finding> find_ground_misfits(const Preparation& prepared, const Fit& fit, const GroupSums& sums) {
  std::vector<Finding> findings;
  for (const int c : prepared.solved_cameras()) {
    const GroupSum& sum = sum_of(sums, Group::kGround, c);
    if (sum.without_outliers().redundancy() < kLeastRedundancy) continue;
    const double noise = explained(prepared, fit.noise, c);
    const Misfit misfit = misfit_of(sum, fit.noise.ground_scale[static_cast<std::size_t>(c)]);
    const bool contradicts = misfit.most > kContradicts * noise;
    if (!contradicts && misfit.most <= kSuspect * noise && misfit.all <= kContradicts * noise) continue;
    findings.push_back(Finding(contradicts ? "ground.off" : "ground.off_slightly",
                               {{"sigmas", std::max(misfit.most, misfit.all)}, {"explained", noise}})
                           .of(prepared.original.cameras[static_cast<std::size_t>(c)].name));
  }
  return findings;
}

}  // namespace rigproof::ml
