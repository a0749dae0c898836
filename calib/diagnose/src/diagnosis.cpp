#include "diagnosis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <variant>

#include "faults.h"
#include "pair_agreement.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/core/conventions.h"
#include "stop_edits.h"
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

// The stops that are examined, and their solution as it is.
struct Run {
  Observations observations;
  const Refit& refit;
  Trial as_is;
  bool goes_on;  // the drive has more stops

  std::optional<Trial> without(const Fault& fault, bool same_views) const {
    return refit(undone(fault, observations), same_views, &as_is);
  }
};

using Explanations = std::vector<Explained>;

bool any_clean(const Explanations& explained) {
  return std::any_of(explained.begin(), explained.end(), [](const Explained& e) { return e.trial.clean; });
}

// Those of the faults without which the data agree better.
Explanations try_faults(const Run& run, const std::vector<Fault>& faults, bool same_views) {
  Explanations better;
  for (const Fault& fault : faults) {
    const std::optional<Trial> trial = run.without(fault, same_views);
    if (trial && trial->unexplained < run.as_is.unexplained - kDecides)
      better.push_back({fault, *trial, fault.further});
  }
  return better;
}

// Of the odometry against the images, in fractions of a stop: on a grid, then about the best of it.
std::vector<Fault> best_shift(const Run& run, double stops_ahead) {
  double best = 0.0, least = run.as_is.unexplained;
  const auto look = [&](double stops) {
    const std::optional<Trial> trial = run.without(odometry_ahead(run.observations, stops), true);
    if (!trial || trial->unexplained >= least) return;
    least = trial->unexplained;
    best = stops;
  };
  if (std::abs(stops_ahead) < 1.0) look(stops_ahead);
  for (const double stops : {-0.8, -0.6, -0.4, -0.2, 0.2, 0.4, 0.6, 0.8}) look(stops);
  if (best == 0.0) return {};
  for (double step = 0.1; step > 0.01; step *= 0.5) {
    const double centre = best;
    look(centre - step);
    look(centre + step);
  }
  return {odometry_ahead(run.observations, best)};
}

Explanations try_odometry(const Run& run, const Symptoms& symptoms) {
  std::vector<Fault> faults = odometry_faults(run.observations);
  if (std::abs(symptoms.odometry_scale - 1.0) > 0.03) faults.push_back(odometry_scaled(symptoms.odometry_scale));
  if (std::abs(symptoms.odometry_yaw_factor - 1.0) > 0.03) faults.push_back(turns_scaled(symptoms.odometry_yaw_factor));
  constexpr double kDrifts = 3.0;
  if (symptoms.yaw_drift.deviations() > kDrifts)
    faults.push_back(odometry_drifting(run.observations, symptoms.yaw_drift.rad_s));
  Explanations explained = try_faults(run, faults, true);
  if (any_clean(explained)) return explained;
  const Explanations shifted = try_faults(run, best_shift(run, symptoms.stops_ahead), true);
  explained.insert(explained.end(), shifted.begin(), shifted.end());
  return explained;
}

// Of the fault by whose remedy odometry and cameras agree clearly better than by any other's: where remedies leave
// stops out, these take their share of the likelihood along, and the odometry's levels decide.
Explanations clearly_best(std::vector<Explained> tried) {
  constexpr double kClearlyLess = 1.4;  // a factor of two in both levels
  if (tried.size() < 2) return {};
  const auto level = [](const Explained& e) {
    return std::log(e.trial.odometry_xy_m) + std::log(e.trial.odometry_yaw_rad);
  };
  const auto solved = std::partition(tried.begin(), tried.end(), [](const Explained& e) { return e.trial.solved(); });
  tried.erase(solved, tried.end());
  std::sort(tried.begin(), tried.end(),
            [&level](const Explained& a, const Explained& b) { return level(a) < level(b); });
  if (tried.empty() || !tried[0].trial.clean) return {};
  if (tried.size() > 1 && level(tried[0]) > level(tried[1]) - kClearlyLess) return {};
  return {tried[0]};
}

