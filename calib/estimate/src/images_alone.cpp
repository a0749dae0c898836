#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "fine_field.h"
#include "fine_level.h"
#include "fine_numbers.h"
#include "image_rows.h"
#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/core/chi_square.h"
#include "rigproof/core/median.h"

namespace rigproof::ml {
namespace {

// Of the views that tell the errors: evenly chosen, since more tell little more.
constexpr std::size_t kMostViews = 240;

// Of each view.
using Weights = std::vector<Weighted>;

struct Solution {
  Eigen::LLT<Eigen::MatrixXd> llt;     // of lenses, shapes and the errors' unknowns
  Eigen::VectorXd value;               // of the same
  std::vector<FieldEquations> fields;  // of each camera, without poses
  std::vector<Eigen::VectorXd> fine;   // of each camera
};

// Of the errors' unknowns, as the images leave them.
struct Estimate {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};

// The unknowns: five of each lens, four of each board, the repeating errors, and numbers of fine fields. Poses of views
// are eliminated.
class ImagesAlone {
 public:
  // @param fine of each camera
  ImagesAlone(const RepeatingErrors& errors, const Priors& priors, std::vector<RemovedErrors::Fine> fine)
      : errors_(errors),
        cameras_(priors.count(Nuisance::kLens)),
        boards_(priors.count(Nuisance::kBoardShape)),
        fine_(std::move(fine)) {
    prior_ = Eigen::VectorXd::Ones(before_errors() + errors.size());
    constexpr double kBelieved = 1e12;  // information, where nothing is left open
    const auto information = [](double variance) { return variance > 0.0 ? 1.0 / variance : kBelieved; };
    for (int c = 0; c < cameras_; ++c)
      for (int i = 0; i < kLensColumns; ++i)
        prior_[kLensColumns * c + i] = information(priors.covariance(Nuisance::kLens, c)(i, i));
    for (int b = 0; b < boards_; ++b)
      for (int i = 0; i < kShapeColumns; ++i)
        prior_[shape_of(b) + i] = information(priors.covariance(Nuisance::kBoardShape, b)(i, i));
  }

  // The residuals become those after the solution.
  Solution solve(const std::vector<ViewRows>& views, const Weights& weights,
                 std::vector<Eigen::VectorXd>* residuals) const {
    const int raw = raw_size();
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(raw, raw);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(raw);
    for (std::size_t v = 0; v < views.size(); ++v) add(views[v], weights[v], &N, &g);
    const Eigen::MatrixXd half = by_unknowns(N.selfadjointView<Eigen::Lower>().toDenseMatrix());
    Eigen::MatrixXd H = by_unknowns(half.transpose());
    H.diagonal() += prior_;
    Eigen::VectorXd gradient = by_unknowns(g);
    Solution solution;
    for (int c = 0; c < static_cast<int>(fine_.size()); ++c) {
      solution.fields.push_back(field_of(views, weights, c));
      const FieldEquations& field = solution.fields.back();
      if (field.gradient.size() == 0) continue;
      const Eigen::LLT<Eigen::MatrixXd> own(field.own);
      const Eigen::MatrixXd by_root = own.matrixL().solve(field.with_globals.transpose());
      H.selfadjointView<Eigen::Lower>().rankUpdate(by_root.transpose(), -1.0);
      gradient -= by_root.transpose() * own.matrixL().solve(field.gradient);
    }
    solution.llt.compute(H);
    solution.value = -solution.llt.solve(gradient);
    for (const FieldEquations& field : solution.fields)
      solution.fine.push_back(field.gradient.size() > 0 ? field.step(Eigen::VectorXd(0), solution.value)
                                                        : Eigen::VectorXd(0));
    Eigen::VectorXd of_raw(raw);
    const Eigen::Index first = raw - errors_.raw_size();
    of_raw << solution.value.head(first), errors_.raw_by_unknowns() * solution.value.tail(errors_.size());
    for (std::size_t v = 0; v < views.size(); ++v)
      (*residuals)[v] = left_over(views[v], weights[v].to_pose, of_raw, solution.fine);
    return solution;
  }

