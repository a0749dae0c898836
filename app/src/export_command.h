// `rigproof export`: what its command line is parsed into.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "commands.h"

namespace rigproof {

struct ExportArguments {
  CommonArguments common;
  std::filesystem::path result;  ///< a file, or a folder with only one
  std::string to;                ///< empty: urdf, for `into`
  std::filesystem::path into;    ///< an existing URDF or xacro file; empty = none
  std::filesystem::path output;  ///< empty = standard output, or `into` itself
  std::filesystem::path rig;     ///< empty = what lies beside the result
  std::string parent;            ///< empty = the result's
  std::optional<double> parent_height_mm;
  std::vector<std::string> cameras;
  // [CAMERA=]VALUE each:
  std::vector<std::string> links, opticals, joints;
  bool partial = false;
};
int export_command(const ExportArguments& arguments);

void add_export_command(CLI::App& app, Action& action);

}  // namespace rigproof
