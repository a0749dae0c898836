// The steps from the authors' chain of MEMROC to ours, each a method: where the error of the published one comes from.
#include <algorithm>
#include <array>
#include <cmath>

#include "memroc_chain.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/methods/memroc.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/calib/vision/reference_corners.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

MethodTraits traits_of_link(const char* name, const char* summary, MethodReads reads, double seconds_a_view) {
  return {name,  summary,       "board, odometry, ground plane", "camera to robot (6), camera to camera",
          reads, seconds_a_view};
}

// The authors' chain of Joint-MEMROC with the first links replaced by ours.
class ChainMethod : public Method {
 public:
  ChainMethod(const char* name, const char* summary, rivals::ChainLink replaced)
      : name_(name), summary_(summary), replaced_(replaced) {}

  MethodTraits traits() const override {
    const bool clouds = replaced_ < rivals::ChainLink::kPlanes;
    return traits_of_link(name_, summary_, clouds ? MethodReads::kFiles : MethodReads::kObservations, 6e-4);
  }
  Result solve(const Observations& observations) const override { return solve_recording({observations}); }
  Result solve_recording(const MethodInput& input) const override {
    Result result = rivals::solve_chain(input, true, replaced_);
    result.method = name_;
    return result;
  }

 private:
  const char* name_;
  const char* summary_;
  rivals::ChainLink replaced_;
};

// One standard deviation for metres and radians alike, as their equal weights mean: of what MEMROC's own motions leave
// in x and y, and in yaw, the larger, so that neither contradicts it.
double equal_sigma(const Result& memroc) {
  double sigma = 1e-6;
  for (const ResidualSummary& residual : memroc.residuals) {
    if (residual.name == "motions, translation") sigma = std::max(sigma, M_SQRT1_2 * residual.rms);
    if (residual.name == "motions, rotation") sigma = std::max(sigma, deg_to_rad(residual.rms));
  }
  return sigma;
}

// Every corner by itself, as `ml` has it, but odometry as MEMROC has it.
class ReprojectionMethod : public Method {
 public:
  MethodTraits traits() const override {
    return traits_of_link("chain_reprojection", "residuals of corners, instead of poses; odometry still 1 m = 1 rad",
                          MethodReads::kObservations, 1e-3);
  }
  Result solve(const Observations& observations) const override {
    const double sigma = equal_sigma(solve_memroc(observations, estimate_view_poses(observations), {true}));
    Observations equal = observations;
    equal.odometry_noise.model = OdometryModel::kPerIncrement;
    equal.odometry_noise.sigma_xy_m = equal.odometry_noise.sigma_yaw_rad = sigma;
    Result result = estimate_maximum_likelihood(equal).result;
    result.method = traits().name;
    return result;
  }
};

constexpr double kSameCorner_px = 3.0, kTheirSigma_px = 0.05;

// The view with OpenCV's corners under the board's ids; a corner of ours without one of theirs nearby is left out.
BoardView with_corners_of(const rivals::ChessboardCorners& theirs, BoardView view) {
  std::vector<CornerObservation> corners;
  for (const CornerObservation& ours : view.corners) {
    const auto off = [&ours](const Eigen::Vector2f& p) { return (p.cast<double>() - ours.pixel).norm(); };
    const auto nearest = std::min_element(theirs.pixels.begin(), theirs.pixels.end(),
                                          [&off](const auto& a, const auto& b) { return off(a) < off(b); });
    if (nearest == theirs.pixels.end() || off(*nearest) > kSameCorner_px) continue;
    corners.push_back({ours.id, nearest->cast<double>(), std::pow(kTheirSigma_px, 2) * Eigen::Matrix2d::Identity()});
  }
  view.corners = corners;
  return view;
}

// The other way round: our estimate from the authors' corners.
class OpenCvCornersMethod : public Method {
 public:
  MethodTraits traits() const override {
    return traits_of_link("ml_opencv_corners", "ml with OpenCV's corners again", MethodReads::kFiles, 1e-3);
  }
  std::optional<Finding> why_not(const MethodInput& input) const override {
    if (input.recording != nullptr) return {};
    return Finding("method.needs_images");
  }
  Result solve(const Observations& observations) const override { return run_method(*this, {observations}); }
  Result solve_recording(const MethodInput& input) const override {
    const rivals::FramesByStop frames = rivals::frames_by_stop(input.observations, *input.recording);
    const rivals::ChessboardViews boards = rivals::reference_chessboards(input, frames);
    Observations theirs = input.observations;
    theirs.board_views.clear();
    for (const BoardView& view : input.observations.board_views) {
      const auto found = boards.find({view.stop, view.camera});
      if (found != boards.end() && found->second) theirs.board_views.push_back(with_corners_of(*found->second, view));
    }
    Result result = estimate_maximum_likelihood(theirs).result;
    result.method = traits().name;
    return result;
  }
};

}  // namespace

const std::vector<const Method*>& memroc_chain_methods() {
  using rivals::ChainLink;
  static const std::array<ChainMethod, 6> links = {
      ChainMethod("chain_corners", "corners of ours, instead of OpenCV's", ChainLink::kCorners),
      ChainMethod("chain_pnp", "PnP of every view by its corners' covariances, instead of RANSAC", ChainLink::kPnp),
      ChainMethod("chain_planes", "planes fitted with the sensor's noise, instead of 0.1 mm", ChainLink::kPlanes),
      ChainMethod("chain_vertical", "ground told by the drive with its lever arm, instead of aligned paths",
                  ChainLink::kVertical),
      ChainMethod("chain_start", "closed-form start, instead of the board's axes", ChainLink::kStart),
      ChainMethod("chain_residual", "angles between rotations, heights by themselves", ChainLink::kResidual)};
  static const ReprojectionMethod reprojection;
  static const OpenCvCornersMethod opencv_corners;
  static const std::vector<const Method*> methods = [] {
    std::vector<const Method*> all;
    for (const ChainMethod& link : links) all.push_back(&link);
    all.push_back(&reprojection);
    all.push_back(&opencv_corners);
    return all;
  }();
  return methods;
}

}  // namespace rigproof