// By so many stops that those without odometry of their own are no longer outliers among the others.
Explanations try_far_shifts(const Run& run) {
  constexpr int kNearest = 4, kFarthest = 10, kLeastLeft = 6;
  const int stops = static_cast<int>(run.observations.stops.size());
  Explanations tried;
  for (int by = kNearest; by <= std::min(kFarthest, stops - kLeastLeft); ++by)
    for (const int ahead : {by, -by}) {
      const Fault fault = far_ahead(run.observations, ahead);
      if (const std::optional<Trial> trial = run.without(fault, false)) tried.push_back({fault, *trial, {}});
    }
  return clearly_best(std::move(tried));
}

using LensOf = std::function<LensEstimate(const LensTest&)>;

std::optional<Trial> with_lens(const Run& run, const std::vector<int>& cameras, const Eigen::Vector3d& change) {
  if (change.isZero(0.0)) return run.as_is;
  Observations repaired = run.observations;
  for (const int c : cameras) change_lens(c, change, &repaired);
  return run.refit(repaired, false, nullptr);
}

// Gauss-Newton on the intrinsics of one camera, or of all alike, by refits.
Explanations try_lens(const Run& run, const std::vector<int>& cameras, const LensOf& estimate_of,
                      const Eigen::Vector3d& start = Eigen::Vector3d::Zero()) {
  constexpr int kSteps = 6;
  Eigen::Vector3d change = start;
  std::optional<Trial> trial = with_lens(run, cameras, change);
  const LensEstimate at_start = estimate_of(*run.as_is.lenses);
  for (int step = 0; step < kSteps && trial && trial->lenses; ++step) {
    const LensEstimate estimate = estimate_of(*trial->lenses);
    if (step > 0 && (estimate.value.cwiseAbs() - 0.2 * estimate.sigma).maxCoeff() <= 0.0) break;
    change[0] = std::clamp((1.0 + change[0]) * (1.0 + estimate.value[0]) - 1.0, -0.8, 4.0);
    change.tail<2>() += estimate.value.tail<2>();
    trial = with_lens(run, cameras, change);
  }
  if (!trial || !trial->lenses || trial->unexplained > run.as_is.unexplained - kDecidesLens) return {};
  LensEstimate final = estimate_of(*trial->lenses);
  final.value = change;
  final.deviations = std::max(at_start.deviations, std::sqrt(run.as_is.unexplained - trial->unexplained));
  if (!final.contradicts()) return {};
  return {{{FaultKind::kLens, wrong_lens(run.observations, cameras, final), true, {}}, *trial, {}}};
}

// Where depth and corners differ by a factor the focal length may be off by it: too far for Gauss and Newton. The
// centre is where it is stated, or where another resolution puts it.
std::vector<Eigen::Vector3d> starts_of(const Camera& camera, double factor) {
  const auto of_resolution = [factor](double centre_px) { return (centre_px + 0.5) * factor - 0.5 - centre_px; };
  return {{factor - 1.0, 0.0, 0.0}, {factor - 1.0, of_resolution(camera.cx_px), of_resolution(camera.cy_px)}};
}

Explanations try_lenses(const Run& run, const Symptoms& symptoms) {
  const LensTest& lenses = *run.as_is.lenses;
  Explanations explained;
  const auto try_of = [&](const std::vector<int>& cameras, const LensOf& estimate_of,
                          const Eigen::Vector3d& start = Eigen::Vector3d::Zero()) {
    const Explanations more = try_lens(run, cameras, estimate_of, start);
    explained.insert(explained.end(), more.begin(), more.end());
  };
  const auto alone = [](std::size_t camera) { return [camera](const LensTest& test) { return test.alone[camera]; }; };
  std::vector<int> all;
  for (std::size_t i = 0; i < run.observations.cameras.size(); ++i) {
    all.push_back(static_cast<int>(i));
    if (lenses.alone[i].contradicts() || symptoms.bad_corners[i]) try_of({all.back()}, alone(i));
  }
  const LensOf common = [](const LensTest& test) { return test.common; };
  if (all.size() > 1 && lenses.common.contradicts()) try_of(all, common);
  if (lenses.common_shift.may_contradict())  // what remains without it decides
    try_of(all, [](const LensTest& test) { return test.common_shift; });
  if (any_clean(explained)) return explained;
  for (const auto& [cameras, factor] : symptoms.depth_ratios) {
    const std::size_t first = static_cast<std::size_t>(cameras.front());
    for (const Eigen::Vector3d& start : starts_of(run.observations.cameras[first].camera, factor))
      try_of(cameras, cameras.size() > 1 ? common : LensOf(alone(first)), start);
  }
  return explained;
}

