#include "broken_runs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

Rigid3 pose_of(const Stop& stop) { return planar_pose(stop.x_m, stop.y_m, stop.yaw_rad); }

void set_pose(const Rigid3& T, Stop* stop) {
  stop->x_m = T.translation.x();
  stop->y_m = T.translation.y();
  stop->yaw_rad = yaw_of(T);
}

template <int kPerMetre>
std::string positions_in(std::uint64_t, Observations* observations) {
  for (Stop& stop : observations->stops) {
    stop.x_m *= kPerMetre;
    stop.y_m *= kPerMetre;
  }
  return kPerMetre == 1000 ? "millimetres" : "centimetres";
}

std::string yaw_in_degrees(std::uint64_t, Observations* observations) {
  for (Stop& stop : observations->stops) stop.yaw_rad = rad_to_deg(stop.yaw_rad);
  return "degrees";
}

std::string yaw_of_other_sign(std::uint64_t, Observations* observations) {
  for (Stop& stop : observations->stops) stop.yaw_rad = -stop.yaw_rad;
  return "yaw has the wrong sign";
}

std::string x_and_y_swapped(std::uint64_t, Observations* observations) {
  for (Stop& stop : observations->stops) std::swap(stop.x_m, stop.y_m);
  return "x and y are swapped";
}

std::string left_handed(std::uint64_t, Observations* observations) {
  for (Stop& stop : observations->stops) {
    stop.y_m = -stop.y_m;
    stop.yaw_rad = -stop.yaw_rad;
  }
  return "mirrored";
}

std::string inverted(std::uint64_t, Observations* observations) {
  // Read in a world of the odometry's own, as on a robot: where its first pose is, is arbitrary.
  const Rigid3 T_odom_world = planar_pose(1.3, -0.7, 0.9);
  for (Stop& stop : observations->stops) set_pose((T_odom_world * pose_of(stop)).inverse(), &stop);
  return "inverted";
}

template <int kStops>
std::string stamps_off_by_stops(std::uint64_t, Observations* observations) {
  std::vector<Stop>& stops = observations->stops;
  const std::vector<Stop> right = stops;
  const int last = static_cast<int>(stops.size()) - 1;
  for (int i = 0; i <= last; ++i)
    set_pose(pose_of(right[static_cast<std::size_t>(std::clamp(i + kStops, 0, last))]),
             &stops[static_cast<std::size_t>(i)]);
  return "stamps are shifted";
}

std::string stamps_off_by_a_third(std::uint64_t, Observations* observations) {
  std::vector<Stop>& stops = observations->stops;
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    const Rigid3 T = pose_of(stops[i]);
    set_pose(T * se3_exp(0.3 * se3_log(T.inverse() * pose_of(stops[i + 1]))), &stops[i]);
  }
  return "stamps are shifted";
}

// 5 to 10 % either way.
double wrong_factor(RandomStream* random) {
  const double size = random->uniform(0.05, 0.10);
  return random->uniform() < 0.5 ? 1.0 + size : 1.0 - size;
}

std::size_t any_camera(RandomStream* random, const Observations& observations) {
  return static_cast<std::size_t>(random->below(static_cast<std::uint32_t>(observations.cameras.size())));
}

int any_stop(RandomStream* random, const Observations& observations) {
  return 1 + static_cast<int>(random->below(static_cast<std::uint32_t>(observations.stops.size()) - 2));
}

std::string board_of_other_size(std::uint64_t seed, Observations* observations) {
  RandomStream random(seed, "broken board");
  observations->board.square_m *= wrong_factor(&random);
  return "board's size";
}

std::string board_8_percent(std::uint64_t, Observations* observations) {
  observations->board.square_m *= 1.08;
  return "board's size";
}

