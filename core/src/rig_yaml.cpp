#include "rigproof/core/rig_yaml.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "rigproof/core/board_markers.h"
#include "rigproof/core/camera_info.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/files.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxSize = 32768.0;
constexpr double kMaxPixel = 1e6;
constexpr double kMmPerM = 1000.0;
constexpr double kDegPerRad = 180.0 / kPi;
constexpr double kMsPerS = 1000.0;
const NumberRange kPositive = {std::numeric_limits<double>::min(), 1e9};
const NumberRange kNotNegative = {0.0, 1e9};

// What the file says, or what the number of coefficients tells.
void visit_lens(FieldVisitor& visitor, Camera& camera) {
  visitor.choice(
      "lens", camera.lens,
      {{"pinhole", Lens::kPinhole}, {"brown_conrady", Lens::kBrownConrady}, {"kannala_brandt", Lens::kKannalaBrandt}},
      "model of the distortion; without this key brown_conrady where coefficients are given, else pinhole");
  std::vector<double> coefficients;
  if (!visitor.is_reading())
    coefficients.assign(camera.distortion.begin(), camera.distortion.begin() + coefficient_count(camera.lens));
  if (visitor.takes("distortion", !coefficients.empty()))
    visitor.field("distortion", coefficients, {-1e3, 1e3}, 0, 5,
                  "brown_conrady: k1 k2 p1 p2 k3; kannala_brandt: k1 k2 k3 k4");
  if (!visitor.is_reading()) return;
  if (visitor.given("lens") == nullptr && !coefficients.empty()) camera.lens = Lens::kBrownConrady;
  const auto expected = static_cast<std::size_t>(coefficient_count(camera.lens));
  if (expected > 0) visitor.require("distortion", std::to_string(expected) + " coefficients");
  const bool fits = coefficients.size() == expected;
  visitor.check(fits || visitor.given("distortion") == nullptr, "distortion",
                "the lens " + std::string(lens_name(camera.lens)) + " has " + std::to_string(expected) +
                    " coefficients (brown_conrady: k1 k2 p1 p2 k3, kannala_brandt: k1 k2 k3 k4)");
  if (fits) std::copy(coefficients.begin(), coefficients.end(), camera.distortion.begin());
}

void visit_own_camera(FieldVisitor& visitor, DepthStream& depth) {
  const bool has = depth.own_camera.has_value();
  const bool camera = visitor.takes("camera", has), transform = visitor.takes("T_color_depth", has);
  visitor.check(camera == transform, camera ? "camera" : "T_color_depth",
                "camera and T_color_depth belong together; give both or none");
  if (!camera || !transform) return;
  DepthStream::OwnCamera own;
  if (has && !visitor.is_reading()) own = *depth.own_camera;
  visitor.nested("camera", own.camera, "where the device measures depth, if that is not registered to colour");
  visitor.nested("T_color_depth", own.T_color_depth, "pose of that camera in the colour camera");
  if (visitor.is_reading()) depth.own_camera = own;
}

// `depth: none`, a block that refines the preset's, or nothing: the preset's.
void visit_optional_depth(FieldVisitor& visitor, std::optional<DepthStream>& depth) {
  if (!visitor.takes("depth", true)) return;
  const auto read_none = [&depth](const std::string& text) {
    if (text != "none") throw Error("must be none or a block");
    depth.reset();
  };
  const auto write_none = [&depth] { return depth ? std::nullopt : std::optional<std::string>("none"); };
  const auto visit = [&](FieldVisitor& block) {
    if (block.instead({{}, "none: no depth images", read_none, write_none})) return;
    DepthStream stream = depth.value_or(DepthStream());
    visit_fields(block, stream);
    if (block.is_reading()) depth = stream;
  };
  visitor.section("depth", visit, "what differs from the depth stream of the sensor's preset");
}

// True if the block says all that a preset would: files that this program wrote need none.
bool describes_depth(const YamlTree* depth) {
  if (depth == nullptr) return false;
  if (!depth->is_map()) return true;
  const auto has_all = [](const YamlTree& tree, std::initializer_list<const char*> keys) {
    return std::all_of(keys.begin(), keys.end(), [&tree](const char* key) { return tree.find(key) != nullptr; });
  };
  return has_all(*depth, {"unit_m", "min_m", "max_m", "noise"}) &&
         has_all(*depth->find("noise"),
                 {"law", "inverse_depth_sigma_per_m", "constant_m", "proportional", "correlation_px", "scale_sigma"});
}