// What could have been exchanged: at every stop every two cameras of which one saw the board, and whose frames no other
// camera vouches for.
std::vector<SwappedFrames> possible_swaps(const Observations& observations) {
  const PairAgreement agreement(observations);
  std::vector<std::vector<bool>> saw(observations.stops.size(), std::vector<bool>(observations.cameras.size(), false));
  for (const BoardView& view : observations.board_views)
    saw[static_cast<std::size_t>(view.stop)][static_cast<std::size_t>(view.camera)] = true;
  std::vector<SwappedFrames> all;
  const int cameras = static_cast<int>(observations.cameras.size());
  for (int stop = 0; stop < static_cast<int>(saw.size()); ++stop) {
    const std::vector<bool>& saw_there = saw[static_cast<std::size_t>(stop)];
    for (int a = 0; a < cameras; ++a)
      for (int b = a + 1; b < cameras; ++b)
        if ((saw_there[static_cast<std::size_t>(a)] || saw_there[static_cast<std::size_t>(b)]) &&
            !agreement.vouches_for(a, stop) && !agreement.vouches_for(b, stop))
          all.push_back({a, b, {stop}});
  }
  return all;
}

void note_swap(const SwappedFrames& swap, std::vector<SwappedFrames>* swapped) {
  for (SwappedFrames& frames : *swapped) {
    if (frames.first != swap.first || frames.second != swap.second) continue;
    frames.stops.push_back(swap.stops.front());
    return;
  }
  swapped->push_back(swap);
}

// Exchanges frames of two cameras stop by stop, each time the exchange that explains most.
Explanations try_swaps(const Run& run) {
  constexpr int kMostSwaps = 8;
  Observations repaired = run.observations;
  std::vector<SwappedFrames> swapped;
  Trial best = run.as_is;
  for (int round = 0; round < kMostSwaps && !best.clean; ++round) {
    std::optional<SwappedFrames> chosen;
    for (const SwappedFrames& swap : possible_swaps(repaired)) {
      Observations tried = repaired;
      swap_frames(swap.stops.front(), swap.first, swap.second, &tried);
      const std::optional<Trial> trial = run.refit(tried, false, nullptr);
      if (!trial || trial->unexplained > best.unexplained - kDecides) continue;
      best = *trial;
      chosen = swap;
      if (best.clean) break;
    }
    if (!chosen) return {};
    swap_frames(chosen->stops.front(), chosen->first, chosen->second, &repaired);
    note_swap(*chosen, &swapped);
  }
  if (!best.clean || swapped.empty()) return {};
  std::vector<Finding> causes;
  for (SwappedFrames& frames : swapped) {
    std::sort(frames.stops.begin(), frames.stops.end());
    causes.push_back(finding_of(frames, run.observations));
  }
  return {{{FaultKind::kFrames, causes.front(), true, {}}, best, {causes.begin() + 1, causes.end()}}};
}

// Fewer stops whose views fit better elsewhere are better explained as wrong by themselves: the remedy leaves a stop's
// views out, which alone makes any drive agree better.
constexpr std::size_t kLeastShifted = 3;

