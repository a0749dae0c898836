#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <variant>

#include "proof_parts.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/median.h"
#include "rigproof/validate/figures.h"

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
  Rigid3 T_board_camera;
  const TrueStop* stop = nullptr;
};

// Expected measurement divided by z, and what was measured; a hypothesis is one such rule.
struct Hypothesis {
  std::string explanation;
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

class DepthProof {
 public:
  DepthProof(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
             const ProofOptions& options, CameraProof* proof);
  Findings run() const;

 private:
  bool read_frame(const CameraFrame& recorded, Frame* frame) const;
  void place(double dt_s, Frame* frame) const;
  void collect(Frame* frame, Samples* samples) const;
  std::string compare_frames() const;
  void collect_pixel(const Frame& frame, int u, int v, Samples* samples) const;
  Sample sample_at(const Frame& frame, int u, int v, const Eigen::Vector3d& ray, double z) const;
  std::string explain(const std::vector<Sample>& board, double rms_now) const;
  void summarise(const Samples& samples) const;
  void summarise_noise(const std::vector<const Sample*>& samples) const;
  // What stands on the ground hides it: only pixels near the expected depth (2 % and 5 sigma) show the ground.
  static bool shows_ground(const Sample& s) {
    return s.measured > 0.0 && std::abs(s.measured - s.z) < 0.02 * s.z + 5.0 * s.sigma;
  }
  // What the truth says of this sensor; 0 where it says nothing.
  double label(const char* name) const {
    const auto found = true_camera_.sensing.find(name);
    return found == true_camera_.sensing.end() ? 0.0 : found->second;
  }
  void judge_ground(const std::vector<Sample>& ground, Findings* findings) const;
  std::vector<const Sample*> on_ground(const std::vector<Sample>& ground) const;