bool is_told(const Problems& problems, const std::string& message) {
  return std::any_of(problems.all().begin(), problems.all().end(),
                     [&message](const Problem& problem) { return problem.message == message; });
}

// A file is named as seen from the rig's own file.
std::string located_sensor(FieldVisitor& visitor, const std::string& sensor) {
  const YamlTree* given = visitor.given("sensor");
  if (given == nullptr || !names_sensor_file(sensor)) return sensor;
  return (fs::absolute(given->file).parent_path() / sensor).lexically_normal().string();
}

bool is_known_sensor(const std::string& name) {
  std::error_code ignored;
  if (names_sensor_file(name)) return fs::is_regular_file(name, ignored);
  const std::vector<std::string> known = list_presets("sensors");
  return std::find(known.begin(), known.end(), name) != known.end();
}

// What may be named instead of a sensor that is not there.
std::string other_sensors(const std::string& name) {
  if (names_sensor_file(name))
    return "; the path starts at this file's folder; presets: " + joined(list_presets("sensors"));
  return "; one of your own is a file beside this one, sensor: ./mine.yaml, or lies in models/sensors of a folder that "
         "RIGPROOF_PATH names";
}

std::optional<SensorPreset> read_sensor(FieldVisitor& visitor, const std::string& name, const RigReadOptions& options) {
  const bool told = describes_depth(visitor.given("depth")) &&
                    !(options.nominal_intrinsics && visitor.given("intrinsics") == nullptr);
  if (name.empty()) return std::nullopt;
  bool is_unknown = false;
  try {
    is_unknown = !is_known_sensor(name);
    if (told && (!is_unknown || options.folder.empty())) return std::nullopt;  // observations go to other machines
    return load_sensor_preset(name);
  } catch (const Error& error) {
    if (told && !is_unknown) return std::nullopt;  // no data folder, and nothing is wanted of it
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    const std::string reason = error.what();
    // What is wrong in a preset is told for the first camera that names it; an unknown name is each line's own mistake.
    if (!is_unknown && is_told(*visitor.problems(), reason)) return std::nullopt;
    visitor.check(false, "sensor",
                  reason + (is_unknown ? other_sensors(name) : "") +
                      (told ? ", or leave this key out: the file describes the camera itself" : ""));
    return std::nullopt;
  }
}

void read_camera_info_file(FieldVisitor& visitor, const fs::path& file, Camera* camera) {
  try {
    const std::optional<InfoReading> reading = read_camera_info(file, false, visitor.problems());
    if (!reading) return;
    if (!reading->to_undo.empty())
      throw Error(file.string() +
                  ": no lens of ours comes near these coefficients; make the recording of a bag with `rigproof init`, "
                  "which rectifies, or give rectified images, and P as their camera_matrix");
    *camera = reading->camera;
  } catch (const Error& error) {
    visitor.check(false, "", error.what());
  }
}

// Where the file has no block: the file that is named, else camera_info.yaml in the camera's folder, else the sensor's
// nominal ones.
void find_intrinsics(FieldVisitor& visitor, const RigReadOptions& options, const std::optional<SensorPreset>& sensor,
                     const std::string& named, RigCamera* camera) {
  const fs::path inside = fs::path(camera->folder) / (named.empty() ? "camera_info.yaml" : named);
  if (!options.folder.empty()) {
    try {
      const fs::path file = path_inside(options.folder, inside.generic_string());
      std::error_code ignored;
      if (!named.empty() || fs::exists(file, ignored)) return read_camera_info_file(visitor, file, &camera->camera);
    } catch (const Error& error) {
      return visitor.check(false, "camera_info", error.what());
    }
  }
  if (sensor && options.nominal_intrinsics) {
    camera->camera = sensor->camera;
    return;
  }
  // A sensor that cannot be read was told already.
  if (options.nominal_intrinsics && !camera->sensor.empty()) return;
  visitor.check(false, "",
                "has no intrinsics; give `intrinsics: {width_px, height_px, fx_px, fy_px, cx_px, cy_px, lens, "
                "distortion}` or put a ROS camera_info.yaml at " +
                    inside.generic_string());
}

