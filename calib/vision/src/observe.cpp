#include "rigproof/calib/vision/observe.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "board_depth.h"
#include "depth_check.h"
#include "looking.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/calib/vision/parallel.h"
#include "rigproof/calib/vision/picture_memory.h"
#include "rigproof/calib/vision/recall.h"
#include "rigproof/calib/vision/stops.h"
#include "rigproof/core/error.h"
#include "rigproof/core/exclusions.h"
#include "rigproof/core/files.h"
#include "rigproof/core/median.h"
#include "rigproof/core/text.h"
#include "sight.h"
#include "standstill.h"
#include "tag_side.h"

namespace rigproof {
namespace {

using detection::PlaneSight;
using detection::PlannedStop;
using detection::Sight;
using detection::StopPlan;

// Readable images looked at to tell which board is in them when the stated one is in none.
constexpr std::size_t kDiagnosedImages = 12;

// Height sigmas of one camera's planes differ by the share of the image that the floor fills, a few times at most.
constexpr double kMaxUncertaintyRatio = 10.0;

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

std::string sizes_text(const Finding& wrong) {
  const auto value = [&wrong](const char* name) { return static_cast<int>(std::get<double>(wrong.find(name)->value)); };
  return "image is " + size_text(value("width"), value("height")) + ", the rig says " +
         size_text(value("rig_width"), value("rig_height"));
}

double mean_variance(const std::vector<CornerObservation>& corners) {
  double sum = 0.0;
  for (const CornerObservation& corner : corners) sum += corner.covariance_px2.trace();
  return sum / static_cast<double>(std::max<std::size_t>(corners.size(), 1));
}

// More corners, then nearer to the stop's stamp: tyres give way while wheels stand, so that cameras are compared as of
// one moment. Then sharper corners, then the earlier frame.
// @param a_off_s, b_off_s of each frame, from the stop's stamp
bool better(const Sight& a, double a_off_s, const Sight& b, double b_off_s) {
  if (a.corners.size() != b.corners.size()) return a.corners.size() > b.corners.size();
  if (a.readable != b.readable) return a.readable;
  if (a_off_s != b_off_s) return a_off_s < b_off_s;
  return !a.corners.empty() && mean_variance(a.corners) < mean_variance(b.corners);
}

// A file holds the upper triangle: what is solved from memory must not differ from it by the other one's rounding.
template <typename Matrix>
void mirror_upper_triangle(Matrix* covariance) {
  *covariance = Matrix(covariance->template selfadjointView<Eigen::Upper>());
}

template <typename Value>
std::optional<Value> take(std::variant<Value, Unreadable> read, std::string* reason) {
  if (auto* failure = std::get_if<Unreadable>(&read)) {
    *reason = failure->reason;
    return std::nullopt;
  }
  return std::move(std::get<Value>(read));
}

/// What every step reads.
struct Source {
  const Recording& recording;
  const ObserveOptions& options;
  PictureMemory* memory;  ///< null = none

