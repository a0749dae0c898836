// What is simulated of an image's noise, found again in the files: each square of the board is of one colour, so that
// what is left of a plane fitted to its light is noise. Spread against light is the photon transfer curve (EMVA 1288,
// release 4.0, section 6.6): with light in electrons its slope is 1.
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "proof_parts.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/median.h"

namespace rigproof::proof_detail {
namespace {

constexpr double kSquareMargin = 0.2;  // of a square's side, beyond the lens's blur
constexpr double kLeastMargin_px = 3.0;
constexpr std::size_t kLeastPixels = 30;
// Levels beyond which noise is cut off by black or white.
constexpr double kDarkest = 15.0, kBrightest = 235.0;
constexpr std::size_t kFewestSquares = 20;
// Upper ends of the bands of light, as shares of the full well.
constexpr std::array<double, 6> kBands = {0.01, 0.03, 0.1, 0.3, 0.6, 1.0};

// The law by which the truth says that levels were made.
struct ImageLaw {
  double full_well = 0.0, read_noise = 0.0, gamma = 1.0;
  double pixel_offset = 0.0, pixel_gain = 0.0;

  double electrons_of(double level) const { return full_well * std::pow(level / 255.0, gamma); }
  double level_of(double electrons) const { return 255.0 * std::pow(electrons / full_well, 1.0 / gamma); }
  /// Shot noise, read noise, the pixels' fixed pattern, and the rounding to levels, squared [electrons].
  double variance(double electrons) const {
    const double level = level_of(electrons), slope = gamma * electrons / level;
    return electrons + read_noise * read_noise + pixel_offset * pixel_offset + std::pow(pixel_gain * electrons, 2) +
           slope * slope / 12.0;
  }
};

struct Patch {
  double electrons = 0.0;
  double variance_ratio = 0.0;  // realised over stated
  std::size_t pixels = 0;
};

// Median of a variance estimated with n degrees of freedom, over the variance (Wilson and Hilferty).
double median_share(double n) { return std::pow(1.0 - 2.0 / (9.0 * n), 3); }

// Variance about the plane that fits best. The places are those of the pixels, from their mean.
struct Plane {
  double mean = 0.0, variance = 0.0;
};
Plane fit_plane(const std::vector<Eigen::Vector2d>& places, const std::vector<double>& values) {
  const auto rows = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixX3d A(rows, 3);
  Eigen::VectorXd b(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto k = static_cast<std::size_t>(i);
    A.row(i) << 1.0, places[k].x(), places[k].y();
    b[i] = values[k];
  }
  const Eigen::Vector3d x = (A.transpose() * A).ldlt().solve(A.transpose() * b);
  return {b.mean(), (b - A * x).squaredNorm() / static_cast<double>(rows - 3)};
}

class ImageProof {
 public:
  ImageProof(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
             const ProofOptions& options, CameraProof* proof)
      : recording_(recording),
        truth_(truth),
        frames_(recording.frames[recorded_camera]),
        true_camera_(truth.cameras[camera]),
        stops_(truth.stops_of(camera)),
        options_(options),
        proof_(proof) {
    law_.full_well = label("full_well_electrons");
    law_.read_noise = label("read_noise_electrons");
    law_.gamma = label("image_gamma");
    law_.pixel_offset = label("pixel_offset_electrons");
    law_.pixel_gain = 0.01 * label("pixel_gain_percent");
  }

  Findings run() const {
    Findings findings;
    const bool simulated = label("image_noise") > 0.0 && law_.full_well > 0.0 && law_.gamma > 0.0;
    if (!simulated || options_.max_depth_frames < 0 || frames_.empty() || truth_.board.type != "checkerboard")
      return findings;
    if (frames_.front().color_file.find(".png") == std::string::npos) {
      findings.notes.push_back("image noise is not compared: JPEG changes it");
      return findings;
    }
    const std::size_t count = options_.max_depth_frames == 0
                                  ? frames_.size()
                                  : std::min(frames_.size(), static_cast<std::size_t>(options_.max_depth_frames));
    std::vector<Patch> patches;
    for (std::size_t i = 0; i < count; ++i) look_at(frames_[i * frames_.size() / count], &patches);
    summarise(patches);
    return findings;
  }

 private:
  double label(const char* name) const {
    const auto found = true_camera_.sensing.find(name);
    return found == true_camera_.sensing.end() ? 0.0 : found->second;
  }

  void look_at(const CameraFrame& frame, std::vector<Patch>* patches) const {
    const std::optional<std::size_t> stop = stop_at(stops_, frame.stamp_s);
    if (!stop) return;
    const Rigid3 T_camera_board =
        (stops_[*stop].T_world_robot * true_camera_.T_robot_camera).inverse() * truth_.T_world_board;
    const Board& board = truth_.board;
    cv::Mat image;
    for (int iy = 0; iy < board.squares_y; ++iy)
      for (int ix = 0; ix < board.squares_x; ++ix) {
        const std::vector<Eigen::Vector2d> places = inside_of(T_camera_board, ix, iy);
        if (places.size() < kLeastPixels) continue;
        if (image.empty()) image = read(frame);
        for (int channel = 0; channel < image.channels(); ++channel) add_patch(image, places, channel, patches);
      }
  }