void visit_intrinsics(FieldVisitor& visitor, const RigReadOptions& options, const std::optional<SensorPreset>& sensor,
                      RigCamera& camera) {
  std::string named;
  const bool is_named = visitor.takes("camera_info", false);
  if (is_named)
    visitor.field("camera_info", named, TextChoices{},
                  "ROS CameraInfo file below the camera's folder in place of intrinsics; default camera_info.yaml");
  if (visitor.takes("intrinsics", true)) {
    visitor.check(!is_named, "camera_info", "intrinsics are given twice; remove one of them");
    visitor.nested("intrinsics", camera.camera, "the colour camera's");
  } else {
    find_intrinsics(visitor, options, sensor, named, &camera);
  }
  if (sensor) camera.intrinsics_sigma = sensor->intrinsics_sigma;
  if (visitor.takes("intrinsics_sigma", !camera.sensor.empty() || !(camera.intrinsics_sigma == IntrinsicsSigma())))
    visitor.nested("intrinsics_sigma", camera.intrinsics_sigma,
                   "how well the intrinsics are known, one sigma: estimated with them");
}

// A prior that is far sharper than any data drowns them in rounding.
void check_prior(FieldVisitor& visitor, const char* key, double in_unit) {
  constexpr double kLeast = 1e-3;
  visitor.check(in_unit <= 0.0 || in_unit >= kLeast, key, "allowed is 0 (believed) or 0.001 and more");
}

void visit_timing(FieldVisitor& visitor, RigCamera& camera) {
  const RigCamera usual;
  if (visitor.takes("readout_ms", camera.readout_s != usual.readout_s))
    visitor.scaled("readout_ms", camera.readout_s, kMsPerS, {-200.0, 200.0},
                   "rolling shutter: from the first row's time to the last one's");
  if (visitor.takes("readout_sigma_ms", camera.readout_sigma_s != usual.readout_sigma_s))
    visitor.scaled("readout_sigma_ms", camera.readout_sigma_s, kMsPerS, {0.0, 100.0},
                   "how well that is known, one sigma: estimated from images taken at speed; 0: as stated");
  if (!visitor.takes("clock_offset_sigma_ms", camera.clock_offset_sigma_s != usual.clock_offset_sigma_s)) return;
  visitor.scaled(
      "clock_offset_sigma_ms", camera.clock_offset_sigma_s, kMsPerS, {0.0, 1000.0},
      "how late or early its stamps are against the odometry's clock, one sigma: estimated from images taken "
      "at speed; 0: they are believed");
  check_prior(visitor, "clock_offset_sigma_ms", kMsPerS * camera.clock_offset_sigma_s);
}

// However it is spelled or linked to.
fs::path place_of(const std::string& camera_folder, const fs::path& recording) {
  std::error_code error;
  const fs::path place = recording.empty() ? fs::path() : fs::weakly_canonical(recording / camera_folder / ".", error);
  const fs::path normal = (place.empty() ? fs::path(camera_folder) / "." : place).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// Two cameras with the same images would agree perfectly.
void check_own_folder(const std::vector<RigCamera>& cameras, const RigCamera& camera, const RigReadOptions& options,
                      FieldVisitor& visitor) {
  const fs::path place = place_of(camera.folder, options.folder);
  for (const RigCamera& other : cameras)
    if (&other != &camera)
      visitor.check(place_of(other.folder, options.folder) != place, "folder",
                    "holds the images of " + other.name + " already (folder " + for_message(other.folder) +
                        "); every camera needs a folder of its own");
}

// A simulated device is where its preset says; of a real one that has to be told.
void take_raw_depth(FieldVisitor& visitor, const RigReadOptions& options, const SensorPreset& sensor,
                    DepthStream* depth) {
  if (!sensor.delivers_raw_depth || depth->own_camera) return;
  if (options.nominal_intrinsics) depth->own_camera = sensor.raw_depth;
  visitor.check(options.nominal_intrinsics, "depth",
                "the sensor " + sensor.name +
                    " delivers depth that is not registered to colour; give depth.camera and depth.T_color_depth");
}

}  // namespace

bool is_frame_name(const std::string& name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  };
  return !name.empty() && name.size() <= 64 && name.front() != '.' && std::all_of(name.begin(), name.end(), allowed);
}