  const RigCamera& camera(const Sight& sight) const {
    return recording.rig.cameras[static_cast<std::size_t>(sight.camera)];
  }
  const CameraFrame& frame(const Sight& sight) const {
    return recording.frames[static_cast<std::size_t>(sight.camera)][static_cast<std::size_t>(sight.frame)];
  }
  const std::string& depth_file(const Sight& sight) const {
    const CameraFrame& seen = frame(sight);
    return seen.depth_file.empty() ? seen.cloud_file : seen.depth_file;
  }
};

using Verticals = std::vector<std::optional<Eigen::Vector3d>>;  // per camera, in its frame

// A board as an image shows it.
struct SeenBoard {
  Rigid3 T_camera_board;
  int board;
};
using Boards = std::map<std::pair<int, int>, SeenBoard>;  // by (stop, camera)

Observations described(const Recording& recording, const StopPlan& plan) {
  const Rig& rig = recording.rig;
  Observations result;
  result.source = recording.folder.string();
  result.robot_frame = rig.robot_frame;
  result.board = rig.board;
  result.more_boards = rig.more_boards;
  result.cameras = rig.cameras;
  result.odometry_noise = rig.odometry_noise;
  result.accept = rig.accept;
  result.exclusions = plan.exclusions;
  for (const PlannedStop& stop : plan.stops) result.stops.push_back(stop.stop);
  return result;
}

// The file of a frame; a path that leaves the recording is a reason like any other.
template <typename Value, typename Read>
std::optional<Value> read(const Recording& recording, const std::string& relative, Read read_file,
                          std::string* reason) {
  try {
    return take<Value>(read_file(path_inside(recording.folder, relative)), reason);
  } catch (const Error& failure) {
    if (failure.exit_code() == ExitCode::kTryAgain) throw;
    *reason = failure.what();
    const std::string path = (recording.folder / relative).string() + ": ";
    if (reason->rfind(path, 0) == 0) reason->erase(0, path.size());
    return std::nullopt;
  }
}

void search(const Source& from, const Board& board, const std::vector<Board>& others, Sight* sight) {
  detection::tell_opened(from.memory, from.frame(*sight).color_file);
  std::string unreadable;
  const auto image = read<Image8>(from.recording, from.frame(*sight).color_file, read_grey_image, &unreadable);
  if (!image) sight->why_not = Finding("image.unreadable", {{"text", unreadable}});
  if (!image) return;
  detection::search_image(*image, from.camera(*sight).camera, board, others, sight);
}

void look_for(const Source& from, int index, Sight* sight) {
  const Board& board = from.recording.rig.board_at(index);
  const std::vector<Board> others = detection::others_than(from.recording.rig, index);
  const std::string content = detection::content_of(from.memory, from.frame(*sight).color_file);
  const std::string key =
      content.empty() ? content : detection::corners_key(content, from.camera(*sight).camera, board, others);
  detection::recall_or(from.memory, PictureMemory::Finding::kCorners, key, sight, [&] {
    search(from, board, others, sight);
    return sight->readable;
  });
}

// Any texture has squares that would be far too small for markers.
bool tells_more(const Sight& other, const Sight& than) {
  return than.why_not && than.why_not->is("board.not_found") && other.why_not && !other.why_not->is("board.too_small");
}

// For the board of which most corners are there; without any, why not is that of the board of which it tells more.
void look(const Source& from, Sight* sight) {
  const Rig& rig = from.recording.rig;
  const Sight before = *sight;
  look_for(from, 0, sight);
  for (int b = 1; b < rig.boards() && sight->readable; ++b) {
    Sight other = before;
    other.board = b;
    look_for(from, b, &other);
    if (other.corners.size() > sight->corners.size() || tells_more(other, *sight)) *sight = other;
  }
}

// By (stop, camera, frame).
std::vector<Sight> planned_sights(const StopPlan& plan) {
  std::vector<Sight> sights;
  for (std::size_t stop = 0; stop < plan.stops.size(); ++stop)
    for (std::size_t camera = 0; camera < plan.stops[stop].frames.size(); ++camera)
      for (const int frame : plan.stops[stop].frames[camera])
        sights.push_back({static_cast<int>(stop), static_cast<int>(camera), frame, false, false, {}, {}});
  return sights;
}

std::vector<Sight> look_for_boards(const Source& from, std::vector<Sight> sights) {
  std::function<bool(std::size_t)> proceed;
  if (from.options.progress) proceed = [&](std::size_t done) { return from.options.progress(done, sights.size()); };
  const auto work = [&](std::size_t i) { look(from, &sights[i]); };
  if (!detection::for_each_parallel(sights.size(), from.options.threads, work, proceed))
    throw Error("interrupted", ExitCode::kTryAgain);
  return sights;
}

// A standstill by the odometry is one if the images stand still, too.
std::vector<Sight> look_for_boards(const Source& from, StopPlan* plan) {
  std::vector<Sight> sights = look_for_boards(from, planned_sights(*plan));
  const std::vector<detection::TimeSpan> moved = detection::false_standstills(from.recording, *plan, sights);
  if (moved.empty()) return sights;
  *plan = detection::plan_stops(from.recording, from.options, moved);
  return look_for_boards(from, planned_sights(*plan));
}

// Another camera of the rig whose images have this size.
std::string owner_of(const Sight& wrong, const Rig& rig) {
  const auto value = [&wrong](const char* name) { return std::get<double>(wrong.why_not->find(name)->value); };
  for (const RigCamera& camera : rig.cameras)
    if (camera.camera.width_px == value("width") && camera.camera.height_px == value("height"))
      return "; " + camera.name + " has this size: are their folders exchanged?";
  return "";
}

// Intrinsics of another size are a fault of the whole camera, not of each frame.
void refuse_wrong_sizes(const Source& from, const std::vector<Sight>& sights) {
  const Recording& recording = from.recording;
  Problems problems;
  std::size_t readable = 0;
  for (std::size_t camera = 0; camera < recording.rig.cameras.size(); ++camera) {
    const Sight* wrong = nullptr;
    std::size_t right = 0;
    for (const Sight& sight : sights) {
      if (static_cast<std::size_t>(sight.camera) != camera) continue;
      right += sight.readable;
      if (sight.wrong_size && wrong == nullptr) wrong = &sight;
    }
    readable += right;
    if (wrong == nullptr || right > 0) continue;
    problems.add({(recording.folder / from.frame(*wrong).color_file).string(), 0,
                  "cameras." + recording.rig.cameras[camera].name, "",
                  sizes_text(*wrong->why_not) + "; every image of this camera differs from its intrinsics" +
                      owner_of(*wrong, recording.rig)});
  }
  problems.throw_if_any();
  if (readable == 0)
    throw Error(recording.folder.string() + ": none of " + std::to_string(sights.size()) +
                " images can be read; the first, " + from.frame(sights.front()).color_file + ": " +
                std::get<std::string>(sights.front().why_not->find("text")->value));
}

// One readable frame for each stop and camera; its view, or why there is none, goes to the observations.
std::vector<const Sight*> choose_frames(const Source& from, const std::vector<Sight>& sights, Observations* result) {
  std::vector<const Sight*> chosen;
  const auto off_s = [&](const Sight& sight) {
    return std::abs(from.frame(sight).stamp_s - result->stops[static_cast<std::size_t>(sight.stop)].stamp_s);
  };
  for (std::size_t begin = 0; begin < sights.size();) {
    std::size_t end = begin + 1, best = begin;
    for (; end < sights.size() && sights[end].stop == sights[begin].stop && sights[end].camera == sights[begin].camera;
         ++end)
      if (better(sights[end], off_s(sights[end]), sights[best], off_s(sights[best]))) best = end;
    for (std::size_t i = begin; i < end; ++i) {
      const Sight& sight = sights[i];
      if (sight.corners.empty() || i != best)
        result->exclusions.push_back({sight.camera, sight.stop, from.frame(sight).color_file,
                                      sight.corners.empty() ? *sight.why_not : Finding("frame.surplus")});
    }
    const Sight& sight = sights[best];
    const CameraFrame& frame = from.frame(sight);
    if (sight.readable) chosen.push_back(&sight);
    if (!sight.corners.empty())
      result->board_views.push_back(
          {sight.stop, sight.camera, frame.stamp_s, frame.color_file, sight.corners, sight.board});
    begin = end;
  }
  return chosen;
}

std::string in_words(const Board& board) {
  const std::string squares = "[" + std::to_string(board.squares_x) + ", " + std::to_string(board.squares_y) + "]";
  const std::string marker = number_text(std::round(100.0 * board.marker_side_m() / board.square_m)) + " % of ";
  if (board.has_tags())
    return "an AprilGrid (type: aprilgrid) with squares " + squares + ", tags of " + marker + "square_mm";
  return "a ChArUco board (type: charuco) with squares " + squares + ", dictionary " + board.dictionary +
         ", markers of " + marker + "the squares' side" + (board.legacy_pattern ? ", legacy_pattern" : "");
}

// What an image shows instead of the stated board; empty: nothing.
std::string other_board_in(const Image8& image, const Board& stated) {
  // First the one with markers: its corners alone look like a checkerboard's.
  if (const std::optional<Board> seen = find_any_marked_board(image))
    return "the images seem to show " + in_words(*seen);
  const std::optional<CheckerboardSize> size = find_any_checkerboard(image);
  return size ? describe_size_mismatch(*size, stated) : std::string();
}

// What most of some evenly spread images show.
std::optional<std::string> board_in_images(const Source& from, const std::vector<const Sight*>& chosen) {
  std::map<std::string, int> votes;
  const std::size_t step = std::max<std::size_t>(1, chosen.size() / kDiagnosedImages);
  for (std::size_t i = 0; i < chosen.size(); i += step) {
    std::string ignored;
    const auto image = read<Image8>(from.recording, from.frame(*chosen[i]).color_file, read_grey_image, &ignored);
    if (!image) continue;
    const std::string seen = other_board_in(*image, from.recording.rig.board);
    if (!seen.empty()) ++votes[seen];
  }
  const auto most =
      std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == votes.end() ? std::nullopt : std::optional(most->first);
}

[[noreturn]] void throw_without_board(const Source& from, const std::vector<const Sight*>& chosen) {
  std::vector<Finding> reasons;
  for (const Sight* sight : chosen) reasons.push_back(*sight->why_not);
  const Board& board = from.recording.rig.board;
  Finding nowhere("board.nowhere",
                  {{"squares_x", board.squares_x}, {"squares_y", board.squares_y}, {"images", chosen.size()}});
  if (const int others = from.recording.rig.boards() - 1; others > 0) nowhere = nowhere.with({{"others", others}});
  if (const std::optional<std::string> seen = board_in_images(from, chosen)) nowhere = nowhere.with({{"seen", *seen}});
  throw FindingError(from.recording.folder.string(), nowhere.by(counted(reasons)));
}

// What is looked at of it, where the memory has that.
std::optional<Image16> read_depth(const Source& from, const Sight& sight, std::string* unreadable) {
  const std::string& file = from.frame(sight).depth_file;
  const std::string content = detection::content_of(from.memory, file);
  if (std::optional<Image16> depth = detection::recall_depth(from.memory, content)) return depth;
  detection::tell_opened(from.memory, file);
  return read<Image16>(from.recording, file, read_depth_image, unreadable);
}

std::optional<DepthPoints> read_points(const Source& from, const Sight& sight, std::optional<Finding>* why_not) {
  const CameraFrame& frame = from.frame(sight);
  const RigCamera& camera = from.camera(sight);
  std::string unreadable;
  if (!frame.depth_file.empty()) {
    const auto depth = read_depth(from, sight, &unreadable);
    const Camera& optics = camera.depth_optics();
    if (depth && depth->width == optics.width_px && depth->height == optics.height_px)
      return sampled_depth(*depth, camera, detection::kDepthPoints);
    *why_not = depth ? detection::wrong_size("depth.wrong_size", depth->width, depth->height, optics)
                     : Finding("depth.unreadable", {{"text", unreadable}});
    return std::nullopt;
  }
  auto cloud = read<std::vector<Eigen::Vector3f>>(from.recording, frame.cloud_file, read_point_cloud, &unreadable);
  if (cloud) return points_from_cloud(std::move(*cloud), *camera.depth, detection::kDepthPoints);
  *why_not = Finding("depth.unreadable", {{"text", unreadable}});
  return std::nullopt;
}

// Rows or columns the other way round.
Image16 turned(Image16 image, detection::DepthReading reading) {
  using detection::DepthReading;
  const auto rows = image.pixels.begin();
  if (reading == DepthReading::kMirrored || reading == DepthReading::kHalfTurn)
    for (std::ptrdiff_t y = 0; y < image.height; ++y)
      std::reverse(rows + y * image.width, rows + (y + 1) * image.width);
  if (reading == DepthReading::kUpsideDown || reading == DepthReading::kHalfTurn)
    for (std::ptrdiff_t y = 0; y < image.height / 2; ++y)
      std::swap_ranges(rows + y * image.width, rows + (y + 1) * image.width,
                       rows + (image.height - 1 - y) * image.width);
  return image;
}

const SeenBoard* board_at(const Boards& boards, const Sight& sight) {
  const auto board = boards.find({sight.stop, sight.camera});
  return board == boards.end() ? nullptr : &board->second;
}

std::optional<Rigid3> pose_of(const SeenBoard* seen) {
  return seen == nullptr ? std::nullopt : std::optional(seen->T_camera_board);
}

// The points of a file whatever their range, otherwise taken than it says.
std::function<std::optional<DepthPoints>(detection::DepthReading)> any_points(const Source& from, const Sight& sight) {
  using detection::DepthReading;
  RigCamera camera = from.camera(sight);
  camera.depth->min_m = 0.0;
  camera.depth->max_m = 1e6;
  const CameraFrame& frame = from.frame(sight);
  std::string ignored;
  if (frame.depth_file.empty()) {
    const auto cloud = read<std::vector<Eigen::Vector3f>>(from.recording, frame.cloud_file, read_point_cloud, &ignored);
    return [cloud, camera](DepthReading reading) -> std::optional<DepthPoints> {
      if (!cloud || (reading != DepthReading::kAsItIs && reading != DepthReading::kBodyAxes)) return std::nullopt;
      std::vector<Eigen::Vector3f> points = *cloud;
      if (reading == DepthReading::kBodyAxes)
        for (Eigen::Vector3f& p : points) p = {-p.y(), -p.z(), p.x()};
      return points_from_cloud(std::move(points), *camera.depth, detection::kDepthPoints);
    };
  }
  const auto depth = read_depth(from, sight, &ignored);
  const Camera& optics = camera.depth_optics();
  const bool fits = depth && depth->width == optics.width_px && depth->height == optics.height_px;
  return [depth, camera, fits](DepthReading reading) -> std::optional<DepthPoints> {
    if (!fits || reading == DepthReading::kBodyAxes) return std::nullopt;
    return sampled_depth(turned(*depth, reading), camera, detection::kDepthPoints);
  };
}

PlaneSight fit_planes(const Board& board, const DepthNoise& noise, const DepthPoints& points,
                      const std::optional<Rigid3>& T_camera_board, const std::optional<Eigen::Vector3d>& up_camera) {
  const detection::SplitPoints split =
      T_camera_board ? detection::split_at_board(points, board, *T_camera_board) : detection::SplitPoints{{}, points};
  GroundPlaneFit ground = fit_ground_plane(split.elsewhere, noise, up_camera);
  PlaneSight result;
  if (!ground.plane) result.why_not = ground.why_not;
  result.ground = std::move(ground.plane);
  if (T_camera_board) result.board = detection::fit_board_plane(split.on_board, noise, *T_camera_board);
  return result;
}

PlaneSight look_at_depth(const Source& from, const Sight& sight, const SeenBoard* seen,
                         const std::optional<Eigen::Vector3d>& up_camera) {
  const std::string content = detection::content_of(from.memory, from.depth_file(sight));
  const RigCamera& camera = from.camera(sight);
  const Board& board = from.recording.rig.board_at(seen == nullptr ? 0 : seen->board);
  const std::optional<Rigid3> T_camera_board = pose_of(seen);
  const std::string key = content.empty() ? content
                                          : detection::planes_key(content, camera, board, detection::kDepthPoints,
                                                                  T_camera_board, up_camera);
  PlaneSight planes;
  detection::recall_or(from.memory, PictureMemory::Finding::kPlanes, key, &planes, [&] {
    std::optional<Finding> unreadable;
    const std::optional<DepthPoints> points = read_points(from, sight, &unreadable);
    if (points) planes = fit_planes(board, camera.depth->noise, *points, T_camera_board, up_camera);
    if (!points) planes.why_not = unreadable;
    return points.has_value();
  });
  return planes;
}

std::vector<PlaneSight> planes_of(const Source& from, const std::vector<const Sight*>& sights, const Boards& boards,
                                  const Verticals& up, std::size_t images) {
  std::vector<PlaneSight> planes(sights.size());
  const auto look = [&](std::size_t i) {
    const Sight& sight = *sights[i];
    planes[i] = look_at_depth(from, sight, board_at(boards, sight), up[static_cast<std::size_t>(sight.camera)]);
  };
  const auto proceed = [&](std::size_t) { return !from.options.progress || from.options.progress(images, images); };
  if (!detection::for_each_parallel(sights.size(), from.options.threads, look, proceed))
    throw Error("interrupted", ExitCode::kTryAgain);
  return planes;
}

Verticals opposite(Verticals up) {
  for (std::optional<Eigen::Vector3d>& direction : up)
    if (direction) direction = -*direction;
  return up;
}

// The sense of the odometry's turns tells up from down. Where it leaves hardly a depth image with a ground, the same
// images are searched for level planes above the camera. Cameras that by the odometry hang upside down and see such
// planes more likely stand upright, and the turns are of the wrong sense (mirrored, or of other stops): the planes
// are kept, and contradict the odometry. Those of upright cameras are ceilings.
bool hang_above(const Source& from, const std::vector<const Sight*>& sights, const Boards& boards,
                const Verticals& down, std::size_t images, std::vector<PlaneSight>* planes) {
  const auto has_ground = [](const PlaneSight& seen) { return seen.ground.has_value(); };
  const auto found = static_cast<std::size_t>(std::count_if(planes->begin(), planes->end(), has_ground));
  if (2 * found >= planes->size()) return false;
  std::vector<PlaneSight> above = planes_of(from, sights, boards, down, images);
  std::size_t below_image = 0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    const std::optional<Eigen::Vector3d>& direction = down[static_cast<std::size_t>(sights[i]->camera)];
    if (!direction || !has_ground(above[i]) || has_ground((*planes)[i])) continue;
    if (direction->y() < 0.0) ++below_image;  // the image's up is nearer to it than to the odometry's
    (*planes)[i].why_not = Finding("plane.above");
  }
  if (2 * below_image <= planes->size()) return false;
  *planes = std::move(above);
  return true;
}

// A board in the middle of its image looks the same from a camera that hangs upside down, as far above it as the other
// is below, and planar motion tells neither: images that are mirrored or upside down pass. The floor does not, if it is
// the ceiling of a camera that sees no other: of one that hangs upside down by its images, or lower than ceilings are.
void find_floors_above(const Source& from, const std::vector<const Sight*>& sights, const Boards& boards,
                       const Verticals& up, std::size_t images, std::vector<PlaneSight>* planes) {
  constexpr double kLowest_m = 1.2;
  std::vector<int> with_ground(up.size(), 0);
  for (std::size_t i = 0; i < sights.size(); ++i)
    with_ground[static_cast<std::size_t>(sights[i]->camera)] += (*planes)[i].ground.has_value();
  std::vector<const Sight*> without;
  std::vector<PlaneSight*> its_planes;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto camera = static_cast<std::size_t>(sights[i]->camera);
    if (with_ground[camera] > 0 || !up[camera]) continue;
    without.push_back(sights[i]);
    its_planes.push_back(&(*planes)[i]);
  }
  const std::vector<PlaneSight> above = planes_of(from, without, boards, opposite(up), images);
  for (std::size_t i = 0; i < without.size(); ++i) {
    const bool hangs = up[static_cast<std::size_t>(without[i]->camera)]->y() > 0.0;  // the image's y is down
    if (above[i].ground && (hangs || height_above(*above[i].ground).height_m < kLowest_m))
      its_planes[i]->why_not = Finding("plane.above");
  }
}

