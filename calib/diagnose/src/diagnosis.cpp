#include "diagnosis.h"

#include <algorithm>
#include <cmath>

#include "faults.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/core/conventions.h"
#include "swapped_frames.h"

namespace rigproof::ml {
namespace {

// -2 ln of a likelihood ratio that decides between causes, and that makes a lens a cause at all: it has free
// parameters.
constexpr double kDecides = 10.0;
constexpr double kDecidesLens = 20.0;
// Runs this short have no majority by which a wrong stop stands out.
constexpr int kFewStops = 15;

struct Explained {
  Fault fault;
  Trial trial;
  std::vector<Finding> further;  // that belong to the fault
};

// `all` where it is not one of them.
Finding about_cameras(Finding finding, const Observations& observations, const std::vector<int>& cameras) {
  if (cameras.size() > 1 && cameras.size() == observations.cameras.size()) finding = finding.with({{"all", 1}});
  for (const int c : cameras) finding.cameras.push_back(observations.cameras[static_cast<std::size_t>(c)].name);
  return finding;
}

constexpr double kMinFocalNoise = 0.003;  // relative

// Half a pixel in x, y or both, and nothing else, within what the data tell.
bool half_pixel(const LensEstimate& lens) {
  constexpr double kSigmas = 3.0, kMinPixelNoise = 0.12, kMaxPixelNoise = 0.4;
  const auto nought_or_half = [&](int axis) {
    const double noise = std::clamp(kSigmas * lens.sigma[axis], kMinPixelNoise, kMaxPixelNoise);
    const double size = std::abs(lens.value[axis]);
    return std::min(size, std::abs(size - 0.5)) < noise;
  };
  return std::abs(lens.value[0]) < std::max(kMinFocalNoise, kSigmas * lens.sigma[0]) && nought_or_half(1) &&
         nought_or_half(2) && lens.value.tail<2>().cwiseAbs().maxCoeff() < 1.0;
}

Finding wrong_lens(const Observations& observations, const std::vector<int>& cameras, const LensEstimate& estimate) {
  const Eigen::Vector3d& change = estimate.value;
  const Camera& lens = observations.cameras[static_cast<std::size_t>(cameras.front())].camera;
  const FindingValues shift = {{"x_px", change[1]}, {"y_px", change[2]}};
  if (half_pixel(estimate)) return about_cameras(Finding("lens.half_pixel_slip", shift), observations, cameras);
  if (std::abs(change[0]) < kMinFocalNoise)
    return about_cameras(Finding("lens.principal_point", shift), observations, cameras);
  return about_cameras(Finding("lens.intrinsics", {{"focal_px", lens.fx_px * (1.0 + change[0])},
                                                   {"stated_px", lens.fx_px},
                                                   {"off_percent", 100.0 * change[0]}})
                           .with(shift),
                       observations, cameras);
}

class Search {
 public:
  Search(const Observations& observations, const Symptoms& symptoms, const Refit& refit)
      : all_(observations), sample_(first_stops(observations, kDiagnosedStops)), symptoms_(symptoms), refit_(refit) {}

  std::optional<Cause> run() {
    const std::optional<Trial> as_is = refit_(sample_, true);
    if (!as_is) return std::nullopt;
    as_is_ = *as_is;
    // From the plain to the far-fetched; what leaves the data in order ends the search.
    if (symptoms_.odometry) try_odometry();
    if (!any_clean() && as_is_.lenses) try_lenses();
    if (!any_clean() && symptoms_.frames) try_each(camera_shift_faults(sample_), false);
    if (!any_clean() && symptoms_.frames && sample_.cameras.size() > 1) try_swaps();
    if (!any_clean() && symptoms_.odometry) try_single_stops();
    if (!any_clean()) return std::nullopt;
    return conclude();
  }

 private:
  void try_fault(const Fault& fault, bool same_views, double decides) {
    Observations repaired = sample_;
    fault.undo(&repaired);
    const std::optional<Trial> trial = refit_(repaired, same_views);
    if (trial && trial->unexplained < as_is_.unexplained - decides) explained_.push_back({fault, *trial, {}});
  }

  bool any_clean() const {
    return std::any_of(explained_.begin(), explained_.end(), [](const Explained& e) { return e.trial.clean; });
  }

  void try_each(const std::vector<Fault>& faults, bool same_views) {
    for (const Fault& fault : faults) try_fault(fault, same_views, kDecides);
  }