  // By how the corners fit so far, at the given levels.
  Solution solve_again(const std::vector<ViewRows>& views, const std::vector<double>& levels,
                       std::vector<Eigen::VectorXd>* residuals) const {
    return solve(views, weights_by(views, *residuals, levels), residuals);
  }

  Estimate estimate_of(const Solution& solution) const {
    const Eigen::Index size = errors_.size();
    return {solution.value.tail(size), covariance_of(solution).bottomRightCorner(size, size)};
  }

  // Covariance of the errors' estimates by fine fields that are no unknowns of the solution.
  Eigen::MatrixXd bent(const Solution& solution, const std::vector<ViewRows>& views, const Weights& weights) const {
    const Eigen::MatrixXd by_gradient = covariance_of(solution).bottomRows(errors_.size());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(errors_.size(), errors_.size());
    for (int c = 0; c < static_cast<int>(fine_.size()); ++c) {
      const Eigen::MatrixXd by_field = by_gradient * field_of(views, weights, c).with_globals;
      sum += by_field * by_field.transpose();
    }
    return sum;
  }

  // Of each camera: dimensions of its corners that the errors absorb.
  std::vector<double> absorbed_by(const Solution& solution, const std::vector<ViewRows>& views) const {
    const Eigen::MatrixXd all = covariance_of(solution);
    std::vector<double> absorbed(static_cast<std::size_t>(cameras_), 0.0);
    for (const RepeatingErrors::Group& group : errors_.groups()) {
      const double dimensions = group.size - all.diagonal().segment(before_errors() + group.first, group.size).sum();
      if (group.camera >= 0) {
        absorbed[static_cast<std::size_t>(group.camera)] += dimensions;
        continue;
      }
      double rows = 0.0;
      for (const ViewRows& view : views)
        if (view.board == group.board) rows += static_cast<double>(view.residual.size());
      for (const ViewRows& view : views)
        if (view.board == group.board)
          absorbed[static_cast<std::size_t>(view.camera)] +=
              dimensions * static_cast<double>(view.residual.size()) / rows;
    }
    for (std::size_t c = 0; c < solution.fields.size(); ++c) {
      const FieldEquations& field = solution.fields[c];
      const Eigen::Index size = field.gradient.size();
      if (size == 0) continue;
      const Eigen::LLT<Eigen::MatrixXd> own(field.own);
      const Eigen::MatrixXd followed = own.solve(field.with_globals.transpose());
      absorbed[c] += static_cast<double>(size) - own.solve(Eigen::MatrixXd::Identity(size, size)).trace() -
                     (followed * all).cwiseProduct(followed).sum();
    }
    return absorbed;
  }

  // By how the corners fit so far.
  // @param levels of each camera: square of what its corners scatter by, as a multiple of what is stated
  static Weights weights_by(const std::vector<ViewRows>& views, const std::vector<Eigen::VectorXd>& residuals,
                            const std::vector<double>& levels) {
    Weights all;
    for (std::size_t v = 0; v < views.size(); ++v)
      all.push_back(weighted(views[v], residuals[v], levels[static_cast<std::size_t>(views[v].camera)]));
    return all;
  }

  // Of each camera: square of what its corners scatter by, as a multiple of what is stated.
  std::vector<double> squares_of_levels(const std::vector<ViewRows>& views,
                                        const std::vector<Eigen::VectorXd>& residuals) const {
    constexpr double kMedianSquare = 1.386;  // of a whitened residual of two dimensions: 2 ln 2
    std::vector<std::vector<double>> squares(static_cast<std::size_t>(cameras_));
    for (std::size_t v = 0; v < views.size(); ++v)
      for (Eigen::Index i = 0; i + 1 < residuals[v].size(); i += 2)
        squares[static_cast<std::size_t>(views[v].camera)].push_back(residuals[v].segment<2>(i).squaredNorm());
    std::vector<double> levels;
    for (std::vector<double>& of_camera : squares)
      levels.push_back(of_camera.empty() ? 1.0 : std::max(1e-4, median(std::move(of_camera)) / kMedianSquare));
    return levels;
  }

