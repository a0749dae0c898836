// The joints of a URDF or xacro file with the places of their origins in its text, so that one can be changed and
// nothing else.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace rigproof::exporting {

/// An attribute as the file has it.
struct XmlAttribute {
  std::string value;
  std::size_t begin = 0, end = 0;  ///< of the value between its quotes, bytes of the text
};

struct UrdfJoint {
  std::string name, type, parent, child;
  int line = 0;
  std::size_t tag_end = 0;  ///< behind ">" of its start tag
  int origins = 0;          ///< how many <origin> it has
  std::size_t origin_name_end = 0;
  std::optional<XmlAttribute> xyz, rpy;
  bool has_macro = false;  ///< a xacro element inside: its origin may come from there
};

struct UrdfText {
  std::string file;  ///< for messages
  std::string text;
  std::vector<UrdfJoint> joints;   ///< in the order of the file
  std::vector<std::string> links;  ///< that are defined
  bool is_xacro = false;
};

/// Throws Error with file and line for what is no XML, no <robot>, or in an encoding that is not a superset of ASCII.
UrdfText parse_urdf(const std::string& text, const std::string& file);

/// True for ${..}, $(..).
bool has_expression(const std::string& text);

/// The text with new values in the <origin> of a joint, which is made where there is none.
std::string with_origin(const UrdfText& urdf, const UrdfJoint& joint, const std::string& xyz, const std::string& rpy);

}  // namespace rigproof::exporting
