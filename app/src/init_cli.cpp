// The command line of `init`.
#include "command_line.h"
#include "number_in.h"
#include "one_of.h"

namespace rigproof {

void add_init_command(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "init", "Make a recording out of a ROS 2 bag, or of images and a trajectory",
                  "rigproof init monday_bag/ --squares 6x5 --square-mm 110 -o monday", init_command);
  command
      ->add_option("SOURCE", arguments.source,
                   "A bag: its folder, or a file .mcap or .db3 (also .zstd); or a folder of images with a trajectory")
      ->required();
  command->add_option("-o,--output", arguments.output, "Folder of the recording, a new one")->required();
  command->add_option("--board", arguments.board, "The board: as `rigproof boards` lists them, or a file")
      ->type_name("BOARD");
  command->add_option("--squares", arguments.squares, "In place of --board: columns x rows of squares, e.g. 6x5");
  command->add_option("--square-mm", arguments.square_mm, "Side of a square, measured")->check(number_in(1.0, 1000.0));
  command->add_option(
      "--odometry", arguments.odometry,
      "Trajectory of a folder of images: odometry.csv, TUM, EuRoC or KITTI; default the only one in it");
  command
      ->add_option("--topic", arguments.topics,
                   "Where a guess is wrong: CAMERA=/images, CAMERA.depth=/depth, CAMERA.camera_info=/info, "
                   "odometry=/odom; none leaves it out (tf_static=none: the robot's frames); may be repeated")
      ->type_name("NAME=TOPIC");
  command
      ->add_option("--camera-info", arguments.camera_infos,
                   "Intrinsics from a file of camera_calibration, OpenCV or Kalibr (its camchain alone: of all "
                   "cameras; calibrate compares how they stand to each other); may be repeated")
      ->type_name("[CAMERA=]FILE");
  command
      ->add_option("--sensor", arguments.sensors,
                   "What measures depth, as `rigproof sensors` lists them, for one camera or for all; may be repeated")
      ->type_name("[CAMERA=]SENSOR");
  command->add_option("--robot-frame", arguments.robot_frame,
                      "Frame on the ground that results are given in; default base_footprint");
  command
      ->add_option("--stamps", arguments.stamps,
                   "header: when images and poses were taken; log: when they were recorded, for clocks that differ")
      ->check(one_of({"header", "log"}))
      ->capture_default_str();
  command->add_flag("--every-image", arguments.every_image,
                    "Keep every image, also those taken while the robot moves; default: a few of each stop");
  command->add_option("--images-per-stop", arguments.images_per_stop, "How many of each stop and camera")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_jobs(command, arguments.common, "Threads for looking at boards; 0 = one for each core");
  add_common(command, arguments.common);
}

}  // namespace rigproof