  void try_odometry() {
    try_each(odometry_faults(sample_), true);
    if (std::abs(symptoms_.odometry_scale - 1.0) > 0.03)
      try_fault(odometry_scaled(symptoms_.odometry_scale), true, kDecides);
    if (!any_clean()) try_shift();
  }

  // Fractions of a stop: on a grid, then about the best of it.
  void try_shift() {
    const auto unexplained = [&](double stops) {
      Observations repaired = sample_;
      odometry_ahead(sample_, stops).undo(&repaired);
      const std::optional<Trial> trial = refit_(repaired, true);
      return trial ? trial->unexplained : as_is_.unexplained;
    };
    double best = 0.0, least = as_is_.unexplained;
    const auto look = [&](double stops) {
      const double value = unexplained(stops);
      if (value >= least) return;
      least = value;
      best = stops;
    };
    if (std::abs(symptoms_.stops_ahead) < 1.0) look(symptoms_.stops_ahead);
    for (const double stops : {-0.8, -0.6, -0.4, -0.2, 0.2, 0.4, 0.6, 0.8}) look(stops);
    if (best == 0.0) return;
    for (double step = 0.1; step > 0.01; step *= 0.5) {
      const double centre = best;
      look(centre - step);
      look(centre + step);
    }
    try_fault(odometry_ahead(sample_, best), true, kDecides);
  }

  void try_lenses() {
    const int count = static_cast<int>(sample_.cameras.size());
    std::vector<int> all;
    for (int c = 0; c < count; ++c) {
      const std::size_t i = static_cast<std::size_t>(c);
      if (as_is_.lenses->alone[i].contradicts() || symptoms_.bad_corners[i])
        try_lens({c}, [i](const LensTest& test) { return test.alone[i]; });
      all.push_back(c);
    }
    if (count > 1 && as_is_.lenses->common.contradicts())
      try_lens(all, [](const LensTest& test) { return test.common; });
    if (as_is_.lenses->common_shift.may_contradict())  // what remains without it decides
      try_lens(all, [](const LensTest& test) { return test.common_shift; });
  }

  // Gauss-Newton on the intrinsics of one camera, or of all alike, by refits.
  void try_lens(const std::vector<int>& cameras, const std::function<LensEstimate(const LensTest&)>& estimate_of) {
    constexpr int kSteps = 6;
    Eigen::Vector3d change = Eigen::Vector3d::Zero();
    std::optional<Trial> trial = as_is_;
    const LensEstimate at_start = estimate_of(*as_is_.lenses);
    for (int step = 0; step < kSteps && trial && trial->lenses; ++step) {
      const LensEstimate estimate = estimate_of(*trial->lenses);
      if (step > 0 && (estimate.value.cwiseAbs() - 0.2 * estimate.sigma).maxCoeff() <= 0.0) break;
      change[0] = std::clamp((1.0 + change[0]) * (1.0 + estimate.value[0]) - 1.0, -0.5, 1.0);
      change.tail<2>() += estimate.value.tail<2>();
      Observations repaired = sample_;
      for (const int c : cameras) change_lens(c, change, &repaired);
      trial = refit_(repaired, false);
    }
    if (!trial || !trial->lenses || trial->unexplained > as_is_.unexplained - kDecidesLens) return;
    LensEstimate final = estimate_of(*trial->lenses);
    final.value = change;
    final.deviations = std::max(at_start.deviations, std::sqrt(as_is_.unexplained - trial->unexplained));
    if (!final.contradicts()) return;
    explained_.push_back({{FaultKind::kLens, wrong_lens(all_, cameras, final), true, {}}, *trial, {}});
  }

  // Exchanges frames of two cameras stop by stop, each time the exchange that explains most.
  void try_swaps() {
    constexpr int kMostSwaps = 8;
    Observations repaired = sample_;
    std::vector<SwappedFrames> swapped;
    Trial best = as_is_;
    for (int round = 0; round < kMostSwaps && !best.clean; ++round) {
      std::optional<Swap> chosen;
      for (const Swap& swap : swaps(repaired)) {
        Observations tried = repaired;
        swap_frames(swap.stop, swap.first, swap.second, &tried);
        const std::optional<Trial> trial = refit_(tried, false);
        if (!trial || trial->unexplained > best.unexplained - kDecides) continue;
        best = *trial;
        chosen = swap;
        if (best.clean) break;
      }
      if (!chosen) return;
      swap_frames(chosen->stop, chosen->first, chosen->second, &repaired);
      note_swap(*chosen, &swapped);
    }
    if (!best.clean) return;
    std::vector<Finding> causes;
    for (SwappedFrames& frames : swapped) {
      std::sort(frames.stops.begin(), frames.stops.end());
      causes.push_back(finding_of(frames, all_));
    }
    if (causes.empty()) return;
    const Finding first = causes.front();
    causes.erase(causes.begin());
    explained_.push_back({{FaultKind::kFrames, first, true, {}}, best, causes});
  }

