#include "urdf_chain.h"

#include <algorithm>
#include <array>

#include "numbers.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"

namespace rigproof::exporting {
namespace {

bool is_fixed(const UrdfJoint& joint) { return joint.type == "fixed"; }

// What files write that have optical frames: ${pi/2}, ${-M_PI}, ${0.1}.
std::optional<double> constant(std::string expression) {
  expression.erase(std::remove(expression.begin(), expression.end(), ' '), expression.end());
  double scale = 1.0;
  if (!expression.empty() && expression.front() == '-') scale = -1.0, expression.erase(0, 1);
  for (const char* const half : {"/2.0", "/2", "*0.5"})
    if (const std::string end = half;
        expression.size() > end.size() && expression.compare(expression.size() - end.size(), end.size(), end) == 0) {
      expression.resize(expression.size() - end.size());
      scale *= 0.5;
      break;
    }
  if (expression == "pi" || expression == "M_PI" || expression == "math.pi") return scale * kPi;
  const std::optional<double> number = parse_number(expression);
  return number ? std::optional<double>(scale * *number) : std::nullopt;
}

// With constants in place of their expressions; nothing where there are others.
std::optional<std::string> without_expressions(std::string text) {
  for (std::size_t at = text.find("${"); at != std::string::npos; at = text.find("${")) {
    const std::size_t end = text.find('}', at);
    if (end == std::string::npos) return std::nullopt;
    const std::optional<double> value = constant(text.substr(at + 2, end - at - 2));
    if (!value) return std::nullopt;
    text.replace(at, end - at + 1, number_text(*value));
  }
  return text.find("$(") == std::string::npos ? std::optional<std::string>(text) : std::nullopt;
}

std::optional<Eigen::Vector3d> three_numbers(const std::optional<XmlAttribute>& attribute) {
  if (!attribute) return Eigen::Vector3d::Zero();
  const std::optional<std::string> text = without_expressions(attribute->value);
  if (!text) return std::nullopt;
  Eigen::Vector3d values;
  std::size_t at = 0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const std::size_t begin = text->find_first_not_of(" \t\r\n", at);
    if (begin == std::string::npos) return std::nullopt;
    at = std::min(text->find_first_of(" \t\r\n", begin), text->size());
    const std::optional<double> value = parse_number(text->substr(begin, at - begin));
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return text->find_first_not_of(" \t\r\n", at) == std::string::npos ? std::optional<Eigen::Vector3d>(values)
                                                                     : std::nullopt;
}

// "; did you mean "x"?; links of cameras there: ..."
std::string link_suggestion(const std::string& name, const std::vector<std::string>& links) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> plain, of_cameras;
  for (const std::string& link : links) {
    plain.push_back(plain_name(link));
    if (link.find("optical") != std::string::npos) of_cameras.push_back(for_message(link));
  }
  if (of_cameras.empty())
    for (const std::string& link : links)
      if (link.find("cam") != std::string::npos) of_cameras.push_back(for_message(link));
  std::string text;
  if (const auto near = nearest_name(name, plain)) text = "; did you mean \"" + for_message(*near) + "\"?";
  const std::size_t more = of_cameras.size() > kMost ? of_cameras.size() - kMost : 0;
  of_cameras.resize(of_cameras.size() - more);
  if (of_cameras.empty()) return text;
  return text + (text.empty() ? "; l" : " L") + "inks of cameras there: " + joined(of_cameras) +
         (more > 0 ? " and " + std::to_string(more) + " more" : "");
}

}  // namespace

std::string plain_name(const std::string& name) {
  std::string plain;
  for (std::size_t at = 0; at < name.size(); ++at) {
    const bool opens = name[at] == '$' && at + 1 < name.size() && (name[at + 1] == '{' || name[at + 1] == '(');
    const std::size_t end = opens ? name.find(name[at + 1] == '{' ? '}' : ')', at) : std::string::npos;
    if (end == std::string::npos)
      plain += name[at];
    else
      at = end;
  }
  return plain;
}

UrdfTree::UrdfTree(const UrdfText& urdf) : urdf_(urdf) {
  std::set<std::string> names(urdf.links.begin(), urdf.links.end());
  for (const UrdfJoint& joint : urdf.joints) names.insert(joint.parent), names.insert(joint.child);
  names.erase("");
  links_.assign(names.begin(), names.end());
}

Error UrdfTree::error_of(std::size_t joint, const std::string& message) const {
  const UrdfJoint& of = urdf_.joints[joint];
  return Error(Problem{urdf_.file, of.line, "joint " + for_message(of.name), "", message}.text());
}

std::optional<std::string> UrdfTree::find_link(const std::string& name) const {
  std::optional<std::string> found;
  for (const std::string& link : links_) {
    if (link == name) return link;
    if (plain_name(link) != name) continue;
    if (found) return std::nullopt;
    found = link;
  }
  return found;
}

std::string UrdfTree::link(const std::string& name, const std::string& remedy) const {
  if (const auto found = find_link(name)) return *found;
  throw Error(urdf_.file + ": has no link " + for_message(name) + (remedy.empty() ? "" : "; " + remedy) +
              link_suggestion(name, links_));
}

