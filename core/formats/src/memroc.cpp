// Reads the layout of the MEMROC authors' program: CalibrationInfo.yaml and cameraN/{image,clouds,pose}.
#include "memroc.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "rigproof/core/files.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxSmallFile = 1U << 20U;
constexpr std::size_t kMaxFrames = 1000000;
// Poses of one stop that two cameras' folders repeat may differ by what their text rounds off, not more.
constexpr double kSameDistance = 1e-4, kSameAngle = 1e-4;
// A wheeled robot's odometry is planar; what is projected away may be this large [m, rad].
constexpr double kPlanarDistance = 0.2, kPlanarAngle = 0.2;

struct Pose {
  Rigid3 T_world_robot;
  std::string file;
};

struct Info {
  int cameras = 0;
  std::string prefix = "camera";
  Board board;
  double resize_factor = 1.0;
};

// The program writes with OpenCV's FileStorage, whose first line no other YAML reader takes.
YamlTree read_storage(const fs::path& file) {
  std::string text = read_text_file(file, kMaxSmallFile);
  if (text.rfind("%YAML:", 0) == 0) text.replace(0, text.find('\n'), "#");
  return parse_yaml(text, file);
}

int required_count(MapReader& map, const std::string& key, double low, double high) {
  map.require(key, "a whole number, " + range_text({low, high}));
  return static_cast<int>(map.integer(key, {low, high}).value_or(static_cast<std::int64_t>(low)));
}

double required_number(MapReader& map, const std::string& key, const NumberRange& range) {
  map.require(key, "a number, " + range_text(range));
  return map.number(key, range).value_or(range.min);
}

// Keys that concern the authors' program alone are left alone.
Info read_info(const YamlTree& tree, Problems* problems) {
  Info info;
  MapReader map(tree, "", problems);
  info.cameras = required_count(map, "number_of_cameras", 1.0, 64.0);
  info.prefix = map.text("camera_folder_prefix").value_or(info.prefix);
  if (!is_frame_name(info.prefix)) map.problem("camera_folder_prefix", "must be the beginning of a folder's name");
  const auto pattern = map.text("pattern_type", {"checkerboard", "chessboard"});
  info.board.type = "checkerboard";
  info.board.squares_x = required_count(map, "number_of_rows", 2.0, 99.0) + 1;
  info.board.squares_y = required_count(map, "number_of_columns", 2.0, 99.0) + 1;
  info.board.square_m = required_number(map, "size", {1e-4, 100.0});
  info.resize_factor = map.number("resize_factor", {0.01, 100.0}).value_or(1.0);
  if (info.resize_factor != 1.0)
    map.problem("resize_factor", "only 1 is supported; the images and intrinsics are used as they lie in the folder");
  if (pattern && info.board.ambiguous_under_half_turn())
    map.problem("number_of_rows",
                "the board looks the same when turned by 180 degrees, so its first corner cannot be "
                "told; use one even and one odd number of corners");
  return info;
}

// OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6 under the names k0 k1 px py k2 k3 k4 k5.
void read_distortion(MapReader& map, Camera* camera) {
  static const char* const kUsed[] = {"dist_k0", "dist_k1", "dist_px", "dist_py", "dist_k2"};
  static const char* const kRational[] = {"dist_k3", "dist_k4", "dist_k5"};
  for (std::size_t i = 0; i < 5; ++i) camera->distortion[i] = map.number(kUsed[i], {-1e3, 1e3}).value_or(0.0);
  for (const char* key : kRational)
    if (map.number(key, {-1e6, 1e6}).value_or(0.0) != 0.0)
      map.problem(key, "the rational model is not supported; it must be 0");
  const bool any = std::any_of(camera->distortion.begin(), camera->distortion.end(), [](double k) { return k != 0.0; });
  camera->lens = any ? Lens::kBrownConrady : Lens::kPinhole;
}

Camera read_camera(const YamlTree& tree, Problems* problems) {
  Camera camera;
  MapReader map(tree, "", problems);
  camera.width_px = required_count(map, "img_width", 1.0, 32768.0);
  camera.height_px = required_count(map, "img_height", 1.0, 32768.0);
  camera.fx_px = required_number(map, "fx", {1.0, 1e6});
  camera.fy_px = required_number(map, "fy", {1.0, 1e6});
  camera.cx_px = required_number(map, "cx", {-1e6, 1e6});
  camera.cy_px = required_number(map, "cy", {-1e6, 1e6});
  if (map.integer("has_dist_coeff", {0.0, 1.0}).value_or(1) == 1) read_distortion(map, &camera);
  return camera;
}