// The board that most of a camera's frames show.
int most_seen_board(const std::vector<const Sight*>& sights, const Boards& boards) {
  std::map<int, int> frames;
  for (const Sight* sight : sights)
    if (const SeenBoard* seen = board_at(boards, *sight)) ++frames[seen->board];
  const auto most =
      std::max_element(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == frames.end() ? 0 : most->first;
}

// Some of a camera's frames that show a board, evenly spread.
std::vector<detection::DepthFrame> frames_to_check(const Source& from, const std::vector<const Sight*>& sights,
                                                   const Boards& boards, int board) {
  const auto pose_at = [&](const Sight& sight) -> std::optional<Rigid3> {
    const SeenBoard* seen = board_at(boards, sight);
    return seen != nullptr && seen->board == board ? pose_of(seen) : std::nullopt;
  };
  std::vector<std::size_t> with_board;
  for (std::size_t i = 0; i < sights.size(); ++i)
    if (pose_at(*sights[i])) with_board.push_back(i);
  std::vector<detection::DepthFrame> frames;
  const std::size_t step = (with_board.size() + kDiagnosedImages - 1) / kDiagnosedImages;
  for (std::size_t k = 0; k < with_board.size(); k += step) {
    const std::size_t i = with_board[k];
    detection::DepthFrame frame;
    frame.T_camera_board = pose_at(*sights[i]);
    if (i > 0) frame.T_camera_board_before = pose_at(*sights[i - 1]);
    if (i + 1 < sights.size()) frame.T_camera_board_after = pose_at(*sights[i + 1]);
    for (int camera = 0; camera < static_cast<int>(from.recording.rig.cameras.size()); ++camera) {
      Sight other = *sights[i];
      other.camera = camera;
      frame.T_other_board.push_back(camera == sights[i]->camera ? std::nullopt : pose_at(other));
    }
    frame.points = any_points(from, *sights[i]);
    frames.push_back(std::move(frame));
  }
  return frames;
}

// Whether depth sees the board where the corners do.
bool meets_board(const PlaneSight& planes, const Rigid3& T_camera_board) {
  constexpr double kOff = 0.1, kSigmas = 3.0;
  if (!planes.board) return false;
  const Eigen::Vector3d& place = T_camera_board.translation;
  const double sigma = std::sqrt(place.dot(planes.board->covariance_per_m2 * place));
  return std::abs(planes.board->inverse_depth_plane.dot(place) - 1.0) < kOff + kSigmas * sigma;
}

// Of depth that is mirrored against its images one of the two is flipped: where the floor that depth would show lies
// above by the motion of the images, it is they. An image that is turned by half a turn moves as a camera that hangs
// upside down, and depth cannot tell.
bool images_are_flipped(const std::vector<detection::DepthFrame>& frames, detection::DepthReading reading,
                        const Board& board, const Rig& rig, int camera, const Eigen::Vector3d& up_camera) {
  const DepthNoise& noise = rig.cameras[static_cast<std::size_t>(camera)].depth->noise;
  int below = 0, above = 0;
  for (const detection::DepthFrame& frame : frames) {
    const std::optional<DepthPoints> points = frame.points(reading);
    if (!points) continue;
    const auto has_ground = [&](const Eigen::Vector3d& up) {
      return fit_planes(board, noise, *points, frame.T_camera_board, up).ground.has_value();
    };
    below += has_ground(up_camera);
    above += has_ground(-up_camera);
  }
  return above > below;
}

// Depth that does not belong to its images is left out as a whole, with the cause.
void drop_foreign_depth(const Source& from, const std::vector<const Sight*>& sights, const Boards& boards,
                        const Verticals& up, std::vector<PlaneSight>* planes) {
  constexpr double kUnit = 0.4;  // of the logarithm of a factor: no scale is that wrong
  constexpr std::size_t kOneIn = 5;
  for (int camera = 0; camera < static_cast<int>(from.recording.rig.cameras.size()); ++camera) {
    std::vector<const Sight*> of_camera;
    std::vector<PlaneSight*> its_planes;
    std::size_t views = 0, meet = 0, measured = 0;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      if (sights[i]->camera != camera) continue;
      of_camera.push_back(sights[i]);
      its_planes.push_back(&(*planes)[i]);
      const SeenBoard* seen = board_at(boards, *sights[i]);
      views += seen != nullptr;
      measured += seen != nullptr && (*planes)[i].board.has_value();
      meet += seen != nullptr && meets_board((*planes)[i], seen->T_camera_board);
    }
    if (kOneIn * (views - meet) <= views) continue;
    const int index = most_seen_board(of_camera, boards);
    const Board& board = from.recording.rig.board_at(index);
    const double unit_m = from.camera(*of_camera.front()).depth->unit_m;
    const std::vector<detection::DepthFrame> frames = frames_to_check(from, of_camera, boards, index);
    auto fault = detection::find_depth_fault(frames, board, unit_m);
    if (!fault) continue;
    const std::optional<Eigen::Vector3d>& up_camera = up[static_cast<std::size_t>(camera)];
    if (fault->cause.is("depth.mirrored") && up_camera &&
        images_are_flipped(frames, fault->fits, board, from.recording.rig, camera, *up_camera))
      fault->cause = Finding("images.mirrored");
    // A factor of what is within range is the board's or the sensor's, which the solution tells.
    if (const FindingValue* factor = fault->cause.find("factor"))
      if (2 * measured >= views || std::abs(std::log(std::get<double>(factor->value))) < kUnit) continue;
    std::vector<std::string> names = {from.recording.rig.cameras[static_cast<std::size_t>(camera)].name};
    if (fault->other >= 0) names.push_back(from.recording.rig.cameras[static_cast<std::size_t>(fault->other)].name);
    for (PlaneSight* seen : its_planes) *seen = {std::nullopt, std::nullopt, fault->cause.of(names)};
  }
}

