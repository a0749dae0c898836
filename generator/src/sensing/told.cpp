// What the recording tells of lenses, board and depth scales against what is true: `sensing.told` and `sensing.lens`.
#include <algorithm>
#include <cmath>
#include <optional>

#include "resolve.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

bool is_zero(const Distribution& error) { return error.lowest() == 0.0 && error.highest() == 0.0; }

bool is_zero(const LensSensingConfig& config) {
  return is_zero(config.focal_error_percent) && is_zero(config.centre_error_px) &&
         is_zero(config.distortion_error_percent);
}

// How far a point in the farthest corner moves, in pixels, for each unit of the lens's leading radial coefficient.
double corner_px_by_leading_term(const Camera& camera) {
  const double focal_px = std::sqrt(camera.fx_px * camera.fy_px);
  double farthest = 0.0;
  for (const double u : {0.0, camera.width_px - 1.0})
    for (const double v : {0.0, camera.height_px - 1.0}) {
      const bool fisheye = camera.lens == Lens::kKannalaBrandt;
      // Where a fisheye has no ray in front of it, the distance in the image is nearly the angle.
      double radius = std::hypot((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px);
      Eigen::Vector3d ray;
      if (camera.unproject({u, v}, &ray)) radius = fisheye ? std::atan(ray.head<2>().norm()) : ray.head<2>().norm();
      farthest = std::max(farthest, radius);
    }
  return focal_px * farthest * farthest * farthest;
}

// One draw from all that `sigma` says, in a fixed order.
Camera drawn_around(const Camera& camera, const IntrinsicsSigma& sigma, const LensSensingConfig& asked,
                    RandomStream* random) {
  const auto draw = [random](double deviation) { return random->normal(0.0, deviation); };
  Camera told = camera;
  const double focal = draw(sigma.focal_relative), ratio = draw(sigma.focal_ratio);
  const Eigen::Vector2d centre_px = draw_vector<2>([&] { return draw(sigma.principal_point_px); });
  const double corner_px = draw(sigma.distortion_px);
  if (is_zero(asked.focal_error_percent)) {
    told.fx_px *= (1.0 + focal) * (1.0 + 0.5 * ratio);
    told.fy_px *= (1.0 + focal) * (1.0 - 0.5 * ratio);
  }
  if (is_zero(asked.centre_error_px)) {
    told.cx_px += centre_px.x();
    told.cy_px += centre_px.y();
  }
  if (is_zero(asked.distortion_error_percent) && corner_px != 0.0) {
    if (told.lens == Lens::kPinhole) told.lens = Lens::kBrownConrady;
    told.distortion[0] += corner_px / corner_px_by_leading_term(camera);
  }
  return told;
}

Camera with_errors_asked_for(Camera told, const LensSensingConfig& asked, std::uint64_t seed, std::int32_t index) {
  RandomStream random(seed, "lens", -1, index);
  const double focal = 1.0 + asked.focal_error_percent.sample(random) / 100.0;
  told.fx_px *= focal;
  told.fy_px *= focal;
  told.cx_px += asked.centre_error_px.sample(random);
  told.cy_px += asked.centre_error_px.sample(random);
  for (double& coefficient : told.distortion)
    coefficient *= 1.0 + asked.distortion_error_percent.sample(random) / 100.0;
  return told;
}

}  // namespace

void LensSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("focal_error_percent", focal_error_percent, {-10.0, 10.0},
                "the focal length that the user is told is too large by this, drawn for each camera");
  visitor.field("centre_error_px", centre_error_px, {-50.0, 50.0},
                "the same for the principal point, drawn for each camera and axis");
  visitor.field("distortion_error_percent", distortion_error_percent, {-100.0, 100.0},
                "the same for each coefficient of the lens");
}

bool told_is_drawn(const GenerateConfig& config) {
  return config.sensing.told == "drawn" && config.sensor_noise != "none";
}

double depth_scale_of(const GenerateConfig& config, const Rig& rig, int index, DeviceDraws* draws) {
  const RigCamera& camera = rig.cameras[static_cast<std::size_t>(index)];
  if (!is_zero(config.depth_scale_bias_percent))
    return 1.0 + config.depth_scale_bias_percent.sample(draws->of("depth scale")) / 100.0;
  if (!told_is_drawn(config) || !camera.depth) return 1.0;
  RandomStream common(sensing_seed(config), "depth scale of a make", -1, first_of_make(rig.cameras, index));
  const DepthNoise& noise = camera.depth->noise;
  return 1.0 + common.normal(0.0, noise.common_scale_sigma) + draws->of("depth scale").normal(0.0, noise.scale_sigma);
}

void tell_lens(const GenerateConfig& config, std::int32_t index, RigCamera* camera) {
  const LensSensingConfig& asked = config.sensing.lens;
  const std::uint64_t seed = sensing_seed(config);
  if (told_is_drawn(config)) {
    RandomStream random(seed, "told lens", -1, index);
    camera->camera = drawn_around(camera->camera, camera->intrinsics_sigma, asked, &random);
  } else if (is_zero(asked)) {
    const double residual_px = camera->intrinsics_sigma.residual_px;
    camera->intrinsics_sigma = IntrinsicsSigma::exact();
    camera->intrinsics_sigma.residual_px = residual_px;
  }
  if (!config.render.lens_residual) camera->intrinsics_sigma.residual_px = 0.0;
  camera->camera = with_errors_asked_for(camera->camera, asked, seed, index);
}

void tell_readout(const GenerateConfig& config, double readout_s, RigCamera* camera) {
  if (told_is_drawn(config) || !config.moves_while_exposing()) return;
  camera->readout_s = readout_s;
  camera->readout_sigma_s = 0.0;
}

void tell_board(const GenerateConfig& config, std::size_t index, Board* board) {
  const std::optional<double> print_sigma_m = board->print_sigma_m;
  if (!told_is_drawn(config)) board->believe();
  const bool misprinted = !is_zero(config.board_at(index).defects.print_error_mm);
  board->print_sigma_m = misprinted ? print_sigma_m : 0.0;
  if (!told_is_drawn(config)) return;
  RandomStream random = stream_of_board(sensing_seed(config), "told board", index);
  constexpr double kReadingsPerM = 1e5;  // a hundredth of a millimetre
  const double measured_m = board->square_m * (1.0 + random.normal(0.0, board->square_sigma_relative()));
  board->square_m = std::round(measured_m * kReadingsPerM) / kReadingsPerM;
}

std::optional<BoardPlace> told_place(const GenerateConfig& config, std::size_t index, const Rigid3& T_first_board) {
  const BoardConfig& board = config.board_at(index);
  if (board.told_place_sigma_mm == 0.0) return std::nullopt;
  BoardPlace place{T_first_board, 0.001 * board.told_place_sigma_mm, deg_to_rad(board.told_place_sigma_deg)};
  RandomStream random = stream_of_board(sensing_seed(config), "told place", index);
  place.T_first_board.translation += draw_vector<3>([&] { return random.normal(0.0, place.sigma_m); });
  const Eigen::Vector3d turn = draw_vector<3>([&] { return random.normal(0.0, place.sigma_rad); });
  place.T_first_board.rotation = T_first_board.rotation * so3_exp(turn);
  return place;
}

void tell_depth(const GenerateConfig& config, RigCamera* camera) {
  if (!camera->depth) return;
  DepthNoise& noise = camera->depth->noise;
  const double common_scale_sigma = noise.common_scale_sigma;
  noise.believe_place_and_common_scale();
  if (told_is_drawn(config)) noise.common_scale_sigma = common_scale_sigma;
}

}  // namespace rigproof