static bool is_preset(FieldVisitor& visitor, Board& board) {
  const auto load = [&board](const std::string& name) { board = load_board(find_preset("boards", name).string()); };
  return visitor.instead({{}, "name of a preset in models/boards", load});
}

void visit_fields(FieldVisitor& visitor, Board& board) {
  visitor.on_one_line();
  if (!is_preset(visitor, board)) visit_board(visitor, board);
}

void visit_fields(FieldVisitor& visitor, BoardPlace& place) {
  visitor.on_one_line();
  visit_pose(visitor, place.T_first_board);
  visitor.scaled("sigma_mm", place.sigma_m, kMmPerM, {0.01, 1e4}, "how well that is known along each axis, one sigma");
  visitor.scaled("sigma_deg", place.sigma_rad, 180.0 / kPi, {1e-3, 180.0},
                 "how well it is known about each axis, one sigma");
}

static void visit_other_board(FieldVisitor& visitor, Board& board) {
  visitor.on_one_line();
  if (is_preset(visitor, board)) return;
  visit_board(visitor, board);
  visitor.nested(
      "place", board.place,
      "pose of this board in the frame of `board`, where it was measured; without it, it may stand anywhere");
}

namespace {

// Of boards with markers alone.
void visit_markers(FieldVisitor& visitor, Board& board) {
  visitor.optional(
      "dictionary", board.dictionary,
      "charuco: of its markers, as OpenCV calls it, e.g. DICT_6X6_250; default the smallest DICT_5X5_.. that "
      "has enough");
  visitor.scaled(
      "marker_mm", board.marker_m, kMmPerM, {0.01, 1e5},
      "charuco: side of its markers, default three quarters of square_mm; aprilgrid: side of its tags, default "
      "square_mm over 1.3, gaps of 0.3 tags");
  if (visitor.takes("legacy_pattern", board.legacy_pattern))
    visitor.field("legacy_pattern", board.legacy_pattern,
                  "charuco with an even number of rows: the first square is light and has the first marker, as OpenCV "
                  "before 4.6 drew it");
  const bool of_charuco = !board.dictionary.empty() || board.legacy_pattern;
  visitor.check(board.type == "charuco" || !of_charuco, "type",
                "dictionary and legacy_pattern are of charuco boards; this one is of type " + board.type);
  visitor.check(board.type != "checkerboard" || !board.marker_m, "type",
                "marker_mm is of charuco boards and aprilgrids; this one is of type checkerboard");
  visitor.check(!board.marker_m || *board.marker_m < board.square_m, "marker_mm",
                "must be less than square_mm, as markers lie within squares");
  const std::optional<std::string> problem = problem_of_markers(board);
  visitor.check(!problem, "dictionary", problem.value_or(""));
}

}  // namespace

void visit_board(FieldVisitor& visitor, Board& board) {
  visitor.ignored("description", "for people");
  visitor.field("type", board.type, TextChoices{{"checkerboard", "charuco", "aprilgrid"}}, "what is printed on it");
  visitor.require("squares", "[columns, rows], the number of squares");
  visitor.require("square_mm", "the side of a square in millimetres");
  std::vector<double> squares = {static_cast<double>(board.squares_x), static_cast<double>(board.squares_y)};
  visitor.field(
      "squares", squares, {3.0, 100.0}, 2, 2,
      "[columns, rows]: squares, one more than inner corners; of a checkerboard one even, the other odd; of an "
      "aprilgrid its tags");
  visitor.scaled("square_mm", board.square_m, kMmPerM, {0.1, 1e5},
                 "side of a square; of an aprilgrid from tag to tag: a tag and a gap");
  visitor.scaled("square_sigma_mm", board.square_sigma_m, kMmPerM, {0.0, 1e4},
                 "one sigma of that side: 0.1 where a long row of squares was measured with a ruler, 0: exact; default "
                 "0.5 % of it, as printers leave it");
  visitor.scaled("bow_sigma_mm", board.bow_sigma_m, kMmPerM, {0.0, 1e4},
                 "one sigma of how far the board bows from its middle to its edges, 0: flat; default 0.07 % of its "
                 "longer side, 0.3 mm over A3");
  visitor.scaled(
      "print_sigma_mm", board.print_sigma_m, kMmPerM, {0.0, 100.0},
      "one sigma of where each corner lies against these, along each axis, 0: exactly; default 0.05, of print "
      "and paper");
  visitor.check(squares[0] == std::floor(squares[0]) && squares[1] == std::floor(squares[1]), "squares",
                "must be whole numbers");
  board.squares_x = static_cast<int>(squares[0]);
  board.squares_y = static_cast<int>(squares[1]);
  visit_markers(visitor, board);
  visitor.check(visitor.given("inner_corners") == nullptr || !visitor.takes("inner_corners", false), "inner_corners",
                "give squares: one more than inner corners along each side");
  visitor.check(board.type != "checkerboard" || !board.ambiguous_under_half_turn(), "squares",
                "the board looks the same when turned by 180 degrees, so its first corner cannot be told; "
                "use one even and one odd number of squares");
}