  const Recording& recording_;
  const Truth& truth_;
  const RigCamera& rig_camera_;
  const std::vector<CameraFrame>& frames_;
  const TrueCamera& true_camera_;
  const std::vector<TrueStop>& stops_;
  const ProofOptions& options_;
  CameraProof* proof_;
  Camera camera_;
  Rigid3 T_robot_depth_;
  double scale_ = 1.0;
  int shift_x_ = 0, shift_y_ = 0;  // of the depth image, as the truth labels it
  double max_bias_sigmas_, max_rms_sigmas_;
};

DepthProof::DepthProof(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                       const ProofOptions& options, CameraProof* proof)
    : recording_(recording),
      truth_(truth),
      rig_camera_(recording.rig.cameras[recorded_camera]),
      frames_(recording.frames[recorded_camera]),
      true_camera_(truth.cameras[camera]),
      stops_(truth.stops_of(camera)),
      options_(options),
      proof_(proof),
      camera_(true_camera_.camera),
      T_robot_depth_(true_camera_.T_robot_camera),
      scale_(true_camera_.depth_scale.value_or(1.0)),
      shift_x_(static_cast<int>(label("depth_shift_x_px"))),
      shift_y_(static_cast<int>(label("depth_shift_y_px"))),
      // A device's smooth bias, where it is simulated, is part of the truth: three of its sigmas may come on top.
      max_bias_sigmas_(options.depth_max_bias_sigmas + 3.0 * label("depth_bias_over_noise")),
      max_rms_sigmas_(std::hypot(options.depth_max_rms_sigmas, 3.0 * label("depth_bias_over_noise"))) {
  // What is true if the truth tells, else what the recording tells; compare_frames() looks at the difference.
  const std::optional<DepthStream::OwnCamera>& own =
      true_camera_.depth_camera || !rig_camera_.depth ? true_camera_.depth_camera : rig_camera_.depth->own_camera;
  if (!own) return;
  camera_ = own->camera;
  T_robot_depth_ = T_robot_depth_ * own->T_color_depth;
}

bool DepthProof::read_frame(const CameraFrame& recorded, Frame* frame) const {
  const std::optional<std::size_t> stop = stop_at(stops_, recorded.stamp_s);
  if (!stop) return false;
  const auto file = path_inside(recording_.folder, recorded.depth_file);
  std::variant<Image16, Unreadable> image = read_depth_image(file);
  if (const auto* unreadable = std::get_if<Unreadable>(&image)) throw Error(file.string() + ": " + unreadable->reason);
  frame->depth = std::get<Image16>(std::move(image));
  if (frame->depth.width != camera_.width_px || frame->depth.height != camera_.height_px)
    throw Error(file.string() + ": " + std::to_string(frame->depth.width) + "x" + std::to_string(frame->depth.height) +
                " pixels, the depth of " + rig_camera_.name + " has to have " + std::to_string(camera_.width_px) + "x" +
                std::to_string(camera_.height_px));
  frame->stop = &stops_[*stop];
  place(0.0, frame);
  return true;
}

void DepthProof::place(double dt_s, Frame* frame) const {
  frame->T_world_camera = frame->stop->T_world_robot_after(dt_s) * T_robot_depth_;
  frame->T_board_camera = truth_.T_world_board.inverse() * frame->T_world_camera;
}

// Depth z at which the ray from a camera meets the plane z = 0 of `target`.
std::optional<double> depth_of_plane(const Rigid3& T_target_camera, const Eigen::Vector3d& ray) {
  const double slope = (T_target_camera.rotation * ray).z();
  if (std::abs(slope) < 1e-9) return std::nullopt;
  const double z = -T_target_camera.translation.z() / slope;
  return z > 0.0 ? std::optional<double>(z) : std::nullopt;
}

Sample DepthProof::sample_at(const Frame& frame, int u, int v, const Eigen::Vector3d& ray, double z) const {
  const DepthStream& stream = *rig_camera_.depth;
  const int right = camera_.width_px - 1, bottom = camera_.height_px - 1;
  const auto metres = [&](int x, int y) {
    const int from_x = x + shift_x_, from_y = y + shift_y_;
    const bool inside = from_x >= 0 && from_x <= right && from_y >= 0 && from_y <= bottom;
    return inside ? stream.unit_m * frame.depth.at(from_x, from_y) : 0.0;
  };
  Sample sample;
  sample.z = scale_ * z;
  sample.ray = ray.norm();
  sample.measured = metres(u, v);
  sample.mirrored_x = metres(right - u, v);
  sample.mirrored_y = metres(u, bottom - v);
  // Rounding to the unit has the standard deviation unit / sqrt(12).
  sample.sigma = std::hypot(stream.noise.sigma_m(z), stream.unit_m / std::sqrt(12.0));
  return sample;
}

void DepthProof::collect_pixel(const Frame& frame, int u, int v, Samples* samples) const {
  Eigen::Vector3d ray;
  if (!camera_.unproject({u, v}, &ray)) return;
  const DepthStream& stream = *rig_camera_.depth;
  const Board& board = truth_.board;
  const double margin = 0.2 * board.square_m;  // away from the squares' edge, where depth may fly
  const auto in_range = [&](double z) { return z >= stream.min_m && z <= stream.max_m; };
  const std::optional<double> board_z = depth_of_plane(frame.T_board_camera, ray);
  if (board_z) {
    const Eigen::Vector3d p = frame.T_board_camera * (*board_z * ray);
    const auto inside = [&](double grow) {
      return p.x() >= -board.square_m - grow && p.x() <= board.square_m * board.inner_corners_x() + grow &&
             p.y() >= -board.square_m - grow && p.y() <= board.square_m * board.inner_corners_y() + grow;
    };
    if (inside(-margin) && in_range(*board_z)) samples->board.push_back(sample_at(frame, u, v, ray, *board_z));
    // The board hides what is behind it; its border and rim are left out on both sides.
    if (inside(board.square_m)) return;
  }
  const std::optional<double> ground_z = depth_of_plane(frame.T_world_camera, ray);
  if (ground_z && in_range(*ground_z)) samples->ground.push_back(sample_at(frame, u, v, ray, *ground_z));
}

void DepthProof::collect(Frame* frame, Samples* samples) const {
  const int stride = std::max(1, options_.depth_stride_px);
  const double readout_s = label("depth_readout_ms") / 1000.0;
  for (int v = stride / 2; v < frame->depth.height; v += stride) {
    if (readout_s > 0.0) place(row_delay_s(v, frame->depth.height, readout_s), frame);
    for (int u = stride / 2; u < frame->depth.width; u += stride) collect_pixel(*frame, u, v, samples);
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
  return {"", [](const Sample& s) { return s.z; }, [](const Sample& s) { return s.measured; }};
}

// "a factor of 1000 too long (millimetres and metres exchanged)".
std::string factor_in_words(double factor) {
  const double size = factor > 1.0 ? factor : 1.0 / factor;
  const std::string direction = factor > 1.0 ? "too long" : "too short";
  if (size < 1.5) return short_figure(100.0 * std::abs(factor - 1.0)) + " % " + direction + " (depth scale)";
  for (const double usual : {1000.0, 100.0, 10.0, 4.0, 5.0, 2.0})
    if (std::abs(size / usual - 1.0) < 0.02)
      return short_figure(usual) + " times " + direction + ": the depth unit is wrong by that factor";
  return short_figure(size) + " times " + direction;
}

std::vector<Hypothesis> hypotheses(const std::vector<Sample>& board) {
  std::vector<Hypothesis> list;
  Hypothesis along_ray = as_stated();
  along_ray.explanation = "depth is the distance along the ray, not z along the optical axis";
  along_ray.expected = [](const Sample& s) { return s.z * s.ray; };
  list.push_back(along_ray);
  Hypothesis mirrored_x = as_stated();
  mirrored_x.explanation = "depth images are mirrored left to right (x axis flipped)";
  mirrored_x.measured = [](const Sample& s) { return s.mirrored_x; };
  list.push_back(mirrored_x);
  Hypothesis mirrored_y = as_stated();
  mirrored_y.explanation = "depth images are mirrored top to bottom (y axis flipped)";
  mirrored_y.measured = [](const Sample& s) { return s.mirrored_y; };
  list.push_back(mirrored_y);
  std::vector<double> ratios, ray_ratios;
  for (const Sample& sample : board) {
    if (!(sample.measured > 0.0)) continue;
    ratios.push_back(sample.measured / sample.z);
    ray_ratios.push_back(sample.measured / (sample.z * sample.ray));
  }
  if (ratios.empty()) return list;
  const double factor = median(ratios), ray_factor = median(ray_ratios);
  // Residuals are divided by the factor again, so that every hypothesis is judged by the same sigma.
  list.push_back({"depth is " + factor_in_words(factor), [](const Sample& s) { return s.z; },
                  [factor](const Sample& s) { return s.measured / factor; }});
  list.push_back({"depth is the distance along the ray, and " + factor_in_words(ray_factor),
                  [](const Sample& s) { return s.z * s.ray; },
                  [ray_factor](const Sample& s) { return s.measured / ray_factor; }});
  return list;
}

std::string DepthProof::explain(const std::vector<Sample>& board, double rms_now) const {
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
  if (best != nullptr && (best_rms <= max_rms_sigmas_ || 5.0 * best_rms <= rms_now)) return best->explanation;
  return "depth on the board is off by " + short_figure(rms_now) + " times the sensor's stated noise (allowed " +
         short_figure(max_rms_sigmas_) + "), and no known slip of convention explains it";
}

// The ground itself. Near the feet of what stands on it depth differs by less than the stated noise, so the spread that
// the data have is the measure: five of it and the rounding about the median. Whether the median is where the truth
// says is for judge_ground() to tell.
std::vector<const Sample*> DepthProof::on_ground(const std::vector<Sample>& ground) const {
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
  const double rounding = rig_camera_.depth->unit_m;
  chosen.erase(std::remove_if(chosen.begin(), chosen.end(),
                              [&](const Sample* s) {
                                return std::abs(s->measured - s->z - middle * s->sigma) >
                                       5.0 * spread * s->sigma + rounding;
                              }),
               chosen.end());
  return chosen;
}

// Near a few distances, as far as they occur. Residuals in sigmas, so that a tenth of the distance more or less does
// not widen them.
void DepthProof::summarise_noise(const std::vector<const Sample*>& samples) const {
  constexpr double kMadOfNormal = 0.6745, kTolerance = 0.1;
  constexpr std::size_t kEnough = 200;
  const DepthStream& stream = *rig_camera_.depth;
  for (const double z_m : {0.8, 1.0, 2.0, 4.0}) {
    std::vector<double> residuals;
    for (const Sample* s : samples)
      if (std::abs(s->z - z_m) <= kTolerance * z_m) residuals.push_back((s->measured - s->z) / s->sigma);
    if (residuals.size() < kEnough) continue;
    RealisedDepthNoise noise;
    noise.z_m = z_m;
    noise.pixels = residuals.size();
    noise.stated_sigma_mm = 1e3 * std::hypot(stream.noise.sigma_m(z_m), stream.unit_m / std::sqrt(12.0));
    const double middle = median(residuals);
    for (double& residual : residuals) residual = std::abs(residual - middle);
    noise.sigma_mm = noise.stated_sigma_mm * median(residuals) / kMadOfNormal;
    noise.bias_mm = noise.stated_sigma_mm * middle;
    proof_->depth_noise.push_back(noise);
  }
}

void DepthProof::summarise(const Samples& samples) const {
  std::vector<const Sample*> measured;
  for (const Sample& s : samples.board)
    if (s.measured > 0.0) measured.push_back(&s);
  const auto share = [](std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  if (!samples.board.empty()) proof_->depth_valid_share = share(measured.size(), samples.board.size());
  const std::vector<const Sample*> ground = on_ground(samples.ground);
  if (!samples.ground.empty()) proof_->depth_ground_share = share(ground.size(), samples.ground.size());
  measured.insert(measured.end(), ground.begin(), ground.end());
  summarise_noise(measured);
  std::vector<double> all;
  for (const Sample* s : measured) all.push_back(1e3 * (s->measured - s->z));
  proof_->depth_pixels = all.size();
  proof_->depth_bias_mm = mean_of(all);
  double squares = 0.0;
  for (const double value : all) {
    squares += value * value;
    proof_->depth_max_mm = std::max(proof_->depth_max_mm, std::abs(value));
  }
  if (!all.empty()) proof_->depth_rms_mm = std::sqrt(squares / static_cast<double>(all.size()));
}

void DepthProof::judge_ground(const std::vector<Sample>& ground, Findings* findings) const {
  constexpr std::size_t kEnough = 100;
  std::vector<double> residuals;
  for (const Sample& s : ground)
    if (shows_ground(s)) residuals.push_back((s.measured - s.z) / s.sigma);
  if (residuals.size() < kEnough) return findings->notes.push_back("no depth on the ground to compare");
  // The median, since what stands on the ground is always nearer.
  const double bias = median(residuals);
  if (std::abs(bias) > max_bias_sigmas_)
    findings->problems.push_back("depth on the ground is " + short_figure(std::abs(bias)) +
                                 " times the stated noise too " + (bias > 0.0 ? "long" : "short") +
                                 " (height or tilt of the camera, or the ground is not flat)");
}

// "0.059 m and 0.3 deg".
std::string difference_text(const Rigid3& a, const Rigid3& b) {
  const Vector6d error = transform_error(a, b);
  return short_figure(error.head<3>().norm()) + " m and " + short_figure(rad_to_deg(error.tail<3>().norm())) + " deg";
}

// What the recording tells of the depth camera's place against the truth. Empty if it is the same.
std::string DepthProof::compare_frames() const {
  // Quaternions are stored with all digits: anything beyond rounding is another transform.
  constexpr double kSame = 1e-6;
  const auto& told = rig_camera_.depth->own_camera;
  const auto& truth = true_camera_.depth_camera;
  if (told.has_value() != truth.has_value()) {
    if (!truth) return {};  // a truth that tells nothing: the recording is taken at its word
    return "depth is not registered to colour, but rig.yaml has no depth.camera and no depth.T_color_depth";
  }
  if (!told || transform_error(told->T_color_depth, truth->T_color_depth).norm() < kSame) return {};
  const std::string off =
      "T_color_depth in rig.yaml is off by " + difference_text(told->T_color_depth, truth->T_color_depth);
  if (transform_error(told->T_color_depth, truth->T_color_depth.inverse()).norm() < kSame)
    return off + ": it is inverted (colour in depth)";
  if (transform_error(told->T_color_depth, Rigid3()).norm() < kSame)
    return off + ": it says that depth is measured where colour is";
  return off;
}

Findings DepthProof::run() const {
  Findings findings;
  if (!rig_camera_.depth || options_.max_depth_frames < 0) return findings;
  const std::string frames_differ = compare_frames();
  if (!frames_differ.empty()) findings.problems.push_back(frames_differ);
  std::vector<const CameraFrame*> with_depth;
  for (const CameraFrame& frame : frames_)
    if (!frame.depth_file.empty()) with_depth.push_back(&frame);
  const std::size_t count = options_.max_depth_frames == 0
                                ? with_depth.size()
                                : std::min(with_depth.size(), static_cast<std::size_t>(options_.max_depth_frames));
  Samples samples;
  for (std::size_t i = 0; i < count; ++i) {
    Frame frame;
    if (!read_frame(*with_depth[i * with_depth.size() / count], &frame)) continue;
    ++proof_->depth_frames;
    collect(&frame, &samples);
  }
  summarise(samples);
  const std::vector<double> residuals = whitened(samples.board, as_stated());
  if (proof_->depth_frames == 0) return findings;
  if (residuals.empty()) {
    findings.notes.push_back("no depth on the board to compare");
    return findings;
  }
  proof_->depth_rms_sigmas = trimmed_rms(residuals);
  if (proof_->depth_rms_sigmas > max_rms_sigmas_)
    findings.problems.push_back(explain(samples.board, proof_->depth_rms_sigmas));
  else if (std::abs(mean_of(residuals)) > max_bias_sigmas_)
    findings.problems.push_back("depth on the board is " + short_figure(std::abs(mean_of(residuals))) +
                                " times the stated noise too " + (mean_of(residuals) > 0.0 ? "long" : "short") +
                                " on average");
  else
    judge_ground(samples.ground, &findings);
  return findings;
}

}  // namespace

Findings prove_depth(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                     const ProofOptions& options, CameraProof* proof) {
  return DepthProof(recording, truth, recorded_camera, camera, options, proof).run();
}

}  // namespace rigproof::proof_detail
