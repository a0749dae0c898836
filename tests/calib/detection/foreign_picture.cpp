#include "foreign_picture.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

cv::Mat view_of(Image8* image) { return {image->height, image->width, CV_8UC1, image->pixels.data()}; }

// A grey scene through Bayer's pattern: what the interpolation makes of edges is left in the grey value.
void demosaic(Image8* image) {
  cv::Mat colors, grey;
  cv::demosaicing(view_of(image), colors, cv::COLOR_BayerBG2BGR_EA);
  cv::cvtColor(colors, grey, cv::COLOR_BGR2GRAY);
  grey.copyTo(view_of(image));
}

void sharpen(double amount, Image8* image) {
  cv::Mat grey = view_of(image), blurred;
  cv::GaussianBlur(grey, blurred, cv::Size(), 1.0);
  cv::addWeighted(grey, 1.0 + amount, blurred, -amount, 0.0, grey);
}

void compress(int quality, Image8* image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", view_of(image), bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  cv::imdecode(bytes, cv::IMREAD_GRAYSCALE).copyTo(view_of(image));
}

ForeignPicture kind(const std::string& name, double noise_sigma = 1.0) {
  ForeignPicture result;
  result.name = name;
  result.picture.noise_sigma = noise_sigma;
  return result;
}

}  // namespace

std::vector<ForeignPicture> foreign_pictures() {
  std::vector<ForeignPicture> kinds = {kind("clean", 0.0), kind("noise 2", 2.0), kind("noise 8", 8.0)};
  // Pixels of a renderer without a lens: the mean of n x n rays.
  for (const int rays : {1, 2, 3, 4}) {
    ForeignPicture aliased = kind("aliased, " + std::to_string(rays * rays) + (rays == 1 ? " ray" : " rays"), 0.0);
    aliased.picture.psf_sigma_px = 0.0;
    aliased.picture.point_samples = true;
    aliased.picture.supersampling = rays;
    kinds.push_back(aliased);
  }
  for (const double amount : {0.5, 1.0, 2.0}) {
    kinds.push_back(kind("sharpened " + std::to_string(amount).substr(0, 3)));
    kinds.back().sharpened = amount;
  }
  kinds.push_back(kind("demosaiced"));
  kinds.back().demosaiced = true;
  for (const int quality : {95, 85, 75, 60}) {
    kinds.push_back(kind("JPEG " + std::to_string(quality)));
    kinds.back().jpeg_quality = quality;
  }
  kinds.push_back(kind("vignetted to 30 %"));
  kinds.back().picture.corner_light = 0.3;
  kinds.push_back(kind("bowed by 5 mm"));
  kinds.back().picture.bow_m = 0.005;
  ForeignPicture phone = kind("all of it", 2.0);
  phone.demosaiced = true;
  phone.sharpened = 0.7;
  phone.jpeg_quality = 80;
  phone.picture.corner_light = 0.5;
  phone.picture.bow_m = 0.002;
  kinds.push_back(phone);
  return kinds;
}

ForeignView foreign_view(std::uint64_t seed) {
  RandomStream random(seed, "foreign views");
  const auto is_whole = [](const ForeignView& view) {
    const std::vector<Eigen::Vector3d> outline = view.board.outline();
    return std::all_of(outline.begin(), outline.end(), [&view](const Eigen::Vector3d& p) {
      Eigen::Vector2d pixel;
      return view.camera.project(view.T_camera_board * p, &pixel) && view.camera.contains(pixel, 8.0);
    });
  };
  for (;;) {
    ForeignView view;
    view.camera = seed % 3 == 2 ? Camera::symmetric(640, 480, 420.0) : Camera::symmetric(1280, 720, 640.0);
    view.board = random.below(2) == 0 ? Board{"checkerboard", 6, 5, 0.11, {}, {}, {}}
                                      : Board{"checkerboard", 9, 6, 0.06, {}, {}, {}};
    const double distance = random.uniform(0.7, 3.5), obliquity = deg_to_rad(random.uniform(0.0, 55.0));
    const double axis = random.uniform(0.0, 2.0 * kPi), roll = random.uniform(0.0, 2.0 * kPi);
    const Eigen::Vector2d pixel(random.uniform(0.1, 0.9) * view.camera.width_px,
                                random.uniform(0.1, 0.9) * view.camera.height_px);
    view.T_camera_board = board_in_view(view.camera, view.board, distance, obliquity, axis, roll, pixel);
    if (is_whole(view)) return view;
  }
}

Image8 draw_foreign(const Camera& camera, const Board& board, const Rigid3& T_camera_board, const ForeignPicture& kind,
                    std::uint64_t seed) {
  BoardPictureOptions picture = kind.picture;
  picture.seed = seed;
  Image8 image = draw_board(camera, board, T_camera_board, picture);
  if (kind.demosaiced) demosaic(&image);
  if (kind.sharpened > 0.0) sharpen(kind.sharpened, &image);
  if (kind.jpeg_quality > 0) compress(kind.jpeg_quality, &image);
  return image;
}

bool opencv_finds(const Image8& grey, const Board& board) {
  const cv::Mat view(grey.height, grey.width, CV_8UC1, const_cast<std::uint8_t*>(grey.pixels.data()));
  std::vector<cv::Point2f> corners;
  return cv::findChessboardCornersSB(view, {board.inner_corners_x(), board.inner_corners_y()}, corners,
                                     cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_NORMALIZE_IMAGE);
}

}  // namespace rigproof
