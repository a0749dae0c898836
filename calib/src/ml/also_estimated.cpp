#include "ml/also_estimated.h"

#include <algorithm>
#include <cmath>

#include "ml/sentence.h"
#include "rigproof/core/text.h"

namespace rigproof::ml {
namespace {

// Where the data leave more than this of a prior's sigma they tell next to nothing.
constexpr double kNothingNew = 0.95;

void note_clocks(const Preparation& prepared, Result* result) {
  std::vector<std::string> unknown;
  for (const EstimatedQuantity& quantity : result->also_estimated)
    if (quantity.name == "clock_offset_ms" && quantity.sigma > kNothingNew * quantity.prior_sigma)
      unknown.push_back(quantity.camera);
  if (unknown.empty()) return;
  const std::vector<Stop>& stops = prepared.used.stops;
  const bool moves =
      std::any_of(stops.begin(), stops.end(), [](const Stop& stop) { return !stop.velocity.isZero(0.0); });
  const bool all = unknown.size() == prepared.solved_cameras().size();
  result->notes.push_back(
      (all ? std::string("The clock offsets of the cameras") : "The clock offset of " + joined(unknown)) +
      (all || unknown.size() > 1 ? " are" : " is") + " not observable" +
      (moves ? ": the drive's speeds hardly differ" : ": by the odometry the robot stood at every stop") +
      "; the prior is all that is known.");
}

// Told only if the drive tells it: where a prior is all that is known, the clocks' sigmas are that wide.
void note_turn_lag(double lag_s, double sigma_s, double prior_s, Result* result) {
  if (!(prior_s > 0.0) || sigma_s > kNothingNew * prior_s) return;
  result->notes.push_back(
      format("The body turns %.1f +- %.1f ms later than its wheels; the clock offsets are free of that.", 1e3 * lag_s,
             1e3 * sigma_s));
}

void note_rotation_centre(const Preparation& prepared, const Fit& fit, Result* result) {
  const double sigma_m = prepared.options.rotation_centre_sigma_m;
  if (!fit.noise.along_way || !(sigma_m > 0.0)) return;
  result->notes.push_back(format(
      "x of all cameras counts from the point about which the robot turns; where that lies no odometry tells, and "
      "+-%.1f mm for it are in the uncertainty of x (rotation_centre_sigma_mm).",
      1e3 * sigma_m));
}

void note_riding_height(const Preparation& prepared, Result* result) {
  const double sigma_m = prepared.riding_height_sigma_m();
  if (!(sigma_m > 0.0)) return;
  result->notes.push_back(format(
      "Heights are those of a robot that moves; how much higher it rides than at rest no data tell, and +-%.2f mm "
      "for it are in their uncertainty (riding_height_sigma_mm).",
      1e3 * sigma_m));
}

}  // namespace

void report_also_estimated(const Preparation& prepared, const Fit& fit, const Eigen::MatrixXd& globals,
                           Result* result) {
  if (result->status == ResultStatus::kRefused) return;
  const Priors priors = prepared.priors();
  const Layout layout = Layout::of(prepared.used, priors);
  for (const int c : prepared.solved_cameras()) {
    const std::size_t i = static_cast<std::size_t>(c);
    const auto add = [&](const char* name, int unknown, double value, double prior, double unit) {
      if (!(prior > 0.0)) return;
      const double sigma = std::sqrt(std::max(0.0, globals(unknown, unknown)));
      result->also_estimated.push_back(
          {prepared.original.cameras[i].name, name, unit * value, unit * sigma, unit * prior});
    };
    const Eigen::Vector3d& lens = fit.state.intrinsics[i];
    add("focal_length_percent", layout.intrinsics(c), lens[0], priors.focal_relative, 100.0);
    add("principal_point_x_px", layout.intrinsics(c) + 1, lens[1], priors.principal_point_px, 1.0);
    add("principal_point_y_px", layout.intrinsics(c) + 2, lens[2], priors.principal_point_px, 1.0);
    add("clock_offset_ms", layout.clock_offset(c), fit.state.clock_offset_s[i], priors.clock_offset_s, 1e3);
  }
  note_clocks(prepared, result);
  if (layout.with_clock_offsets)
    note_turn_lag(fit.state.turn_lag_s, std::sqrt(std::max(0.0, globals(layout.turn_lag(), layout.turn_lag()))),
                  priors.turn_lag_s, result);
  note_rotation_centre(prepared, fit, result);
  note_riding_height(prepared, result);
}

}  // namespace rigproof::ml