// "0012.png" is frame 12.
std::optional<std::int64_t> number_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  if (stem.empty() || stem.size() > 15 || stem.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return parse_integer(stem);
}

/// Files of a folder by frame number.
using NumberedFiles = std::map<std::int64_t, std::string>;

NumberedFiles numbered_files(const fs::path& root, const std::string& folder, const std::set<std::string>& types,
                             bool required, Problems* problems) {
  NumberedFiles files;
  std::error_code error;
  if (!fs::is_directory(root / folder, error)) {
    if (required) problems->add({(root / folder).string(), 0, "", "", "no such folder"});
    return files;
  }
  fs::directory_iterator it(path_inside(root, folder), error), end;
  for (; !error && it != end; it.increment(error)) {
    if (types.count(it->path().extension().string()) == 0) continue;
    const std::string name = folder + "/" + it->path().filename().string();
    const auto number = number_of(it->path());
    if (!number) problems->add({(root / name).string(), 0, "", "", "the name must be a number, like 0012"});
    if (!number) continue;
    path_inside(root, name);
    if (!files.emplace(*number, name).second)
      problems->add({(root / name).string(), 0, "", "", "has the number of " + files[*number]});
    if (files.size() > kMaxFrames) throw Error((root / folder).string() + ": more than a million files");
  }
  if (error) throw Error((root / folder).string() + ": " + error.message());
  return files;
}

std::vector<std::vector<double>> read_rows(const fs::path& file, Problems* problems) {
  const std::string text = read_text_file(file, kMaxSmallFile);
  std::vector<std::vector<double>> rows;
  int line = 0;
  for (std::size_t at = 0; at < text.size() && rows.size() < 8;) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string row = text.substr(at, end - at);
    at = end + 1;
    ++line;
    std::replace_if(
        row.begin(), row.end(), [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
    std::vector<double> values;
    for (std::size_t i = row.find_first_not_of(' '); i != std::string::npos; i = row.find_first_not_of(' ', i)) {
      const std::size_t stop = std::min(row.find(' ', i), row.size());
      const auto value = parse_number(std::string_view(row).substr(i, stop - i));
      if (!value) {
        problems->add({file.string(), line, "", for_message(row.substr(i, stop - i)), "must be a finite number"});
        return {};
      }
      values.push_back(*value);
      i = stop;
    }
    if (!values.empty()) rows.push_back(std::move(values));
  }
  return rows;
}

bool is_matrix(const std::vector<std::vector<double>>& rows) {
  if (rows.size() != 3 && rows.size() != 4) return false;
  const bool wide = std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.size() == 4; });
  return wide && (rows.size() == 3 || rows[3] == std::vector<double>{0.0, 0.0, 0.0, 1.0});
}

std::optional<Rigid3> read_pose(const fs::path& file, Problems* problems) {
  const std::size_t before = problems->all().size();
  const auto rows = read_rows(file, problems);
  if (problems->all().size() != before) return std::nullopt;
  const auto refuse = [&](const std::string& why) {
    problems->add({file.string(), 0, "", "", why});
    return std::nullopt;
  };
  if (!is_matrix(rows)) return refuse("must be a 3x4 matrix, or a 4x4 matrix with the last row 0 0 0 1");
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) matrix(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error < 1e-3) || R.determinant() < 0.0)
    return refuse("the upper left 3x3 block must be a rotation within 0.001");
  return Rigid3::from_matrix(matrix);
}

RigCamera rig_camera(const std::string& name, const Camera& camera, bool has_clouds) {
  RigCamera rig_camera;
  rig_camera.name = rig_camera.folder = rig_camera.link = name;
  rig_camera.camera = camera;
  // Clouds carry no sensor's name: the general stereo law, whose sigma is then fitted by the plane's own residuals.
  if (has_clouds) rig_camera.depth = DepthStream();
  return rig_camera;
}

/// Poses of the robot by frame number, from all cameras' folders.
using NumberedPoses = std::map<std::int64_t, Pose>;