std::size_t UrdfTree::joint(const std::string& name) const {
  std::vector<std::size_t> exact, plain;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < urdf_.joints.size(); ++i) {
    const std::string& here = urdf_.joints[i].name;
    if (here == name) exact.push_back(i);
    if (plain_name(here) == name) plain.push_back(i);
    names.push_back(plain_name(here));
  }
  const std::vector<std::size_t>& found = exact.empty() ? plain : exact;
  if (found.size() == 1) return found.front();
  const auto near = found.empty() ? nearest_name(name, names) : std::nullopt;
  throw Error(urdf_.file + ": has " + (found.empty() ? "no" : "several") + " joint" + (found.empty() ? " " : "s ") +
              for_message(name) + (near ? "; did you mean \"" + for_message(*near) + "\"?" : ""));
}

std::vector<std::size_t> UrdfTree::way_up(const std::string& link) const {
  std::vector<std::size_t> way;
  std::set<std::string> seen = {link};
  for (std::string at = link;;) {
    std::vector<std::size_t> above;
    for (std::size_t i = 0; i < urdf_.joints.size(); ++i)
      if (urdf_.joints[i].child == at) above.push_back(i);
    if (above.empty()) return way;
    if (above.size() > 1)
      throw error_of(above[1], "link " + for_message(at) + " is the child of joint " +
                                   for_message(urdf_.joints[above[0]].name) + " (line " +
                                   std::to_string(urdf_.joints[above[0]].line) +
                                   "), too; a link has one parent, remove one of them");
    way.push_back(above.front());
    at = urdf_.joints[above.front()].parent;
    if (!seen.insert(at).second)
      throw error_of(above.front(), "closes a loop: link " + for_message(at) + " is above itself");
  }
}

void UrdfTree::check_chain(const UrdfChain& chain, const std::string& from, const std::string& to) const {
  for (const auto* part : {&chain.up, &chain.down})
    for (const std::size_t i : *part) {
      const UrdfJoint& joint = urdf_.joints[i];
      if (!is_fixed(joint))
        throw error_of(i, "is " + (joint.type.empty() ? "of no type" : for_message(joint.type)) +
                              ", and every joint between " + for_message(from) + " and " + for_message(to) +
                              " must be fixed: how it stood during the calibration is not in the file. Hold it still "
                              "while you calibrate, and write it as fixed at that angle in a copy of the file");
      for (const std::string& link : {joint.parent, joint.child})
        if (!urdf_.is_xacro && std::find(urdf_.links.begin(), urdf_.links.end(), link) == urdf_.links.end())
          throw error_of(i, "names the link " + (link.empty() ? "\"\"" : for_message(link)) + ", which is not defined");
    }
}

UrdfChain UrdfTree::chain(const std::string& from, const std::string& to) const {
  UrdfChain chain{way_up(from), way_up(to)};
  // What both have above them is no part of the chain.
  while (!chain.up.empty() && !chain.down.empty() && chain.up.back() == chain.down.back()) {
    chain.up.pop_back();
    chain.down.pop_back();
  }
  const auto top = [this](const std::vector<std::size_t>& way, const std::string& link) {
    return way.empty() ? link : urdf_.joints[way.back()].parent;
  };
  const std::string above_from = top(chain.up, from), above_to = top(chain.down, to);
  if (above_from != above_to)
    throw Error(urdf_.file + ": no joints lead from " + for_message(from) + " to " + for_message(to) +
                ": they hang in trees of their own, below " + for_message(above_from) + " and below " +
                for_message(above_to));
  std::reverse(chain.down.begin(), chain.down.end());
  check_chain(chain, from, to);
  return chain;
}

Rigid3 UrdfTree::T_parent_child(std::size_t index) const {
  const UrdfJoint& joint = urdf_.joints[index];
  if (joint.origins > 1) throw error_of(index, "has several origins");
  const auto xyz = three_numbers(joint.xyz), rpy = three_numbers(joint.rpy);
  if (xyz && rpy && !(joint.origins == 0 && joint.has_macro)) return UrdfPose{*xyz, *rpy}.transform();
  const std::string shown = (!xyz ? "xyz=\"" + joint.xyz->value : !rpy ? "rpy=\"" + joint.rpy->value : "") + "\"";
  const bool computed = (xyz && rpy) || has_expression(shown);
  throw error_of(index, computed ? "its origin is computed" + (xyz && rpy ? "" : " (" + for_message(shown) + ")") +
                                       "; expand the file first (`xacro robot.urdf.xacro > robot.urdf`) and export "
                                       "into that"
                                 : "its origin has " + for_message(shown) + "; three numbers are expected");
}

Rigid3 UrdfTree::T_of(const UrdfChain& chain) const {
  Rigid3 T;
  for (const std::size_t i : chain.up) T = T * T_parent_child(i).inverse();
  for (const std::size_t i : chain.down) T = T * T_parent_child(i);
  return T;
}

std::set<std::string> UrdfTree::subtree(const std::string& link, bool* all_fixed) const {
  std::set<std::string> links = {link};
  std::vector<std::string> open = {link};
  *all_fixed = true;
  while (!open.empty()) {
    const std::string at = open.back();
    open.pop_back();
    for (const UrdfJoint& joint : urdf_.joints) {
      if (joint.parent != at) continue;
      *all_fixed = *all_fixed && is_fixed(joint);
      if (links.insert(joint.child).second) open.push_back(joint.child);
    }
  }
  return links;
}

}  // namespace rigproof::exporting