bool takes_more_boards(FieldVisitor& visitor, bool has_some) {
  constexpr std::size_t kMost = 7;
  if (!visitor.takes("more_boards", has_some)) return false;
  const YamlTree* given = visitor.given("more_boards");
  const bool too_many = given != nullptr && given->items.size() > kMost;
  visitor.check(!too_many, "more_boards", "allowed are at most 7");
  return !too_many;
}

void visit_more_boards(FieldVisitor& visitor, std::vector<Board>& boards) {
  if (!takes_more_boards(visitor, !boards.empty())) return;
  visitor.nested_list("more_boards", boards,
                      "boards that stand elsewhere, each wherever, that other cameras see, or from other stops; an "
                      "image counts for the one of which it shows the most corners",
                      visit_other_board);
}

void visit_camera(FieldVisitor& visitor, Camera& camera) {
  visitor.field("width_px", camera.width_px, {1.0, kMaxSize}, "width of the image");
  visitor.field("height_px", camera.height_px, {1.0, kMaxSize}, "height of the image");
  visitor.field("fx_px", camera.fx_px, {1.0, kMaxPixel}, "focal length along x");
  visitor.field("fy_px", camera.fy_px, {1.0, kMaxPixel}, "focal length along y");
  visitor.field("cx_px", camera.cx_px, {-kMaxPixel, kMaxPixel}, "principal point; pixel centres are whole numbers");
  visitor.field("cy_px", camera.cy_px, {-kMaxPixel, kMaxPixel}, "principal point");
  visit_lens(visitor, camera);
}

void visit_fields(FieldVisitor& visitor, Camera& camera) {
  visitor.require("width_px", "the width of the image in pixels");
  visitor.require("height_px", "the height of the image in pixels");
  for (const char* key : {"fx_px", "fy_px"}) visitor.require(key, "a number, " + range_text({1.0, kMaxPixel}));
  for (const char* key : {"cx_px", "cy_px"}) visitor.require(key, "a number, " + range_text({-kMaxPixel, kMaxPixel}));
  visit_camera(visitor, camera);
}

// `exact`, or what differs from the usual.
void visit_fields(FieldVisitor& visitor, IntrinsicsSigma& sigma) {
  visitor.on_one_line();
  const auto read_exact = [&sigma](const std::string& text) {
    if (text != "exact") throw Error("must be exact or a block");
    sigma = IntrinsicsSigma::exact();
  };
  const auto write_exact = [&sigma] {
    return sigma == IntrinsicsSigma::exact() ? std::optional<std::string>("exact") : std::nullopt;
  };
  if (visitor.instead({{}, "exact: they are believed to the last digit", read_exact, write_exact})) return;
  constexpr double kPercent = 100.0;
  visitor.scaled("focal_percent", sigma.focal_relative, kPercent, {0.0, 20.0}, "of the focal lengths together");
  visitor.scaled("focal_ratio_percent", sigma.focal_ratio, kPercent, {0.0, 20.0}, "of fx over fy");
  visitor.field("principal_point_px", sigma.principal_point_px, {0.0, 50.0}, "of the principal point along x and y");
  visitor.field("distortion_px", sigma.distortion_px, {0.0, 50.0},
                "of the distortion: radially, in the farthest corner of the image");
  visitor.field("residual_px", sigma.residual_px, {0.0, 10.0},
                "of what no distortion model follows: a smooth field over the image, root mean square");
}

