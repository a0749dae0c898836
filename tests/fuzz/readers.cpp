#include "readers.h"

#include "external_matrices.h"
#include "memroc_sample.h"
#include "rig_files.h"
#include "rigproof/bags/bag.h"
#include "rigproof/bags/messages.h"
#include "rigproof/calib/diagnose/ml_settings.h"
#include "rigproof/calib/plan/accept.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/error.h"
#include "rigproof/core/observations_text.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/result.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/formats/format.h"
#include "rigproof/formats/frame_tree.h"
#include "rigproof/formats/trajectory.h"
#include "rigproof/generator/config.h"
#include "rigproof/sim/models.h"
#include "rigproof/study/sweep/config.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/truth/truth.h"
#include "rigproof/validate/budget.h"
#include "ros_cloud.h"
#include "ros_pictures.h"
#include "rvl.h"
#include "urdf_text.h"

namespace rigproof::fuzz {
namespace {

namespace fs = std::filesystem;

template <typename Value>
void require_readable(const std::variant<Value, Unreadable>& value) {
  if (const auto* why_not = std::get_if<Unreadable>(&value)) throw Error(why_not->reason);
}

std::vector<std::uint8_t> as_bytes(const std::string& text) { return {text.begin(), text.end()}; }

void read_odometry(const std::string&, const fs::path& file) {
  Problems problems;
  read_odometry_csv(file, &problems);
  problems.throw_if_any();
}

void read_bag(const std::string&, const fs::path& file) {
  Bag bag(file, file.parent_path() / "unpacked");
  bag.read([](const BagTopic&) { return true; }, [](const BagMessage&) {});
}

using ReadMessage = std::function<void(std::string_view)>;

template <bool kIsDepth>
void make_picture(const char* type, std::string_view message) {
  kind_of_picture(type, "/camera/image_raw", message);
  PictureMaker maker;
  if (kIsDepth) {
    maker.depth(type, message, 0.001);
  } else {
    maker.color(type, message);
  }
}

// The first byte says which of them the others are.
void read_message(const std::string& bytes, const fs::path&) {
  static const std::vector<ReadMessage> kKinds = {
      [](auto message) { make_picture<false>(kImageType, message); },
      [](auto message) { make_picture<true>(kImageType, message); },
      [](auto message) { make_picture<false>(kCompressedImageType, message); },
      [](auto message) { make_picture<true>(kCompressedImageType, message); },
      [](auto message) { camera_of_info(read_camera_info_message(message), false); },
      [](auto message) { camera_of_info(read_camera_info_message(message), true); },
      [](auto message) { read_odometry_message(message); },
      [](auto message) { read_tf_message(message); },
      [](auto message) { points_of_message(message, Rigid3()); },
  };
  if (bytes.empty()) return;
  const auto kind = static_cast<unsigned char>(bytes[0]) % kKinds.size();
  kKinds[kind](std::string_view(bytes).substr(1));
}

void read_urdf(const std::string& bytes, const fs::path&) {
  const exporting::UrdfText urdf = exporting::parse_urdf(bytes, "robot.urdf");
  for (const exporting::UrdfJoint& joint : urdf.joints) exporting::with_origin(urdf, joint, "1 2 3", "0 0 0");
}

// In a folder whose other files are in order.
Reader memroc(const std::string& name, const std::string& file) {
  const auto folder = std::make_shared<MemrocFolder>();
  const std::string in_order = folder->read(file);
  return {name,
          [folder, file, in_order](const std::string& bytes, const fs::path&) {
            folder->write(file, bytes);
            open_input(folder->path());
          },
          ""};
}

std::vector<Reader> readers_of_our_files() {
  return {
      {"rig", [](const auto&, const auto& file) { load_rig(file); }, "rig.yaml"},
      {"observations", [](const auto& bytes, const auto&) { parse_observations(bytes, "observations.json"); }, ""},
      {"result", [](const auto&, const auto& file) { load_result(file); }},
      {"truth", [](const auto&, const auto& file) { load_truth(file); }},
      {"manifest", [](const auto&, const auto& file) { load_manifest(file); }},
      {"odometry", read_odometry},
      {"frame_tree", [](const auto&, const auto& file) { load_frame_tree(file); }},
      {"run", [](const auto& bytes, const auto&) { parse_generate_config(bytes); }, ""},
      {"sweep", [](const auto&, const auto& file) { load_sweep_config(file); }, "sweep.yaml"},
      {"budget", [](const auto&, const auto& file) { load_budget(file); }, "budget.yaml"},
      {"accept", [](const auto&, const auto& file) { load_accept_criteria(file); }, "accept.yaml"},
      {"ml_settings", [](const auto& bytes, const auto&) { read_ml_settings(bytes); }, ""},
      {"external", [](const auto&, const auto& file) { load_external_config(file); }, "method.yaml"},
      {"board", [](const auto&, const auto& file) { load_board(file.string()); }, "board.yaml"},
      {"robot_model", [](const auto&, const auto& file) { load_robot_model(file.string()); }, "robot.yaml"},
      {"rig_model", [](const auto&, const auto& file) { load_rig_model(file.string()); }, "mounting.yaml"},
      {"scene_model", [](const auto&, const auto& file) { load_scene_model(file.string()); }, "scene.yaml"},
  };
}

std::vector<Reader> readers_of_other_files() {
  return {
      {"trajectory", [](const auto&, const auto& file) { read_trajectory(file); }},
      {"image", [](const auto& bytes, const auto&) { require_readable(decode_grey_image(as_bytes(bytes))); }, ""},
      {"depth_image", [](const auto& bytes, const auto&) { require_readable(decode_depth_image(as_bytes(bytes))); },
       ""},
      {"cloud", [](const auto& bytes, const auto&) { require_readable(decode_point_cloud(as_bytes(bytes))); }, ""},
      {"camera_info",
       [](const auto&, const auto& file) {
         for (const char* topic : {"/left/image_raw", "/left/image_rect"}) camera_of_file(file, "cam0", topic);
       },
       "camera.yaml"},
      {"urdf", read_urdf, ""},
      {"bag", read_bag},
      {"message", read_message, ""},
      {"rvl", [](const auto& bytes, const auto&) { decode_rvl(bytes); }, ""},
      {"matrices", [](const auto& bytes, const auto&) { find_matrices(bytes); }, ""},
      memroc("memroc_info", "CalibrationInfo.yaml"),
      memroc("memroc_intrinsics", "camera1/intrinsic_pars_file.yaml"),
      memroc("memroc_pose", "camera1/pose/0000.csv"),
  };
}

}  // namespace

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all = [] {
    std::vector<Reader> both = readers_of_our_files();
    for (Reader& reader : readers_of_other_files()) both.push_back(std::move(reader));
    return both;
  }();
  return all;
}

std::string complaint_of(const Reader& reader, const std::string& bytes) {
  static const TempFolder folder;
  const fs::path file = reader.file.empty() ? fs::path() : folder.write(reader.file, bytes);
  try {
    reader.read(bytes, file);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace rigproof::fuzz
