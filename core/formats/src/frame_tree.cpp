#include "rigproof/formats/frame_tree.h"

#include <algorithm>
#include <set>

#include "rigproof/core/error.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// tf2 takes "/base_link" for "base_link".
std::string bare(const std::string& frame) { return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame; }

const std::string kWithout = "`init --topic tf_static=none`";

struct Transform {
  std::string parent, child;
  Rigid3 T_parent_child;

  void visit(FieldVisitor& visitor) {
    visitor.on_one_line();
    visitor.require("parent", "a frame");
    visitor.field("parent", parent, TextChoices{}, "frame");
    visitor.require("child", "a frame");
    visitor.field("child", child, TextChoices{}, "frame that has no other parent");
    visit_pose(visitor, T_parent_child);
  }
};

void visit_transforms(FieldVisitor& visitor, std::vector<Transform>& transforms) {
  visitor.nested_list("transforms", transforms, "poses of frames in their parents");
}

}  // namespace

void FrameTree::add(const std::string& parent, const std::string& child, const Rigid3& T_parent_child) {
  const auto [place, is_new] = edges_.emplace(bare(child), Edge{bare(parent), T_parent_child, ""});
  if (is_new) return;
  if (place->second.parent == bare(parent))
    place->second.T_parent_child = T_parent_child;
  else
    place->second.other_parent = bare(parent);
}

void FrameTree::leave_out(const std::string& child, const std::string& why) { left_out_.emplace(bare(child), why); }

std::vector<std::string> FrameTree::left_out() const {
  std::vector<std::string> texts;
  for (const auto& [child, why] : left_out_)
    if (edges_.count(child) == 0) texts.push_back(for_message(child) + ": " + why);
  return texts;
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
      throw Error(
          "/tf_static: " + for_message(edge->first) + " has two parents, " + for_message(edge->second.parent) +
          " and " + for_message(edge->second.other_parent) +
          "; two nodes publish it, of which one must stop. Record again, or do without the frames: " + kWithout);
    const bool loops = std::find(way.begin(), way.end(), edge->second.parent) != way.end();
    way.push_back(edge->second.parent);
    if (loops)
      throw Error("/tf_static: frames go in a circle: " + for_message(joined(way, " -> "), 200) +
                  ". Record again without the node that closes it, or do without the frames: " + kWithout);
  }
  if (const auto bad = left_out_.find(way.back()); bad != left_out_.end())
    throw Error("/tf_static: " + for_message(bad->first) + ": " + bad->second +
                ". Record again with that mended, or do without the frames: " + kWithout);
  return way;
}

Rigid3 FrameTree::T_above(const std::string& above, const std::string& frame) const {
  Rigid3 T;
  for (std::string step = frame; step != above;) {
    const Edge& edge = edges_.at(step);
    T = edge.T_parent_child * T;
    step = edge.parent;
  }
  return T;
}

std::optional<Rigid3> FrameTree::between(const std::string& target, const std::string& source) const {
  const std::vector<std::string> way_target = way_up(target), way_source = way_up(source);
  // By way of the first frame above both, so that what is above that adds no rounding.
  const auto common = std::find_first_of(way_target.begin(), way_target.end(), way_source.begin(), way_source.end());
  if (common == way_target.end()) return std::nullopt;
  return T_above(*common, way_target.front()).inverse() * T_above(*common, way_source.front());
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

std::optional<std::string> FrameTree::ground_frame(const std::string& frame) const {
  for (const std::string& name : frames())
    if (name.find("footprint") != std::string::npos && between(name, frame)) return name;
  return std::nullopt;
}

std::vector<std::string> FrameTree::frames() const {
  std::set<std::string> names;
  for (const auto& [child, edge] : edges_) names.insert({child, edge.parent});
  return {names.begin(), names.end()};
}

bool is_optical_name(const std::string& frame) { return frame.find("optical") != std::string::npos; }

std::string optical_frame_name(const std::string& camera, const std::string& link, const std::string& optical_frame) {
  if (!optical_frame.empty()) return optical_frame;
  if (link.empty() || link == camera || is_optical_name(link)) return link.empty() ? camera : link;
  std::string stem = link;
  for (const std::string end : {"_link", "_frame"})
    if (stem.size() > end.size() && ends_with(stem, end)) stem.resize(stem.size() - end.size());
  return stem + "_optical_frame";
}

std::string frame_tree_text(const FrameTree& tree) {
  std::vector<Transform> transforms;
  for (const auto& [child, edge] : tree.edges()) transforms.push_back({edge.parent, child, edge.T_parent_child});
  return emit_json(tree_of_fields([&](FieldVisitor& visitor) { visit_transforms(visitor, transforms); }), 1) + "\n";
}

FrameTree load_frame_tree(const std::filesystem::path& file) {
  std::vector<Transform> transforms;
  read_fields_of_tree(read_yaml_file(file), [&](FieldVisitor& visitor) { visit_transforms(visitor, transforms); });
  FrameTree tree;
  for (const Transform& transform : transforms) tree.add(transform.parent, transform.child, transform.T_parent_child);
  return tree;
}

}  // namespace rigproof
