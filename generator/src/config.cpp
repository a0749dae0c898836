#include "rigproof/generator/config.h"

#include <cmath>

#include "rigproof/core/rig_yaml.h"

namespace rigproof {
namespace {

constexpr double kMaxDistanceM = 100.0;

bool is_board_size(const std::vector<double>& squares) {
  if (squares.empty()) return true;
  if (squares.size() != 2) return false;
  for (const double count : squares) {
    if (count != std::floor(count)) return false;
  }
  return true;
}

}  // namespace

void BoardConfig::visit(FieldVisitor& visitor) {
  visitor.field("preset", preset, TextChoices{}, "board in models/boards, or a YAML file; empty = the rig's board");
  visitor.field("type", type, TextChoices{{"preset", "checkerboard", "charuco", "aprilgrid"}},
                "what is printed on it; preset = as the preset says");
  visitor.field("squares", squares, {3.0, 64.0}, 0, 2,
                "squares along board x and y instead of the preset's, e.g. [6, 5]; empty = the preset's");
  visitor.field("square_mm", square_mm, {0.0, 1000.0}, "side of a square instead of the preset's; 0 = the preset's");
  visitor.optional("dictionary", dictionary,
                   "charuco: of its markers, as OpenCV calls it, e.g. DICT_6X6_250, instead of the preset's");
  visitor.field("place", place, TextChoices{{"fitted", "scene", "given"}},
                "fitted: the board stands where the scene puts it, at the height that lets all cameras of the rig see "
                "it in most parts of their images; scene: at the scene's height, too; given: where the fields below "
                "put it");
  visitor.field("x_m", x_m, {-kMaxDistanceM, kMaxDistanceM}, "middle of the squares in the scene's frame");
  visitor.field("y_m", y_m, {-kMaxDistanceM, kMaxDistanceM}, "middle of the squares in the scene's frame");
  visitor.field("z_m", z_m, {0.0, 10.0}, "height of the middle of the squares");
  visitor.field("facing_deg", facing_deg, {-360.0, 360.0},
                "heading of the printed face's outward normal: 0 = looks along the scene's x, 90 = along y");
  visitor.field("lean_deg", lean_deg, {-60.0, 60.0}, "the normal points up by this angle (the board leans back)");
  visitor.field("roll_deg", roll_deg, {-180.0, 180.0}, "turn in its own plane, anticlockwise as a viewer sees it");
  visitor.nested("defects", defects, "what is wrong with it; the recording does not tell");
  visitor.check(is_board_size(squares), "squares", "must be empty or two whole numbers from 3 to 64, e.g. [5, 4]");
}

static void visit_more_boards(FieldVisitor& visitor, const BoardConfig& first, std::vector<BoardConfig>& boards) {
  if (!takes_more_boards(visitor, !boards.empty())) return;
  const auto resize = [&](std::size_t size) {
    BoardConfig as_good;
    as_good.defects = first.defects;
    boards.resize(size, as_good);
  };
  const auto visit = [&boards](std::size_t index, FieldVisitor& of_board) {
    BoardConfig& board = boards[index];
    for (const char* key : {"x_m", "y_m", "facing_deg"})
      of_board.require(key, "a number or a distribution: where the board stands");
    board.visit(of_board);
    of_board.field("told_place_sigma_mm", board.told_place_sigma_mm, {0.0, 1e4},
                   "the recording tells where the board stands against the first one, with an error drawn of this "
                   "sigma; 0 = it does not");
    of_board.field("told_place_sigma_deg", board.told_place_sigma_deg, {1e-3, 180.0}, "the same of its attitude");
    of_board.check(board.told_place_sigma_mm == 0.0 || board.told_place_sigma_mm >= 0.01, "told_place_sigma_mm",
                   "must be 0 or at least 0.01, the least that rig.yaml may state");
    of_board.check(board.told_place_sigma_mm > 0.0 || of_board.given("told_place_sigma_deg") == nullptr,
                   "told_place_sigma_deg", "needs told_place_sigma_mm beside it");
    of_board.check(board.place != "scene", "place", "must be fitted or given: the scene has a place for one board");
    of_board.check(board.place == "given" || of_board.given("z_m") == nullptr, "z_m",
                   "is used with place: given alone");
  };
  visitor.list(
      "more_boards", [&boards] { return boards.size(); }, resize, visit,
      "boards that stand elsewhere, each as `board`, with markers of a dictionary of its own; where it says "
      "nothing of defects, with the first one's; place fitted: where x_m, y_m and the angles put it, at the height "
      "that lets all cameras see it");
}

void ListedViewpoint::visit(FieldVisitor& visitor) {
  visitor.field("x_m", x_m, {-kMaxDistanceM, kMaxDistanceM}, "robot's place in the frame of the list");
  visitor.field("y_m", y_m, {-kMaxDistanceM, kMaxDistanceM}, "robot's place in the frame of the list");
  visitor.field("yaw_deg", yaw_deg, {-360.0, 360.0}, "robot's heading in the frame of the list");
}

void GridConfig::visit(FieldVisitor& visitor) {
  visitor.field("distances_m", distances_m, {0.3, kMaxDistanceM}, 1, 1000, "distances from the (first) board");
  visitor.field("bearings_deg", bearings_deg, {-90.0, 90.0}, 1, 1000, "bearings as seen from the (first) board");
  visitor.field("headings_deg", headings_deg, {-360.0, 360.0}, 1, 1000, "headings, 0 = towards the board");
}

void ViewpointConfig::visit(FieldVisitor& visitor) {
  visitor.field("planner", planner, TextChoices{{"covering", "sampled", "grid", "list"}},
                "covering: drawn from the distributions below, of each board in turn, with the heading that shows each "
                "camera a board where none has been yet; sampled: drawn, with headings from heading_deg, the default "
                "where that or "
                "all_cameras_share is given; grid: every combination in `grid`; list: as in `list`");
  // So configurations of 0.1 mean, when it was the only planner that drew.
  const bool gives_sampled = visitor.given("heading_deg") != nullptr || visitor.given("all_cameras_share") != nullptr;
  if (visitor.is_reading() && gives_sampled && visitor.given("planner") == nullptr) planner = "sampled";
  visitor.field("distance_m", distance_m, {0.3, kMaxDistanceM},
                "covering, sampled: from the board's centre to the robot, along the floor");
  visitor.field("bearing_deg", bearing_deg, {-90.0, 90.0},
                "covering, sampled: direction from the board to the robot, 0 = straight in front of it");
  visitor.field("heading_deg", heading_deg, {-360.0, 360.0},
                "sampled: robot's heading against the direction to the board, 0 = towards it; uniform [170, -170] goes "
                "across 180, away from it, and [350, 10] across 0");
  visitor.field("min_cameras", min_cameras, {0.0, 8.0},
                "covering, sampled, grid: cameras that must see the whole board");
  visitor.field("all_cameras_share", all_cameras_share, {0.0, 1.0},
                "sampled: share of stops for which places are drawn until all cameras see the board, if any such place "
                "turns up; the others may stand nearer");
  visitor.field("margin_px", margin_px, {0.0, 500.0},
                "distance that the board, its white border included, keeps from the image's edge");
  visitor.field("max_obliquity_deg", max_obliquity_deg, {0.0, 85.0},
                "largest angle between the board's normal and the line to a camera that is counted");
  visitor.field("max_candidates", max_candidates, {1.0, 1e6},
                "covering, sampled: candidates drawn for one pose before giving up");
  visitor.field("order", order, TextChoices{{"drive", "drawn"}},
                "drive: each stop about step_m from the one before; drawn: as drawn, or as the grid or list says");
  visitor.field("step_m", step_m, {0.0, kMaxDistanceM}, "drive: wanted distance from stop to stop");
  visitor.nested("grid", grid, "planner grid: distances, bearings and headings, in this order of nesting");
  visitor.nested_list("list", list, "planner list: places of the robot");
  visitor.field(
      "list_frame", list_frame, TextChoices{{"scene", "board"}},
      "frame of the list: scene; or board, on the floor below the board's centre, x towards its viewers, z up");
  const ViewpointConfig plain;
  const bool covers = planner == "covering";
  visitor.check(!covers || all_cameras_share == plain.all_cameras_share, "all_cameras_share",
                "belongs to planner sampled; leave one of them out");
  visitor.check(!covers || (heading_deg.lowest() == plain.heading_deg.lowest() &&
                            heading_deg.highest() == plain.heading_deg.highest()),
                "heading_deg", "belongs to planner sampled; leave one of them out");
  visitor.check(planner != "list" || !list.empty(), "list", "planner list needs at least one {x_m, y_m, yaw_deg}");
}

void OdometryConfig::visit(FieldVisitor& visitor) {
  visitor.field("seed", seed, {-1.0, 9007199254740992.0},
                "of the odometry's noise, to repeat it alone; -1 = that of everything random that is not rendered");
  visitor.field("model", model, TextChoices{{"per_increment", "per_pose", "thrun", "wheels"}},
                "per_increment: noise on every motion from stop to stop, so that it drifts; per_pose: independent on "
                "every absolute pose; thrun: grows with the motion; wheels: systematic errors of wheels, slip, ticks");
  visitor.field("lambda", lambda, {0.0, 1000.0}, "per_increment, per_pose: multiplies both sigmas; 0 = exact odometry");
  visitor.field("sigma_xy_cm", sigma_xy_cm, {0.0, 100.0}, "standard deviation of x and of y at lambda 1");
  visitor.field("sigma_yaw_rad", sigma_yaw_rad, {0.0, 1.0}, "standard deviation of yaw at lambda 1");
  visitor.field("scale", scale, {0.5, 2.0}, "per_increment: measured over true length of a motion");
  visitor.field("yaw_factor", yaw_factor, {0.5, 2.0}, "per_increment: measured over true angle of a turn");
  visitor.field("rate_hz", rate_hz, {0.0, 1000.0},
                "samples between the stops as well, at this rate; 0 = one sample a stop (motion drive: 50 Hz)");
  visitor.field("declared", declared, "tell the recording's reader the model and the sigmas, in rig.yaml");
  visitor.nested("thrun", thrun, "model thrun: noise of a turn, a straight way and another turn");
  visitor.nested("wheels", wheels, "model wheels: what is true of the wheels");
  for (const auto& [key, value] : {std::pair("scale", &scale), std::pair("yaw_factor", &yaw_factor)})
    visitor.check(model == "per_increment" || (value->lowest() == 1.0 && value->highest() == 1.0), key,
                  "belongs to model per_increment; must be 1 with " + model);
  visitor.check(!declared || model == "per_increment" || model == "per_pose", "declared",
                "must be false with model " + model + ": only per_increment and per_pose can be told in rig.yaml");
}

void RenderConfig::visit(FieldVisitor& visitor) {
  visitor.field("psf_sigma_px", psf_sigma_px, {0.0, 5.0}, "lens blur, standard deviation; 0 = none");
  visitor.field("board_at_double", board_at_double,
                "render the board's region at twice the resolution, one with markers at four or eight times");
  visitor.field("whole_at_double", whole_at_double, "render everything at twice the resolution (slower)");
  visitor.field(
      "lens_residual", lens_residual,
      "every lens displaces its image smoothly by what its model does not follow, as its preset says; none whose "
      "intrinsics the rig or the preset states to be exact");
  visitor.field("motion_blur", motion_blur, "capture moving: images are the mean over their exposure, in linear light");
  visitor.field("rolling_shutter", rolling_shutter, "capture moving: rows are read one after the other");
  visitor.field("exposure_ms", exposure_ms, {0.0, 200.0},
                "exposure of a row, drawn for each camera; 0 = the sensor preset's");
  visitor.field("readout_ms", readout_ms, {0.0, 200.0},
                "rolling shutter: from the first row to the last, drawn for each camera; 0 = the sensor preset's");
  visitor.field("max_parts", max_parts, {1.0, 1000.0},
                "capture moving: most pictures that one image is put together from; between two of them things move by "
                "less than half a pixel, unless this is too few (the truth says so)");
}

void GenerateConfig::visit(FieldVisitor& visitor) {
  visitor.field("name", name, TextChoices{}, "of the run; empty = the configuration file's name");
  visitor.field("seed", seed, {0.0, 9007199254740992.0}, "of all random numbers");
  visitor.field("scene", scene, TextChoices{}, "world in scenes, or a YAML file");
  visitor.field("scenes", scenes,
                "several worlds instead: `rigproof generate` makes a run NAME/SCENE of each, with seeds that count up");
  visitor.nested("randomize", randomize, "domain randomisation: surfaces, light and clutter drawn anew for each seed");
  visitor.field("rig", rig, TextChoices{}, "robot and cameras in models/rigs, or a YAML file");
  visitor.field("depth_frame", depth_frame, TextChoices{{"rig", "registered", "raw"}},
                "registered: depth has the colour camera's pixels; raw: depth as the sensor preset's depth camera "
                "measures it, at its own place; rig: as rig and presets say");
  visitor.field("image_scale", image_scale, {0.05, 1.0},
                "shrinks every camera's image, for quick trials; what the rig states in pixels of it "
                "(`intrinsics_sigma`) shrinks with it");
  visitor.field("poses", poses, {1.0, 1e6}, "stops of the robot; planners covering and sampled");
  visitor.field("stop_period_s", stop_period_s, {0.1, 1000.0}, "teleport: time from stop to stop");
  visitor.field("motion", motion, TextChoices{{"teleport", "drive"}},
                "teleport: the robot is put on its viewpoints exactly, `odometry` says what its wheels tell; drive: it "
                "drives there by physics, and its encoders tell what they count");
  visitor.nested("drive", drive, "motion drive: how it drives");
  visitor.nested("board", board, "the calibration board and where it stands");
  visit_more_boards(visitor, board, more_boards);
  visitor.nested("viewpoints", viewpoints, "where the robot stands when it takes images");
  visitor.nested("straight_drive", straight_drive, "frames along a straight line, for methods that need them");
  visitor.nested("odometry", odometry, "what the wheels tell");
  visitor.check(motion != "drive" || !odometry.declared, "odometry.declared",
                "must be false with motion drive: its odometry follows no noise law that could be told");
  visitor.check(motion != "drive" || odometry.seed < 0, "odometry.seed",
                "must be -1 with motion drive: its odometry is what the wheels count");
  visitor.field("sensor_noise", sensor_noise, TextChoices{{"realistic", "none"}},
                "realistic: noise and effects of the camera's sensor preset; none: no error of a sensor (the lenses' "
                "fields and the board's print stay: render.lens_residual, board.defects)");
  visitor.field("depth_scale_bias_percent", depth_scale_bias_percent, {-20.0, 20.0},
                "measured depth is too large by this, drawn for each camera");
  visitor.nested("sensing", sensing, "sensor_noise realistic: which effects of the sensors are simulated");
  visitor.check(!moves_while_exposing() || sensing.time.camera_delay_ms.lowest() >= 0.0, "sensing.time.camera_delay_ms",
                "must not be negative with drive.capture moving, where images are taken that much later; "
                "clock_offset_ms is for stamps that are wrong");
  visitor.nested("render", render, "how the clean picture is drawn");
  visitor.field("clouds", clouds, TextChoices{{"none", "pcd"}}, "point cloud files beside the depth images");
  visitor.field("cloud_stride_px", cloud_stride_px, {1.0, 64.0}, "every how many pixels a cloud has a point");
  visitor.field("png_level", png_level, {0.0, 3.0}, "of before, without effect: how PNG images were compressed");
}

GenerateConfig load_generate_config(const std::filesystem::path& file) {
  GenerateConfig config;
  read_fields(file, [&config](FieldVisitor& visitor) { config.visit(visitor); });
  if (config.name.empty()) config.name = file.stem().string();
  return config;
}

GenerateConfig parse_generate_config(const std::string& text, const std::filesystem::path& file) {
  GenerateConfig config;
  read_fields_from_text(text, file, [&config](FieldVisitor& visitor) { config.visit(visitor); });
  if (config.name.empty()) config.name = file.stem().string();
  return config;
}

std::string resolved_text(const GenerateConfig& config) { return emit_yaml(tree_of(config)); }

std::string generate_config_schema() { return schema_of<GenerateConfig>("Rigproof run"); }

std::vector<std::string> differences(const GenerateConfig& there, const GenerateConfig& here) {
  std::vector<std::string> result;
  for (const FieldDifference& difference : field_differences(tree_of(there), tree_of(here)))
    result.push_back(difference.path + ": " + difference.there + " there, " + difference.here + " here");
  return result;
}

}  // namespace rigproof