 private:
  int shape_of(int board) const { return kLensColumns * cameras_ + kShapeColumns * board; }
  int before_errors() const { return shape_of(boards_); }
  int raw_size() const { return before_errors() + errors_.raw_size(); }

  static Eigen::MatrixXd covariance_of(const Solution& solution) {
    return solution.llt.solve(Eigen::MatrixXd::Identity(solution.value.size(), solution.value.size()));
  }

  // Of rows by lenses, shape and raw errors: those by the unknowns.
  Eigen::MatrixXd by_unknowns(const Eigen::MatrixXd& by_raw) const {
    const Eigen::Index first = before_errors();
    Eigen::MatrixXd rows(first + errors_.size(), by_raw.cols());
    rows << by_raw.topRows(first), errors_.by_unknowns(by_raw.bottomRows(errors_.raw_size()));
    return rows;
  }

  int place(const ViewRows& view, Eigen::Index column) const {
    if (column < kLensColumns) return kLensColumns * view.camera + static_cast<int>(column);
    if (column < kLensColumns + kShapeColumns) return shape_of(view.board) + static_cast<int>(column) - kLensColumns;
    return before_errors() + view.raw[static_cast<std::size_t>(column - kLensColumns - kShapeColumns)];
  }

  // A view without its pose.
  void add(const ViewRows& view, const Weighted& by, Eigen::MatrixXd* N, Eigen::VectorXd* g) const {
    const Eigen::MatrixXd free = view.by_others + view.by_pose * (by.to_pose * view.by_others);
    const Eigen::MatrixXd H = view.by_others.transpose() * by.weights.asDiagonal() * free;
    const Eigen::VectorXd gradient = free.transpose() * by.weights.asDiagonal() * view.residual;
    for (Eigen::Index j = 0; j < H.cols(); ++j) {
      const int column = place(view, j);
      (*g)[column] += gradient[j];
      for (Eigen::Index i = 0; i < H.rows(); ++i) {
        const int row = place(view, i);
        if (row >= column) (*N)(row, column) += H(i, j);
      }
    }
  }

  // With lenses, shapes and the errors' unknowns for globals; no poses.
  FieldEquations field_of(const std::vector<ViewRows>& views, const Weights& weights, int camera) const {
    const std::shared_ptr<const FineNumbers>& numbers = fine_[static_cast<std::size_t>(camera)].numbers;
    const Eigen::Index globals = before_errors() + errors_.size();
    FieldEquations field(0, static_cast<int>(globals), numbers ? numbers->size() : 0);
    if (!numbers) return field;
    Eigen::MatrixXd with_raw = Eigen::MatrixXd::Zero(raw_size(), numbers->size());
    std::size_t corners = 0;
    for (const ViewRows& view : views) corners += view.camera == camera ? view.pixels.size() : 0;
    FineSquares squares(*numbers, corners);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const ViewRows& view = views[v];
      if (view.camera != camera) continue;
      const Weighted& by = weights[v];
      for (std::size_t i = 0; i < view.pixels.size(); ++i)
        squares.add(view.pixels[i], numbers->at(view.pixels[i]),
                    by.weights[static_cast<Eigen::Index>(2 * i)] * (view.whitening[i].transpose() * view.whitening[i]));
      // What the view's pose follows is not there.
      const Eigen::MatrixXd weighted = by.weights.asDiagonal() * view.by_fine;
      const Eigen::MatrixXd others = weighted.transpose() * view.by_others, poses = weighted.transpose() * view.by_pose;
      const Eigen::MatrixXd left = others + poses * (by.to_pose * view.by_others);
      for (Eigen::Index j = 0; j < left.cols(); ++j) with_raw.row(place(view, j)) += left.col(j).transpose();
      field.own.noalias() += poses * (by.to_pose * view.by_fine);
      field.gradient += weighted.transpose() * view.residual + poses * (by.to_pose * view.residual);
    }
    field.own += squares.sum();
    field.with_globals = by_unknowns(with_raw);
    return field;
  }