// A frame's number is its stamp: the layout has no other time.
std::vector<CameraFrame> frames_of(const fs::path& root, const std::string& name, const NumberedFiles& images,
                                   const NumberedFiles& clouds, const NumberedFiles& poses, Problems* problems) {
  std::vector<CameraFrame> frames;
  if (images.empty()) problems->add({(root / name / "image").string(), 0, "", "", "holds no image"});
  for (const auto& [number, file] : images) {
    CameraFrame frame;
    frame.color_file = file;
    const auto cloud = clouds.find(number);
    if (cloud != clouds.end()) frame.cloud_file = cloud->second;
    frame.stamp_s = static_cast<double>(number);
    if (poses.count(number) == 0)
      problems->add({(root / file).string(), 0, "", "", "has no pose of the same number in " + name + "/pose"});
    frames.push_back(std::move(frame));
  }
  return frames;
}

void add_pose(const fs::path& root, std::int64_t number, const std::string& file, NumberedPoses* poses,
              Problems* problems) {
  const auto pose = read_pose(root / file, problems);
  if (!pose) return;
  const auto [place, inserted] = poses->emplace(number, Pose{*pose, file});
  if (inserted) return;
  const Vector6d error = transform_error(*pose, place->second.T_world_robot);
  if (error.head<3>().norm() <= kSameDistance && error.tail<3>().norm() <= kSameAngle) return;
  problems->add({(root / file).string(), 0, "", "",
                 "contradicts " + place->second.file + " by " + number_text(error.head<3>().norm()) + " m and " +
                     number_text(error.tail<3>().norm()) + " rad; a frame number stands for one pose of the robot"});
}

void add_camera(const std::string& name, Recording* recording, NumberedPoses* poses, Problems* problems) {
  const fs::path& root = recording->folder;
  try {
    const Camera camera = read_camera(read_storage(path_inside(root, name + "/" + kMemrocIntrinsicsFile)), problems);
    const auto images = numbered_files(root, name + "/image", {".png", ".jpg", ".jpeg"}, true, problems);
    const auto clouds = numbered_files(root, name + "/clouds", {".txt", ".pcd"}, false, problems);
    const auto pose_files = numbered_files(root, name + "/pose", {".csv"}, true, problems);
    recording->rig.cameras.push_back(rig_camera(name, camera, !clouds.empty()));
    recording->frames.push_back(frames_of(root, name, images, clouds, pose_files, problems));
    for (const auto& [number, file] : pose_files) add_pose(root, number, file, poses, problems);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    problems->add({"", 0, "", "", error.what()});
  }
}

std::vector<OdometrySample> odometry_of(const fs::path& root, const NumberedPoses& poses, Problems* problems) {
  std::vector<OdometrySample> odometry;
  for (const auto& [number, pose] : poses) {
    const Rigid3& T = pose.T_world_robot;
    const double tilt = std::acos(std::min(1.0, (T.rotation * Eigen::Vector3d::UnitZ()).z()));
    if (std::abs(T.translation.z() - poses.begin()->second.T_world_robot.translation.z()) > kPlanarDistance ||
        tilt > kPlanarAngle)
      problems->add({(root / pose.file).string(), 0, "", "",
                     "leaves the ground plane; the pose must be T_world_robot with z up"});
    odometry.push_back({static_cast<double>(number), T.translation.x(), T.translation.y(), yaw_of(T)});
  }
  return odometry;
}

bool is_memroc(const fs::path& folder) { return has_file(folder, kMemrocInfoFile); }

// `number_of_rows` counts the inner corners along the board's x axis, as that program's cv::Size(rows, columns); poses
// are T_world_robot; clouds are text, x y z in the camera frame, metres. Frames with the same number belong to the same
// stop.
Input read_memroc(const fs::path& folder) {
  Problems problems;
  const Info info = read_info(read_storage(folder / kMemrocInfoFile), &problems);
  problems.throw_if_any();
  Recording recording;
  recording.folder = folder;
  recording.rig.name = folder.filename().string();
  recording.rig.robot_frame = "robot";
  recording.rig.board = info.board;
  NumberedPoses poses;
  for (int i = 1; i <= info.cameras; ++i) add_camera(info.prefix + std::to_string(i), &recording, &poses, &problems);
  recording.odometry = odometry_of(folder, poses, &problems);
  problems.throw_if_any();
  Input input;
  input.recording = std::move(recording);
  return input;
}

}  // namespace

Format memroc_format() {
  Format format;
  format.name = "memroc";
  format.equal_squares = true;
  format.what = "the MEMROC layout";
  format.given_as = "a folder in the MEMROC layout";
  format.marker = kMemrocInfoFile;
  format.detect = is_memroc;
  format.read = read_memroc;
  format.write = write_memroc;
  format.wants_stops = true;
  return format;
}

}  // namespace rigproof
