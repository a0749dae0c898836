#include <algorithm>
#include <cmath>
#include <functional>

#include "proof_parts.h"
#include "rigproof/core/conventions.h"
#include "rigproof/validate/body_angles.h"

namespace rigproof::proof_detail {
namespace {

struct View {
  std::string file;
  std::size_t stop = 0;
  int board = 0;
  std::vector<CornerObservation> corners;
};

// How corners are predicted; a hypothesis changes one part of it.
struct Setup {
  Camera camera;
  std::optional<LensResidual> lens_residual;
  Rigid3 T_robot_camera;
  std::function<Rigid3(std::size_t)> T_world_robot;  // by stop
  double readout_s = 0.0;                            // of a rolling shutter
  std::function<Rigid3(const TrueBoard&)> T_world_board;
  std::function<int(const Board&, int)> board_id;
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> seen;  // the detected pixel as it should have been
};

struct Hypothesis {
  Finding slip;
  Setup setup;
};

struct Residuals {
  std::vector<Eigen::Vector2d> all;
  std::vector<double> view_rms;
  bool complete = true;  // every corner could be projected
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();
  Eigen::Vector2d rms = Eigen::Vector2d::Zero();
  double max = 0.0;

  double total_rms() const { return rms.norm() / std::sqrt(2.0); }
  // Standard deviation about the bias, of the worse axis.
  double spread() const { return (rms.cwiseAbs2() - bias.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt().maxCoeff(); }
};

void summarise(Residuals* residuals) {
  if (residuals->all.empty()) return;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& d : residuals->all) {
    sum += d;
    squares += d.cwiseAbs2();
    residuals->max = std::max(residuals->max, d.norm());
  }
  const double n = static_cast<double>(residuals->all.size());
  residuals->bias = sum / n;
  residuals->rms = (squares / n).cwiseSqrt();
}

// What is compared of one camera, and what is allowed.
struct Subject {
  const Truth& truth;
  std::size_t camera = 0;
  const std::vector<TrueStop>& stops;
  std::vector<View> views;
  std::size_t corners = 0, without_stop = 0;
  double stated_sigma_px = 0.0;
  double bias_limit_px = 0.0, rms_limit_px = 0.0;
};

Subject subject_of(const Observations& observations, const Truth& truth, std::size_t observed_camera,
                   std::size_t camera, const ProofOptions& options) {
  Subject subject{truth, camera, truth.stops_of(camera), {}};
  double variance = 0.0;
  for (const BoardView& view : observations.board_views) {
    if (view.camera != static_cast<int>(observed_camera) || view.corners.empty()) continue;
    const std::optional<std::size_t> stop = stop_at(subject.stops, view.stamp_s);
    if (!stop) {
      ++subject.without_stop;
      continue;
    }
    subject.views.push_back({view.file, *stop, view.board, view.corners});
    subject.corners += view.corners.size();
    for (const CornerObservation& corner : view.corners) variance += 0.5 * corner.covariance_px2.trace();
  }
  if (subject.corners == 0) return subject;
  const double n = static_cast<double>(subject.corners);
  subject.stated_sigma_px = std::sqrt(variance / n);
  subject.bias_limit_px = options.corner_bias_floor_px + 5.0 * subject.stated_sigma_px / std::sqrt(n);
  subject.rms_limit_px = options.corner_rms_floor_px + 3.0 * subject.stated_sigma_px;
  return subject;
}

Setup as_stated(const Subject& subject) {
  const TrueCamera& camera = subject.truth.cameras[subject.camera];
  return {camera.camera,
          camera.lens_residual,
          camera.T_robot_camera,
          [&subject](std::size_t stop) { return subject.stops[stop].T_world_robot; },
          label_of(camera, "readout_ms") / 1000.0,
          [](const TrueBoard& board) { return board.T_world_board; },
          [](const Board&, int id) { return id; },
          [](const Eigen::Vector2d& pixel) { return pixel; }};
}

// A rolling shutter sees a corner when it reads the corner's row: the robot is a little before or after its stop then.
bool project(const Setup& setup, const TrueStop& stop, const Rigid3& T_camera_board, const Eigen::Vector3d& p_board,
             const Eigen::Vector2d& seen, Eigen::Vector2d* pixel) {
  const std::optional<Vector6d>& velocity = stop.velocity;
  if (!velocity || setup.readout_s <= 0.0)
    return project(setup.camera, setup.lens_residual, T_camera_board * p_board, pixel);
  const double dt_s = row_delay_s(seen.y(), setup.camera.height_px, setup.readout_s);
  const Rigid3 T_now_before = se3_exp(-dt_s * *velocity);  // of the robot
  const Rigid3 T_camera_robot = setup.T_robot_camera.inverse();
  return project(setup.camera, setup.lens_residual,
                 T_camera_robot * (T_now_before * (setup.T_robot_camera * (T_camera_board * p_board))), pixel);
}

Residuals residuals_of(const Subject& subject, const Setup& setup) {
  Residuals result;
  for (const View& view : subject.views) {
    const TrueBoard& board = subject.truth.board_at(view.board);
    const Rigid3 T_camera_board =
        setup.T_robot_camera.inverse() * setup.T_world_robot(view.stop).inverse() * setup.T_world_board(board);
    double squares = 0.0;
    for (const CornerObservation& corner : view.corners) {
      Eigen::Vector2d projected;
      const Eigen::Vector3d point = board.corner(setup.board_id(board.board, corner.id));
      if (!project(setup, subject.stops[view.stop], T_camera_board, point, setup.seen(corner.pixel), &projected)) {
        result.complete = false;
        continue;
      }
      result.all.push_back(setup.seen(corner.pixel) - projected);
      squares += result.all.back().squaredNorm();
    }
    result.view_rms.push_back(std::sqrt(squares / (2.0 * static_cast<double>(view.corners.size()))));
  }
  summarise(&result);
  return result;
}

void add_mirrored_images(const Subject& subject, std::vector<Hypothesis>* list) {
  const Setup stated = as_stated(subject);
  const double right = stated.camera.width_px - 1, bottom = stated.camera.height_px - 1;
  const auto add = [&](const char* flipped, bool x, bool y) {
    Setup setup = stated;
    setup.seen = [=](const Eigen::Vector2d& p) {
      return Eigen::Vector2d(x ? right - p.x() : p.x(), y ? bottom - p.y() : p.y());
    };
    list->push_back({Finding("proof.images_mirrored", {{"flipped", flipped}}), setup});
  };
  add("x", true, false);
  add("y", false, true);
  add("xy", true, true);
}

void add_wrong_poses(const Subject& subject, std::vector<Hypothesis>* list) {
  const Setup stated = as_stated(subject);
  const auto add = [&](const Finding& slip, const std::function<void(Setup*)>& change) {
    Setup setup = stated;
    change(&setup);
    list->push_back({slip, setup});
  };
  const Rigid3 optical_body(optical_from_body(), Eigen::Vector3d::Zero());
  const auto camera = [](const char* way) { return Finding("proof.camera_pose", {{"way", way}}); };
  add(camera("inverted"), [](Setup* s) { s->T_robot_camera = s->T_robot_camera.inverse(); });
  add(camera("body"), [&](Setup* s) { s->T_robot_camera = s->T_robot_camera * optical_body.inverse(); });
  add(Finding("proof.optical_twice"), [&](Setup* s) { s->T_robot_camera = s->T_robot_camera * optical_body; });
  add(Finding("proof.robot_poses_inverted"), [&subject](Setup* s) {
    s->T_world_robot = [&subject](std::size_t stop) { return subject.stops[stop].T_world_robot.inverse(); };
  });
  add(Finding("proof.board_pose_inverted"),
      [](Setup* s) { s->T_world_board = [](const TrueBoard& board) { return board.T_world_board.inverse(); }; });
  for (const int shift : {-1, 1})
    add(Finding("proof.images_one_stop_off", {{"side", shift < 0 ? "late" : "early"}}), [&subject, shift](Setup* s) {
      const auto last = static_cast<std::ptrdiff_t>(subject.stops.size()) - 1;
      s->T_world_robot = [&subject, shift, last](std::size_t stop) {
        const auto moved = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(stop) + shift, 0, last);
        return subject.stops[static_cast<std::size_t>(moved)].T_world_robot;
      };
    });
  if (!subject.truth.cameras[subject.camera].stops.empty())
    add(Finding("proof.delay_missing"), [&subject](Setup* s) {
      s->T_world_robot = [&subject](std::size_t stop) { return subject.truth.stops[stop].T_world_robot; };
    });
}

void add_wrong_boards(const Subject& subject, std::vector<Hypothesis>* list) {
  const auto add = [&](const char* flipped, bool mirror_x, bool mirror_y) {
    Setup setup = as_stated(subject);
    setup.board_id = [=](const Board& board, int id) {
      const int nx = board.inner_corners_x(), ny = board.inner_corners_y();
      const int x = id % nx, y = id / nx;
      return (mirror_y ? ny - 1 - y : y) * nx + (mirror_x ? nx - 1 - x : x);
    };
    list->push_back({Finding("proof.board_flipped", {{"flipped", flipped}}), setup});
  };
  add("xy", true, true);
  add("x", true, false);
  add("y", false, true);
}

void add_wrong_cameras(const Subject& subject, std::vector<Hypothesis>* list) {
  Setup setup = as_stated(subject);
  if (setup.camera.lens != Lens::kPinhole) {
    setup.camera.lens = Lens::kPinhole;
    list->push_back({Finding("proof.no_distortion"), setup});
  }
  setup = as_stated(subject);
  std::swap(setup.camera.fx_px, setup.camera.fy_px);
  list->push_back({Finding("proof.intrinsics_exchanged", {{"first", "fx"}, {"second", "fy"}}), setup});
  setup = as_stated(subject);
  std::swap(setup.camera.cx_px, setup.camera.cy_px);
  list->push_back({Finding("proof.intrinsics_exchanged", {{"first", "cx"}, {"second", "cy"}}), setup});
  for (std::size_t other = 0; other < subject.truth.cameras.size(); ++other) {
    if (other == subject.camera) continue;
    setup = as_stated(subject);
    setup.camera = subject.truth.cameras[other].camera;
    setup.lens_residual = subject.truth.cameras[other].lens_residual;
    setup.T_robot_camera = subject.truth.cameras[other].T_robot_camera;
    list->push_back({Finding("proof.cameras_exchanged", {{"images_of", subject.truth.cameras[other].name}}), setup});
  }
}

std::vector<Hypothesis> hypotheses(const Subject& subject) {
  std::vector<Hypothesis> list;
  add_mirrored_images(subject, &list);
  add_wrong_poses(subject, &list);
  add_wrong_boards(subject, &list);
  add_wrong_cameras(subject, &list);
  return list;
}

bool within_limits(const Subject& subject, const Residuals& r) {
  return r.complete && r.bias.cwiseAbs().maxCoeff() <= subject.bias_limit_px &&
         r.rms.maxCoeff() <= subject.rms_limit_px && r.max <= 1.0 + 10.0 * subject.stated_sigma_px;
}

// By how much corners are off, where that is beyond the limit.
FindingValues shift_of(const Eigen::Vector2d& bias, double limit) {
  FindingValues shift;
  for (int axis = 0; axis < 2; ++axis)
    if (std::abs(bias[axis]) > limit) shift.emplace_back(axis == 0 ? "x_px" : "y_px", bias[axis]);
  return shift;
}

std::optional<Finding> explain_focal(const Subject& subject, const Residuals& now) {
  const Setup setup = as_stated(subject);
  const Eigen::Vector2d centre(setup.camera.cx_px, setup.camera.cy_px);
  double product = 0.0, squares = 0.0;
  std::size_t i = 0;
  for (const View& view : subject.views)
    for (const CornerObservation& corner : view.corners) {
      const Eigen::Vector2d seen = corner.pixel - centre, projected = seen - now.all[i++];
      product += seen.dot(projected);
      squares += projected.squaredNorm();
    }
  const double factor = product / squares;
  Setup scaled = setup;
  scaled.camera.fx_px *= factor;
  scaled.camera.fy_px *= factor;
  if (!within_limits(subject, residuals_of(subject, scaled))) return std::nullopt;
  return Finding("proof.focal_length",
                 {{"off_percent", 100.0 * std::abs(factor - 1.0)}, {"side", factor > 1.0 ? "large" : "small"}});
}

std::optional<Finding> explain_few_views(const Subject& subject, const Residuals& now) {
  std::size_t bad = 0, worst = 0;
  for (std::size_t i = 0; i < now.view_rms.size(); ++i) {
    if (now.view_rms[i] > subject.rms_limit_px) ++bad;
    if (now.view_rms[i] > now.view_rms[worst]) worst = i;
  }
  if (bad == 0 || 4 * bad > now.view_rms.size()) return std::nullopt;
  return Finding("proof.few_views", {{"off", bad},
                                     {"views", now.view_rms.size()},
                                     {"worst_px", now.view_rms[worst]},
                                     {"file", subject.views[worst].file}});
}

Finding explain(const Subject& subject, const Residuals& now) {
  const double limit = subject.bias_limit_px;
  if (now.complete && now.spread() <= subject.rms_limit_px && now.bias.cwiseAbs().maxCoeff() > limit)
    return Finding("proof.corners_shifted", shift_of(now.bias, limit));
  if (now.complete)
    if (const auto focal = explain_focal(subject, now)) return *focal;
  const Hypothesis* best = nullptr;
  Residuals best_residuals;
  const std::vector<Hypothesis> all = hypotheses(subject);
  for (const Hypothesis& hypothesis : all) {
    const Residuals candidate = residuals_of(subject, hypothesis.setup);
    if (!candidate.complete) continue;
    if (best != nullptr && candidate.total_rms() >= best_residuals.total_rms()) continue;
    best = &hypothesis;
    best_residuals = candidate;
  }
  // Ten times better, or (where nothing could be projected as stated) good to a pixel.
  const bool convincing = best != nullptr && (now.complete ? 10.0 * best_residuals.total_rms() < now.total_rms()
                                                           : best_residuals.total_rms() < 1.0);
  if (convincing) {
    const FindingValues shift = shift_of(best_residuals.bias, limit);
    if (best_residuals.spread() > subject.rms_limit_px || shift.empty()) return best->slip;
    return best->slip.by({Finding("proof.corners_shifted", shift)});
  }
  if (const auto few = explain_few_views(subject, now)) return *few;
  return Finding("proof.corners_off", {{"rms_px", now.total_rms()}, {"limit_px", subject.rms_limit_px}});
}

}  // namespace

Proved prove_corners(const Observations& observations, const Truth& truth, std::size_t observed_camera,
                     std::size_t camera, const ProofOptions& options, Proved proved) {
  const Subject subject = subject_of(observations, truth, observed_camera, camera, options);
  proved.camera.views = subject.views.size();
  proved.camera.corners = subject.corners;
  proved.camera.corner_bias_limit_px = subject.bias_limit_px;
  proved.camera.corner_rms_limit_px = subject.rms_limit_px;
  if (subject.without_stop > 0) proved.problems.push_back(Finding("proof.stamps", {{"views", subject.without_stop}}));
  if (subject.corners == 0) {
    proved.notes.emplace_back("proof.no_view");
    return proved;
  }
  const Residuals now = residuals_of(subject, as_stated(subject));
  proved.camera.corner_bias_px = now.bias;
  proved.camera.corner_rms_px = now.rms;
  proved.camera.corner_max_px = now.max;
  if (!within_limits(subject, now)) proved.problems.push_back(explain(subject, now));
  return proved;
}

}  // namespace rigproof::proof_detail
