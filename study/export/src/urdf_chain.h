// Links and joints of a URDF as a tree, and the chain of joints between two links.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/rigid3.h"
#include "urdf_text.h"

namespace rigproof::exporting {

/// Joints, as indices of UrdfText::joints, from a link up to the first that both have above them (child first), and
/// down from there to the other.
struct UrdfChain {
  std::vector<std::size_t> up, down;
};

/// A name without what xacro computes: "${prefix}camera_link" is "camera_link".
std::string plain_name(const std::string& name);

class UrdfTree {
 public:
  explicit UrdfTree(const UrdfText& urdf);

  /// The link of that name, or the only one that has it behind expressions of xacro.
  std::optional<std::string> find_link(const std::string& name) const;
  /// The same; throws Error that names the nearest, and links that sound like cameras.
  /// @param remedy what else to do, "--link names it"
  std::string link(const std::string& name, const std::string& remedy = "") const;
  /// By name. Throws Error that names the nearest.
  std::size_t joint(const std::string& name) const;
  /// Throws Error where there is none, at loops, several parents, links that nobody defines and joints that move.
  UrdfChain chain(const std::string& from, const std::string& to) const;
  /// Pose of the joint's child in its parent. Throws Error where it is no literal numbers (multiples of pi are read).
  Rigid3 T_parent_child(std::size_t joint) const;
  /// Of the chain from its beginning to its end. Throws as T_parent_child().
  Rigid3 T_of(const UrdfChain& chain) const;
  /// The link and all below it. `all_fixed` tells whether no joint among them moves.
  std::set<std::string> subtree(const std::string& link, bool* all_fixed) const;
  const UrdfText& urdf() const { return urdf_; }
  /// An Error that names file, line and joint.
  Error error_of(std::size_t joint, const std::string& message) const;

 private:
  std::vector<std::size_t> way_up(const std::string& link) const;
  void check_chain(const UrdfChain& chain, const std::string& from, const std::string& to) const;

  const UrdfText& urdf_;
  std::vector<std::string> links_;  ///< that are defined, or that a joint names
};

}  // namespace rigproof::exporting