std::string focal_length(std::uint64_t seed, Observations* observations) {
  RandomStream random(seed, "broken focal length");
  RigCamera& camera = observations->cameras[any_camera(&random, *observations)];
  const double factor = wrong_factor(&random);
  camera.camera.fx_px *= factor;
  camera.camera.fy_px *= factor;
  return "intrinsics of";
}

std::string other_intrinsics(std::uint64_t seed, Observations* observations) {
  RandomStream random(seed, "broken intrinsics");
  RigCamera& camera = observations->cameras[any_camera(&random, *observations)];
  const double factor = wrong_factor(&random);
  camera.camera.fx_px *= factor;
  camera.camera.fy_px *= factor;
  camera.camera.cx_px += random.uniform(-15.0, 15.0);
  camera.camera.cy_px += random.uniform(-15.0, 15.0);
  return "intrinsics of " + camera.name;
}

std::string half_pixel_everywhere(std::uint64_t, Observations* observations) {
  for (BoardView& view : observations->board_views)
    for (CornerObservation& corner : view.corners) corner.pixel += Eigen::Vector2d(0.5, 0.5);
  return "half-pixel";
}

void swap_views(int stop, int a, int b, Observations* observations) {
  for (BoardView& view : observations->board_views) {
    if (view.stop != stop || (view.camera != a && view.camera != b)) continue;
    view.camera = view.camera == a ? b : a;
  }
  for (auto* planes : {&observations->ground_planes, &observations->board_planes})
    for (PlaneObservation& plane : *planes)
      if (plane.stop == stop && (plane.camera == a || plane.camera == b)) plane.camera = plane.camera == a ? b : a;
}

std::string frames_swapped(std::uint64_t seed, Observations* observations) {
  RandomStream random(seed, "broken frames");
  const auto seen = [&](int stop) {
    return std::any_of(observations->board_views.begin(), observations->board_views.end(),
                       [stop](const BoardView& view) { return view.stop == stop && view.camera < 2; });
  };
  std::vector<int> stops;
  for (int i = 0; i < static_cast<int>(observations->stops.size()); ++i)
    if (seen(i)) stops.push_back(i);
  for (int i = 0; i < 3 && !stops.empty(); ++i) {
    const std::size_t k = static_cast<std::size_t>(random.below(static_cast<std::uint32_t>(stops.size())));
    swap_views(stops[k], 0, 1, observations);
    stops.erase(stops.begin() + static_cast<std::ptrdiff_t>(k));
  }
  std::stable_sort(
      observations->board_views.begin(), observations->board_views.end(),
      [](const BoardView& a, const BoardView& b) { return a.stop != b.stop ? a.stop < b.stop : a.camera < b.camera; });
  return "swapped";
}

std::string frames_of_next_stop(std::uint64_t seed, Observations* observations) {
  RandomStream random(seed, "broken camera");
  const int camera = static_cast<int>(any_camera(&random, *observations));
  std::vector<BoardView>& views = observations->board_views;
  for (BoardView& view : views)
    if (view.camera == camera) ++view.stop;
  const int stops = static_cast<int>(observations->stops.size());
  views.erase(std::remove_if(views.begin(), views.end(), [stops](const BoardView& v) { return v.stop >= stops; }),
              views.end());
  std::stable_sort(views.begin(), views.end(), [](const BoardView& a, const BoardView& b) {
    return a.stop != b.stop ? a.stop < b.stop : a.camera < b.camera;
  });
  return "frames of " + observations->cameras[static_cast<std::size_t>(camera)].name + " are shifted";
}

std::string wild_row(std::uint64_t seed, Observations* observations) {
  RandomStream random(seed, "broken row");
  const int stop = any_stop(&random, *observations);
  Stop& row = observations->stops[static_cast<std::size_t>(stop)];
  const double direction = random.uniform(-kPi, kPi);
  row.x_m += 0.5 * std::cos(direction);
  row.y_m += 0.5 * std::sin(direction);
  row.yaw_rad += random.uniform(-0.3, 0.3);
  return "row at stop " + std::to_string(stop) + " ";
}

