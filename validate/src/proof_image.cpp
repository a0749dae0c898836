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

namespace fs = std::filesystem;

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

ImageLaw law_of(const TrueCamera& camera) {
  return {label_of(camera, "full_well_electrons"), label_of(camera, "read_noise_electrons"),
          label_of(camera, "image_gamma"), label_of(camera, "pixel_offset_electrons"),
          0.01 * label_of(camera, "pixel_gain_percent")};
}

cv::Mat read(const fs::path& folder, const CameraFrame& frame, const Camera& camera) {
  const auto file = path_inside(folder, frame.color_file);
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_COLOR);
  if (image.cols != camera.width_px || image.rows != camera.height_px)
    throw Error(file.string() + ": is no image of " + std::to_string(camera.width_px) + "x" +
                std::to_string(camera.height_px) + " pixels");
  return image;
}

// Whole pixels within a square of the board, away from its edges; none where the square is not whole in the image.
std::vector<Eigen::Vector2d> inside_of(const Camera& camera, const Rigid3& T_camera_board, double side, int ix,
                                       int iy) {
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
      const Eigen::Vector3d p = T_board_camera.translation - T_board_camera.translation.z() / direction.z() * direction;
      const Eigen::Vector2d share = (p.head<2>() - first) / side;
      if (share.minCoeff() >= margin && share.maxCoeff() <= 1.0 - margin) places.emplace_back(u, v);
    }
  return places;
}

void add_patch(const ImageLaw& law, const cv::Mat& image, const std::vector<Eigen::Vector2d>& places, int channel,
               std::vector<Patch>* patches) {
  std::vector<double> values;
  double levels = 0.0;
  for (const Eigen::Vector2d& place : places) {
    const auto* pixel =
        image.ptr<std::uint8_t>(static_cast<int>(place.y())) + image.channels() * static_cast<int>(place.x()) + channel;
    levels += *pixel;
    values.push_back(law.electrons_of(*pixel));
  }
  const double level = levels / static_cast<double>(places.size());
  if (level < kDarkest || level > kBrightest) return;
  const Plane plane = fit_plane(places, values);
  const double stated = law.variance(plane.mean);
  patches->push_back(
      {plane.mean, plane.variance / stated / median_share(static_cast<double>(places.size() - 3)), places.size()});
}

void look_at(const ImageLaw& law, const fs::path& folder, const CameraFrame& frame, const Camera& camera,
             const Rigid3& T_camera_board, const Board& board, std::vector<Patch>* patches) {
  cv::Mat image;
  for (int iy = 0; iy < board.squares_y; ++iy)
    for (int ix = 0; ix < board.squares_x; ++ix) {
      const std::vector<Eigen::Vector2d> places = inside_of(camera, T_camera_board, board.square_m, ix, iy);
      if (places.size() < kLeastPixels) continue;
      if (image.empty()) image = read(folder, frame, camera);
      for (int channel = 0; channel < image.channels(); ++channel) add_patch(law, image, places, channel, patches);
    }
}

// The median of the squares of a band: a few may be dirty or covered.
std::vector<RealisedImageNoise> noise_of(const ImageLaw& law, const std::vector<Patch>& patches) {
  std::vector<RealisedImageNoise> bands;
  double from = 0.0;
  for (const double share : kBands) {
    const double to = share * law.full_well;
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
    noise.stated_sigma_electrons = std::sqrt(law.variance(noise.electrons));
    noise.sigma_electrons = noise.stated_sigma_electrons * std::sqrt(median(ratios));
    bands.push_back(noise);
  }
  return bands;
}

}  // namespace

Proved prove_image(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                   const ProofOptions& options, Proved proved) {
  const std::vector<CameraFrame>& frames = recording.frames[recorded_camera];
  const TrueCamera& true_camera = truth.cameras[camera];
  const ImageLaw law = law_of(true_camera);
  const bool simulated = label_of(true_camera, "image_noise") > 0.0 && law.full_well > 0.0 && law.gamma > 0.0;
  // Squares that are all dark or all light: the first board's, where it has no markers.
  if (!simulated || options.max_depth_frames < 0 || frames.empty() || truth.board.type != "checkerboard") return proved;
  if (frames.front().color_file.find(".png") == std::string::npos) {
    proved.notes.push_back(Finding("proof.image_noise_changed", {{"by", "jpeg"}}));
    return proved;
  }
  for (const char* processing : {"demosaicing", "sharpening_amount"}) {
    if (label_of(true_camera, processing) <= 0.0) continue;
    proved.notes.push_back(Finding("proof.image_noise_changed", {{"by", "processor"}}));
    return proved;
  }
  const std::vector<TrueStop>& stops = truth.stops_of(camera);
  const std::size_t count = frames_looked_at(frames.size(), options);
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < count; ++i) {
    const CameraFrame& frame = frames[i * frames.size() / count];
    const std::optional<std::size_t> stop = stop_at(stops, frame.stamp_s);
    if (!stop) continue;
    const Rigid3 T_world_camera = stops[*stop].T_world_robot * true_camera.T_robot_camera;
    look_at(law, recording.folder, frame, true_camera.camera, T_world_camera.inverse() * truth.T_world_board,
            truth.board, &patches);
  }
  proved.camera.image_noise = noise_of(law, patches);
  return proved;
}

}  // namespace rigproof::proof_detail
