#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "fine_field.h"
#include "fine_level.h"
#include "image_rows.h"
#include "rigproof/core/chi_square.h"
#include "rigproof/core/median.h"

namespace rigproof::ml {
namespace {

// Of the views that tell the errors: evenly chosen, since more tell little more.
constexpr std::size_t kMostViews = 240;

struct Estimate {
  Eigen::VectorXd value;        // of the errors' unknowns
  Eigen::MatrixXd covariance;   // as the images leave it
  Eigen::MatrixXd by_gradient;  // what gradients by all unknowns, as large as they are taken for, make of the value
};

// By lenses, shape and repeating errors, from which the poses of the views are eliminated.
struct NormalEquations {
  Eigen::LLT<Eigen::MatrixXd> llt;
  Eigen::VectorXd solution;
};

// The unknowns: five of each lens, four of each board, the repeating errors. Poses of views are eliminated.
class ImagesAlone {
 public:
  ImagesAlone(const RepeatingErrors& errors, const Priors& priors)
      : errors_(errors), cameras_(priors.count(Nuisance::kLens)), boards_(priors.count(Nuisance::kBoardShape)) {
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

  // One round more: equations by the weights of how the corners fit so far, and their solution. The residuals become
  // those after it.
  NormalEquations solve(const std::vector<ViewRows>& views, std::vector<Eigen::VectorXd>* residuals) const {
    const int raw = raw_size();
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(raw, raw);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(raw);
    const std::vector<double> levels = squares_of_levels(views, *residuals);
    std::vector<Eigen::MatrixXd> to_pose;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Weighted by = weighted(views[v], (*residuals)[v], levels[static_cast<std::size_t>(views[v].camera)]);
      add(views[v], by, &N, &g);
      to_pose.push_back(by.to_pose);
    }
    const Eigen::MatrixXd half = by_unknowns(N.selfadjointView<Eigen::Lower>().toDenseMatrix());
    Eigen::MatrixXd H = by_unknowns(half.transpose());
    H.diagonal() += prior_;
    NormalEquations normal{Eigen::LLT<Eigen::MatrixXd>(H), {}};
    normal.solution = -normal.llt.solve(by_unknowns(g));
    Eigen::VectorXd of_raw(raw);
    const Eigen::Index first = raw - errors_.raw_size();
    of_raw << normal.solution.head(first), errors_.raw_by_unknowns() * normal.solution.tail(errors_.size());
    for (std::size_t v = 0; v < views.size(); ++v) (*residuals)[v] = left_over(views[v], to_pose[v], of_raw);
    return normal;
  }

  Estimate estimate_of(const NormalEquations& normal) const {
    const Eigen::Index size = errors_.size();
    Eigen::MatrixXd last = Eigen::MatrixXd::Zero(normal.solution.size(), size);
    last.bottomRows(size).setIdentity();
    const Eigen::MatrixXd by_gradient = normal.llt.solve(last).transpose();
    return {normal.solution.tail(size), by_gradient.rightCols(size), by_gradient};
  }

  // What a fine field of a camera makes of an estimate that does not know of it: a column for each of its coefficients.
  Eigen::MatrixXd response_to_fine(const std::vector<ViewRows>& views, const std::vector<Eigen::VectorXd>& residuals,
                                   int camera, const FineField& fine, const Estimate& estimate, double level) const {
    Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(raw_size(), fine.size());
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (views[v].camera != camera) continue;
      const Eigen::MatrixXd by_field = gradients_by_fine(views[v], weighted(views[v], residuals[v], level), fine);
      for (Eigen::Index j = 0; j < by_field.rows(); ++j) gradients.row(place(views[v], j)) += by_field.row(j);
    }
    return estimate.by_gradient * by_unknowns(gradients);
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

  // By lens, shape and raw errors of a view (rows) and the coefficients of its camera's fine field.
  static Eigen::MatrixXd gradients_by_fine(const ViewRows& view, const Weighted& by, const FineField& field) {
    const Eigen::MatrixXd free = view.by_others + view.by_pose * (by.to_pose * view.by_others);
    const Eigen::MatrixXd weighted = free.transpose() * by.weights.asDiagonal();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(free.cols(), field.size());
    for (std::size_t i = 0; i < view.pixels.size(); ++i) {
      const Eigen::MatrixX2d of_pixel = weighted.middleCols<2>(static_cast<Eigen::Index>(2 * i)) * view.whitening[i];
      for (const FineField::Share& share : field.at(view.pixels[i]))
        all.middleCols<2>(2 * share.node) += share.weight * of_pixel;
    }
    return all;
  }

  Eigen::VectorXd left_over(const ViewRows& view, const Eigen::MatrixXd& to_pose, const Eigen::VectorXd& raw) const {
    Eigen::VectorXd others(view.by_others.cols());
    for (Eigen::Index j = 0; j < others.size(); ++j) others[j] = raw[place(view, j)];
    const Eigen::VectorXd moved = view.residual + view.by_others * others;
    return moved + view.by_pose * (to_pose * moved);
  }

