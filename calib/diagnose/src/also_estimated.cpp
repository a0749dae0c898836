#include "also_estimated.h"

#include <algorithm>
#include <cmath>

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
  result->notes.push_back(Finding("clock.offsets_unknown", {{"of", all ? "all" : "some"},
                                                            {"verb", all || unknown.size() > 1 ? "are" : "is"},
                                                            {"drive", moves ? "steady" : "stops"}})
                              .of(unknown));
}

// Told only if the drive tells it: where a prior is all that is known, the clocks' sigmas are that wide.
void note_turn_lag(double lag_s, double sigma_s, double prior_s, Result* result) {
  if (!(prior_s > 0.0) || sigma_s > kNothingNew * prior_s) return;
  result->notes.push_back(Finding("robot.turn_lag", {{"lag_ms", 1e3 * lag_s}, {"sigma_ms", 1e3 * sigma_s}}));
}

void note_rotation_centre(const Preparation& prepared, const Fit& fit, Result* result) {
  const double sigma_m = prepared.options.priors.rotation_centre_m;
  if (!fit.noise.along_way || !(sigma_m > 0.0)) return;
  result->notes.push_back(Finding("robot.rotation_centre", {{"sigma_mm", 1e3 * sigma_m}}));
}

void note_riding_height(const Preparation& prepared, Result* result) {
  const double sigma_m = prepared.sigmas().riding_height_m;
  if (!(sigma_m > 0.0)) return;
  result->notes.push_back(Finding("robot.riding_height", {{"sigma_mm", 1e3 * sigma_m}}));
}

}  // namespace

void report_also_estimated(const Preparation& prepared, const Fit& fit, const Eigen::MatrixXd& globals,
                           Result* result) {
  if (result->status == ResultStatus::kRefused) return;
  const Priors& priors = prepared.priors;
  const Layout layout = Layout::of(prepared.used, priors);
  const auto sigma_of = [&](Nuisance nuisance, int c, int part) {
    const int unknown = layout.place(nuisance, c) + part;
    return std::sqrt(std::max(0.0, globals(unknown, unknown)));
  };
  for (const int c : prepared.solved_cameras()) {
    for (std::size_t n = 0; n < kNuisances; ++n) {
      const Nuisance nuisance = static_cast<Nuisance>(n);
      const NuisanceRow& row = row_of(nuisance);
      for (int i = 0; row.reported && layout.has(nuisance) && i < row.size(); ++i) {
        const NuisanceRow::Part& part = row.parts[static_cast<std::size_t>(i)];
        const double unit = part.units_per_si, prior = priors.sigma(nuisance, c, i);
        if (prior > 0.0)
          result->also_estimated.push_back({prepared.original.cameras[static_cast<std::size_t>(c)].name, part.name,
                                            unit * fit.state.nuisances.of(nuisance, c)[i],
                                            unit * sigma_of(nuisance, c, i), unit * prior});
      }
    }
  }
  note_clocks(prepared, result);
  if (layout.has(Nuisance::kTurnLag))
    note_turn_lag(fit.state.nuisances.of(Nuisance::kTurnLag)[0], sigma_of(Nuisance::kTurnLag, 0, 0),
                  priors.sigma(Nuisance::kTurnLag), result);
  note_rotation_centre(prepared, fit, result);
  note_riding_height(prepared, result);
}

}  // namespace rigproof::ml
