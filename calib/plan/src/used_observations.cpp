#include "used_observations.h"

#include <algorithm>

namespace rigproof {
namespace {

bool was_left_out(const Result& result, const BoardView& view) {
  const std::vector<Exclusion>& left_out = result.use[static_cast<std::size_t>(view.camera)].left_out;
  return std::any_of(left_out.begin(), left_out.end(),
                     [&view](const Exclusion& exclusion) { return exclusion.stop == view.stop && !exclusion.depth; });
}

}  // namespace

Observations without_places(Observations observations) {
  for (Board& board : observations.more_boards) board.place.reset();
  return observations;
}

Observations used_observations(const Result& result, const Observations& observations, const GroundCheck& ground) {
  const auto has_none = [&](const PlaneObservation& plane) {
    return result.find(observations.robot_frame, observations.cameras[static_cast<std::size_t>(plane.camera)].name) ==
           nullptr;
  };
  Observations used = without_places(observations);
  used.ground_planes = ground.planes(observations);
  for (auto* planes : {&used.ground_planes, &used.board_planes})
    planes->erase(std::remove_if(planes->begin(), planes->end(), has_none), planes->end());
  used.board_views.erase(std::remove_if(used.board_views.begin(), used.board_views.end(),
                                        [&result](const BoardView& view) { return was_left_out(result, view); }),
                         used.board_views.end());
  return used;
}

}  // namespace rigproof