void visit_fields(FieldVisitor& visitor, DepthNoise& noise) {
  const bool stereo = noise.law == DepthNoise::Law::kStereo, biased = noise.has_bias();
  visitor.choice("law", noise.law,
                 {{"stereo", DepthNoise::Law::kStereo}, {"time_of_flight", DepthNoise::Law::kTimeOfFlight}},
                 "stereo: sigma_z = z^2 inverse_depth_sigma_per_m; time_of_flight: constant_m + proportional z");
  visitor.field("inverse_depth_sigma_per_m", noise.inverse_depth_sigma_per_m, kNotNegative, "stereo: one sigma of 1/z");
  visitor.field("constant_m", noise.constant_m, {0.0, 10.0}, "time_of_flight: one sigma at the camera");
  visitor.field("proportional", noise.proportional, {0.0, 1.0}, "time_of_flight: what is added a metre");
  visitor.field("correlation_px", noise.correlation_px, {1.0, 1000.0},
                "side of the square of pixels whose noise is one and the same");
  visitor.field("scale_sigma", noise.scale_sigma, {0.0, 1.0}, "prior of the relative error of all depth, one sigma");
  visitor.field("common_scale_sigma", noise.common_scale_sigma, {0.0, 1.0},
                "the same of the part that the rig's depth cameras of the same sensor share");
  visitor.scaled("offset_sigma_mm", noise.offset_sigma_m, kMmPerM, {0.0, 1000.0},
                 "prior of an error of all depth alike, one sigma");
  visitor.scaled("tilt_sigma_deg", noise.tilt_sigma_rad, kDegPerRad, {0.0, 20.0},
                 "prior of the depth camera's tilt against the colour camera, about x and y, one sigma");
  visitor.field("shift_sigma_px", noise.shift_sigma_px, {0.0, 50.0},
                "prior of the depth image's shift against the colour image, along x and y, one sigma");
  if (visitor.takes("bias_inverse_depth_per_m", biased && stereo))
    visitor.field("bias_inverse_depth_per_m", noise.bias_inverse_depth_per_m, {0.0, 1.0},
                  "stereo: the device's fixed, smooth error of 1/z over its view, one sigma; 0: none is known of");
  if (visitor.takes("bias_m", biased && !stereo))
    visitor.field("bias_m", noise.bias_m, {0.0, 1.0}, "time_of_flight: the same of z");
  if (visitor.takes("bias_cell_deg", biased))
    visitor.field("bias_cell_deg", noise.bias_cell_deg, {1.0, 90.0}, "angle over which the fixed error changes");
  const bool silent = noise.law == DepthNoise::Law::kStereo ? noise.inverse_depth_sigma_per_m <= 0.0
                                                            : noise.constant_m <= 0.0 && noise.proportional <= 0.0;
  visitor.check(!silent, "", "this law has no noise at all; give what rounding alone does, at least");
}

void visit_fields(FieldVisitor& visitor, DepthStream& depth) {
  visitor.field("unit_m", depth.unit_m, {1e-6, 1.0}, "of one count of the 16-bit images");
  visitor.field("min_m", depth.min_m, {0.0, 1000.0}, "nearest depth that is measured");
  visitor.field("max_m", depth.max_m, {0.0, 1000.0}, "farthest depth that is measured");
  visitor.check(depth.min_m < depth.max_m, "min_m", "must be less than max_m");
  visitor.nested("noise", depth.noise, "how depth is measured");
  visit_own_camera(visitor, depth);
}

void visit_fields(FieldVisitor& visitor, DepthStream::OwnCamera& camera) {
  visit_fields(visitor, camera.camera);
  visitor.require("T_color_depth", "{translation_m, quaternion_xyzw}");
  visitor.nested("T_color_depth", camera.T_color_depth, "pose of the depth camera in the colour camera");
}

// Where the camera is in the user's tree of frames.
static void visit_frames(FieldVisitor& visitor, RigCamera& camera) {
  visitor.field("link", camera.link, TextChoices{}, "TF link that results are exported for; default the camera's name");
  visitor.optional("optical_frame", camera.optical_frame, "name of the optical frame in the same tree");
  visitor.nested("T_link_camera", camera.T_link_camera,
                 "pose of the optical frame in link, as the driver publishes it");
  if (!camera.T_link_camera) return;
  visitor.check(visitor.given("link") != nullptr, "T_link_camera", "is a pose in `link`, which is not given");
  visitor.check(camera.link != camera.optical_frame, "T_link_camera",
                "link and optical_frame are one frame; leave T_link_camera out, or name the frame above as link");
}

