// The command line of `record-check`.
#include "command_line.h"
#include "number_in.h"
#include "one_of.h"

namespace rigproof {

void add_record_check_command(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "record-check", "Tell of a drive, also while it is recorded, what it shows of the board",
                  "rigproof record-check monday_bag/ --follow", record_check_command);
  command
      ->add_option("SOURCE", arguments.source,
                   "A recording; a folder of images with a trajectory; or a bag: its folder, or a file .mcap or .db3")
      ->required();
  command->add_flag("-f,--follow", arguments.follow,
                    "Look again and again as it grows, until Ctrl-C: in place on a terminal, else a line a change");
  command
      ->add_option("--until-idle", arguments.until_idle_s,
                   "With --follow: end when nothing has changed for so many seconds")
      ->check(number_in(1.0, 86400.0));
  command
      ->add_option("--board", arguments.board,
                   "The board: as `rigproof boards` lists them, or a file; default a recording's, else as images show")
      ->type_name("BOARD");
  command->add_option("--squares", arguments.squares, "In place of --board: columns x rows of squares, e.g. 6x5");
  command->add_option(
      "--odometry", arguments.odometry,
      "Trajectory of a folder of images: odometry.csv, TUM, EuRoC or KITTI; default the only one in it");
  command
      ->add_option("--topic", arguments.topics,
                   "Where a guess is wrong, as `init` has it: CAMERA=/images, odometry=/odom; may be repeated")
      ->type_name("NAME=TOPIC");
  command
      ->add_option("--camera-info", arguments.camera_infos,
                   "Intrinsics from a file of camera_calibration, OpenCV or Kalibr (its camchain alone: of all "
                   "cameras); may be repeated")
      ->type_name("[CAMERA=]FILE");
  command
      ->add_option("--stamps", arguments.stamps,
                   "header: when images and poses were taken; log: when they were recorded, for clocks that differ")
      ->check(one_of({"header", "log"}))
      ->capture_default_str();
  add_common(command, arguments.common);
}

}  // namespace rigproof