  Eigen::VectorXd left_over(const ViewRows& view, const Eigen::MatrixXd& to_pose, const Eigen::VectorXd& raw,
                            const std::vector<Eigen::VectorXd>& fine) const {
    Eigen::VectorXd others(view.by_others.cols());
    for (Eigen::Index j = 0; j < others.size(); ++j) others[j] = raw[place(view, j)];
    Eigen::VectorXd moved = view.residual + view.by_others * others;
    const auto camera = static_cast<std::size_t>(view.camera);
    if (camera < fine.size() && fine[camera].size() > 0) moved += view.by_fine * fine[camera];
    return moved + view.by_pose * (to_pose * moved);
  }

  const RepeatingErrors& errors_;
  int cameras_, boards_;
  std::vector<RemovedErrors::Fine> fine_;
  Eigen::VectorXd prior_;  // information
};

// Estimates of numbers of unit variance scatter by 1 less what the data leave, and by what else is known to bend them.
// How many times larger the numbers are, where chance does not explain the estimates; 1 where it does.
// @param chance that so much is chance
// @param bent covariance of all estimates by what bends them; null: nothing does
double enlargement(const Estimate& estimate, const RepeatingErrors::Group& group, double chance,
                   const Eigen::MatrixXd* bent) {
  const Eigen::Index first = group.first, size = group.size;
  Eigen::MatrixXd told = Eigen::MatrixXd::Identity(size, size) - estimate.covariance.block(first, first, size, size);
  const double of_own = told.trace();
  if (bent != nullptr) told += bent->block(first, first, size, size);
  const double expected = told.trace(), squares = estimate.value.segment(first, size).squaredNorm();
  if (!(of_own > 0.0) || squares <= expected) return 1.0;
  const double degrees = expected * expected / told.squaredNorm();
  if (chi_square_tail(degrees * squares / expected, degrees) > chance) return 1.0;
  return std::sqrt((squares - expected + of_own) / of_own);
}

bool enlarge(const Estimate& estimate, RepeatingErrors* errors) {
  constexpr double kChance = 1e-6, kSettled = 1.05, kMost = 50.0;
  bool changed = false;
  for (const RepeatingErrors::Group& group : errors->groups()) {
    const double factor = std::min(enlargement(estimate, group, kChance, nullptr), kMost / group.level);
    if (factor < kSettled) continue;
    errors->enlarge(group, factor);
    changed = true;
  }
  return changed;
}

// How fine the field of a lens is nobody states. Before any data the grids and none at all are alike.
RemovedErrors::Fine fine_field(const std::vector<LeftOver>& views, const LensField& smooth, double prior_px) {
  constexpr double kUnlikely = 0.01;  // is left out
  std::array<FineLevel, kFineGrids.size()> levels{};
  RemovedErrors::Fine fine;
  double most = 0.0;  // of the logarithms: that of none
  for (std::size_t i = 0; i < kFineGrids.size(); ++i) {
    levels[i] = fine_level(views, FineField(smooth.camera(), kFineGrids[i]), smooth, prior_px / FineField::kRms);
    if (i == 0 || levels[i].log_evidence >= most) fine.noise = levels[i].noise;
    most = std::max(most, levels[i].log_evidence);
  }
  double sum = std::exp(-most);
  for (const FineLevel& level : levels) sum += std::exp(level.log_evidence - most);
  for (std::size_t i = 0; i < kFineGrids.size(); ++i) {
    const double share = std::exp(levels[i].log_evidence - most) / sum;
    if (!(share >= kUnlikely)) continue;  // nor one that is no number
    fine.grids.push_back({kFineGrids[i], levels[i].sigma_px, share});
    fine.rms_px = std::hypot(fine.rms_px, FineField::kRms * fine.grids.back().counted_px());
    fine.shown_px = std::hypot(fine.shown_px, FineField::kRms * std::sqrt(share) * levels[i].shown_px);
  }
  return fine;
}

// 1 for rows of corners that fit, 0 for others. Weights that fall with the residual would make a field that adds to
// noise look smaller than it is.
Eigen::VectorXd weights_of_used(const Eigen::VectorXd& residual, double level) {
  constexpr double kMostSigmas = 5.0;
  Eigen::VectorXd weights(residual.size());
  for (Eigen::Index i = 0; i + 1 < residual.size(); i += 2)
    weights.segment<2>(i).setConstant(residual.segment<2>(i).squaredNorm() < kMostSigmas * kMostSigmas * level);
  return weights;
}

std::vector<RemovedErrors::Fine> fine_fields(const std::vector<ViewRows>& views,
                                             const std::vector<Eigen::VectorXd>& residuals,
                                             const std::vector<double>& levels, const Observations& observations,
                                             const RepeatingErrors& errors) {
  std::vector<RemovedErrors::Fine> fine;
  for (std::size_t c = 0; c < observations.cameras.size(); ++c) {
    const int camera = static_cast<int>(c);
    std::vector<LeftOver> seen;
    for (std::size_t v = 0; v < views.size(); ++v)
      if (views[v].camera == camera)
        seen.push_back({&views[v], residuals[v], weights_of_used(residuals[v], levels[c])});
    const double prior = observations.cameras[c].intrinsics_sigma.residual_px;
    const bool has_field = errors.field(camera) >= 0 && !seen.empty();
    fine.push_back(has_field ? fine_field(seen, errors.lens_field(camera), prior) : RemovedErrors::Fine{});
  }
  return fine;
}

// What was seen of views, as the polynomials and the print alone explain it.
struct Seen {
  const Observations& observations;
  const Priors& priors;
  std::vector<ViewRows> rows;
  std::vector<Eigen::VectorXd> residuals;
  std::vector<double> levels;
};

// Polynomials follow what they can of fields that bend within a board, and are large for it, though the field is not
// larger than stated. What the fine fields make of the estimate, none counted for larger than it is stated to be.
Eigen::MatrixXd bent_by_fine(Seen seen, const RepeatingErrors& errors, std::vector<RemovedErrors::Fine> fine,
                             const Solution& smooth) {
  for (std::size_t c = 0; c < fine.size(); ++c) {
    const RigCamera& camera = seen.observations.cameras[c];
    for (RemovedErrors::Fine::Grid& grid : fine[c].grids)
      grid.sigma_px = std::min(grid.sigma_px, camera.intrinsics_sigma.residual_px / FineField::kRms);
    fine[c].numbers = numbers_for(seen.observations, static_cast<int>(c), fine[c].grids, fine[c].noise);
  }
  for (ViewRows& view : seen.rows) add_fine_rows(fine[static_cast<std::size_t>(view.camera)].numbers.get(), &view);
  return ImagesAlone(errors, seen.priors, fine)
      .bent(smooth, seen.rows, ImagesAlone::weights_by(seen.rows, seen.residuals, seen.levels));
}

// Of each group: how many times larger it is than stated (RemovedErrors::beyond_stated).
std::vector<double> beyond_stated(const Seen& seen, const RepeatingErrors& errors,
                                  const std::vector<RemovedErrors::Fine>& fine, const Solution& smooth,
                                  const Estimate& estimate) {
  // A rig has as many groups as cameras, and its boards: chance is named in one healthy rig of three cameras of 2,500.
  // A rarer one hides fields that are six times as large as stated.
  constexpr double kChance = 1e-4;
  std::vector<double> beyond;
  std::optional<Eigen::MatrixXd> bent;  // dear, and rarely asked for
  for (const RepeatingErrors::Group& group : errors.groups()) {
    beyond.push_back(enlargement(estimate, group, kChance, nullptr));
    if (beyond.back() == 1.0) continue;
    if (!bent) bent = bent_by_fine(seen, errors, fine, smooth);
    beyond.back() = enlargement(estimate, group, kChance, &*bent);
  }
  return beyond;
}

// Evenly chosen.
std::vector<ViewRows> rows_of_some(const std::vector<ViewPose>& views, const RemovedErrors& removed,
                                   const Observations& observations) {
  std::vector<ViewRows> rows;
  const std::size_t step = (views.size() + kMostViews - 1) / kMostViews;
  std::map<std::pair<int, int>, std::size_t> seen;  // by camera and board, since they take turns among the views
  for (const ViewPose& view : views)
    if (seen[{view.camera, view.board}]++ % step == 0) rows.push_back(rows_of(view, removed, observations));
  return rows;
}

// Residuals still hold the fine fields: beside the noise alone they would all pass for outliers.
Weights weights_beside_fields(const std::vector<ViewRows>& rows, const std::vector<Eigen::VectorXd>& residuals,
                              const std::vector<double>& levels, const std::vector<RemovedErrors::Fine>& fine) {
  Weights weights;
  for (std::size_t v = 0; v < rows.size(); ++v) {
    const auto camera = static_cast<std::size_t>(rows[v].camera);
    const double noise = fine[camera].grids.empty() ? levels[camera] : fine[camera].noise;
    weights.push_back(weighted_by(rows[v], weights_of_used(residuals[v], levels[camera]) / noise));
  }
  return weights;
}

// The fine fields become unknowns of the rows, and the levels those beside them.
void take_numbers(const Observations& observations, std::vector<ViewRows>* rows, std::vector<double>* levels,
                  RemovedErrors* removed) {
  for (std::size_t c = 0; c < removed->fine.size(); ++c) {
    RemovedErrors::Fine& fine = removed->fine[c];
    fine.numbers = numbers_for(observations, static_cast<int>(c), fine.grids, fine.noise);
    if (fine.numbers) (*levels)[c] = fine.noise;
  }
  for (ViewRows& view : *rows) add_fine_rows(removed->fine[static_cast<std::size_t>(view.camera)].numbers.get(), &view);
}

}  // namespace

