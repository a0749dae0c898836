#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <variant>

#include "bent_face.h"
#include "proof_parts.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/median.h"

namespace rigproof::proof_detail {
namespace {

// One pixel whose ray meets the board or the ground.
struct Sample {
  double z = 0.0;    // expected depth [m], with the sensor's true scale
  double ray = 1.0;  // length of the ray at z = 1: distance along the ray is z * ray
  double measured = 0.0;
  double mirrored_x = 0.0, mirrored_y = 0.0;  // measured at the mirrored pixels, 0 = no measurement
  double sigma = 0.0;                         // stated noise and rounding at z
};

// Pixels whose ray meets the board, or else the ground.
struct Samples {
  std::vector<Sample> board, ground;
};

struct Frame {
  Image16 depth;
  Rigid3 T_world_camera;
  std::vector<Rigid3> T_board_camera;  // of each board
  int compared = 0;                    // the board on which depth is compared; -1: none
  const TrueStop* stop = nullptr;
};

// Expected measurement divided by z, and what was measured; a hypothesis is one such rule.
struct Hypothesis {
  Finding slip;
  std::function<double(const Sample&)> expected;
  std::function<double(const Sample&)> measured;
};

// Robust against the few flying pixels at edges: the largest hundredth is left out.
double trimmed_rms(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  values.resize(std::max<std::size_t>(1, values.size() * 99 / 100));
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

// What the depth of one camera is compared with, and what is allowed.
struct Subject {
  const Recording& recording;
  const Truth& truth;
  const RigCamera& rig_camera;
  const TrueCamera& true_camera;
  const std::vector<TrueStop>& stops;
  Camera camera;
  std::optional<LensResidual> lens_residual;  // of depth that is registered to colour
  Rigid3 T_robot_depth;
  double scale = 1.0;
  int shift_x = 0, shift_y = 0;  // of the depth image, as the truth labels it
  double max_bias_sigmas = 0.0, max_rms_sigmas = 0.0;
  std::vector<BentFace> faces = {};  // of each board
};

Subject subject_of(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                   const ProofOptions& options) {
  const RigCamera& rig = recording.rig.cameras[recorded_camera];
  const TrueCamera& true_camera = truth.cameras[camera];
  // A device's smooth bias, where it is simulated, is part of the truth: three of its sigmas may come on top.
  const double bias_sigmas = 3.0 * label_of(true_camera, "depth_bias_over_noise");
  Subject subject{recording,
                  truth,
                  rig,
                  true_camera,
                  truth.stops_of(camera),
                  true_camera.camera,
                  true_camera.lens_residual,
                  true_camera.T_robot_camera,
                  true_camera.depth_scale.value_or(1.0),
                  static_cast<int>(label_of(true_camera, "depth_shift_x_px")),
                  static_cast<int>(label_of(true_camera, "depth_shift_y_px")),
                  options.depth_max_bias_sigmas + bias_sigmas,
                  std::hypot(options.depth_max_rms_sigmas, bias_sigmas)};
  for (int b = 0; b < truth.boards(); ++b) subject.faces.emplace_back(truth.board_at(b));
  // What is true if the truth tells, else what the recording tells; compare_frames() looks at the difference.
  const std::optional<DepthStream::OwnCamera>& own =
      true_camera.depth_camera || !rig.depth ? true_camera.depth_camera : rig.depth->own_camera;
  if (!own) return subject;
  subject.camera = own->camera;
  subject.lens_residual.reset();
  subject.T_robot_depth = subject.T_robot_depth * own->T_color_depth;
  return subject;
}

// What stands on the ground hides it: only pixels near the expected depth (2 % and 5 sigma) show the ground.
bool shows_ground(const Sample& s) {
  return s.measured > 0.0 && std::abs(s.measured - s.z) < 0.02 * s.z + 5.0 * s.sigma;
}

// With the rounding to the unit, which has the standard deviation unit / sqrt(12).
double stated_sigma_m(const DepthStream& stream, double z) {
  return std::hypot(stream.noise.sigma_m(z), stream.unit_m / std::sqrt(12.0));
}

void place(const Subject& subject, double dt_s, Frame* frame) {
  frame->T_world_camera = frame->stop->T_world_robot_after(dt_s) * subject.T_robot_depth;
  frame->T_board_camera.clear();
  for (int b = 0; b < subject.truth.boards(); ++b)
    frame->T_board_camera.push_back(subject.truth.board_at(b).T_world_board.inverse() * frame->T_world_camera);
}

bool read_frame(const Subject& subject, const CameraFrame& recorded, Frame* frame) {
  const std::optional<std::size_t> stop = stop_at(subject.stops, recorded.stamp_s);
  if (!stop) return false;
  const Camera& camera = subject.camera;
  const auto file = path_inside(subject.recording.folder, recorded.depth_file);
  std::variant<Image16, Unreadable> image = read_depth_image(file);
  if (const auto* unreadable = std::get_if<Unreadable>(&image)) throw Error(file.string() + ": " + unreadable->reason);
  frame->depth = std::get<Image16>(std::move(image));
  if (frame->depth.width != camera.width_px || frame->depth.height != camera.height_px)
    throw Error(file.string() + ": " + std::to_string(frame->depth.width) + "x" + std::to_string(frame->depth.height) +
                " pixels, the depth of " + subject.rig_camera.name + " has to have " + std::to_string(camera.width_px) +
                "x" + std::to_string(camera.height_px));
  frame->stop = &subject.stops[*stop];
  place(subject, 0.0, frame);
  return true;
}

// Depth z at which the ray from a camera meets the plane z = height of `target`.
std::optional<double> depth_of_plane(const Rigid3& T_target_camera, const Eigen::Vector3d& ray, double height_m = 0.0) {
  const double slope = (T_target_camera.rotation * ray).z();
  if (std::abs(slope) < 1e-9) return std::nullopt;
  const double z = (height_m - T_target_camera.translation.z()) / slope;
  return z > 0.0 ? std::optional<double>(z) : std::nullopt;
}

Sample sample_at(const Subject& subject, const Frame& frame, int u, int v, const Eigen::Vector3d& ray, double z) {
  const DepthStream& stream = *subject.rig_camera.depth;
  const int right = subject.camera.width_px - 1, bottom = subject.camera.height_px - 1;
  const auto metres = [&](int x, int y) {
    const int from_x = x + subject.shift_x, from_y = y + subject.shift_y;
    const bool inside = from_x >= 0 && from_x <= right && from_y >= 0 && from_y <= bottom;
    return inside ? stream.unit_m * frame.depth.at(from_x, from_y) : 0.0;
  };
  Sample sample;
  sample.z = subject.scale * z;
  sample.ray = ray.norm();
  sample.measured = metres(u, v);
  sample.mirrored_x = metres(right - u, v);
  sample.mirrored_y = metres(u, bottom - v);
  sample.sigma = stated_sigma_m(stream, z);
  return sample;
}

// Where a ray meets a board: at which depth, and how far beyond the edge of its squares (negative: inside).
struct BoardHit {
  double z = 0.0, beyond_m = 0.0;
};

std::optional<BoardHit> meet_board(const Board& board, const BentFace& face, const Rigid3& T_board_camera,
                                   const Eigen::Vector3d& ray) {
  constexpr int kRounds = 3;  // each takes what is left of a bend's height times its slope
  std::optional<double> z = depth_of_plane(T_board_camera, ray);
  if (!z) return std::nullopt;
  Eigen::Vector3d p = T_board_camera * (*z * ray);
  for (int round = 0; round < kRounds; ++round) {
    z = depth_of_plane(T_board_camera, ray, face.z_m(p.x(), p.y()));
    if (!z) return std::nullopt;
    p = T_board_camera * (*z * ray);
  }
  return BoardHit{*z, std::max({board.along(-1) - p.x(), p.x() - board.along(board.inner_corners_x()),
                                board.along(-1) - p.y(), p.y() - board.along(board.inner_corners_y())})};
}

void collect_pixel(const Subject& subject, const Frame& frame, int u, int v, Samples* samples) {
  Eigen::Vector3d ray;
  if (!unproject(subject.camera, subject.lens_residual, Eigen::Vector2d(u, v), &ray)) return;
  const DepthStream& stream = *subject.rig_camera.depth;
  const auto in_range = [&](double z) { return z >= stream.min_m && z <= stream.max_m; };
  std::optional<double> on_board;
  int boards = 0;  // whose sheets the ray meets, or passes by closely: they hide what is behind them
  for (int b = 0; b < subject.truth.boards(); ++b) {
    const Board& board = subject.truth.board_at(b).board;
    const auto index = static_cast<std::size_t>(b);
    const auto hit = meet_board(board, subject.faces[index], frame.T_board_camera[index], ray);
    if (!hit || hit->beyond_m > board.square_m) continue;
    ++boards;
    // Away from the squares' edge, where depth may fly; border and rim are left out on both sides.
    if (b == frame.compared && hit->beyond_m <= -0.2 * board.square_m && in_range(hit->z)) on_board = hit->z;
  }
  if (boards == 1 && on_board) samples->board.push_back(sample_at(subject, frame, u, v, ray, *on_board));
  if (boards > 0) return;
  const std::optional<double> ground_z = depth_of_plane(frame.T_world_camera, ray);
  if (ground_z && in_range(*ground_z)) samples->ground.push_back(sample_at(subject, frame, u, v, ray, *ground_z));
}

void collect(const Subject& subject, int stride, Frame* frame, Samples* samples) {
  const double readout_s = label_of(subject.true_camera, "depth_readout_ms") / 1000.0;
  for (int v = stride / 2; v < frame->depth.height; v += stride) {
    if (readout_s > 0.0) place(subject, row_delay_s(v, frame->depth.height, readout_s), frame);
    for (int u = stride / 2; u < frame->depth.width; u += stride) collect_pixel(subject, *frame, u, v, samples);
  }
}

std::vector<double> whitened(const std::vector<Sample>& samples, const Hypothesis& hypothesis) {
  std::vector<double> values;
  for (const Sample& sample : samples) {
    const double measured = hypothesis.measured(sample);
    if (measured > 0.0) values.push_back((measured - hypothesis.expected(sample)) / sample.sigma);
  }
  return values;
}

Hypothesis as_stated() {
  return {{}, [](const Sample& s) { return s.z; }, [](const Sample& s) { return s.measured; }};
}

// Depth is so many times too long, or short: by a wrong scale, a wrong unit, or who knows.
Finding wrong_factor(double factor) {
  const double size = factor > 1.0 ? factor : 1.0 / factor;
  const FindingValue side("side", factor > 1.0 ? "long" : "short");
  if (size < 1.5) return Finding("proof.depth_scale", {{"off_percent", 100.0 * std::abs(factor - 1.0)}, side});
  for (const double usual : {1000.0, 100.0, 10.0, 4.0, 5.0, 2.0})
    if (std::abs(size / usual - 1.0) < 0.02) return Finding("proof.depth_unit", {{"times", usual}, side});
  return Finding("proof.depth_factor", {{"times", size}, side});
}

std::vector<Hypothesis> hypotheses(const std::vector<Sample>& board) {
  const auto z = [](const Sample& s) { return s.z; };
  const auto along_ray = [](const Sample& s) { return s.z * s.ray; };
  const auto mirrored = [](const char* flipped) { return Finding("proof.depth_mirrored", {{"flipped", flipped}}); };
  std::vector<Hypothesis> list = {
      {Finding("proof.depth_along_ray"), along_ray, [](const Sample& s) { return s.measured; }},
      {mirrored("x"), z, [](const Sample& s) { return s.mirrored_x; }},
      {mirrored("y"), z, [](const Sample& s) { return s.mirrored_y; }}};
  std::vector<double> ratios, ray_ratios;
  for (const Sample& sample : board) {
    if (!(sample.measured > 0.0)) continue;
    ratios.push_back(sample.measured / sample.z);
    ray_ratios.push_back(sample.measured / (sample.z * sample.ray));
  }
  if (ratios.empty()) return list;
  const double factor = median(ratios), ray_factor = median(ray_ratios);
  // Residuals are divided by the factor again, so that every hypothesis is judged by the same sigma.
  list.push_back({wrong_factor(factor), z, [factor](const Sample& s) { return s.measured / factor; }});
  list.push_back({wrong_factor(ray_factor).with({{"along", "ray"}}), along_ray,
                  [ray_factor](const Sample& s) { return s.measured / ray_factor; }});
  return list;
}

Finding explain(const std::vector<Sample>& board, double rms_now, double max_rms_sigmas) {
  const Hypothesis* best = nullptr;
  double best_rms = 0.0;
  const std::vector<Hypothesis> all = hypotheses(board);
  for (const Hypothesis& hypothesis : all) {
    const std::vector<double> residuals = whitened(board, hypothesis);
    // A mirrored image must have measurements where the original has them.
    if (2 * residuals.size() < board.size()) continue;
    const double rms = trimmed_rms(residuals);
    // The list goes from simple to compound: a later one has to be clearly better.
    if (best != nullptr && 1.5 * rms >= best_rms) continue;
    best = &hypothesis;
    best_rms = rms;
  }
  if (best != nullptr && (best_rms <= max_rms_sigmas || 5.0 * best_rms <= rms_now)) return best->slip;
  return Finding("proof.depth_off", {{"times", rms_now}, {"limit", max_rms_sigmas}});
}

// The ground itself. Near the feet of what stands on it depth differs by less than the stated noise, so the spread that
// the data have is the measure: five of it and the rounding about the median. Whether the median is where the truth
// says is for judge_ground() to tell.
std::vector<const Sample*> on_ground(const std::vector<Sample>& ground, double unit_m) {
  constexpr double kMadOfNormal = 0.6745;
  std::vector<const Sample*> chosen;
  std::vector<double> residuals;
  for (const Sample& s : ground) {
    if (!shows_ground(s)) continue;
    chosen.push_back(&s);
    residuals.push_back((s.measured - s.z) / s.sigma);
  }
  if (chosen.empty()) return chosen;
  const double middle = median(residuals);
  for (double& residual : residuals) residual = std::abs(residual - middle);
  const double spread = median(residuals) / kMadOfNormal;
  chosen.erase(std::remove_if(chosen.begin(), chosen.end(),
                              [&](const Sample* s) {
                                return std::abs(s->measured - s->z - middle * s->sigma) >
                                       5.0 * spread * s->sigma + unit_m;
                              }),
               chosen.end());
  return chosen;
}

// Near a few distances, as far as they occur. Residuals in sigmas, so that a tenth of the distance more or less does
// not widen them.
std::vector<RealisedDepthNoise> noise_of(const std::vector<const Sample*>& samples, const DepthStream& stream) {
  constexpr double kMadOfNormal = 0.6745, kTolerance = 0.1;
  constexpr std::size_t kEnough = 200;
  std::vector<RealisedDepthNoise> list;
  for (const double z_m : {0.8, 1.0, 2.0, 4.0}) {
    std::vector<double> residuals;
    for (const Sample* s : samples)
      if (std::abs(s->z - z_m) <= kTolerance * z_m) residuals.push_back((s->measured - s->z) / s->sigma);
    if (residuals.size() < kEnough) continue;
    RealisedDepthNoise noise;
    noise.z_m = z_m;
    noise.pixels = residuals.size();
    noise.stated_sigma_mm = 1e3 * stated_sigma_m(stream, z_m);
    const double middle = median(residuals);
    for (double& residual : residuals) residual = std::abs(residual - middle);
    noise.sigma_mm = noise.stated_sigma_mm * median(residuals) / kMadOfNormal;
    noise.bias_mm = noise.stated_sigma_mm * middle;
    list.push_back(noise);
  }
  return list;
}

void summarise(const Samples& samples, const DepthStream& stream, CameraProof* proof) {
  std::vector<const Sample*> measured;
  for (const Sample& s : samples.board)
    if (s.measured > 0.0) measured.push_back(&s);
  const auto share = [](std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  if (!samples.board.empty()) proof->depth_valid_share = share(measured.size(), samples.board.size());
  const std::vector<const Sample*> ground = on_ground(samples.ground, stream.unit_m);
  if (!samples.ground.empty()) proof->depth_ground_share = share(ground.size(), samples.ground.size());
  measured.insert(measured.end(), ground.begin(), ground.end());
  proof->depth_noise = noise_of(measured, stream);
  std::vector<double> all;
  for (const Sample* s : measured) all.push_back(1e3 * (s->measured - s->z));
  proof->depth_pixels = all.size();
  proof->depth_bias_mm = mean_of(all);
  double squares = 0.0;
  for (const double value : all) {
    squares += value * value;
    proof->depth_max_mm = std::max(proof->depth_max_mm, std::abs(value));
  }
  if (!all.empty()) proof->depth_rms_mm = std::sqrt(squares / static_cast<double>(all.size()));
}

Finding biased(const char* code, double bias_sigmas) {
  return Finding(code, {{"times", std::abs(bias_sigmas)}, {"side", bias_sigmas > 0.0 ? "long" : "short"}});
}

void judge_ground(const std::vector<Sample>& ground, double max_bias_sigmas, Proved* proved) {
  constexpr std::size_t kEnough = 100;
  std::vector<double> residuals;
  for (const Sample& s : ground)
    if (shows_ground(s)) residuals.push_back((s.measured - s.z) / s.sigma);
  if (residuals.size() < kEnough) return proved->notes.push_back(Finding("proof.no_depth_on_ground"));
  // The median, since what stands on the ground is always nearer.
  const double bias = median(residuals);
  if (std::abs(bias) > max_bias_sigmas) proved->problems.push_back(biased("proof.ground_biased", bias));
}

// What the recording tells of the depth camera's place against the truth, if it is not the same.
std::optional<Finding> compare_frames(const Subject& subject) {
  // Quaternions are stored with all digits: anything beyond rounding is another transform.
  constexpr double kSame = 1e-6;
  const auto& told = subject.rig_camera.depth->own_camera;
  const auto& truth = subject.true_camera.depth_camera;
  if (told.has_value() != truth.has_value()) {
    if (!truth) return std::nullopt;  // a truth that tells nothing: the recording is taken at its word
    return Finding("proof.depth_frame_missing");
  }
  if (!told) return std::nullopt;
  const auto off_from = [&](const Rigid3& T) { return transform_error(told->T_color_depth, T); };
  const Vector6d error = off_from(truth->T_color_depth);
  if (error.norm() < kSame) return std::nullopt;
  const Finding off("proof.depth_frame",
                    {{"off_m", error.head<3>().norm()}, {"off_deg", rad_to_deg(error.tail<3>().norm())}});
  if (off_from(truth->T_color_depth.inverse()).norm() < kSame) return off.with({{"way", "inverted"}});
  if (off_from(Rigid3()).norm() < kSame) return off.with({{"way", "identity"}});
  return off;
}

// The only board; of several the one that was found in the image beside the depth image.
int compared_board(const Observations& observations, const Subject& subject, const CameraFrame& frame) {
  if (subject.truth.boards() == 1) return 0;
  const std::optional<std::size_t> camera = camera_named(observations.cameras, subject.rig_camera.name);
  for (const BoardView& view : observations.board_views)
    if (camera && view.camera == static_cast<int>(*camera) && view.stamp_s == frame.stamp_s) return view.board;
  return -1;
}

}  // namespace

Proved prove_depth(const Recording& recording, const Observations& observations, const Truth& truth,
                   std::size_t recorded_camera, std::size_t camera, const ProofOptions& options, Proved proved) {
  const Subject subject = subject_of(recording, truth, recorded_camera, camera, options);
  if (!subject.rig_camera.depth || options.max_depth_frames < 0) return proved;
  if (const auto frames_differ = compare_frames(subject)) proved.problems.push_back(*frames_differ);
  std::vector<const CameraFrame*> with_depth;
  for (const CameraFrame& frame : recording.frames[recorded_camera])
    if (!frame.depth_file.empty()) with_depth.push_back(&frame);
  const std::size_t count = frames_looked_at(with_depth.size(), options);
  Samples samples;
  for (std::size_t i = 0; i < count; ++i) {
    const CameraFrame& recorded = *with_depth[i * with_depth.size() / count];
    Frame frame;
    if (!read_frame(subject, recorded, &frame)) continue;
    frame.compared = compared_board(observations, subject, recorded);
    ++proved.camera.depth_frames;
    collect(subject, std::max(1, options.depth_stride_px), &frame, &samples);
  }
  summarise(samples, *subject.rig_camera.depth, &proved.camera);
  const std::vector<double> residuals = whitened(samples.board, as_stated());
  if (proved.camera.depth_frames == 0) return proved;
  if (residuals.empty()) {
    proved.notes.emplace_back("proof.no_depth_on_board");
    return proved;
  }
  const double rms = proved.camera.depth_rms_sigmas = trimmed_rms(residuals), bias = mean_of(residuals);
  if (rms > subject.max_rms_sigmas)
    proved.problems.push_back(explain(samples.board, rms, subject.max_rms_sigmas));
  else if (std::abs(bias) > subject.max_bias_sigmas)
    proved.problems.push_back(biased("proof.depth_biased", bias));
  else
    judge_ground(samples.ground, subject.max_bias_sigmas, &proved);
  return proved;
}

}  // namespace rigproof::proof_detail