// Stops of which a shift from a stop on files the cameras' views at another one of the run.
std::size_t shifted_stops(const Observations& observations, const std::vector<int>& cameras, int by, int from) {
  std::set<int> shifted;
  for (const BoardView& view : observations.board_views)
    if (view.stop >= from && view.stop + by < static_cast<int>(observations.stops.size()) &&
        std::find(cameras.begin(), cameras.end(), view.camera) != cameras.end())
      shifted.insert(view.stop);
  return shifted.size();
}

// The stop from which on frames fit best one stop later or earlier: among some of the stops, then about the best.
Explanations try_lost_frame_of(const Run& run, const std::vector<int>& cameras, int by) {
  constexpr int kAtFirst = 6;
  const int stops = static_cast<int>(run.observations.stops.size());
  std::set<int> tried;
  std::optional<Explained> best;
  const auto look = [&](int from) {
    if (from < 1 || from >= stops || !tried.insert(from).second) return;
    if (!run.goes_on && shifted_stops(run.observations, cameras, by, from) < kLeastShifted) return;
    const Fault fault = shifted_frames(run.observations, cameras, by, from);
    const std::optional<Trial> trial = run.without(fault, false);
    if (!trial || trial->unexplained >= (best ? best->trial : run.as_is).unexplained - kDecides) return;
    best = Explained{fault, *trial, {}};
  };
  int step = std::max(1, stops / kAtFirst);
  for (int from = step; from < stops; from += step) look(from);
  while (best && step > 1) {
    const int centre = static_cast<int>(std::get<double>(best->fault.cause.find("from")->value));
    step /= 2;
    look(centre - step);
    look(centre + step);
  }
  return best ? Explanations{*best} : Explanations();
}

// Cameras of which all frames could have been filed at other stops: those that no other camera vouches for.
std::vector<int> doubtful_cameras(const Observations& observations) {
  const PairAgreement agreement(observations);
  std::vector<int> doubtful;
  for (int c = 0; c < static_cast<int>(observations.cameras.size()); ++c)
    if (!agreement.vouches_for(c)) doubtful.push_back(c);
  return doubtful;
}

// Of all cameras, and of the doubtful ones by themselves.
Explanations try_lost_frames(const Run& run, const std::vector<int>& doubtful) {
  std::vector<int> all(run.observations.cameras.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::vector<int>> groups = {all};
  if (all.size() > 1)
    for (const int c : doubtful) groups.push_back({c});
  Explanations explained;
  for (const std::vector<int>& group : groups)
    for (const int by : {1, -1}) {
      const Explanations more = try_lost_frame_of(run, group, by);
      explained.insert(explained.end(), more.begin(), more.end());
    }
  return explained;
}

Explanations try_single_stops(const Run& run) {
  const int n = static_cast<int>(run.observations.stops.size());
  if (n > kFewStops || n < 4) return {};
  Explanations tried;
  for (int i = 0; i < n; ++i) {
    const Fault fault = wrong_stop(run.observations, i);
    if (const std::optional<Trial> trial = run.without(fault, false)) tried.push_back({fault, *trial, {}});
  }
  return clearly_best(std::move(tried));
}

void add_further(const Explained& explained, Cause* cause) {
  for (const Finding& finding : explained.further) cause->findings.push_back(finding.with({{"joined_by", "and"}}));
}

// Two shifts that differ by a hundredth of a stop are one cause, and so are a camera and all cameras, and images that
// are mirrored one way or the other.
bool same_kind(const Fault& a, const Fault& b) {
  return (a.kind == b.kind && (a.kind == FaultKind::kStamps || a.kind == FaultKind::kLens)) ||
         (a.cause.code == b.cause.code && a.cause.cameras == b.cause.cameras && a.kind == FaultKind::kImages);
}

Cause conclude(Explanations explained, const Trial& as_is) {
  std::sort(explained.begin(), explained.end(), [](const Explained& a, const Explained& b) {
    if (a.trial.clean != b.trial.clean) return a.trial.clean;
    return a.trial.unexplained < b.trial.unexplained;
  });
  // Of what explains the data equally, images are blamed last.
  const auto tied = std::find_if(explained.begin(), explained.end(), [&explained](const Explained& e) {
    return !e.trial.clean || e.trial.unexplained > explained.front().trial.unexplained + kDecides;
  });
  std::stable_partition(explained.begin(), tied, [](const Explained& e) { return e.fault.kind != FaultKind::kImages; });
  const Explained& best = explained.front();
  Cause cause{{best.fault.cause.with({{"undone_mm", 1e3 * best.trial.odometry_xy_m},
                                      {"undone_deg", rad_to_deg(best.trial.odometry_yaw_rad)}})},
              best.fault.spoils_all,
              as_is.unexplained - best.trial.unexplained,
              best.trial.shakes};
  add_further(best, &cause);
  for (std::size_t i = 1; i < explained.size(); ++i) {
    if (!explained[i].trial.clean || explained[i].trial.unexplained > best.trial.unexplained + kDecides) break;
    if (same_kind(explained[i].fault, best.fault)) continue;
    cause.findings.push_back(explained[i].fault.cause.with({{"joined_by", "or"}}));
    add_further(explained[i], &cause);
    cause.spoils_all = cause.spoils_all || explained[i].fault.spoils_all;
  }
  return cause;
}

Run run_of(const Observations& observations, const Refit& refit) {
  const bool goes_on = static_cast<int>(observations.stops.size()) > kDiagnosedStops;
  Run run{first_stops(observations, kDiagnosedStops), refit, {}, goes_on};
  // Data may be so wrong that they have no solution.
  if (const std::optional<Trial> as_is = refit(run.observations, true, nullptr)) run.as_is = *as_is;
  return run;
}

}  // namespace