void exclude_depth(int camera, int stop, const std::string& file, const Finding& why, Observations* result) {
  result->exclusions.push_back({camera, stop, file, why, true});
}

void keep(const Sight& sight, const std::string& file, PlaneSight planes, Observations* result) {
  if (planes.why_not) exclude_depth(sight.camera, sight.stop, file, *planes.why_not, result);
  const auto add = [&](std::optional<PlaneObservation>& plane, std::vector<PlaneObservation>* to) {
    if (!plane) return;
    plane->stop = sight.stop;
    plane->camera = sight.camera;
    plane->file = file;
    to->push_back(std::move(*plane));
  };
  add(planes.ground, &result->ground_planes);
  add(planes.board, &result->board_planes);
}

// Something before the board, or a shine on it. What all frames of a camera and board share is a scale, and stays.
void drop_odd_board_planes(const Boards& boards, std::vector<PlaneObservation>* planes) {
  constexpr double kOdd = 0.05, kSigmas = 3.0;
  const auto place_of = [&](const PlaneObservation& plane) {
    return boards.at({plane.stop, plane.camera}).T_camera_board.translation;
  };
  const auto key_of = [&](const PlaneObservation& plane) {
    return std::pair(plane.camera, boards.at({plane.stop, plane.camera}).board);
  };
  // Expected over measured distance; 0 behind the camera.
  const auto ratio_of = [&](const PlaneObservation& plane) {
    return std::max(0.0, plane.inverse_depth_plane.dot(place_of(plane)));
  };
  std::map<std::pair<int, int>, std::vector<double>> ratios;
  for (const PlaneObservation& plane : *planes) ratios[key_of(plane)].push_back(ratio_of(plane));
  const auto is_odd = [&](const PlaneObservation& plane) {
    const Eigen::Vector3d place = place_of(plane);
    const double ratio = ratio_of(plane), middle = median(ratios[key_of(plane)]);
    const double sigma = std::sqrt(place.dot(plane.covariance_per_m2 * place));
    return !(ratio > 0.0 && std::abs(ratio - middle) <= kOdd * middle + kSigmas * sigma);
  };
  planes->erase(std::remove_if(planes->begin(), planes->end(), is_odd), planes->end());
}

