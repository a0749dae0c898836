#include "lasting_errors.h"

#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/lasting.h"

namespace rigproof::ml {
namespace {

// Of the solved cameras by the globals.
Eigen::MatrixXd chart_of_solved(const Preparation& prepared, const Fit& fit, const Layout& layout) {
  const Eigen::MatrixXd J = camera_chart(fit.state, layout);
  const std::vector<int> solved = prepared.solved_cameras();
  Eigen::MatrixXd chart(6 * static_cast<Eigen::Index>(solved.size()), J.cols());
  for (std::size_t i = 0; i < solved.size(); ++i)
    chart.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = J.middleRows<6>(6 * solved[i]);
  return chart;
}

std::vector<LastingErrors::FineGrid> fine_grids(const Preparation& prepared) {
  std::vector<LastingErrors::FineGrid> grids;
  for (std::size_t c = 0; c < prepared.repeating.fine.size(); ++c)
    for (const RemovedErrors::Fine::Grid& grid : prepared.repeating.fine[c].grids)
      grids.push_back({prepared.used.cameras[c].name, grid.cells, grid.sigma_px, grid.share});
  return grids;
}

}  // namespace

std::optional<LastingErrors> lasting_errors(const Preparation& prepared, const OdometryChoice& choice,
                                            const GlobalCovariance& globals, const Result& result) {
  const std::vector<LastingUnknown> unknowns = lasting_unknowns(prepared.used, prepared.priors);
  if (!result.joint_covariance || unknowns.empty()) return std::nullopt;
  const Layout layout = Layout::of(prepared.used, prepared.priors);
  const Eigen::VectorXd values = lasting_among_globals(choice.fit.state, layout);
  LastingErrors lasting;
  Eigen::MatrixXd chosen = Eigen::MatrixXd::Zero(layout.globals(), static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const LastingUnknown& unknown = unknowns[i];
    chosen(unknown.place, static_cast<Eigen::Index>(i)) = unknown.units_per_si;
    lasting.unknowns.push_back({unknown.of, unknown.name, unknown.units_per_si * values[unknown.place]});
  }
  const Eigen::MatrixXd with_all = globals.covariance * chosen;
  lasting.covariance = chosen.transpose() * with_all;
  // What the other odometry model adds to the cameras is taken as independent of these errors.
  const double share = choice.other ? choice.decision.probability : 1.0;
  lasting.with_cameras = share * chart_of_solved(prepared, choice.fit, layout) * with_all;
  lasting.fine_fields = fine_grids(prepared);
  lasting.stated = hashes_of_stated(prepared.original);
  return lasting;
}

}  // namespace rigproof::ml
