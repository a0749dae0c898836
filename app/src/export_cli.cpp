// The command line of `export`.
#include <algorithm>

#include "command_line.h"
#include "export_command.h"
#include "number_in.h"
#include "rigproof/core/text.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

std::string formats_in_words() {
  std::string text = "Formats:\n";
  for (const ExportFormat& format : export_formats()) {
    const std::string name = "  " + format.name;
    text += name + std::string(14 - std::min<std::size_t>(13, name.size()), ' ') + format.what + "\n";
  }
  return text;
}

void add_frames(CLI::App* command, ExportArguments& arguments) {
  command
      ->add_option("--parent", arguments.parent,
                   "The frame of the robot's tree to give poses in; where tf_static.json beside the rig does not have "
                   "it, another name of the robot frame of the result; default that frame")
      ->type_name("LINK");
  command
      ->add_option("--parent-height-mm", arguments.parent_height_mm,
                   "How high the frame of --parent stands above the ground, where tf_static.json does not say")
      ->check(number_in(-10000.0, 10000.0));
  command
      ->add_option("--link", arguments.links,
                   "Link of a camera in the robot's tree of frames; default `link` of the rig, else the camera's name. "
                   "CAMERA= may be left out for a single one")
      ->type_name("[CAMERA=]LINK");
  command
      ->add_option(
          "--optical", arguments.opticals,
          "The optical frame of a camera: its name in the URDF of --into; or its pose in the link, as `tf2_echo "
          "LINK FRAME` prints it: X,Y,Z,QX,QY,QZ,QW; default `optical_frame` and `T_link_camera` of the rig")
      ->type_name("[CAMERA=]FRAME");
  command
      ->add_option("--joint", arguments.joints,
                   "The joint that --into changes; default the one into the camera's link, or the one that holds the "
                   "device of its optical frame")
      ->type_name("[CAMERA=]JOINT");
}

}  // namespace

void add_export_command(CLI::App& app, Action& action) {
  const auto [command, arguments] = add_command(
      app, action, "export", "Write a result for TF, URDF, Kalibr, OpenCV and others, or into a robot's URDF",
      "rigproof export monday/results/ml.yaml --into robot.urdf", export_command, formats_in_words());
  command->add_option("RESULT", arguments.result, "A result, or a folder that holds only one")->required();
  command->add_option("--to", arguments.to, "What to write; default urdf, with --into")
      ->type_name("FORMAT:{" + joined(export_format_names(), ",") + "}");
  command->add_option(
      "--into", arguments.into,
      "Change the origin of each camera's joint in this URDF or xacro file, and not another byte of it");
  command->add_option("-o,--output", arguments.output,
                      "File; what is there is kept as FILE.bak. A folder where there are several. Default standard "
                      "output, with --into that file itself");
  command->add_option("--camera", arguments.cameras, "Only this one; may be repeated");
  command->add_option("--rig", arguments.rig,
                      "A rig.yaml, or a run, recording or observations with it; default what lies beside the result");
  add_frames(command, arguments);
  command->add_flag("--partial", arguments.partial, "Export what is known of a partial result");
  add_common(command, arguments.common);
}

}  // namespace rigproof
