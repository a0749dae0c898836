#include "also_estimated.h"

#include <algorithm>
#include <cmath>

#include "rigproof/calib/diagnose/turning_point.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/core/conventions.h"

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

// Where the data tell it beyond doubt.
void note_veer(double veer, double sigma, Result* result) {
  constexpr double kSure = 5.0;
  if (std::abs(veer) > kSure * sigma)
    result->notes.push_back(Finding("odometry.veers", {{"deg_per_m", rad_to_deg(veer)}, {"sigma", rad_to_deg(sigma)}}));
}

// Beside it, which scatter of stamps would do as much at the speed of the drive: the same along the whitened velocity.
void note_displacement(const Preparation& prepared, const Fit& fit, Result* result) {
  constexpr double kSuspect = 3.0, kParts = 6.0;
  const double scale = fit.noise.displacement_scale;
  if (scale < kSuspect) return;
  double square = 0.0, at_speed = 0.0;
  for (const Stop& stop : prepared.used.stops) {
    square += stop.velocity.head<2>().squaredNorm() / (kLeastDisplacement_m * kLeastDisplacement_m) +
              stop.velocity.z() * stop.velocity.z() / (kLeastDisplacement_rad * kLeastDisplacement_rad);
    if (!stop.velocity.isZero(0.0)) ++at_speed;
  }
  const double stamps_s = scale * std::sqrt(kParts * at_speed / square);
  result->notes.push_back(Finding("images.displaced", {{"shift_mm", 1e3 * scale * kLeastDisplacement_m},
                                                       {"turn_deg", rad_to_deg(scale * kLeastDisplacement_rad)},
                                                       {"times", scale},
                                                       {"stamps_ms", 1e3 * stamps_s}}));
}

// The largest sigma of x and y of a camera, measured from the turning point itself; 0 where none is told.
double from_turning_point(const Result& result) {
  double most = 0.0;
  for (const EstimatedTransform& camera : result.camera_to_robot)
    for (std::size_t axis = 0; camera.covariance && axis < 2; ++axis)
      if (camera.observable[axis]) most = std::max(most, variance_beside_turning_point(camera, axis));
  return std::sqrt(most);
}

void note_rotation_centre(const Preparation& prepared, const Fit& fit, Result* result) {
  const double sigma_m = prepared.sigmas().rotation_centre_m;
  if (!is_of_turning_point(fit.noise.law.model, prepared.used) || !(sigma_m > 0.0)) return;
  const bool stated = prepared.used.odometry_noise.rotation_centre_sigma_m ||
                      was_asked(prepared.options.priors, &PriorSigmas::rotation_centre_m) ||
                      prepared.options.priors.rotation_centre_m != usual_priors().rotation_centre_m;
  Finding note("robot.rotation_centre", {{"sigma_mm", 1e3 * sigma_m}, {"stated", stated ? "yes" : "no"}});
  if (const double seen_m = from_turning_point(*result); seen_m > 0.0)
    note.values.emplace_back("seen_mm", 1e3 * seen_m);
  if (const Eigen::Vector2d& at_m = prepared.used.odometry_noise.rotation_centre_m; !at_m.isZero(0.0))
    note = note.with({{"x_mm", 1e3 * at_m.x()}, {"y_mm", 1e3 * at_m.y()}});
  result->notes.push_back(std::move(note));
}

void note_riding_height(const Preparation& prepared, Result* result) {
  const double sigma_m = prepared.sigmas().riding_height_m;
  if (!(sigma_m > 0.0)) return;
  result->notes.push_back(Finding("robot.riding_height", {{"sigma_mm", 1e3 * sigma_m}}));
}

// A row of the table as it was estimated for a camera, a board, or the rig.
struct Estimated {
  Nuisance nuisance;
  int which;  // camera or board; 0 for the rig
  int part;
  double value, sigma, prior;

  const NuisanceRow::Part& about() const { return row_of(nuisance).parts[static_cast<std::size_t>(part)]; }
  // "board_size_percent" of the second board: board_2_size_percent.
  std::string name() const {
    return row_of(nuisance).each == Each::kBoard ? name_of_board(about().name, which) : about().name;
  }
};

// The cameras that have a row's values of camera c: it alone, or, of what a make shares, all of the make of which it is
// the first.
std::vector<int> cameras_of(const Preparation& prepared, Nuisance nuisance, int c) {
  std::vector<int> cameras;
  for (const int solved : prepared.solved_cameras())
    if ((nuisance == Nuisance::kCommonDepthScale ? first_of_make(prepared.used.cameras, solved) : solved) == c)
      cameras.push_back(solved);
  return cameras;
}

std::vector<Estimated> all_estimated(const Preparation& prepared, const Fit& fit, const GlobalCovariance& globals) {
  const Layout layout = Layout::of(prepared.used, prepared.priors);
  std::vector<Estimated> all;
  const auto add_row = [&](Nuisance nuisance, int c) {
    for (int i = 0; layout.has(nuisance) && i < row_of(nuisance).size(); ++i) {
      const int unknown = layout.place(nuisance, c) + i;
      const double sigma = std::sqrt(std::max(0.0, globals.covariance(unknown, unknown)));
      const double prior = prepared.priors.sigma(nuisance, c, i);
      if (prior > 0.0) all.push_back({nuisance, c, i, fit.state.nuisances.of(nuisance, c)[i], sigma, prior});
    }
  };
  const auto each_row = [](const auto& act) {
    for (std::size_t n = 0; n < kNuisances; ++n) act(static_cast<Nuisance>(n), row_of(static_cast<Nuisance>(n)).each);
  };
  for (int c = 0; c < layout.cameras; ++c)
    each_row([&](Nuisance nuisance, Each each) {
      if (each == Each::kCamera && !cameras_of(prepared, nuisance, c).empty()) add_row(nuisance, c);
    });
  each_row([&](Nuisance nuisance, Each each) {
    if (each == Each::kRig) add_row(nuisance, 0);
    for (int b = 0; each == Each::kBoard && b < layout.boards; ++b)
      if (prepared.sees(b)) add_row(nuisance, b);
  });
  return all;
}

