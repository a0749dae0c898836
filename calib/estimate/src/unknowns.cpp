#include "rigproof/calib/estimate/unknowns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "rigproof/calib/estimate/depth_bias.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/core/conventions.h"
#include "shared_ground_error.h"

namespace rigproof {

bool was_asked(const PriorSigmas& sigmas, double PriorSigmas::*which) {
  return std::find(sigmas.asked.begin(), sigmas.asked.end(), which) != sigmas.asked.end();
}

PriorSigmas usual_priors() {
  PriorSigmas priors;
  priors.odometry_veer_rad_per_m = 0.03;
  priors.turn_lag_s = 0.02;
  priors.rotation_centre_m = 0.05;
  priors.riding_height_m = 0.0003;
  return priors;
}

PriorSigmas with_those_of_rig(PriorSigmas sigmas, const OdometryNoise& stated) {
  struct OfRig {
    double PriorSigmas::*sigma;
    std::optional<double> OdometryNoise::*stated;
  };
  static constexpr std::array<OfRig, 6> kOfRig = {{
      {&PriorSigmas::odometry_scale, &OdometryNoise::scale_sigma},
      {&PriorSigmas::odometry_yaw_factor, &OdometryNoise::yaw_factor_sigma},
      {&PriorSigmas::odometry_veer_rad_per_m, &OdometryNoise::veer_sigma_rad_per_m},
      {&PriorSigmas::turn_lag_s, &OdometryNoise::turn_lag_sigma_s},
      {&PriorSigmas::rotation_centre_m, &OdometryNoise::rotation_centre_sigma_m},
      {&PriorSigmas::riding_height_m, &OdometryNoise::riding_height_sigma_m},
  }};
  const PriorSigmas usual = usual_priors();
  for (const OfRig& prior : kOfRig) {
    if (!was_asked(sigmas, prior.sigma) && stated.*prior.stated && sigmas.*prior.sigma == usual.*prior.sigma)
      sigmas.*prior.sigma = *(stated.*prior.stated);
  }
  return sigmas;
}

const std::vector<PriorSetting>& prior_settings() {
  static const std::vector<PriorSetting> kSettings = {
      {"clock_offset_sigma_ms", &PriorSigmas::clock_offset_s, 1e3, 1000.0, true,
       "Each camera's stamps are late or early by about this much against the odometry's, whatever the rig states: "
       "estimated from images that are taken while the robot moves; 0: they are believed"},
      {"focal_sigma_percent", &PriorSigmas::focal_relative, 100.0, 20.0, true,
       "Each camera's focal length is off by about this much, whatever the rig states: estimated; 0: as the rig "
       "states"},
      {"principal_point_sigma_px", &PriorSigmas::principal_point_px, 1.0, 50.0, true,
       "Each camera's principal point is off by about this much along x and y, whatever the rig states: estimated; "
       "0: as the rig states"},
      {"odometry_scale_sigma_percent", &PriorSigmas::odometry_scale, 100.0, 100.0, true,
       "Odometry from stop to stop: its translations are off by a factor that differs from 1 by about this much: "
       "estimated; 0 where they are not"},
      {"odometry_yaw_factor_sigma_percent", &PriorSigmas::odometry_yaw_factor, 100.0, 100.0, true,
       "The same of its turns"},
      {"odometry_veer_sigma_deg_per_m", &PriorSigmas::odometry_veer_rad_per_m, 180.0 / kPi, 100.0, true,
       "Odometry from stop to stop: its heading gains about this much on the robot's with every metre forward, as of "
       "wheels whose diameters differ; 0 where they do not"},
      {"rotation_centre_sigma_mm", &PriorSigmas::rotation_centre_m, 1e3, 1000.0, false,
       "Odometry along the way: the point about which the robot turns lies off the robot's origin by about this "
       "much along x and along y, which no data tell; 5 where it is the middle of one driven axle, 0 where the origin "
       "is that point by definition"},
      {"turn_lag_sigma_ms", &PriorSigmas::turn_lag_s, 1e3, 1000.0, true,
       "Beside clock offsets: the body turns later than its wheels by about this much (tyres give way): "
       "estimated; 0 where it does not"},
      {"riding_height_sigma_mm", &PriorSigmas::riding_height_m, 1e3, 100.0, false,
       "Images taken at speed: the robot rides higher or lower than at rest by about this much, which no data "
       "tell; 0 where it does not"},
      {"readout_sigma_ms", &PriorSigmas::readout_s, 1e3, 100.0, true,
       "Images taken at speed: each camera's readout, from the first row to the last, is off by about this much, "
       "whatever the rig states: estimated; 0: as the rig states"},
  };
  return kSettings;
}

namespace ml {
namespace {

using Covariances = std::vector<Eigen::MatrixXd>;

Eigen::MatrixXd independent(const std::vector<double>& sigmas) {
  return Eigen::Map<const Eigen::VectorXd>(sigmas.data(), static_cast<Eigen::Index>(sigmas.size()))
      .cwiseAbs2()
      .asDiagonal();
}

Covariances for_each_camera(const PriorSource& source, const Eigen::MatrixXd& covariance) {
  return Covariances(source.observations.cameras.size(), covariance);
}

Covariances of_odometry(const PriorSource& source) {
  return {independent({source.sigmas.odometry_scale, source.sigmas.odometry_yaw_factor})};
}

Covariances of_odometry_veer(const PriorSource& source) {
  return {independent({source.sigmas.odometry_veer_rad_per_m})};
}

Covariances of_depth_scale(const PriorSource& source) {
  Covariances covariances;
  for (const RigCamera& camera : source.observations.cameras)
    covariances.push_back(independent({camera.depth ? camera.depth->noise.scale_sigma : 0.0}));
  return covariances;
}

DepthNoise exact_depth() {
  DepthNoise noise;
  noise.believe_place_and_common_scale();
  return noise;
}

double common_scale_sigma(const RigCamera& camera) {
  return camera.depth ? camera.depth->noise.common_scale_sigma : 0.0;
}

// As far off as the worst of a make is said to be.
double largest_common_scale_sigma(const Observations& observations, int make) {
  double sigma = 0.0;
  for (int c = 0; c < static_cast<int>(observations.cameras.size()); ++c)
    if (first_of_make(observations.cameras, c) == make)
      sigma = std::max(sigma, common_scale_sigma(observations.cameras[static_cast<std::size_t>(c)]));
  return sigma;
}

// Of each make, at its first camera.
Covariances of_common_depth_scale(const PriorSource& source) {
  Covariances covariances;
  for (int c = 0; c < static_cast<int>(source.observations.cameras.size()); ++c)
    covariances.push_back(
        independent({source.sigmas.believe_told ? 0.0 : largest_common_scale_sigma(source.observations, c)}));
  return covariances;
}

Covariances of_depth_offset(const PriorSource& source) {
  Covariances covariances;
  for (const RigCamera& camera : source.observations.cameras) {
    const DepthNoise noise = camera.depth && !source.sigmas.believe_told ? camera.depth->noise : exact_depth();
    covariances.push_back(independent({noise.offset_sigma_m, noise.tilt_sigma_rad, noise.tilt_sigma_rad}));
  }
  return covariances;
}

IntrinsicsSigma lens_sigma(const PriorSigmas& settings, const RigCamera& camera) {
  IntrinsicsSigma sigma = settings.believe_told ? IntrinsicsSigma::exact() : camera.intrinsics_sigma;
  if (settings.focal_relative > 0.0) sigma.focal_relative = settings.focal_relative;
  if (settings.principal_point_px > 0.0) sigma.principal_point_px = settings.principal_point_px;
  return sigma;
}

Eigen::MatrixXd shape_covariance(double shift_px, double focal_relative, const Camera& camera) {
  return independent({shift_px / camera.fx_px, shift_px / camera.fy_px, 0.0, 0.0, focal_relative, 0.0});
}

// An estimated lens moves planes as if they filled the image: over a floor, distortion acts by up to a tenth of it
// otherwise, and of the residual field, which moves no plane that fills the image, about all of it is left. The latter
// counts as a shift alone; whether as slopes and turns, too, is open (docs/measurements/estimation.md).
Eigen::MatrixXd shape_left_by(const IntrinsicsSigma& lens, const Camera& camera) {
  constexpr double kOfDistortion = 0.1;
  const double distortion = kOfDistortion * lens.distortion_px / camera.fx_px;
  const double shift = std::hypot(distortion, lens.residual_px / camera.fx_px);
  return independent({shift, shift, distortion, distortion, distortion, distortion});
}

// A depth image may lie aside of its colour image. A driver makes clouds with the intrinsics that are stated, or with
// others, which are no better: they may differ by as much as the stated ones err. What is far beyond is doubted only
// where it is tested: see depth_shape.h.
Covariances of_depth_shape(const PriorSource& source) {
  Covariances covariances = for_each_camera(source, Eigen::MatrixXd::Zero(6, 6));
  const auto doubt = [&covariances](std::size_t camera, const Eigen::MatrixXd& covariance) {
    covariances[camera] = covariances[camera].cwiseMax(covariance);
  };
  for (const auto* planes : {&source.observations.ground_planes, &source.observations.board_planes})
    for (const PlaneObservation& plane : *planes) {
      const auto c = static_cast<std::size_t>(plane.camera);
      const RigCamera& camera = source.observations.cameras[c];
      const IntrinsicsSigma lens = lens_sigma(source.sigmas, camera);
      if (is_cloud(plane, camera))
        doubt(c, shape_covariance(lens.principal_point_px, lens.focal_relative, camera.camera));
      if (source.sigmas.believe_told || !camera.depth) continue;
      doubt(c, shape_left_by(lens, camera.depth_optics()));
      if (!is_cloud(plane, camera))
        doubt(c, shape_covariance(camera.depth->noise.shift_sigma_px, 0.0, camera.depth_optics()));
    }
  return covariances;
}

Covariances of_lens(const PriorSource& source) {
  Covariances covariances;
  for (const RigCamera& camera : source.observations.cameras) {
    const IntrinsicsSigma s = lens_sigma(source.sigmas, camera);
    covariances.push_back(
        independent({s.focal_relative, s.principal_point_px, s.principal_point_px, s.focal_ratio, s.distortion_px}));
  }
  return covariances;
}

// Printers scale both directions of a sheet more alike than right.
Covariances of_board_shape(const PriorSource& source) {
  constexpr double kRatio = 0.2;  // of the sigma of the squares' side
  Covariances covariances;
  for (int b = 0; b < source.observations.boards(); ++b) {
    const Board& board = source.observations.board_at(b);
    const double side = board.square_sigma_relative(), bow_m = board.bow_sigma();
    covariances.push_back(independent({side, kRatio * side, bow_m, bow_m}));
    if (source.sigmas.believe_told) covariances.back().setZero();
  }
  return covariances;
}

Covariances of_ground_offset(const PriorSource& source) {
  std::vector<Eigen::Matrix3d> shared;
  if (source.planes_share_errors) shared = shared_ground_errors(source.observations);
  shared = sum_of(std::move(shared), ground_plane_biases(source.observations));
  if (shared.empty()) return for_each_camera(source, Eigen::Matrix3d::Zero());
  return Covariances(shared.begin(), shared.end());
}

Covariances of_clock_offset(const PriorSource& source) {
  const double asked = source.sigmas.clock_offset_s;
  const bool of_rig = !(asked > 0.0) && !was_asked(source.sigmas, &PriorSigmas::clock_offset_s);
  Covariances covariances;
  for (const RigCamera& camera : source.observations.cameras)
    covariances.push_back(independent({of_rig ? camera.clock_offset_sigma_s : asked}));
  return covariances;
}

// Believed stamps are late by no lag.
Covariances of_turn_lag(const PriorSource& source) {
  const Covariances clocks = of_clock_offset(source);
  const bool doubted = std::any_of(clocks.begin(), clocks.end(), [](const auto& clock) { return clock(0, 0) > 0.0; });
  return {independent({doubted ? source.sigmas.turn_lag_s : 0.0})};
}

// Of a robot that stands it does not matter.
Covariances of_readout(const PriorSource& source) {
  const std::vector<Stop>& stops = source.observations.stops;
  const bool moves =
      std::any_of(stops.begin(), stops.end(), [](const Stop& stop) { return !stop.velocity.isZero(0.0); });
  Covariances covariances;
  for (const RigCamera& camera : source.observations.cameras) {
    double sigma = source.sigmas.believe_told ? 0.0 : camera.readout_sigma_s;
    if (source.sigmas.readout_s > 0.0) sigma = source.sigmas.readout_s;
    covariances.push_back(independent({moves ? sigma : 0.0}));
  }
  return covariances;
}

using Parts = std::vector<NuisanceRow::Part>;

Parts odometry_parts() { return {{"odometry_scale", 1.0}, {"odometry_yaw_factor", 1.0}}; }

Parts odometry_veer_parts() { return {{"odometry_veer_deg_per_m", 180.0 / kPi}}; }

// How they drift from day to day: docs/theory/moved.md#errors-that-last.
Parts depth_scale_parts() { return {{"depth_scale_percent", 100.0, 5e-4}}; }

Parts common_depth_scale_parts() { return {{"common_depth_scale_percent", 100.0, 1e-4}}; }

Parts depth_offset_parts() {
  return {
      {"depth_offset_mm", 1e3, 2e-4}, {"depth_tilt_x_deg", 180.0 / kPi, 1e-4}, {"depth_tilt_y_deg", 180.0 / kPi, 1e-4}};
}

Parts depth_shape_parts() {
  constexpr double kDrift = 1e-4;
  return {{"depth_shift_x", 1.0, kDrift}, {"depth_shift_y", 1.0, kDrift},      {"depth_slope_x", 1.0, kDrift},
          {"depth_slope_y", 1.0, kDrift}, {"depth_focal_length", 1.0, kDrift}, {"depth_roll", 1.0, kDrift}};
}

Parts lens_parts() {
  return {{"focal_length_percent", 100.0, 2e-4},
          {"principal_point_x_px", 1.0, 0.1},
          {"principal_point_y_px", 1.0, 0.1},
          {"focal_ratio_percent", 100.0, 2e-5},
          {"distortion_px", 1.0, 0.03}};
}

Parts board_parts() {
  return {{"board_size_percent", 100.0, 2e-4},
          {"board_ratio_percent", 100.0, 1e-4},
          {"board_bow_x_mm", 1e3, 5e-5},
          {"board_bow_y_mm", 1e3, 5e-5}};
}

Parts ground_offset_parts() {
  return {{"ground_offset_x_per_m", 1.0}, {"ground_offset_y_per_m", 1.0}, {"ground_offset_z_per_m", 1.0}};
}

}  // namespace

const std::array<NuisanceRow, kNuisances>& nuisance_table() {
  constexpr Each kRig = Each::kRig, kCamera = Each::kCamera, kBoard = Each::kBoard;
  constexpr bool kAny = false, kIncrements = true;  // odometry that knows it
  constexpr bool kReported = true;
  static const std::array<NuisanceRow, kNuisances> kTable = {{
      {odometry_parts(), kRig, kIncrements, !kReported, "odometry", &of_odometry},
      {odometry_veer_parts(), kRig, kIncrements, !kReported, "odometry", &of_odometry_veer},
      {depth_scale_parts(), kCamera, kAny, !kReported, "depth scale", &of_depth_scale},
      {common_depth_scale_parts(), kCamera, kAny, kReported, "depth scale", &of_common_depth_scale},
      {depth_offset_parts(), kCamera, kAny, kReported, "depth error", &of_depth_offset},
      {depth_shape_parts(), kCamera, kAny, !kReported, "depth error", &of_depth_shape},
      {lens_parts(), kCamera, kAny, kReported, "lens", &of_lens},
      {board_parts(), kBoard, kAny, kReported, "board", &of_board_shape},
      {ground_offset_parts(), kCamera, kAny, !kReported, "depth error", &of_ground_offset},
      {{{"clock_offset_ms", 1e3}}, kCamera, kAny, kReported, "clock", &of_clock_offset},
      {{{"turn_lag_ms", 1e3}}, kRig, kAny, !kReported, "turn lag", &of_turn_lag},
      {{{"readout_ms", 1e3, 1e-6}}, kCamera, kAny, kReported, "rolling shutter", &of_readout},
  }};
  return kTable;
}

std::string name_of_board(const std::string& quantity, int board) {
  const std::string prefix = "board_";
  const bool has_prefix = quantity.rfind(prefix, 0) == 0;
  if (board == 0) return quantity;
  return prefix + std::to_string(board + 1) + "_" + (has_prefix ? quantity.substr(prefix.size()) : quantity);
}

CommonDepth common_depth(const Observations& observations, int camera) {
  const int make = first_of_make(observations.cameras, camera);
  const double largest = largest_common_scale_sigma(observations, make);
  const double own = common_scale_sigma(observations.cameras[static_cast<std::size_t>(camera)]);
  return {make, largest > 0.0 ? own / largest : 1.0};
}

const std::array<CommonError, 3>& common_errors() {
  static const std::array<CommonError, 3> kErrors = {{
      {&PriorSigmas::rotation_centre_m, 0, true, "turning point"},
      {&PriorSigmas::rotation_centre_m, 1, true, "turning point"},
      {&PriorSigmas::riding_height_m, 2, false, "riding height"},
  }};
  return kErrors;
}

Priors Priors::of(const PriorSource& source) {
  Priors priors;
  for (std::size_t n = 0; n < kNuisances; ++n) priors.covariances_[n] = nuisance_table()[n].prior(source);
  return priors;
}

bool Priors::has(Nuisance nuisance) const {
  const Covariances& all = covariances_[static_cast<std::size_t>(nuisance)];
  return std::any_of(all.begin(), all.end(),
                     [](const Eigen::MatrixXd& covariance) { return (covariance.diagonal().array() > 0.0).any(); });
}

double Priors::sigma(Nuisance nuisance, int camera, int part) const {
  return std::sqrt(covariance(nuisance, camera)(part, part));
}

namespace {

// First the rig's values, then camera by camera, then board by board.
struct Addresses {
  std::array<int, kNuisances> first{};  // among the values of one
  std::array<int, 3> size{};            // values of one, by Each
};

const Addresses& addresses() {
  static const Addresses kAddresses = [] {
    Addresses all;
    for (std::size_t n = 0; n < kNuisances; ++n) {
      const NuisanceRow& row = nuisance_table()[n];
      int& end = all.size[static_cast<std::size_t>(row.each)];
      all.first[n] = end;
      end += row.size();
    }
    return all;
  }();
  return kAddresses;
}

}  // namespace

NuisanceValues::NuisanceValues(int cameras, int boards) : cameras_(cameras) {
  const auto [rig, camera, board] = addresses().size;
  values_ = Eigen::VectorXd::Zero(rig + cameras * camera + boards * board);
}

Eigen::Index NuisanceValues::address(Nuisance nuisance, int which) const {
  const auto [rig, camera, board] = addresses().size;
  const int first = addresses().first[static_cast<std::size_t>(nuisance)];
  switch (row_of(nuisance).each) {
    case Each::kRig:
      return first;
    case Each::kCamera:
      return rig + which * camera + first;
    case Each::kBoard:
      return rig + cameras_ * camera + which * board + first;
  }
  return first;
}

}  // namespace ml
}  // namespace rigproof
