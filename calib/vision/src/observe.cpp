#include "rigproof/calib/vision/observe.h"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "board_depth.h"
#include "parallel.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/picture_memory.h"
#include "rigproof/calib/vision/recall.h"
#include "rigproof/core/error.h"
#include "rigproof/core/exclusions.h"
#include "rigproof/core/files.h"
#include "sight.h"
#include "stops.h"

namespace rigproof {
namespace {

using detection::PlaneSight;
using detection::PlannedStop;
using detection::Sight;
using detection::StopPlan;

// Depth images are sampled so that about this many points remain: more tell little about a plane and cost time.
constexpr int kDepthPoints = 12000;
// Readable images looked at to tell which board is in them when the stated one is in none.
constexpr std::size_t kDiagnosedImages = 12;

// Height sigmas of one camera's planes differ by the share of the image that the floor fills, a few times at most.
constexpr double kMaxUncertaintyRatio = 10.0;

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

Finding wrong_size(const char* code, int width, int height, const Camera& rig) {
  return Finding(code,
                 {{"width", width}, {"height", height}, {"rig_width", rig.width_px}, {"rig_height", rig.height_px}});
}

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

// More corners, then sharper ones, then the earlier frame.
bool better(const Sight& a, const Sight& b) {
  if (a.corners.size() != b.corners.size()) return a.corners.size() > b.corners.size();
  if (a.readable != b.readable) return a.readable;
  return !a.corners.empty() && mean_variance(a.corners) < mean_variance(b.corners);
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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

class Observer {
 public:
  Observer(const Recording& recording, const ObserveOptions& options, PictureMemory* memory)
      : recording_(recording), options_(options), memory_(memory), plan_(detection::plan_stops(recording, options)) {}

  Observations run() {
    const std::string& type = recording_.rig.board.type;
    if (type != "checkerboard")
      throw Error(recording_.folder.string() + ": board.type: " + type +
                  ": such boards are printed and rendered, but not detected; calibration needs a checkerboard");
    describe();
    look_for_boards();
    refuse_wrong_sizes();
    choose_frames();
    refuse_without_board();
    if (options_.use_depth) look_at_depth();
    make_symmetric();
    sort_exclusions();
    return std::move(result_);
  }

 private:
  void describe() {
    const Rig& rig = recording_.rig;
    result_.source = recording_.folder.string();
    result_.robot_frame = rig.robot_frame;
    result_.board = rig.board;
    result_.cameras = rig.cameras;
    result_.odometry_noise = rig.odometry_noise;
    result_.accept = rig.accept;
    result_.exclusions = plan_.exclusions;
    for (const PlannedStop& stop : plan_.stops) result_.stops.push_back(stop.stop);
  }

  const CameraFrame& frame_of(const Sight& sight) const {
    return recording_.frames[static_cast<std::size_t>(sight.camera)][static_cast<std::size_t>(sight.frame)];
  }

  void exclude(const Sight& sight, const Finding& why) {
    result_.exclusions.push_back({sight.camera, sight.stop, frame_of(sight).color_file, why});
  }

  void exclude_depth(int camera, int stop, const std::string& file, const Finding& why) {
    result_.exclusions.push_back({camera, stop, file, why, true});
  }

  // The file of a frame; a path that leaves the recording is a reason like any other.
  template <typename Value, typename Read>
  std::optional<Value> read(const std::string& relative, Read read_file, std::string* reason) const {
    try {
      return take<Value>(read_file(path_inside(recording_.folder, relative)), reason);
    } catch (const Error& failure) {
      *reason = failure.what();
      const std::string path = (recording_.folder / relative).string() + ": ";
      if (reason->rfind(path, 0) == 0) reason->erase(0, path.size());
      return std::nullopt;
    }
  }

  std::optional<Image8> read_image(const Sight& sight, std::string* reason) const {
    return read<Image8>(frame_of(sight).color_file, read_grey_image, reason);
  }

  void look(Sight* sight) const {
    const std::string content = detection::content_of(memory_, frame_of(*sight).color_file);
    const Camera& camera = recording_.rig.cameras[static_cast<std::size_t>(sight->camera)].camera;
    const std::string key = content.empty() ? content : detection::corners_key(content, camera, recording_.rig.board);
    detection::recall_or(memory_, PictureMemory::Finding::kCorners, key, sight, [&] {
      search(sight);
      return sight->readable;
    });
  }

  void search(Sight* sight) const {
    std::string unreadable;
    const std::optional<Image8> image = read_image(*sight, &unreadable);
    if (!image) sight->why_not = Finding("image.unreadable", {{"text", unreadable}});
    if (!image) return;
    const Camera& camera = recording_.rig.cameras[static_cast<std::size_t>(sight->camera)].camera;
    sight->wrong_size = image->width != camera.width_px || image->height != camera.height_px;
    if (sight->wrong_size) {
      sight->why_not = wrong_size("image.wrong_size", image->width, image->height, camera);
      return;
    }
    sight->readable = true;
    BoardDetection detection = detect_checkerboard(*image, recording_.rig.board);
    if (auto* missing = std::get_if<BoardNotFound>(&detection))
      sight->why_not = missing->why;
    else
      sight->corners = std::move(std::get<std::vector<CornerObservation>>(detection));
  }

  void look_for_boards() {
    for (std::size_t stop = 0; stop < plan_.stops.size(); ++stop)
      for (std::size_t camera = 0; camera < plan_.stops[stop].frames.size(); ++camera)
        for (const int frame : plan_.stops[stop].frames[camera])
          sights_.push_back({static_cast<int>(stop), static_cast<int>(camera), frame, false, false, {}, {}});
    std::function<bool(std::size_t)> proceed;
    if (options_.progress) proceed = [this](std::size_t done) { return options_.progress(done, sights_.size()); };
    const bool finished = detection::for_each_parallel(
        sights_.size(), options_.threads, [this](std::size_t i) { look(&sights_[i]); }, proceed);
    if (!finished) throw Error("interrupted", ExitCode::kTryAgain);
  }

  // Intrinsics of another size are a fault of the whole camera, not of each frame.
  void refuse_wrong_sizes() const {
    Problems problems;
    std::size_t readable = 0;
    for (std::size_t camera = 0; camera < recording_.rig.cameras.size(); ++camera) {
      const Sight* wrong = nullptr;
      std::size_t right = 0;
      for (const Sight& sight : sights_) {
        if (static_cast<std::size_t>(sight.camera) != camera) continue;
        right += sight.readable;
        if (sight.wrong_size && wrong == nullptr) wrong = &sight;
      }
      readable += right;
      if (wrong == nullptr || right > 0) continue;
      const std::string name = recording_.rig.cameras[camera].name;
      problems.add({(recording_.folder / frame_of(*wrong).color_file).string(), 0, "cameras." + name, "",
                    sizes_text(*wrong->why_not) + "; every image of this camera differs from its intrinsics"});
    }
    problems.throw_if_any();
    if (readable == 0)
      throw Error(recording_.folder.string() + ": none of " + std::to_string(sights_.size()) +
                  " images can be read; the first, " + frame_of(sights_.front()).color_file + ": " +
                  std::get<std::string>(sights_.front().why_not->find("text")->value));
  }

  // One frame for each stop and camera.
  void choose_frames() {
    for (std::size_t begin = 0; begin < sights_.size();) {
      std::size_t end = begin + 1, best = begin;
      for (; end < sights_.size() && sights_[end].stop == sights_[begin].stop &&
             sights_[end].camera == sights_[begin].camera;
           ++end)
        if (better(sights_[end], sights_[best])) best = end;
      for (std::size_t i = begin; i < end; ++i) {
        if (sights_[i].corners.empty())
          exclude(sights_[i], *sights_[i].why_not);
        else if (i != best)
          exclude(sights_[i], Finding("frame.surplus"));
      }
      keep(sights_[best]);
      begin = end;
    }
  }

  void keep(const Sight& sight) {
    if (!sight.readable) return;
    chosen_.push_back(&sight);
    if (sight.corners.empty()) return;
    const CameraFrame& frame = frame_of(sight);
    result_.board_views.push_back({sight.stop, sight.camera, frame.stamp_s, frame.color_file, sight.corners});
  }

  void refuse_without_board() const {
    if (!result_.board_views.empty()) return;
    std::vector<Finding> reasons;
    for (const Sight* sight : chosen_) reasons.push_back(*sight->why_not);
    const Board& board = recording_.rig.board;
    Finding nowhere("board.nowhere",
                    {{"squares_x", board.squares_x}, {"squares_y", board.squares_y}, {"images", chosen_.size()}});
    if (const std::optional<CheckerboardSize> seen = board_in_images())
      nowhere = nowhere.with({{"seen", describe_size_mismatch(*seen, board)}});
    throw FindingError(recording_.folder.string(), nowhere.by(counted(reasons)));
  }

  // The size of board that most of some evenly spread images show.
  std::optional<CheckerboardSize> board_in_images() const {
    std::map<std::pair<int, int>, int> votes;
    const std::size_t step = std::max<std::size_t>(1, chosen_.size() / kDiagnosedImages);
    for (std::size_t i = 0; i < chosen_.size(); i += step) {
      std::string ignored;
      const std::optional<Image8> image = read_image(*chosen_[i], &ignored);
      if (!image) continue;
      if (const auto size = find_any_checkerboard(*image))
        ++votes[{size->inner_corners_long, size->inner_corners_short}];
    }
    const auto most =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == votes.end()) return std::nullopt;
    return CheckerboardSize{most->first.first, most->first.second};
  }

  std::optional<DepthPoints> read_points(const Sight& sight, std::optional<Finding>* why_not) const {
    std::string unreadable;
    const auto give_up = [&] {
      *why_not = Finding("depth.unreadable", {{"text", unreadable}});
      return std::nullopt;
    };
    const CameraFrame& frame = frame_of(sight);
    const RigCamera& camera = recording_.rig.cameras[static_cast<std::size_t>(sight.camera)];
    if (!frame.depth_file.empty()) {
      const std::optional<Image16> depth = read<Image16>(frame.depth_file, read_depth_image, &unreadable);
      if (!depth) return give_up();
      const Camera& depth_camera = camera.depth->own_camera ? camera.depth->own_camera->camera : camera.camera;
      if (depth->width != depth_camera.width_px || depth->height != depth_camera.height_px) {
        *why_not = wrong_size("depth.wrong_size", depth->width, depth->height, depth_camera);
        return std::nullopt;
      }
      int stride = 1;
      while ((depth->width / stride) * (depth->height / stride) > kDepthPoints) ++stride;
      return points_from_depth(*depth, camera, stride);
    }
    std::optional<std::vector<Eigen::Vector3f>> cloud =
        read<std::vector<Eigen::Vector3f>>(frame.cloud_file, read_point_cloud, &unreadable);
    if (!cloud) return give_up();
    return points_of_cloud(std::move(*cloud), *camera.depth);
  }

  // Clouds come in the colour camera's frame; only what the sensor can measure counts.
  static DepthPoints points_of_cloud(std::vector<Eigen::Vector3f> cloud, const DepthStream& depth) {
    const auto min = static_cast<float>(depth.min_m), max = static_cast<float>(depth.max_m);
    cloud.erase(std::remove_if(cloud.begin(), cloud.end(),
                               [&](const Eigen::Vector3f& p) { return !(p.z() >= min && p.z() <= max); }),
                cloud.end());
    DepthPoints points;
    points.min_m = depth.min_m;
    points.max_m = depth.max_m;
    const std::size_t step = cloud.size() / static_cast<std::size_t>(kDepthPoints) + 1;
    for (std::size_t i = 0; i < cloud.size(); i += step) points.points.push_back(cloud[i]);
    return points;
  }

  const std::string& depth_file_of(const Sight& sight) const {
    const CameraFrame& frame = frame_of(sight);
    return frame.depth_file.empty() ? frame.cloud_file : frame.depth_file;
  }

  PlaneSight look_at_depth(const Sight& sight, const std::optional<Rigid3>& T_camera_board,
                           const std::optional<Eigen::Vector3d>& up_camera) const {
    const std::string content = detection::content_of(memory_, depth_file_of(sight));
    const RigCamera& camera = recording_.rig.cameras[static_cast<std::size_t>(sight.camera)];
    const std::string key = content.empty() ? content
                                            : detection::planes_key(content, camera, recording_.rig.board, kDepthPoints,
                                                                    T_camera_board, up_camera);
    PlaneSight planes;
    detection::recall_or(memory_, PictureMemory::Finding::kPlanes, key, &planes, [&] {
      std::optional<Finding> unreadable;
      const std::optional<DepthPoints> points = read_points(sight, &unreadable);
      if (points) planes = fit_planes(sight, *points, T_camera_board, up_camera);
      if (!points) planes.why_not = unreadable;
      return points.has_value();
    });
    return planes;
  }

  PlaneSight fit_planes(const Sight& sight, const DepthPoints& points, const std::optional<Rigid3>& T_camera_board,
                        const std::optional<Eigen::Vector3d>& up_camera) const {
    PlaneSight result;
    const DepthNoise& noise = recording_.rig.cameras[static_cast<std::size_t>(sight.camera)].depth->noise;
    const auto fit_ground = [&](const DepthPoints& elsewhere) {
      GroundPlaneFit fit = fit_ground_plane(elsewhere, noise, up_camera);
      result.ground = std::move(fit.plane);
      if (!result.ground) result.why_not = fit.why_not;
    };
    if (!T_camera_board) {
      fit_ground(points);
      return result;
    }
    const detection::SplitPoints split = detection::split_at_board(points, recording_.rig.board, *T_camera_board);
    fit_ground(split.elsewhere);
    result.board = detection::fit_board_plane(split.on_board, noise, *T_camera_board);
    return result;
  }

  // Boards first: how the cameras moved past them tells where up is, so that walls are not taken for the ground.
  void look_at_depth() {
    std::vector<const Sight*> with_depth;
    for (const Sight* sight : chosen_) {
      const CameraFrame& frame = frame_of(*sight);
      if (!recording_.rig.cameras[static_cast<std::size_t>(sight->camera)].depth) continue;
      if (frame.depth_file.empty() && frame.cloud_file.empty())
        exclude_depth(sight->camera, sight->stop, frame.color_file, Finding("depth.missing"));
      else
        with_depth.push_back(sight);
    }
    if (with_depth.empty()) return;
    const std::vector<ViewPose> poses = estimate_view_poses(result_).poses;
    const TrajectoryAlignment alignment = align_trajectories(result_, poses);
    Boards boards;
    for (const ViewPose& pose : poses) boards[{pose.stop, pose.camera}] = pose.T_camera_board;
    Verticals up(result_.cameras.size());
    if (alignment.source == VerticalSource::kMotion) up = alignment.up_camera;
    std::vector<PlaneSight> planes = planes_of(with_depth, boards, up);
    const bool upside_down =
        alignment.source == VerticalSource::kMotion && hang_above(with_depth, boards, opposite(up), &planes);
    for (std::size_t i = 0; i < planes.size(); ++i) keep(*with_depth[i], std::move(planes[i]));
    drop_odd_board_planes(boards);
    drop_uncertain_planes();
    vote_on_ground(poses, upside_down);
  }

  using Verticals = std::vector<std::optional<Eigen::Vector3d>>;  // per camera, in its frame
  using Boards = std::map<std::pair<int, int>, Rigid3>;           // T_camera_board by (stop, camera)

  static Verticals opposite(Verticals up) {
    for (std::optional<Eigen::Vector3d>& direction : up)
      if (direction) direction = -*direction;
    return up;
  }

  std::vector<PlaneSight> planes_of(const std::vector<const Sight*>& sights, const Boards& boards,
                                    const Verticals& up) const {
    std::vector<PlaneSight> planes(sights.size());
    const auto look = [&](std::size_t i) {
      const Sight& sight = *sights[i];
      const auto board = boards.find({sight.stop, sight.camera});
      planes[i] = look_at_depth(sight, board == boards.end() ? std::nullopt : std::optional(board->second),
                                up[static_cast<std::size_t>(sight.camera)]);
    };
    const auto proceed = [this](std::size_t) {
      return !options_.progress || options_.progress(sights_.size(), sights_.size());
    };
    if (!detection::for_each_parallel(sights.size(), options_.threads, look, proceed))
      throw Error("interrupted", ExitCode::kTryAgain);
    return planes;
  }

  // The sense of the odometry's turns tells up from down. Where it leaves hardly a depth image with a ground, the same
  // images are searched for level planes above the camera. Cameras that by the odometry hang upside down and see such
  // planes more likely stand upright, and the turns are of the wrong sense (mirrored, or of other stops): the planes
  // are kept, and contradict the odometry. Those of upright cameras are ceilings.
  bool hang_above(const std::vector<const Sight*>& sights, const Boards& boards, const Verticals& down,
                  std::vector<PlaneSight>* planes) const {
    const auto has_ground = [](const PlaneSight& seen) { return seen.ground.has_value(); };
    const auto found = static_cast<std::size_t>(std::count_if(planes->begin(), planes->end(), has_ground));
    if (2 * found >= planes->size()) return false;
    std::vector<PlaneSight> above = planes_of(sights, boards, down);
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

  void keep(const Sight& sight, PlaneSight planes) {
    const std::string& file = depth_file_of(sight);
    if (planes.why_not) exclude_depth(sight.camera, sight.stop, file, *planes.why_not);
    const auto add = [&](std::optional<PlaneObservation>& plane, std::vector<PlaneObservation>* to) {
      if (!plane) return;
      plane->stop = sight.stop;
      plane->camera = sight.camera;
      plane->file = file;
      to->push_back(std::move(*plane));
    };
    add(planes.ground, &result_.ground_planes);
    add(planes.board, &result_.board_planes);
  }

  // Something before the board, or a shine on it. What all frames of a camera share is its scale, and stays.
  void drop_odd_board_planes(const Boards& boards) {
    constexpr double kOdd = 0.05, kSigmas = 3.0;
    std::map<int, std::vector<double>> ratios;
    std::vector<double> ratio_of;  // expected over measured distance; 0 behind the camera
    for (const PlaneObservation& plane : result_.board_planes) {
      const Eigen::Vector3d& place = boards.at({plane.stop, plane.camera}).translation;
      ratio_of.push_back(std::max(0.0, plane.inverse_depth_plane.dot(place)));
      ratios[plane.camera].push_back(ratio_of.back());
    }
    std::vector<PlaneObservation> kept;
    for (std::size_t i = 0; i < ratio_of.size(); ++i) {
      PlaneObservation& plane = result_.board_planes[i];
      const Eigen::Vector3d& place = boards.at({plane.stop, plane.camera}).translation;
      const double median = median_of(ratios[plane.camera]);
      const double sigma = std::sqrt(place.dot(plane.covariance_per_m2 * place));
      if (ratio_of[i] > 0.0 && std::abs(ratio_of[i] - median) <= kOdd * median + kSigmas * sigma)
        kept.push_back(std::move(plane));
    }
    result_.board_planes = std::move(kept);
  }

  // A plane far less certain than its camera's others is a mixture of surfaces; its vote would agree with any height.
  void drop_uncertain_planes() {
    std::map<int, std::vector<double>> sigmas;
    for (const PlaneObservation& plane : result_.ground_planes)
      sigmas[plane.camera].push_back(height_above(plane).sigma_m);
    std::vector<PlaneObservation> certain;
    for (PlaneObservation& plane : result_.ground_planes) {
      const double sigma = height_above(plane).sigma_m;
      if (sigma <= kMaxUncertaintyRatio * median_of(sigmas[plane.camera]))
        certain.push_back(std::move(plane));
      else
        exclude_depth(plane.camera, plane.stop, plane.file, Finding("plane.uncertain"));
    }
    result_.ground_planes = std::move(certain);
  }

  // The planes of all frames must agree with the vertical and with each other.
  void vote_on_ground(const std::vector<ViewPose>& poses, bool upside_down) {
    TrajectoryAlignment alignment = align_trajectories(result_, poses);
    if (upside_down) alignment.up_camera = opposite(std::move(alignment.up_camera));
    const GroundCheck check = check_ground_planes(result_, alignment);
    std::vector<PlaneObservation> accepted;
    for (std::size_t i = 0; i < result_.ground_planes.size(); ++i)
      if (check.accepted[i]) accepted.push_back(std::move(result_.ground_planes[i]));
    result_.ground_planes = std::move(accepted);
    result_.exclusions.insert(result_.exclusions.end(), check.rejected.begin(), check.rejected.end());
  }

  void make_symmetric() {
    for (BoardView& view : result_.board_views)
      for (CornerObservation& corner : view.corners) mirror_upper_triangle(&corner.covariance_px2);
    for (auto* planes : {&result_.ground_planes, &result_.board_planes})
      for (PlaneObservation& plane : *planes) mirror_upper_triangle(&plane.covariance_per_m2);
  }

  void sort_exclusions() {
    std::stable_sort(result_.exclusions.begin(), result_.exclusions.end(), [](const Exclusion& a, const Exclusion& b) {
      return std::tie(a.camera, a.stop, a.file) < std::tie(b.camera, b.stop, b.file);
    });
  }

  const Recording& recording_;
  const ObserveOptions& options_;
  PictureMemory* memory_;  ///< null = none
  StopPlan plan_;
  std::vector<Sight> sights_;         ///< by (stop, camera, frame)
  std::vector<const Sight*> chosen_;  ///< one readable frame for each (stop, camera)
  Observations result_;
};

}  // namespace

Observations observe(const Recording& recording, const ObserveOptions& options) {
  return Observer(recording, options, nullptr).run();
}

Observations observe(const Recording& recording, const ObserveOptions& options, PictureMemory* memory) {
  return Observer(recording, options, memory).run();
}

}  // namespace rigproof
