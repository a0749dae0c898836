#include "start_misfit.h"

#include <cmath>
#include <utility>
#include <vector>

#include "rigproof/core/median.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::ml {

double start_misfit(const Preparation& prepared) {
  constexpr double kLeast = 1e-4;  // [m, rad]: nobody drives by less
  std::vector<double> ways, shifts, turns;
  const std::vector<Rigid3> odometry = odometry_poses(prepared.used);
  for (const int c : prepared.solved_cameras()) {
    const Rigid3& X = *prepared.guess.T_robot_camera[static_cast<std::size_t>(c)];
    for (const ViewPair& pair : consecutive_pairs(prepared.views, c)) {
      const Rigid3 seen = pair.from->T_camera_board * pair.to->T_camera_board.inverse();
      const Rigid3 told = odometry[static_cast<std::size_t>(pair.from->stop)].inverse() *
                          odometry[static_cast<std::size_t>(pair.to->stop)];
      const Vector6d apart = transform_error(X * seen * X.inverse(), told);
      ways.push_back(seen.translation.norm());
      shifts.push_back(apart.head<2>().norm());
      turns.push_back(std::abs(apart[5]));
    }
  }
  const double share = (kLeast + median(std::move(shifts))) / (kLeast + median(std::move(ways)));
  return 2.0 * std::log(share) + std::log(kLeast + median(std::move(turns)));
}

bool is_hopeless(double misfit, double as_is) {
  // Half of the way and half a radian, or four times as far apart as without the remedy. Of what left data in order
  // nothing came within a third of the former: see docs/measurements/refusals.md.
  const double most = 3.0 * std::log(0.5), worse = 3.0 * std::log(4.0);
  return misfit > most || misfit > as_is + worse;
}

}  // namespace rigproof::ml