// A plane far less certain than its camera's others is a mixture of surfaces; its vote would agree with any height.
void drop_uncertain_planes(Observations* result) {
  std::map<int, std::vector<double>> sigmas;
  for (const PlaneObservation& plane : result->ground_planes)
    sigmas[plane.camera].push_back(height_above(plane).sigma_m);
  std::vector<PlaneObservation> certain;
  for (PlaneObservation& plane : result->ground_planes) {
    if (height_above(plane).sigma_m <= kMaxUncertaintyRatio * median(sigmas[plane.camera]))
      certain.push_back(std::move(plane));
    else
      exclude_depth(plane.camera, plane.stop, plane.file, Finding("plane.uncertain"), result);
  }
  result->ground_planes = std::move(certain);
}

// The planes of all frames must agree with the vertical and with each other.
void vote_on_ground(const std::vector<ViewPose>& poses, bool upside_down, Observations* result) {
  TrajectoryAlignment alignment = align_trajectories(*result, poses);
  if (upside_down) alignment.up_camera = opposite(std::move(alignment.up_camera));
  const GroundCheck check = check_ground_planes(*result, alignment);
  result->ground_planes = check.planes(*result);
  result->exclusions.insert(result->exclusions.end(), check.rejected.begin(), check.rejected.end());
}