static void visit_rig_camera(FieldVisitor& visitor, const RigReadOptions& options, RigCamera& camera) {
  // Another machine has no such file, and what is written says all that it does.
  std::string sensor = visitor.is_reading() || !names_sensor_file(camera.sensor) ? camera.sensor : "";
  visitor.optional("sensor", sensor,
                   "preset in models/sensors: d455, d435, l515, ..; or a file, as seen from this one: ./mine.yaml");
  if (visitor.is_reading()) camera.sensor = located_sensor(visitor, sensor);
  visitor.field("folder", camera.folder, TextChoices{}, "folder inside of the recording; default the camera's name");
  visit_frames(visitor, camera);
  std::optional<SensorPreset> preset;
  if (visitor.is_reading()) preset = read_sensor(visitor, camera.sensor, options);
  visit_intrinsics(visitor, options, preset, camera);
  visit_timing(visitor, camera);
  if (preset) camera.depth = preset->depth;
  visit_optional_depth(visitor, camera.depth);
  if (preset && camera.depth) take_raw_depth(visitor, options, *preset, &*camera.depth);
}

void visit_rig_cameras(FieldVisitor& visitor, const RigReadOptions& options, std::vector<RigCamera>& cameras,
                       const VisitMount& visit_mount) {
  FieldMap map = map_by_name(cameras, [&](FieldVisitor& block, RigCamera& camera) {
    if (block.is_reading()) camera.link = camera.folder = camera.name;
    if (visit_mount) visit_mount(block);
    visit_rig_camera(block, options, camera);
    if (block.is_reading()) check_own_folder(cameras, camera, options, block);
    block.tolerate("x-");
  });
  map.size_min = 1;
  map.size_max = options.max_cameras;
  map.size_rule = "must be a map of 1 to " + std::to_string(map.size_max) + " cameras by name";
  map.is_name = is_frame_name;
  map.name_rule = "a camera's name has letters, digits, \"_\", \"-\" and \".\", at most 64, and no leading dot";
  map.name_pattern = "^[A-Za-z0-9_-][A-Za-z0-9_.-]{0,63}$";
  visitor.map("cameras", map, "cameras by name, in the order of all results");
}

void visit_rotation_centre(FieldVisitor& visitor, Eigen::Vector2d& centre_m, const char* description) {
  if (!visitor.takes("rotation_centre_mm", !centre_m.isZero(0.0))) return;
  std::vector<double> centre_mm = {value_in_unit(centre_m.x(), kMmPerM), value_in_unit(centre_m.y(), kMmPerM)};
  visitor.field("rotation_centre_mm", centre_mm, {-1e4, 1e4}, 2, 2, description);
  if (centre_mm.size() == 2) centre_m << centre_mm[0] / kMmPerM, centre_mm[1] / kMmPerM;
}

// What increments have wrong in common.
static void visit_wheels(FieldVisitor& visitor, OdometryNoise& noise) {
  constexpr double kPercent = 100.0;
  const auto prior = [&visitor](const char* key, std::optional<double>& sigma, double units_per_si, double most,
                                const char* description) {
    visitor.scaled(key, sigma, units_per_si, {0.0, most}, description);
    check_prior(visitor, key, units_per_si * sigma.value_or(0.0));
  };
  prior("scale_sigma_percent", noise.scale_sigma, kPercent, 100.0,
        "how far off the factor of its translations is (wheel radius), one sigma: estimated; 0: it is 1; default 10");
  prior("yaw_factor_sigma_percent", noise.yaw_factor_sigma, kPercent, 100.0,
        "the same of its turns (track of the wheels); default 10");
  prior("veer_sigma_deg_per_m", noise.veer_sigma_rad_per_m, kDegPerRad, 100.0,
        "the heading that it gains with every metre forward (unequal wheels), one sigma: estimated; 0: none; default "
        "1.72");
  prior(
      "turn_lag_sigma_ms", noise.turn_lag_sigma_s, kMsPerS, 1000.0,
      "where clocks are estimated: by how much the body turns later than its wheels, one sigma: estimated; 0: it does "
      "not; default 20");
}