std::optional<Cause> find_cause_in_images(const Observations& observations, const Refit& refit) {
  const Run run = run_of(observations, refit);
  Explanations found = try_faults(run, image_faults(run.observations), false);
  if (!any_clean(found)) return std::nullopt;
  return conclude(std::move(found), run.as_is);
}

std::optional<Cause> find_cause(const Observations& observations, const Symptoms& symptoms, const Refit& refit) {
  const Run run = run_of(observations, refit);
  // From the plain to the far-fetched; what leaves the data in order ends the search.
  Explanations found;
  const auto add = [&found](const Explanations& more) { found.insert(found.end(), more.begin(), more.end()); };
  if (symptoms.odometry) add(try_odometry(run, symptoms));
  if (symptoms.odometry && !any_clean(found)) add(try_faults(run, frame_order_faults(observations), false));
  if (symptoms.odometry && !any_clean(found)) add(try_far_shifts(run));
  // Mirrored odometry and mirrored images are the same where lenses are symmetric. Drives so short that other odometry
  // explains them as well do not accuse the images.
  const std::vector<Finding> causes = any_clean(found) ? conclude(found, run.as_is).findings : std::vector<Finding>();
  if (causes.empty() || (causes.size() == 1 && causes.front().is("odometry.mirrored")))
    add(try_faults(run, image_faults(run.observations), false));
  if (!any_clean(found) && run.as_is.lenses) add(try_lenses(run, symptoms));
  const std::vector<int> doubtful = any_clean(found) ? std::vector<int>() : doubtful_cameras(run.observations);
  if (!any_clean(found) && symptoms.frames)
    add(try_faults(run, camera_shift_faults(run.observations, doubtful), false));
  if (!any_clean(found) && symptoms.frames) add(try_faults(run, camera_order_faults(observations, doubtful), false));
  if (!any_clean(found) && (symptoms.odometry || symptoms.frames)) add(try_lost_frames(run, doubtful));
  if (!any_clean(found) && symptoms.frames && run.observations.cameras.size() > 1) add(try_swaps(run));
  if (!any_clean(found) && symptoms.odometry) add(try_single_stops(run));
  if (!any_clean(found)) return std::nullopt;
  return conclude(std::move(found), run.as_is);
}

}  // namespace rigproof::ml