bool same_bytes(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code error;
  if (std::filesystem::file_size(a, error) != std::filesystem::file_size(b, error) || error) return false;
  return read_binary_file(a) == read_binary_file(b);
}

// The same depth though the board is elsewhere in the image, or though the image is a repetition, too. Without noise a
// floor alone may well look the same twice.
bool repeats_depth(const Source& from, const Boards& boards, const Sight& before, const Sight& sight) {
  const bool repeated_image = sight.why_not && sight.why_not->is("image.repeats");
  const bool both_show_board = board_at(boards, before) != nullptr && board_at(boards, sight) != nullptr;
  if (!repeated_image && !both_show_board) return false;
  const std::string content = detection::content_of(from.memory, from.depth_file(sight));
  if (!content.empty()) return content == detection::content_of(from.memory, from.depth_file(before));
  const std::filesystem::path& folder = from.recording.folder;
  return same_bytes(folder / from.depth_file(before), folder / from.depth_file(sight));
}

// Boards first: how the cameras moved past them tells where up is, so that walls are not taken for the ground.
void add_planes(const Source& from, const std::vector<const Sight*>& chosen, std::size_t images, Observations* result) {
  const std::vector<ViewPose> poses = estimate_view_poses(*result).poses;
  Boards boards;
  for (const ViewPose& pose : poses) boards[{pose.stop, pose.camera}] = {pose.T_camera_board, pose.board};
  std::vector<const Sight*> with_depth;
  std::map<int, const Sight*> last;
  for (const Sight* sight : chosen) {
    if (!from.camera(*sight).depth) continue;
    const Sight*& before = last[sight->camera];
    if (from.depth_file(*sight).empty())
      exclude_depth(sight->camera, sight->stop, from.frame(*sight).color_file, Finding("depth.missing"), result);
    else if (before != nullptr && repeats_depth(from, boards, *before, *sight))
      exclude_depth(sight->camera, sight->stop, from.depth_file(*sight),
                    Finding("depth.repeats", {{"file", from.depth_file(*before)}}), result);
    else
      with_depth.push_back(before = sight);
  }
  if (with_depth.empty()) return;
  const TrajectoryAlignment alignment = align_trajectories(*result, poses);
  const bool by_motion = alignment.source == VerticalSource::kMotion;
  const Verticals up = by_motion ? alignment.up_camera : Verticals(result->cameras.size());
  std::vector<PlaneSight> planes = planes_of(from, with_depth, boards, up, images);
  const bool upside_down = by_motion && hang_above(from, with_depth, boards, opposite(up), images, &planes);
  if (by_motion && !upside_down) find_floors_above(from, with_depth, boards, up, images, &planes);
  drop_foreign_depth(from, with_depth, boards, up, &planes);
  for (std::size_t i = 0; i < planes.size(); ++i)
    keep(*with_depth[i], from.depth_file(*with_depth[i]), std::move(planes[i]), result);
  drop_odd_board_planes(boards, &result->board_planes);
  drop_uncertain_planes(result);
  vote_on_ground(poses, upside_down, result);
}

