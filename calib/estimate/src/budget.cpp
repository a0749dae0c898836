#include "rigproof/calib/estimate/budget.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <utility>

#include "local_block.h"
#include "rigproof/calib/estimate/covariance.h"

namespace rigproof::ml {
namespace {

// By Group.
constexpr std::array<const char*, kGroupCount> kSources = {
    "corners", "ground depth", "board depth", "odometry", "odometry", "suspension", "suspension", "images at speed"};

// C H_b C of every block, by the rows of C: of the unknowns a column each, of the cameras' errors a row each.
class BudgetSink : public BlockSink {
 public:
  BudgetSink(Eigen::MatrixXd poses, Eigen::MatrixXd globals)
      : poses_(std::move(poses)),
        globals_(std::move(globals)),
        rows_(globals_.rows(), LocalBlock::kMaxUnknowns),
        product_(rows_) {
    for (Eigen::VectorXd& sum : sums_) sum = Eigen::VectorXd::Zero(globals_.rows());
  }

  void add(const LocalBlock& block) override {
    const int n = block.unknowns;
    for (std::size_t a = 0; a < static_cast<std::size_t>(block.count); ++a)
      rows_.middleCols(block.starts[a], block.segments[a].size) = of(block.segments[a]);
    product_.leftCols(n).noalias() = rows_.leftCols(n) * block.H.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
    sums_[static_cast<std::size_t>(block.group)] +=
        product_.leftCols(n).cwiseProduct(rows_.leftCols(n)).rowwise().sum();
  }

  const Eigen::VectorXd& of(Group group) const { return sums_[static_cast<std::size_t>(group)]; }

 private:
  Eigen::MatrixXd::ConstColsBlockXpr of(const Segment& segment) const {
    return segment.pose < 0 ? globals_.middleCols(segment.offset, segment.size)
                            : poses_.middleCols(6 * segment.pose + segment.offset, segment.size);
  }

  Eigen::MatrixXd poses_, globals_;
  Eigen::MatrixXd rows_, product_;  // of the block at hand
  std::array<Eigen::VectorXd, kGroupCount> sums_;
};

// How the cameras answer to a change of the gradient: a row for each of their values.
struct Answer {
  Eigen::MatrixXd to_poses, to_globals, to_repeating;
  std::vector<Eigen::MatrixXd> to_fields;
};

Answer answer_of(const Problem& problem, const State& state, const SolvedEquations& solved) {
  const Layout& layout = problem.layout();
  const Eigen::Index globals = layout.globals(), all = solved.all.covariance.rows();
  const Eigen::MatrixXd chart = camera_chart(state, layout);
  const Eigen::MatrixXd by_all = chart * solved.all.covariance.topRows(globals);
  Answer answer{chart * solved.with_poses, by_all.leftCols(globals), by_all.rightCols(all - globals), {}};
  for (const Eigen::MatrixXd& field : solved.with_fields) answer.to_fields.push_back(chart * field);
  return answer;
}

// What corners tell of the repeating errors, beside what their blocks hold: C H C of the rest of H, diagonal.
Eigen::VectorXd corners_with_repeating(const SolvedEquations& solved, const Answer& answer) {
  const Eigen::Index globals = answer.to_globals.cols(), repeating = answer.to_repeating.cols();
  const ArrowSystem& H = solved.system;
  Eigen::MatrixXd own = H.global.bottomRightCorner(repeating, repeating);
  own.diagonal().array() -= 1.0;  // their priors
  const Eigen::MatrixXd across = answer.to_globals * H.global.topRightCorner(globals, repeating) +
                                 answer.to_poses * H.pose_global.rightCols(repeating);
  return (2.0 * across + answer.to_repeating * own).cwiseProduct(answer.to_repeating).rowwise().sum();
}

// The same of the fine fields.
Eigen::VectorXd corners_with_fields(const SolvedEquations& solved, const Answer& answer) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(answer.to_poses.rows());
  Eigen::MatrixXd by_globals(answer.to_globals.rows(), answer.to_globals.cols() + answer.to_repeating.cols());
  by_globals << answer.to_globals, answer.to_repeating;
  for (std::size_t f = 0; f < answer.to_fields.size(); ++f) {
    const FieldEquations& field = solved.system.fields[f];
    const Eigen::MatrixXd& own = answer.to_fields[f];
    Eigen::MatrixXd by_own = own * field.own.selfadjointView<Eigen::Lower>();
    by_own -= own;  // their priors
    const Eigen::MatrixXd across = answer.to_poses * field.with_poses + by_globals * field.with_globals;
    sum += (2.0 * across + by_own).cwiseProduct(own).rowwise().sum();
  }
  return sum;
}

}  // namespace

void add_to_budget(const std::string& source, const Eigen::VectorXd& variances, std::vector<BudgetLine>* budget) {
  if (!(variances.maxCoeff() > 0.0)) return;
  const auto found =
      std::find_if(budget->begin(), budget->end(), [&source](const BudgetLine& line) { return line.source == source; });
  if (found == budget->end())
    budget->push_back({source, variances});
  else
    found->variances += variances;
}

std::vector<BudgetLine> budget_of(const Problem& problem, const State& state, const SolvedEquations& solved) {
  const Layout& layout = problem.layout();
  const Answer answer = answer_of(problem, state, solved);
  BudgetSink sink(answer.to_poses, answer.to_globals);
  problem.visit_blocks(state, Weighting::kInformation, &sink);
  std::vector<BudgetLine> budget;
  for (std::size_t g = 0; g < kGroupCount; ++g) {
    const auto group = static_cast<Group>(g);
    Eigen::VectorXd variances = sink.of(group);
    if (group == Group::kCorners)
      variances += corners_with_repeating(solved, answer) + corners_with_fields(solved, answer);
    add_to_budget(kSources[g], variances, &budget);
  }
  problem.for_each_prior([&](Nuisance nuisance, int place, const Eigen::MatrixXd& information) {
    const auto by_prior = answer.to_globals.middleCols(place, information.rows());
    add_to_budget(row_of(nuisance).source, (by_prior * information).cwiseProduct(by_prior).rowwise().sum(), &budget);
  });
  for (const PlaceError& error : problem.place_errors(state)) {
    const Eigen::MatrixXd by_place = answer.to_globals * error.by_globals(layout).transpose();
    add_to_budget("places of boards", (by_place * error.information()).cwiseProduct(by_place).rowwise().sum(), &budget);
  }
  Eigen::VectorXd of_repeating = answer.to_repeating.rowwise().squaredNorm();
  for (const Eigen::MatrixXd& field : answer.to_fields) of_repeating += field.rowwise().squaredNorm();
  add_to_budget("print and lens residual", of_repeating, &budget);
  return budget;
}

}  // namespace rigproof::ml
