#include "export_told.h"

#include <cmath>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

struct Told {
  std::string camera, value;
};

// Where only one camera is exported it need not be named.
std::optional<std::string> single_camera(const ExportArguments& arguments, const Result& result) {
  if (arguments.cameras.size() == 1) return arguments.cameras.front();
  if (arguments.cameras.empty() && result.camera_to_robot.size() == 1) return result.camera_to_robot.front().child;
  return std::nullopt;
}

std::vector<Told> split(const std::vector<std::string>& values, const char* option,
                        const std::optional<std::string>& single, Problems* problems) {
  std::vector<Told> told;
  for (const std::string& value : values) {
    const std::size_t equals = value.find('=');
    if (equals == std::string::npos && !single)
      problems->add({"", 0, option, for_message(value), "is of which camera? Write CAMERA=" + for_message(value)});
    else if (equals + 1 == value.size() || value.empty())
      problems->add({"", 0, option, for_message(value), "names nothing"});
    else if (equals == std::string::npos)
      told.push_back({*single, value});
    else
      told.push_back({value.substr(0, equals), value.substr(equals + 1)});
  }
  return told;
}

// "X,Y,Z,QX,QY,QZ,QW"
std::optional<Rigid3> read_pose(const std::string& text, Problems* problems) {
  std::vector<double> numbers;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::optional<double> number = parse_number(text.substr(at, end - at));
    if (!number) break;
    numbers.push_back(*number);
    at = end + 1;
  }
  const bool seven = numbers.size() == 7;
  const Eigen::Quaterniond q =
      seven ? Eigen::Quaterniond(numbers[6], numbers[3], numbers[4], numbers[5]) : Eigen::Quaterniond::Identity();
  if (seven && std::abs(q.norm() - 1.0) <= 1e-3) return Rigid3(q, {numbers[0], numbers[1], numbers[2]});
  problems->add(
      {"", 0, "--optical", for_message(text),
       "must be the name of a frame, or seven numbers X,Y,Z,QX,QY,QZ,QW in metres and as a quaternion of norm 1"});
  return std::nullopt;
}

}  // namespace

ExportOptions export_options(const ExportArguments& arguments, const Result& result) {
  ExportOptions options;
  options.cameras = arguments.cameras;
  options.partial = arguments.partial;
  options.parent = arguments.parent;
  if (arguments.parent_height_mm) options.parent_height_m = 1e-3 * *arguments.parent_height_mm;
  Problems problems;
  if (arguments.parent_height_mm && arguments.parent.empty())
    problems.add({"", 0, "--parent-height-mm", "", "of which frame? Give --parent LINK, too"});
  const std::optional<std::string> single = single_camera(arguments, result);
  for (const Told& told : split(arguments.links, "--link", single, &problems)) options.links[told.camera] = told.value;
  for (const Told& told : split(arguments.joints, "--joint", single, &problems))
    options.joints[told.camera] = told.value;
  for (const Told& told : split(arguments.opticals, "--optical", single, &problems)) {
    if (told.value.find(',') == std::string::npos)
      options.optical_frames[told.camera] = told.value;
    else if (const auto T = read_pose(told.value, &problems))
      options.T_link_camera[told.camera] = *T;
  }
  problems.throw_if_any();
  return options;
}

}  // namespace rigproof
