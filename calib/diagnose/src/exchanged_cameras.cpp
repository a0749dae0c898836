#include "exchanged_cameras.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "faults.h"
#include "rigproof/core/conventions.h"
#include "stop_edits.h"

namespace rigproof::ml {
namespace {

// A ratio of the priors' densities; healthy lenses of two cameras, all of whose ten values are told, are strained by
// as much in one of 200 rigs. Exchanged ones are strained by more, and by less once they are exchanged back; a lens
// that is wrong stays so in either place.
constexpr double kDecides = 25.0;

bool same_size(const Camera& a, const Camera& b) { return a.width_px == b.width_px && a.height_px == b.height_px; }

double strain_of(const std::vector<double>& strains, int first, int second) {
  return strains[static_cast<std::size_t>(first)] + strains[static_cast<std::size_t>(second)];
}

std::optional<Cause> cause_of_exchange(const Observations& some_stops, const Trial& as_is, int first, int second,
                                       const Refit& refit) {
  const Fault exchanged = exchanged_folders(some_stops, first, second);
  const std::optional<Trial> trial = refit(undone(exchanged, some_stops), false, &as_is);
  if (!trial || !trial->clean) return std::nullopt;
  const double strain = strain_of(trial->lens_strains, first, second);
  const double gain = strain_of(as_is.lens_strains, first, second) - strain;
  if (gain < kDecides || strain > kDecides) return std::nullopt;
  return Cause{{exchanged.cause.with(
                   {{"undone_mm", 1e3 * trial->odometry_xy_m}, {"undone_deg", rad_to_deg(trial->odometry_yaw_rad)}})},
               true,
               gain};
}

// Which smooth fields count as a strain.
enum class Fields { kAll, kLargerThanStated };

std::vector<double> strains_with(Fields which, const Preparation& prepared, const Fit& fit) {
  std::vector<double> strains(prepared.used.cameras.size(), 0.0);
  const RemovedErrors& repeating = prepared.repeating;
  for (std::size_t g = 0; g < repeating.beyond_stated.size(); ++g) {
    const RepeatingErrors::Group& group = repeating.errors.groups()[g];
    if (group.camera >= 0 && (which == Fields::kAll || repeating.beyond_stated[g] > 1.0))
      strains[static_cast<std::size_t>(group.camera)] +=
          group.level * group.level * repeating.value.segment(group.first, group.size).squaredNorm();
  }
  if (!prepared.priors.has(Nuisance::kLens)) return strains;
  for (std::size_t c = 0; c < strains.size(); ++c) {
    const auto change = fit.state.nuisances.of(Nuisance::kLens, static_cast<int>(c));
    const Eigen::VectorXd variances = prepared.priors.covariance(Nuisance::kLens, static_cast<int>(c)).diagonal();
    for (Eigen::Index i = 0; i < variances.size(); ++i)
      if (variances[i] > 0.0) strains[c] += change[i] * change[i] / variances[i];
  }
  return strains;
}

}  // namespace

std::vector<double> lens_strains(const Preparation& prepared, const Fit& fit) {
  return strains_with(Fields::kAll, prepared, fit);
}

std::optional<Cause> find_exchanged_cameras(const Preparation& prepared, const Fit& fit, const Refit& refit) {
  const std::vector<int> solved = prepared.solved_cameras();
  // Fields of two healthy lenses have some seventy numbers: to try for their sake would be to try nearly always.
  const std::vector<double> strains = strains_with(Fields::kLargerThanStated, prepared, fit);
  std::optional<Observations> some_stops;
  std::optional<Trial> as_is;
  std::optional<Cause> best;
  for (std::size_t i = 0; i < solved.size(); ++i)
    for (std::size_t j = i + 1; j < solved.size(); ++j) {
      const int first = solved[i], second = solved[j];
      const auto& cameras = prepared.original.cameras;
      if (strain_of(strains, first, second) < kDecides ||
          !same_size(cameras[static_cast<std::size_t>(first)].camera, cameras[static_cast<std::size_t>(second)].camera))
        continue;
      if (!some_stops) {
        some_stops = first_stops(prepared.original, kDiagnosedStops);
        as_is = refit(*some_stops, false, nullptr);
      }
      if (!as_is) return std::nullopt;
      const std::optional<Cause> cause = cause_of_exchange(*some_stops, *as_is, first, second, refit);
      if (cause && (!best || cause->gain > best->gain)) best = cause;
    }
  return best;
}

}  // namespace rigproof::ml