void visit_fields(FieldVisitor& visitor, OdometryNoise& noise) {
  visitor.on_one_line();
  visitor.choice("model", noise.model,
                 {{"unknown", OdometryModel::kUnknown},
                  {"per_pose", OdometryModel::kPerPose},
                  {"per_increment", OdometryModel::kPerIncrement}},
                 "per_pose: independent on every absolute pose; per_increment: on every increment, so that it drifts; "
                 "unknown: decided from the data");
  visitor.scaled("sigma_xy_mm", noise.sigma_xy_m, kMmPerM, kNotNegative, "one sigma of x and of y; default estimated");
  visitor.scaled("sigma_yaw_deg", noise.sigma_yaw_rad, kDegPerRad, {0.0, 360.0}, "one sigma; default estimated");
  visit_rotation_centre(visitor, noise.rotation_centre_m,
                        "[x, y] in the robot's frame of the point about which the robot turns, and whose motion "
                        "odometry therefore tells; default [0, 0], the origin");
  visitor.scaled(
      "rotation_centre_sigma_mm", noise.rotation_centre_sigma_m, kMmPerM, {0.0, 1000.0},
      "how well that point is known along x, and along y, one sigma; 0 where it is so by definition, 5 where it is the "
      "middle of one driven axle; default 50");
  visitor.check(visitor.given("rotation_centre_mm") == nullptr || noise.rotation_centre_sigma_m,
                "rotation_centre_sigma_mm",
                "is missing: how well is `rotation_centre_mm` known? 5 where it was measured to 5 mm");
  visitor.scaled("riding_height_sigma_mm", noise.riding_height_sigma_m, kMmPerM, {0.0, 100.0},
                 "how much higher the robot rides while it moves, one sigma; default 0.3");
  visit_wheels(visitor, noise);
}

void visit_fields(FieldVisitor& visitor, AcceptLimits& accept) {
  visitor.on_one_line();
  const NumberRange angle{kPositive.min, 180.0};
  visitor.require("xy_mm", "a number, " + range_text(kPositive));
  visitor.scaled("xy_mm", accept.xy_m, kMmPerM, kPositive, "along the robot's x and y");
  visitor.require("z_mm", "a number, " + range_text(kPositive));
  visitor.scaled("z_mm", accept.z_m, kMmPerM, kPositive, "of the height");
  visitor.require("angle_deg", "a number, " + range_text(angle));
  visitor.scaled("angle_deg", accept.angle_rad, kDegPerRad, angle, "about each axis of the robot");
}

void visit_pose(FieldVisitor& visitor, Rigid3& T, bool is_required) {
  // q and -q are one rotation: the file holds the one with w >= 0.
  const Eigen::Vector4d c = T.rotation.w() < 0.0 ? Eigen::Vector4d(-T.rotation.coeffs()) : T.rotation.coeffs();
  std::vector<double> t = {T.translation.x(), T.translation.y(), T.translation.z()}, q = {c[0], c[1], c[2], c[3]};
  if (is_required) visitor.require("translation_m", "[x, y, z]");
  if (is_required) visitor.require("quaternion_xyzw", "[x, y, z, w]");
  visitor.field("translation_m", t, {-1e6, 1e6}, 3, 3, "x, y, z of the child's origin in the parent");
  visitor.field("quaternion_xyzw", q, {-2.0, 2.0}, 4, 4, "rotation from child to parent, norm 1");
  if (!visitor.is_reading()) return;
  const Eigen::Vector4d read(q[0], q[1], q[2], q[3]);
  const double norm = read.norm();
  visitor.check(std::abs(norm - 1.0) <= 1e-3, "quaternion_xyzw",
                "has the norm " + number_text(norm) + "; it must be 1 within 0.001, order x y z w");
  T.translation << t[0], t[1], t[2];
  // What this program wrote is a unit to rounding, and reads back to the same bits.
  if (std::abs(norm - 1.0) <= 1e-3)
    T.rotation.coeffs() = std::abs(norm - 1.0) < 1e-14 ? read : Eigen::Vector4d(read * (1.0 / norm));
}

void visit_fields(FieldVisitor& visitor, Rigid3& T) {
  visitor.on_one_line();
  visit_pose(visitor, T);
}

}  // namespace rigproof
