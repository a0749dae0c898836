#include "vertical_lines.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "directions.h"
#include "rigproof/calib/vision/image_files.h"
#include "rigproof/calib/vision/image_pairs.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof::rivals {
namespace {

using Eigen::Vector3d;
using Images = std::vector<std::vector<SeenLine>>;

constexpr double kMinLength_px = 25.0;
constexpr int kSamples = 2000;
const double kAgrees = std::sin(deg_to_rad(1.0));
const double kUpright = std::cos(deg_to_rad(45.0));
const double kSquare = std::sin(deg_to_rad(5.0));
// Of lines in any direction a sixtieth is within a degree of a given one.
constexpr double kMinShare = 0.08;
constexpr std::size_t kMinLinesOfAnImage = 3;
// A board's outer squares and its edge lie beyond its corners.
constexpr double kBoardMargin = 0.4;

bool may_be_up(const Vector3d& v, const Vector3d& ahead) {
  return std::abs(v.y()) > kUpright && std::abs(v.dot(ahead)) < kSquare;
}

double agreeing_length(const Images& images, const Vector3d& v) {
  double length = 0.0;
  for (const auto& lines : images)
    for (const SeenLine& line : lines)
      if (std::abs(line.normal.dot(v)) < kAgrees) length += line.length_px;
  return length;
}

template <typename T>
const T& one_of(const std::vector<T>& list, RandomStream* random) {
  const auto index = static_cast<std::size_t>(random->uniform() * static_cast<double>(list.size()));
  return list[std::min(index, list.size() - 1)];
}

std::optional<Vector3d> sampled_direction(const Images& images, const Vector3d& ahead, RandomStream* random) {
  std::optional<Vector3d> best;
  double best_length = 0.0;
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto& lines = one_of(images, random);
    if (lines.empty()) continue;
    const Vector3d& first = one_of(lines, random).normal;
    const Vector3d v = first.cross(one_of(lines, random).normal);
    // Lines of nearly one plane say little of where they meet.
    if (!(v.norm() > 0.02) || !may_be_up(v.normalized(), ahead)) continue;
    const double length = agreeing_length(images, v.normalized());
    if (length <= best_length) continue;
    best_length = length;
    best = v.normalized();
  }
  return best;
}

Vector3d refined(const Images& images, Vector3d v) {
  for (int round = 0; round < 10; ++round) {
    Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
    for (const auto& lines : images) {
      for (const SeenLine& line : lines) {
        const double e = line.normal.dot(v) / (0.3 * kAgrees);
        if (std::abs(line.normal.dot(v)) < 2.0 * kAgrees)
          M += line.length_px * line.length_px / (1.0 + e * e) * line.normal * line.normal.transpose();
      }
    }
    v = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(M).eigenvectors().col(0);
  }
  return v;
}

/// Where an image shows the board, with what lies around its corners.
struct BoardPlace {
  Eigen::AlignedBox2d box;

  explicit BoardPlace(const BoardView* view) {
    if (view == nullptr) return;
    for (const CornerObservation& corner : view->corners) box.extend(corner.pixel);
    if (box.isEmpty()) return;
    const Eigen::Vector2d margin = kBoardMargin * box.sizes();
    box = Eigen::AlignedBox2d(box.min() - margin, box.max() + margin);
  }
  bool holds(const Eigen::Vector2d& pixel) const { return !box.isEmpty() && box.contains(pixel); }
};

std::vector<SeenLine> lines_of_image(const Image8& image, const Camera& camera, const BoardView* view) {
  const BoardPlace board(view);
  std::vector<cv::Vec4f> segments;
  const cv::Mat picture(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::createLineSegmentDetector()->detect(picture, segments);
  std::vector<SeenLine> lines;
  for (const cv::Vec4f& s : segments) {
    const Eigen::Vector2d a(s[0], s[1]), b(s[2], s[3]);
    Vector3d ray_a, ray_b;
    if ((b - a).norm() < kMinLength_px || board.holds(0.5 * (a + b))) continue;
    if (!camera.unproject(a, &ray_a) || !camera.unproject(b, &ray_b)) continue;
    const Vector3d normal = ray_a.cross(ray_b);
    if (normal.norm() > 1e-9) lines.push_back({normal.normalized(), (b - a).norm()});
  }
  return lines;
}

}  // namespace

std::optional<PlumbLines> plumb_direction(const Images& images, const Vector3d& ahead, int camera) {
  double length = 0.0;
  for (const auto& lines : images)
    for (const SeenLine& line : lines) length += line.length_px;
  if (!(length > 0.0)) return std::nullopt;
  RandomStream random(0, "plumb lines", -1, camera);
  const std::optional<Vector3d> sampled = sampled_direction(images, ahead, &random);
  if (!sampled) return std::nullopt;
  PlumbLines found{refined(images, *sampled), 0, 0};
  if (!may_be_up(found.up, ahead) || agreeing_length(images, found.up) < kMinShare * length) return std::nullopt;
  if (found.up.y() > 0.0) found.up = -found.up;
  for (const auto& lines : images) {
    const auto agreeing = static_cast<std::size_t>(std::count_if(lines.begin(), lines.end(), [&](const SeenLine& line) {
      return std::abs(line.normal.dot(found.up)) < kAgrees;
    }));
    found.lines += agreeing;
    found.images += agreeing >= kMinLinesOfAnImage;
  }
  if (found.images < kMinDirections) return std::nullopt;
  return found;
}

Images lines_of_camera(const MethodInput& input, int camera) {
  std::vector<std::pair<const CameraFrame*, const BoardView*>> frames;
  for (const auto& [key, frame] : frames_by_stop(input.observations, *input.recording)) {
    const int stop = key.first;
    if (key.second != camera) continue;
    const auto is_of_it = [&](const BoardView& view) { return view.camera == camera && view.stop == stop; };
    const auto& views = input.observations.board_views;
    const auto view = std::find_if(views.begin(), views.end(), is_of_it);
    frames.emplace_back(frame, view == views.end() ? nullptr : &*view);
  }
  for (const auto& [k, frame] : straight_segment_images(*input.recording))
    if (k == camera) frames.emplace_back(frame, nullptr);
  Images images(frames.size());
  const Camera& model = input.observations.cameras[static_cast<std::size_t>(camera)].camera;
  for_each_image(input, frames.size(), [&](std::size_t i) {
    const auto image = readable_image(*input.recording, *frames[i].first, model);
    if (image) images[i] = lines_of_image(*image, model, frames[i].second);
  });
  return images;
}

}  // namespace rigproof::rivals