  struct Swap {
    int stop, first, second;
  };

  // What could have been exchanged: at every stop every two cameras of which one saw the board.
  static std::vector<Swap> swaps(const Observations& observations) {
    std::vector<std::vector<bool>> saw(observations.stops.size(),
                                       std::vector<bool>(observations.cameras.size(), false));
    for (const BoardView& view : observations.board_views)
      saw[static_cast<std::size_t>(view.stop)][static_cast<std::size_t>(view.camera)] = true;
    std::vector<Swap> all;
    const int cameras = static_cast<int>(observations.cameras.size());
    for (int stop = 0; stop < static_cast<int>(observations.stops.size()); ++stop)
      for (int a = 0; a < cameras; ++a)
        for (int b = a + 1; b < cameras; ++b)
          if (saw[static_cast<std::size_t>(stop)][static_cast<std::size_t>(a)] ||
              saw[static_cast<std::size_t>(stop)][static_cast<std::size_t>(b)])
            all.push_back({stop, a, b});
    return all;
  }

  static void note_swap(const Swap& swap, std::vector<SwappedFrames>* swapped) {
    for (SwappedFrames& frames : *swapped) {
      if (frames.first != swap.first || frames.second != swap.second) continue;
      frames.stops.push_back(swap.stop);
      return;
    }
    swapped->push_back({swap.first, swap.second, {swap.stop}});
  }

  // A stop that is left out takes its share of the likelihood along: what counts is the odometry's level without it.
  void try_single_stops() {
    const int n = static_cast<int>(sample_.stops.size());
    if (n > kFewStops || n < 4) return;
    std::vector<std::pair<double, Explained>> levels;
    for (int i = 0; i < n; ++i) {
      const Fault fault = wrong_stop(sample_, i);
      Observations repaired = sample_;
      fault.undo(&repaired);
      if (const std::optional<Trial> trial = refit_(repaired, false))
        levels.push_back({std::log(trial->odometry_xy_m) + std::log(trial->odometry_yaw_rad), {fault, *trial, {}}});
    }
    if (levels.size() < 2) return;
    std::sort(levels.begin(), levels.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    constexpr double kClearlyLess = 1.4;  // a factor of two in both levels
    if (levels[0].second.trial.clean && levels[0].first < levels[1].first - kClearlyLess)
      explained_.push_back(levels[0].second);
  }

  Cause conclude() {
    std::sort(explained_.begin(), explained_.end(), [](const Explained& a, const Explained& b) {
      if (a.trial.clean != b.trial.clean) return a.trial.clean;
      return a.trial.unexplained < b.trial.unexplained;
    });
    const Explained& best = explained_.front();
    Cause cause{{best.fault.cause.with({{"undone_mm", 1e3 * best.trial.odometry_xy_m},
                                        {"undone_deg", rad_to_deg(best.trial.odometry_yaw_rad)}})},
                best.fault.spoils_all};
    add_further(best, &cause);
    for (std::size_t i = 1; i < explained_.size(); ++i) {
      if (!explained_[i].trial.clean || explained_[i].trial.unexplained > best.trial.unexplained + kDecides) break;
      if (same_kind(explained_[i].fault, best.fault)) continue;
      cause.findings.push_back(explained_[i].fault.cause.with({{"joined_by", "or"}}));
      add_further(explained_[i], &cause);
      cause.spoils_all = cause.spoils_all || explained_[i].fault.spoils_all;
    }
    return cause;
  }

  static void add_further(const Explained& explained, Cause* cause) {
    for (const Finding& finding : explained.further) cause->findings.push_back(finding.with({{"joined_by", "and"}}));
  }

  // Two shifts that differ by a hundredth of a stop are one cause, and so are a camera and all cameras.
  static bool same_kind(const Fault& a, const Fault& b) {
    return a.kind == b.kind && (a.kind == FaultKind::kStamps || a.kind == FaultKind::kLens);
  }

  const Observations& all_;
  const Observations sample_;
  const Symptoms& symptoms_;
  const Refit& refit_;
  Trial as_is_;
  std::vector<Explained> explained_;
};

}  // namespace

std::optional<Cause> find_cause(const Observations& observations, const Symptoms& symptoms, const Refit& refit) {
  return Search(observations, symptoms, refit).run();
}

}  // namespace rigproof::ml