std::string wild_frame(std::uint64_t seed, Observations* observations) {
  RandomStream random(seed, "broken frame");
  std::vector<BoardView>& views = observations->board_views;
  const std::size_t k = static_cast<std::size_t>(random.below(static_cast<std::uint32_t>(views.size())));
  // Another frame of the same camera, from as far away as there is one.
  const BoardView* other = nullptr;
  double farthest = 0.0;
  for (const BoardView& view : views) {
    if (view.camera != views[k].camera) continue;
    const double distance = (view.corners.front().pixel - views[k].corners.front().pixel).norm();
    if (distance <= farthest) continue;
    farthest = distance;
    other = &view;
  }
  if (other != nullptr) views[k].corners = other->corners;
  // Where no other camera saw the board, a frame and its odometry row are equally likely to be wrong.
  return "at stop " + std::to_string(views[k].stop) + " ";
}

}  // namespace

const std::vector<Breakage>& breakages() {
  static const std::vector<Breakage> kAll = {
      {"odometry in millimetres", 1, false, NamedIn::kReasons, false, &positions_in<1000>},
      {"odometry in centimetres", 1, false, NamedIn::kReasons, false, &positions_in<100>},
      {"yaw in degrees", 1, false, NamedIn::kReasons, false, &yaw_in_degrees},
      {"yaw of the wrong sign", 1, false, NamedIn::kReasons, false, &yaw_of_other_sign},
      {"x and y swapped", 1, false, NamedIn::kReasons, false, &x_and_y_swapped},
      {"odometry mirrored", 1, false, NamedIn::kReasons, false, &left_handed},
      {"odometry inverted", 1, false, NamedIn::kReasons, false, &inverted},
      {"stamps ahead by 1 stop", 1, false, NamedIn::kReasons, false, &stamps_off_by_stops<1>},
      {"stamps behind by 2 stops", 1, false, NamedIn::kReasons, false, &stamps_off_by_stops<-2>},
      {"stamps ahead by 0.3 stops", 1, false, NamedIn::kReasons, false, &stamps_off_by_a_third},
      {"board 8 % too large", 1, true, NamedIn::kReasons, false, &board_8_percent},
      {"board off by 5 to 10 %", 1, true, NamedIn::kReasons, false, &board_of_other_size},
      {"focal length off by 5 to 10 %", 1, false, NamedIn::kReasons, false, &focal_length},
      {"intrinsics of another camera", 1, false, NamedIn::kReasons, false, &other_intrinsics},
      {"half-pixel offset", 1, false, NamedIn::kReasons, false, &half_pixel_everywhere},
      {"half-pixel offset, 100 stops of the reference rig", 1, false, NamedIn::kReasons, true, &half_pixel_everywhere},
      {"3 frames of two cameras swapped", 2, false, NamedIn::kReasons, false, &frames_swapped},
      {"one camera's frames a stop late", 2, false, NamedIn::kReasons, false, &frames_of_next_stop},
      {"one wild odometry row", 1, false, NamedIn::kNotes, false, &wild_row},
      {"one wild frame", 1, false, NamedIn::kNotes, false, &wild_frame},
  };
  return kAll;
}

GeometricConfig broken_run_config(const Breakage& breakage, std::uint64_t seed) {
  RandomStream random(seed, "broken run");
  GeometricConfig config;
  config.seed = seed;
  config.rig = random_rig(seed, breakage.min_cameras + static_cast<int>(random.below(3)));
  config.stops = 12 + static_cast<int>(random.below(19));
  if (breakage.large) {
    config.rig = reference_rig();
    config.stops = 100;
  }
  config.lambda = random.uniform(0.0, 1.0);
  config.board_planes = breakage.board_depth;
  config.depth_scale_sigma = 0.003;
  config.declare_odometry_model = config.declare_odometry_sigmas = seed % 2 == 0;
  return config;
}

}  // namespace rigproof
