#include "rigproof/core/recording.h"

#include "frame_list.h"
#include "rigproof/core/files.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/core/rig_yaml.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

void read_odometry_key(MapReader& map, Rig* rig) {
  const YamlTree* odometry = map.find("odometry");
  if (odometry == nullptr) return;
  if (odometry->is_scalar()) {
    rig->odometry_file = odometry->scalar;
    return;
  }
  MapReader block(*odometry, "odometry", &map.problems());
  rig->odometry_file = block.text("file").value_or(rig->odometry_file);
  if (const YamlTree* noise = block.find("noise")) {
    MapReader noise_map(*noise, "odometry.noise", &map.problems());
    rig->odometry_noise = read_odometry_noise(noise_map);
    noise_map.finish();
  }
  block.finish();
}

Rig read_rig(const YamlTree& tree, const fs::path& folder, Problems* problems) {
  Rig rig;
  MapReader map(tree, "", problems);
  map.find("$schema");
  rig.name = map.text("name").value_or("");
  rig.robot_frame = map.text("robot_frame").value_or(rig.robot_frame);
  map.require("board", "{squares: [columns, rows], square_mm: side}");
  if (const YamlTree* board = map.find("board")) rig.board = read_board(*board, "board", problems);
  read_odometry_key(map, &rig);
  map.require("cameras", "a map of cameras by name");
  RigReadOptions options;
  options.folder = folder;
  if (const YamlTree* cameras = map.find("cameras"))
    rig.cameras = read_rig_cameras(*cameras, "cameras", options, problems);
  if (const YamlTree* accept = map.find("accept")) {
    MapReader accept_map(*accept, "accept", problems);
    rig.accept = read_accept_limits(accept_map);
    accept_map.finish();
  }
  for (const RigCamera& camera : rig.cameras)
    if (camera.name == rig.robot_frame)
      map.problem("robot_frame", "is the name of a camera, too; frames must have names of their own");
  map.finish("x-");
  return rig;
}

YamlTree tree_of(const Rig& rig) {
  YamlTree tree = YamlTree::map();
  if (!rig.name.empty()) tree.set("name", YamlTree::text(rig.name));
  tree.set("robot_frame", YamlTree::text(rig.robot_frame));
  tree.set("board", rigproof::tree_of(rig.board));
  YamlTree& odometry = tree.set("odometry", YamlTree::map());
  odometry.set("file", YamlTree::text(rig.odometry_file));
  odometry.set("noise", rigproof::tree_of(rig.odometry_noise));
  YamlTree& cameras = tree.set("cameras", YamlTree::map());
  for (const RigCamera& camera : rig.cameras) cameras.set(camera.name, rigproof::tree_of(camera));
  if (rig.accept) tree.set("accept", rigproof::tree_of(*rig.accept));
  return tree;
}

fs::path rig_file(const fs::path& folder) { return folder / "rig.yaml"; }

}  // namespace

Rig load_rig(const fs::path& file) {
  Problems problems;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  Rig rig = read_rig(read_yaml_file(file), folder, &problems);
  problems.sort();
  problems.throw_if_any();
  return rig;
}

void save_rig(const Rig& rig, const fs::path& file) { write_file_atomically(file, emit_yaml(tree_of(rig))); }

Recording load_recording(const fs::path& folder) {
  Recording recording;
  recording.folder = folder;
  Problems problems;
  recording.rig = read_rig(read_yaml_file(rig_file(folder)), folder, &problems);
  problems.sort();
  try {
    recording.odometry = read_odometry_csv(path_inside(folder, recording.rig.odometry_file), &problems);
  } catch (const Error& error) {
    problems.add({"", 0, "", "", error.what()});
  }
  for (const RigCamera& camera : recording.rig.cameras)
    recording.frames.push_back(list_frames(folder, camera, recording.odometry, &problems));
  problems.throw_if_any();
  return recording;
}

void save_recording(const Recording& recording) {
  const Rig& rig = recording.rig;
  if (recording.frames.size() != rig.cameras.size())
    throw Error("save_recording: " + std::to_string(recording.frames.size()) + " lists of frames for " +
                std::to_string(rig.cameras.size()) + " cameras");
  save_rig(rig, rig_file(recording.folder));
  write_file_atomically(path_inside(recording.folder, rig.odometry_file), odometry_csv(recording.odometry));
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const std::string& camera_folder = rig.cameras[i].folder;
    write_file_atomically(path_inside(recording.folder, camera_folder) / "frames.csv",
                          frames_csv(recording.frames[i], camera_folder));
  }
}

}  // namespace rigproof