void make_symmetric(Observations* result) {
  for (BoardView& view : result->board_views)
    for (CornerObservation& corner : view.corners) mirror_upper_triangle(&corner.covariance_px2);
  for (auto* planes : {&result->ground_planes, &result->board_planes})
    for (PlaneObservation& plane : *planes) mirror_upper_triangle(&plane.covariance_per_m2);
}

// Images tell the tags' share of an AprilGrid better than a ruler does, so that marker_mm need only be near it.
void measure_tags(const Recording& recording, int index, Observations* result) {
  constexpr double kOff = 0.03;
  Board& board = index == 0 ? result->board : result->more_boards[static_cast<std::size_t>(index) - 1];
  const std::optional<double> share = board.has_tags() ? detection::tag_share_in(*result, index) : std::nullopt;
  if (!share) return;
  const double seen_m = *share * board.square_m, stated_m = board.marker_side_m();
  if (std::abs(seen_m / stated_m - 1.0) > kOff)
    throw Error((recording.folder / "rig.yaml").string() +
                (index == 0 ? ": board" : ": more_boards[" + std::to_string(index - 1) + "]") +
                ".marker_mm: " + number_text(std::round(1e4 * stated_m) / 10.0) + ", but in the images tags have " +
                number_text(std::round(1e3 * *share) / 10.0) + " % of the distance from tag to tag: " +
                number_text(std::round(1e4 * seen_m) / 10.0) + " if square_mm (tag and gap) is right");
  board.marker_m = seen_m;
}

}  // namespace

Observations observe(const Recording& recording, const ObserveOptions& options) {
  return observe(recording, options, nullptr);
}

Observations observe(const Recording& recording, const ObserveOptions& options, PictureMemory* memory) {
  StopPlan plan = detection::plan_stops(recording, options);
  const Source from{recording, options, memory};
  std::vector<Sight> sights = look_for_boards(from, &plan);
  refuse_wrong_sizes(from, sights);
  detection::drop_repeated_images(recording, plan, &sights);
  Observations result = described(recording, plan);
  const std::vector<const Sight*> chosen = choose_frames(from, sights, &result);
  if (result.board_views.empty()) throw_without_board(from, chosen);
  for (int b = 0; b < result.boards(); ++b) measure_tags(recording, b, &result);
  if (options.use_depth) add_planes(from, chosen, sights.size(), &result);
  make_symmetric(&result);
  std::stable_sort(result.exclusions.begin(), result.exclusions.end(), [](const Exclusion& a, const Exclusion& b) {
    return std::tie(a.camera, a.stop, a.file) < std::tie(b.camera, b.stop, b.file);
  });
  return result;
}

}  // namespace rigproof