void estimate_repeating(const Observations& observations, const std::vector<ViewPose>& views, const Priors& priors,
                        const RemovedErrors* known, RemovedErrors* removed) {
  constexpr int kRounds = 3, kMostRounds = 5;  // weights and levels settle soon
  if (known != nullptr) removed->errors = known->errors;
  Seen seen{observations, priors, rows_of_some(views, *removed, observations), {}, {}};
  for (const ViewRows& view : seen.rows) seen.residuals.push_back(view.residual);
  const ImagesAlone polynomials(removed->errors, priors, {});
  Solution smooth;
  for (int round = 0; round < kRounds; ++round) {
    seen.levels = polynomials.squares_of_levels(seen.rows, seen.residuals);
    smooth =
        polynomials.solve(seen.rows, ImagesAlone::weights_by(seen.rows, seen.residuals, seen.levels), &seen.residuals);
  }
  seen.levels = polynomials.squares_of_levels(seen.rows, seen.residuals);
  removed->fine = known != nullptr ? known->fine
                                   : fine_fields(seen.rows, seen.residuals, seen.levels, observations, removed->errors);
  removed->beyond_stated =
      known != nullptr ? known->beyond_stated
                       : beyond_stated(seen, removed->errors, removed->fine, smooth, polynomials.estimate_of(smooth));
  const Weights weights = weights_beside_fields(seen.rows, seen.residuals, seen.levels, removed->fine);
  take_numbers(observations, &seen.rows, &seen.levels, removed);
  const ImagesAlone whole(removed->errors, priors, removed->fine);
  Solution solution = whole.solve(seen.rows, weights, &seen.residuals);
  for (int round = 1; round < kRounds; ++round) solution = whole.solve_again(seen.rows, seen.levels, &seen.residuals);
  for (int round = 0; known == nullptr && round < kMostRounds; ++round) {
    if (!enlarge(whole.estimate_of(solution), &removed->errors)) break;
    solution = whole.solve_again(seen.rows, seen.levels, &seen.residuals);
  }
  removed->value = whole.estimate_of(solution).value;
  for (std::size_t c = 0; c < removed->fine.size(); ++c) removed->fine[c].value = solution.fine[c];
  removed->absorbed = whole.absorbed_by(solution, seen.rows);
}

}  // namespace rigproof::ml