  const RepeatingErrors& errors_;
  int cameras_, boards_;
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

// The polynomials also make up for the fine fields, which the estimate does not weigh: for that they are taken for
// larger, too.
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
  // Of two alone, splines of eight cells made up for fields of twelve: many times too large.
  constexpr std::array<int, 3> kGrids = {8, 12, 16};
  constexpr double kUnlikely = 0.01;  // is left out
  std::array<FineLevel, kGrids.size()> levels{};
  double most = 0.0;  // of the logarithms: that of none
  for (std::size_t i = 0; i < kGrids.size(); ++i) {
    levels[i] = fine_level(views, FineField(smooth.camera(), kGrids[i]), smooth, prior_px / FineField::kRms);
    most = std::max(most, levels[i].log_evidence);
  }
  double sum = std::exp(-most);
  for (const FineLevel& level : levels) sum += std::exp(level.log_evidence - most);
  RemovedErrors::Fine fine;
  for (std::size_t i = 0; i < kGrids.size(); ++i) {
    const double share = std::exp(levels[i].log_evidence - most) / sum;
    if (!(share >= kUnlikely)) continue;  // nor one that is no number
    fine.grids.push_back({kGrids[i], levels[i].sigma_px, share});
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
                                             const std::vector<Eigen::VectorXd>& residuals, const ImagesAlone& problem,
                                             const Observations& observations, const RepeatingErrors& errors) {
  const std::vector<double> levels = problem.squares_of_levels(views, residuals);
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

// Polynomials follow what they can of fields that bend within a board, and are large for it, though the field is not
// larger than stated. What the fields that are counted make of the estimate, none for larger than it is stated to be.
Eigen::MatrixXd bent_by_fine(const std::vector<ViewRows>& views, const std::vector<Eigen::VectorXd>& residuals,
                             const ImagesAlone& problem, const Observations& observations, const RemovedErrors& removed,
                             const Estimate& estimate) {
  Eigen::MatrixXd bent = Eigen::MatrixXd::Zero(estimate.value.size(), estimate.value.size());
  const std::vector<double> levels = problem.squares_of_levels(views, residuals);
  for (std::size_t c = 0; c < removed.fine.size(); ++c) {
    const double stated_px = observations.cameras[c].intrinsics_sigma.residual_px / FineField::kRms;
    for (const RemovedErrors::Fine::Grid& grid : removed.fine[c].grids) {
      const int camera = static_cast<int>(c);
      const FineField field(removed.errors.lens_field(camera).camera(), grid.cells);
      const Eigen::MatrixXd by_field = problem.response_to_fine(views, residuals, camera, field, estimate, levels[c]);
      const double counted_px = std::min(grid.sigma_px, stated_px);
      bent += (grid.share * counted_px * counted_px) * by_field * by_field.transpose();
    }
  }
  return bent;
}

// Of each group: how many times larger it is than stated (RemovedErrors::beyond_stated).
std::vector<double> beyond_stated(const std::vector<ViewRows>& views, const std::vector<Eigen::VectorXd>& residuals,
                                  const ImagesAlone& problem, const Observations& observations,
                                  const RemovedErrors& removed, const Estimate& estimate) {
  // A rig has as many groups as cameras, and its boards: chance is named in one healthy rig of three cameras of 2,500.
  // A rarer one hides fields that are six times as large as stated.
  constexpr double kChance = 1e-4;
  std::vector<double> beyond;
  std::optional<Eigen::MatrixXd> bent;  // dear, and rarely asked for
  for (const RepeatingErrors::Group& group : removed.errors.groups()) {
    beyond.push_back(enlargement(estimate, group, kChance, nullptr));
    if (beyond.back() == 1.0) continue;
    if (!bent) bent = bent_by_fine(views, residuals, problem, observations, removed, estimate);
    beyond.back() = enlargement(estimate, group, kChance, &*bent);
  }
  return beyond;
}

}  // namespace

void estimate_repeating(const Observations& observations, const std::vector<ViewPose>& views, const Priors& priors,
                        RemovedErrors* removed) {
  constexpr int kRounds = 3, kMostRounds = 5;  // weights and levels settle soon
  std::vector<ViewRows> rows;
  const std::size_t step = (views.size() + kMostViews - 1) / kMostViews;
  std::map<std::pair<int, int>, std::size_t> seen;  // by camera and board, since they take turns among the views
  for (const ViewPose& view : views)
    if (seen[{view.camera, view.board}]++ % step == 0) rows.push_back(rows_of(view, *removed, observations));
  std::vector<Eigen::VectorXd> residuals;
  for (const ViewRows& view : rows) residuals.push_back(view.residual);
  const ImagesAlone problem(removed->errors, priors);
  for (int round = 1; round < kRounds; ++round) problem.solve(rows, &residuals);
  const auto next_estimate = [&] { return problem.estimate_of(problem.solve(rows, &residuals)); };
  Estimate estimate = next_estimate();
  removed->fine = fine_fields(rows, residuals, problem, observations, removed->errors);
  removed->beyond_stated = beyond_stated(rows, residuals, problem, observations, *removed, estimate);
  for (int round = 0; round < kMostRounds && enlarge(estimate, &removed->errors); ++round) estimate = next_estimate();
  removed->value = estimate.value;
}

}  // namespace rigproof::ml
