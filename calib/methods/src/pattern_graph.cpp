#include "pattern_graph.h"

#include <algorithm>
#include <map>
#include <optional>

namespace rigproof::rivals {
namespace {

class TreeGrower {
 public:
  TreeGrower(const Observations& observations, const std::vector<ViewPose>& views)
      : observations_(observations), views_(views), camera_pose_(observations.cameras.size()) {}

  std::vector<PatternPart> grow() {
    std::vector<PatternPart> parts;
    for (std::size_t k = 0; k < camera_pose_.size(); ++k) {
      const int camera = static_cast<int>(k);
      const bool sees =
          std::any_of(views_.begin(), views_.end(), [&](const ViewPose& v) { return v.camera == camera; });
      if (sees && !camera_pose_[k]) parts.push_back(grow_from(camera));
    }
    return parts;
  }

 private:
  bool knows_camera(const ViewPose& view) const {
    return camera_pose_[static_cast<std::size_t>(view.camera)].has_value();
  }
  bool knows_stop(const ViewPose& view) const { return board_pose_.count(view.stop) > 0; }

  std::size_t corners(const ViewPose& view) const {
    return observations_.board_views[static_cast<std::size_t>(view.view)].corners.size();
  }
  bool better(const ViewPose& a, const ViewPose& b) const {
    if (corners(a) != corners(b)) return corners(a) > corners(b);
    return a.covariance.trace() < b.covariance.trace();
  }

  // The best edge between what is reached and what is not (Prim). What an earlier part reached has none to a new one,
  // or they would be one part.
  const ViewPose* next_edge() const {
    const ViewPose* best = nullptr;
    for (const ViewPose& view : views_)
      if (knows_camera(view) != knows_stop(view) && (best == nullptr || better(view, *best))) best = &view;
    return best;
  }

  PatternPart grow_from(int root) {
    PatternPart part;
    part.cameras.push_back(root);
    part.T_camera_root.emplace_back();
    camera_pose_[static_cast<std::size_t>(root)] = Rigid3();
    while (const ViewPose* edge = next_edge()) {
      if (knows_camera(*edge)) {
        const Rigid3& T_camera_root = *camera_pose_[static_cast<std::size_t>(edge->camera)];
        const Rigid3 T_root_board = T_camera_root.inverse() * edge->T_camera_board;
        board_pose_[edge->stop] = T_root_board;
        part.stops.push_back(edge->stop);
        part.T_root_board.push_back(T_root_board);
      } else {
        const Rigid3 T_camera_root = edge->T_camera_board * board_pose_.at(edge->stop).inverse();
        camera_pose_[static_cast<std::size_t>(edge->camera)] = T_camera_root;
        part.cameras.push_back(edge->camera);
        part.T_camera_root.push_back(T_camera_root);
      }
    }
    return part;
  }

  const Observations& observations_;
  const std::vector<ViewPose>& views_;
  std::vector<std::optional<Rigid3>> camera_pose_;
  std::map<int, Rigid3> board_pose_;
};

}  // namespace

std::vector<PatternPart> pattern_parts(const Observations& observations, const std::vector<ViewPose>& views) {
  return TreeGrower(observations, views).grow();
}

}  // namespace rigproof::rivals