  cv::Mat read(const CameraFrame& frame) const {
    const auto file = path_inside(recording_.folder, frame.color_file);
    cv::Mat image = cv::imread(file.string(), cv::IMREAD_COLOR);
    const Camera& camera = true_camera_.camera;
    if (image.cols != camera.width_px || image.rows != camera.height_px)
      throw Error(file.string() + ": is no image of " + std::to_string(camera.width_px) + "x" +
                  std::to_string(camera.height_px) + " pixels");
    return image;
  }

  // Whole pixels within a square of the board, away from its edges; none where the square is not whole in the image.
  std::vector<Eigen::Vector2d> inside_of(const Rigid3& T_camera_board, int ix, int iy) const {
    const Camera& camera = true_camera_.camera;
    const double side = truth_.board.square_m;
    const Eigen::Vector2d first(side * (ix - 1), side * (iy - 1));
    Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const auto& [x, y] : {std::pair(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}) {
      Eigen::Vector2d pixel;
      if (!camera.project(T_camera_board * Eigen::Vector3d(first.x() + x * side, first.y() + y * side, 0.0), &pixel) ||
          !camera.contains(pixel, 0.0))
        return {};
      low = low.cwiseMin(pixel);
      high = high.cwiseMax(pixel);
    }
    const double margin = std::max(kSquareMargin, kLeastMargin_px / (high - low).minCoeff());
    const Rigid3 T_board_camera = T_camera_board.inverse();
    std::vector<Eigen::Vector2d> places;
    for (int v = static_cast<int>(std::ceil(low.y())); v <= high.y(); ++v)
      for (int u = static_cast<int>(std::ceil(low.x())); u <= high.x(); ++u) {
        Eigen::Vector3d ray;
        if (!camera.unproject({u, v}, &ray)) continue;
        const Eigen::Vector3d direction = T_board_camera.rotation * ray;
        const Eigen::Vector3d p =
            T_board_camera.translation - T_board_camera.translation.z() / direction.z() * direction;
        const Eigen::Vector2d share = (p.head<2>() - first) / side;
        if (share.minCoeff() >= margin && share.maxCoeff() <= 1.0 - margin) places.emplace_back(u, v);
      }
    return places;
  }

  void add_patch(const cv::Mat& image, const std::vector<Eigen::Vector2d>& places, int channel,
                 std::vector<Patch>* patches) const {
    std::vector<double> values;
    double levels = 0.0;
    for (const Eigen::Vector2d& place : places) {
      const auto* pixel = image.ptr<std::uint8_t>(static_cast<int>(place.y())) +
                          image.channels() * static_cast<int>(place.x()) + channel;
      levels += *pixel;
      values.push_back(law_.electrons_of(*pixel));
    }
    const double level = levels / static_cast<double>(places.size());
    if (level < kDarkest || level > kBrightest) return;
    const Plane plane = fit_plane(places, values);
    const double stated = law_.variance(plane.mean);
    patches->push_back(
        {plane.mean, plane.variance / stated / median_share(static_cast<double>(places.size() - 3)), places.size()});
  }

  // The median of the squares of a band: a few may be dirty or covered.
  void summarise(const std::vector<Patch>& patches) const {
    double from = 0.0;
    for (const double share : kBands) {
      const double to = share * law_.full_well;
      std::vector<double> ratios, light;
      RealisedImageNoise noise;
      for (const Patch& patch : patches) {
        if (patch.electrons <= from || patch.electrons > to) continue;
        ratios.push_back(patch.variance_ratio);
        light.push_back(patch.electrons);
        noise.samples += patch.pixels;
      }
      from = to;
      if (ratios.size() < kFewestSquares) continue;
      noise.electrons = median(light);
      noise.stated_sigma_electrons = std::sqrt(law_.variance(noise.electrons));
      noise.sigma_electrons = noise.stated_sigma_electrons * std::sqrt(median(ratios));
      proof_->image_noise.push_back(noise);
    }
  }

  const Recording& recording_;
  const Truth& truth_;
  const std::vector<CameraFrame>& frames_;
  const TrueCamera& true_camera_;
  const std::vector<TrueStop>& stops_;
  const ProofOptions& options_;
  CameraProof* proof_;
  ImageLaw law_;
};

}  // namespace

Findings prove_image(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                     const ProofOptions& options, CameraProof* proof) {
  return ImageProof(recording, truth, recorded_camera, camera, options, proof).run();
}

}  // namespace rigproof::proof_detail