std::vector<std::string> camera_names_of(const Preparation& prepared, const Estimated& estimated) {
  std::vector<std::string> names;
  if (row_of(estimated.nuisance).each == Each::kCamera)
    for (const int c : cameras_of(prepared, estimated.nuisance, estimated.which))
      names.push_back(prepared.original.cameras[static_cast<std::size_t>(c)].name);
  return names;
}

std::string first_camera_of(const Preparation& prepared, const Estimated& estimated) {
  const std::vector<std::string> names = camera_names_of(prepared, estimated);
  return names.empty() ? "" : names.front();
}

// What a rig states as zero with a sigma; the other rows are judged as odometry or follow from the data.
bool is_stated(Nuisance nuisance) { return row_of(nuisance).reported || nuisance == Nuisance::kDepthScale; }

// Some thirty values are looked at in every run: one in 5,000 healthy runs is suspected.
constexpr double kSuspect = 4.5;

// An estimate v with sigma s of what was believed to be 0 +- p scatters by sqrt(p^2 - s^2). Where the data tell little
// that is little, and says nothing of what was believed.
void note_strained(const Preparation& prepared, const Estimated& estimated, Result* result) {
  const double p = estimated.prior, s_square = estimated.sigma * estimated.sigma;
  if (s_square > std::pow(kNothingNew * p, 2)) return;
  const double deviations = std::abs(estimated.value) / std::sqrt(p * p - s_square);
  if (deviations < kSuspect) return;
  const double unit = estimated.about().units_per_si;
  Finding finding("prior.strained", {{"quantity", estimated.name()},
                                     {"value", unit * estimated.value},
                                     {"prior", unit * p},
                                     {"deviations", deviations}});
  result->notes.push_back(finding.of(camera_names_of(prepared, estimated)));
}

Finding strained(const std::string& quantity, double value, double prior) {
  return Finding("prior.strained",
                 {{"quantity", quantity}, {"value", value}, {"prior", prior}, {"deviations", value / prior}});
}

// Errors that repeat in every image: larger than stated where chance does not explain them.
void note_strained_repeating(const Preparation& prepared, Result* result) {
  constexpr double kMm = 1e3;
  constexpr double kFineSuspect = 3.0;
  const RemovedErrors& repeating = prepared.repeating;
  for (std::size_t g = 0; g < repeating.beyond_stated.size(); ++g) {
    const int c = repeating.errors.groups()[g].camera, board = repeating.errors.groups()[g].board;
    const double level = repeating.beyond_stated[g];
    if (c < 0) {
      const double prior = kMm * prepared.used.board_at(board).print_sigma();
      if (level > 1.0) result->notes.push_back(strained(name_of_board("print_mm", board), level * prior, prior));
      continue;
    }
    const RigCamera& camera = prepared.used.cameras[static_cast<std::size_t>(c)];
    const double prior = camera.intrinsics_sigma.residual_px;
    const double fine_px = repeating.fine[static_cast<std::size_t>(c)].shown_px;
    if (level > 1.0 || fine_px > kFineSuspect * prior)
      result->notes.push_back(strained("lens_residual_px", std::hypot(level * prior, fine_px), prior).of(camera.name));
  }
}

void report_lenses(const Preparation& prepared, const Fit& fit, Result* result) {
  if (!prepared.priors.has(Nuisance::kLens)) return;
  for (const int c : prepared.solved_cameras()) {
    const RigCamera& camera = prepared.used.cameras[static_cast<std::size_t>(c)];
    const LensChange change = fit.state.nuisances.of(Nuisance::kLens, c);
    result->lenses.push_back({camera.name, prepared.whitened->lenses[static_cast<std::size_t>(c)].changed(change)});
  }
}

}  // namespace

void report_also_estimated(const Preparation& prepared, const Fit& fit, const GlobalCovariance& globals,
                           Result* result) {
  if (result->status == ResultStatus::kRefused) return;
  for (const Estimated& estimated : all_estimated(prepared, fit, globals)) {
    if (estimated.nuisance == Nuisance::kTurnLag)
      note_turn_lag(estimated.value, estimated.sigma, estimated.prior, result);
    if (estimated.nuisance == Nuisance::kOdometryVeer && fit.noise.law.model == OdometryModel::kPerIncrement)
      note_veer(estimated.value, estimated.sigma, result);
    if (is_stated(estimated.nuisance)) note_strained(prepared, estimated, result);
    if (!row_of(estimated.nuisance).reported) continue;
    const double unit = estimated.about().units_per_si;
    result->also_estimated.push_back({first_camera_of(prepared, estimated), estimated.name(), unit * estimated.value,
                                      unit * estimated.sigma, unit * estimated.prior});
  }
  note_strained_repeating(prepared, result);
  report_lenses(prepared, fit, result);
  note_clocks(prepared, result);
  note_displacement(prepared, fit, result);
  note_rotation_centre(prepared, fit, result);
  note_riding_height(prepared, result);
}

}  // namespace rigproof::ml
