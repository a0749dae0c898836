#include "mjcf_text.h"

#include <locale>
#include <sstream>

namespace rigproof {

std::string numbers(std::initializer_list<double> values) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  const char* separator = "";
  for (const double value : values) {
    text << separator << value;
    separator = " ";
  }
  return text.str();
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"')
      out += "&quot;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else
      out += c;
  }
  return out + '"';
}

std::string pose_attributes(const Rigid3& T) {
  const Eigen::Vector3d& t = T.translation;
  const Eigen::Quaterniond& q = T.rotation;
  return "pos=" + quoted(numbers({t.x(), t.y(), t.z()})) + " quat=" + quoted(numbers({q.w(), q.x(), q.y(), q.z()}));
}

}  // namespace rigproof
