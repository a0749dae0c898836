#include "urdf_text.h"

#include <algorithm>
#include <cstring>
#include <pugixml.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof::exporting {
namespace {

constexpr const char* kSpace = " \t\r\n";

int line_of(const std::string& text, std::size_t offset) {
  return 1 + static_cast<int>(std::count(
                 text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size())), '\n'));
}

Error error_at(const std::string& file, int line, const std::string& message) {
  return Error(Problem{file, line, "", "", message}.text());
}

// The parser has seen the text: names, quotes and the end of the tag are there.
std::size_t tag_end(const std::string& text, std::size_t name_end) {
  char quote = 0;
  for (std::size_t i = name_end; i < text.size(); ++i) {
    if (quote != 0)
      quote = text[i] == quote ? '\0' : quote;
    else if (text[i] == '"' || text[i] == '\'')
      quote = text[i];
    else if (text[i] == '>')
      return i + 1;
  }
  return text.size();
}

std::optional<XmlAttribute> find_attribute(const std::string& text, std::size_t name_end, const std::string& name) {
  const std::size_t end = tag_end(text, name_end);
  std::size_t at = text.find_first_not_of(kSpace, name_end);
  while (at < end && text[at] != '>' && text[at] != '/') {
    const std::size_t equals = text.find('=', at), open = text.find_first_of("\"'", equals);
    const std::size_t close = text.find(text[open], open + 1);
    std::string key = text.substr(at, equals - at);
    key.erase(key.find_last_not_of(kSpace) + 1);
    if (key == name) return XmlAttribute{text.substr(open + 1, close - open - 1), open + 1, close};
    at = text.find_first_not_of(kSpace, close + 1);
  }
  return std::nullopt;
}

std::size_t name_end_of(const pugi::xml_node& node) {
  return static_cast<std::size_t>(node.offset_debug()) + std::strlen(node.name());
}

bool is_xacro_name(const char* name) { return std::strncmp(name, "xacro:", 6) == 0; }

UrdfJoint read_joint(const pugi::xml_node& node, const std::string& text) {
  UrdfJoint joint;
  joint.name = node.attribute("name").value();
  joint.type = node.attribute("type").value();
  joint.parent = node.child("parent").attribute("link").value();
  joint.child = node.child("child").attribute("link").value();
  joint.line = line_of(text, static_cast<std::size_t>(node.offset_debug()));
  joint.tag_end = tag_end(text, name_end_of(node));
  for (const pugi::xml_node& child : node.children()) {
    joint.has_macro = joint.has_macro || is_xacro_name(child.name());
    if (std::strcmp(child.name(), "origin") != 0) continue;
    ++joint.origins;
    joint.origin_name_end = name_end_of(child);
    joint.xyz = find_attribute(text, joint.origin_name_end, "xyz");
    joint.rpy = find_attribute(text, joint.origin_name_end, "rpy");
  }
  return joint;
}

// Joints of the robot stand in <robot>, in xacro also in macros and conditions. What else is called so, in
// <transmission> or <gazebo>, only names one.
void read_elements(const pugi::xml_node& robot, UrdfText* urdf) {
  std::vector<pugi::xml_node> open = {robot};
  while (!open.empty()) {
    const pugi::xml_node parent = open.back();
    open.pop_back();
    for (const pugi::xml_node& node : parent.children()) {
      if (node.type() != pugi::node_element) continue;
      if (std::strcmp(node.name(), "joint") == 0) urdf->joints.push_back(read_joint(node, urdf->text));
      if (std::strcmp(node.name(), "link") == 0) urdf->links.emplace_back(node.attribute("name").value());
      if (!is_xacro_name(node.name())) continue;
      urdf->is_xacro = true;
      open.push_back(node);
    }
  }
  std::sort(urdf->joints.begin(), urdf->joints.end(),
            [](const UrdfJoint& a, const UrdfJoint& b) { return a.tag_end < b.tag_end; });
}

void check_encoding(const std::string& text, const std::string& file) {
  const bool wide =
      text.size() >= 2 && ((text[0] == '\xff' && text[1] == '\xfe') || (text[0] == '\xfe' && text[1] == '\xff'));
  if (wide || text.find('\0') != std::string::npos)
    throw Error(file + ": is not in UTF-8 or another encoding that continues ASCII; save it as UTF-8");
}

}  // namespace

bool has_expression(const std::string& text) {
  return text.find("${") != std::string::npos || text.find("$(") != std::string::npos;
}

UrdfText parse_urdf(const std::string& text, const std::string& file) {
  check_encoding(text, file);
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
    throw error_at(file, line_of(text, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, result.offset))),
                   "is no XML: " + std::string(result.description()));
  const pugi::xml_node root = document.document_element();
  if (std::strcmp(root.name(), "robot") != 0)
    throw error_at(file, line_of(text, static_cast<std::size_t>(root.offset_debug())),
                   "the outermost element is <" + for_message(root.name()) + ">; a URDF or xacro file has <robot>");
  UrdfText urdf;
  urdf.file = file;
  urdf.text = text;
  read_elements(root, &urdf);
  return urdf;
}

namespace {

struct Edit {
  std::size_t begin, end;
  std::string text;
};

// Where the joint's first child stands: a new sibling before it is indented alike.
std::string whitespace_before_first_child(const UrdfText& urdf, const UrdfJoint& joint) {
  const std::size_t child = urdf.text.find_first_not_of(kSpace, joint.tag_end);
  const std::string space = urdf.text.substr(joint.tag_end, child - joint.tag_end);
  const std::size_t last_line = space.find_last_of('\n');
  if (last_line == std::string::npos) return "";
  const std::size_t begin = last_line > 0 && space[last_line - 1] == '\r' ? last_line - 1 : last_line;
  return space.substr(begin);
}

}  // namespace

std::string with_origin(const UrdfText& urdf, const UrdfJoint& joint, const std::string& xyz, const std::string& rpy) {
  std::vector<Edit> edits;
  if (joint.origins == 0) {
    edits.push_back({joint.tag_end, joint.tag_end,
                     whitespace_before_first_child(urdf, joint) + "<origin xyz=\"" + xyz + "\" rpy=\"" + rpy + "\"/>"});
  } else {
    std::string missing;
    if (!joint.xyz) missing += " xyz=\"" + xyz + "\"";
    if (!joint.rpy) missing += " rpy=\"" + rpy + "\"";
    edits.push_back({joint.origin_name_end, joint.origin_name_end, missing});
    if (joint.xyz) edits.push_back({joint.xyz->begin, joint.xyz->end, xyz});
    if (joint.rpy) edits.push_back({joint.rpy->begin, joint.rpy->end, rpy});
  }
  // From the end, so that places before stay where they are.
  std::sort(edits.begin(), edits.end(), [](const Edit& a, const Edit& b) { return a.begin > b.begin; });
  std::string text = urdf.text;
  for (const Edit& edit : edits) text.replace(edit.begin, edit.end - edit.begin, edit.text);
  return text;
}

}  // namespace rigproof::exporting
