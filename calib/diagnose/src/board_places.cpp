#include "board_places.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "global_covariance.h"
#include "rigproof/calib/estimate/board_place.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/stated_levels.h"
#include "rigproof/core/chi_square.h"
#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// One in ten thousand healthy places.
constexpr double kLeastProbability = 1e-4;

bool are_stated(const Observations& observations) {
  return std::any_of(observations.more_boards.begin(), observations.more_boards.end(),
                     [](const Board& board) { return board.place.has_value(); });
}

bool is_shown(const Preparation& prepared, const Fit& fit, int board) {
  return std::any_of(prepared.views.begin(), prepared.views.end(), [&](const ViewPose& view) {
    return view.board == board && !fit.view_left_out[static_cast<std::size_t>(view.view)];
  });
}

// What the solution allows for is in its uncertainty.
bool is_sound(const Examination& found) {
  return !found.cause && found.wrong_frames.empty() && found.contradictions.odometry.empty() &&
         found.contradictions.cameras.empty() && !found.symptoms.any() && found.motion_suffices();
}

// A solution that places are compared with.
struct Judge {
  const Fit& fit;
  Layout layout;
  GlobalCovariance globals;
};

// One of each odometry model that is not out of the question; none where poses are not determined.
std::vector<Judge> judges_of(const Preparation& prepared, const OdometryChoice& choice) {
  std::vector<Judge> judges;
  for (const Fit* fit : {&choice.fit, choice.other ? &*choice.other : nullptr}) {
    if (fit == nullptr) continue;
    const auto sums = problem_at(prepared, *fit, fit->noise).sums_with_leverage(fit->state);
    std::optional<GlobalCovariance> globals =
        covariance_at(prepared, *fit, sums ? stated_levels(prepared, *fit, *sums) : fit->noise);
    if (!globals) return {};
    judges.push_back({*fit, Layout::of(prepared.used, prepared.priors), std::move(*globals)});
  }
  return judges;
}

bool is_open(const Eigen::MatrixXd& J, const GlobalCovariance& globals) {
  constexpr double kRounding = 1e-6;
  return globals.free_directions.cols() > 0 && (J * globals.free_directions).cwiseAbs().maxCoeff() > kRounding;
}

// How likely a healthy place is off by as much, weighed by what is stated of it and by what the drive tells of it;
// absent where the drive leaves it open.
std::optional<double> probability_of(const Judge& judge, int board, const BoardPlace& place) {
  const PlaceError error = place_error(judge.fit.state, board, place);
  const Eigen::MatrixXd J = error.by_globals(judge.layout);
  if (is_open(J, judge.globals)) return std::nullopt;
  Matrix6d covariance = J * judge.globals.covariance * J.transpose();
  covariance.diagonal() += error.sigma.cwiseAbs2();
  return chi_square_tail(error.value.dot(covariance.ldlt().solve(error.value)), 6);
}

enum class Agreement { kFits, kContradicts, kUndecided };

// The judges may differ: what only some of them accept is neither used nor accused.
Agreement agreement_of(const std::vector<Judge>& judges, int board, const BoardPlace& place) {
  std::size_t fits = 0, contradicts = 0;
  for (const Judge& judge : judges) {
    const std::optional<double> probability = probability_of(judge, board, place);
    fits += probability && *probability >= kLeastProbability;
    contradicts += probability && *probability < kLeastProbability;
  }
  return fits == judges.size()          ? Agreement::kFits
         : contradicts == judges.size() ? Agreement::kContradicts
                                        : Agreement::kUndecided;
}

Finding contradicted(const std::vector<Judge>& judges, int board, const BoardPlace& stated) {
  const Vector6d off = place_error(judges.front().fit.state, board, stated).value;
  BoardPlace inverted = stated;
  inverted.T_first_board = stated.T_first_board.inverse();
  const bool is_inverted = agreement_of(judges, board, inverted) == Agreement::kFits;
  return Finding("board.place", {{"board", board + 1},
                                 {"off_mm", 1e3 * off.head<3>().norm()},
                                 {"off_deg", rad_to_deg(off.tail<3>().norm())},
                                 {"stated_mm", 1e3 * stated.sigma_m},
                                 {"stated_deg", rad_to_deg(stated.sigma_rad)},
                                 {"way", is_inverted ? "inverted" : "other"}});
}

// What becomes of the stated places: which are used, and what is to be said.
struct Verdict {
  std::vector<int> used;
  std::vector<Finding> notes;
};

Verdict judge_places(const Preparation& prepared, const OdometryChoice& choice, bool sound) {
  Verdict verdict;
  const std::vector<Judge> judges = sound ? judges_of(prepared, choice) : std::vector<Judge>();
  bool undecided = false;
  for (int b = 1; b < prepared.original.boards(); ++b) {
    const std::optional<BoardPlace>& place = prepared.original.board_at(b).place;
    if (!place || !is_shown(prepared, choice.fit, b)) continue;
    const bool comparable = !judges.empty() && is_shown(prepared, choice.fit, 0);
    const Agreement agreement = comparable ? agreement_of(judges, b, *place) : Agreement::kUndecided;
    if (agreement == Agreement::kFits) verdict.used.push_back(b);
    if (agreement == Agreement::kContradicts) verdict.notes.push_back(contradicted(judges, b, *place));
    undecided = undecided || agreement == Agreement::kUndecided;
  }
  if (undecided) verdict.notes.emplace_back("board.places_unused");
  return verdict;
}

}  // namespace

void use_stated_places(Preparation* prepared, OdometryChoice* choice, Examination* found) {
  if (!are_stated(prepared->original)) return;
  const Verdict verdict = judge_places(*prepared, *choice, is_sound(*found));
  found->notes.insert(found->notes.end(), verdict.notes.begin(), verdict.notes.end());
  if (verdict.used.empty()) return;
  for (const int b : verdict.used)
    prepared->used.more_boards[static_cast<std::size_t>(b) - 1].place = prepared->original.board_at(b).place;
  settle_again(prepared, choice->fit);
  choice->fit = fit_again(*prepared, choice->fit);
  if (choice->other) choice->other = fit_again(*prepared, *choice->other);
  found->sums = problem_at(*prepared, choice->fit, choice->fit.noise).sums_with_leverage(choice->fit.state);
}

std::vector<EstimatedBoard> standing_boards(const Preparation& prepared, const Fit& fit,
                                            const GlobalCovariance& globals) {
  std::vector<EstimatedBoard> boards;
  if (prepared.used.boards() == 1 || !is_shown(prepared, fit, 0)) return boards;
  const Layout layout = Layout::of(prepared.used, prepared.priors);
  for (int b = 1; b < prepared.used.boards(); ++b) {
    if (!is_shown(prepared, fit, b)) continue;
    BoardPlace here;
    here.T_first_board =
        fit.state.T_world_board.front().inverse() * fit.state.T_world_board[static_cast<std::size_t>(b)];
    const Eigen::MatrixXd J = place_error(fit.state, b, here).by_globals(layout);
    if (is_open(J, globals)) continue;
    const Vector6d variances = (J * globals.covariance).cwiseProduct(J).rowwise().sum();
    EstimatedBoard& board = boards.emplace_back();
    board.number = b + 1;
    board.T_first_board = here.T_first_board;
    for (Eigen::Index i = 0; i < 6; ++i)
      board.sigma[static_cast<std::size_t>(i)] = std::sqrt(std::max(0.0, variances[i]));
  }
  return boards;
}

}  // namespace rigproof::ml
