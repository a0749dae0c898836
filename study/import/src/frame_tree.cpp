#include "frame_tree.h"

#include <algorithm>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// tf2 takes "/base_link" for "base_link".
std::string bare(const std::string& frame) { return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame; }

}  // namespace

void FrameTree::add(const RosTransform& transform) {
  const std::string parent = bare(transform.header.frame_id), child = bare(transform.child_frame_id);
  const auto [place, is_new] = edges_.emplace(child, Edge{parent, transform.T_parent_child, ""});
  if (is_new) return;
  if (place->second.parent == parent)
    place->second.T_parent_child = transform.T_parent_child;  // the latest word counts, as in tf2
  else
    place->second.other_parent = parent;
}

bool FrameTree::has(const std::string& frame) const {
  const std::string name = bare(frame);
  return edges_.count(name) > 0 ||
         std::any_of(edges_.begin(), edges_.end(), [&name](const auto& edge) { return edge.second.parent == name; });
}

std::vector<std::string> FrameTree::way_up(const std::string& frame) const {
  std::vector<std::string> way = {bare(frame)};
  for (auto edge = edges_.find(way.back()); edge != edges_.end(); edge = edges_.find(way.back())) {
    if (!edge->second.other_parent.empty())
      throw Error("/tf_static: " + for_message(edge->first) + " has two parents, " + for_message(edge->second.parent) +
                  " and " + for_message(edge->second.other_parent) +
                  "; two nodes publish it, of which one must stop: record again, or leave the frames out with "
                  "`--robot-frame` of a frame that is not in the tree");
    const bool loops = std::find(way.begin(), way.end(), edge->second.parent) != way.end();
    way.push_back(edge->second.parent);
    if (loops) throw Error("/tf_static: frames go in a circle: " + for_message(joined(way, " -> "), 200));
  }
  return way;
}

Rigid3 FrameTree::T_root(const std::string& frame) const {
  Rigid3 T;
  for (const std::string& step : way_up(frame))
    if (const auto edge = edges_.find(step); edge != edges_.end()) T = edge->second.T_parent_child * T;
  return T;
}

std::optional<Rigid3> FrameTree::between(const std::string& target, const std::string& source) const {
  if (bare(target) == bare(source)) return Rigid3();
  if (way_up(target).back() != way_up(source).back()) return std::nullopt;
  return T_root(target).inverse() * T_root(source);
}

std::string FrameTree::mount_link(const std::string& optical, const std::vector<std::string>& robot_frames) const {
  const std::vector<std::string> way = way_up(optical);
  std::string last = way.front();
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (std::find(robot_frames.begin(), robot_frames.end(), way[i]) != robot_frames.end()) return last;
    if (ends_with(way[i], "_link")) return way[i];
    last = way[i];
  }
  return way.size() > 1 && robot_frames.empty() ? last : way.front();
}

}  // namespace rigproof
