#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>

#include "rigproof/core/camera_info.h"
#include "rigproof/core/rational_lens.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr std::uint32_t kMaxSide = 32768;

bool all_zero(const std::vector<double>& values, std::size_t from = 0) {
  return std::all_of(values.begin() + static_cast<std::ptrdiff_t>(std::min(from, values.size())), values.end(),
                     [](double value) { return value == 0.0; });
}

void take_matrix(const CameraInfo& info, bool rectified, Camera* camera) {
  const double fx = rectified ? info.p[0] : info.k[0], fy = rectified ? info.p[5] : info.k[4];
  // Right of the focal lengths, below the diagonal, and what the row of the axis ends in.
  const std::array<double, 4> zeros = rectified ? std::array<double, 4>{info.p[1], info.p[4], info.p[8], info.p[9]}
                                                : std::array<double, 4>{info.k[1], info.k[3], info.k[6], info.k[7]};
  const double one = rectified ? info.p[10] : info.k[8];
  camera->fx_px = fx;
  camera->fy_px = fy;
  camera->cx_px = rectified ? info.p[2] : info.k[2];
  camera->cy_px = rectified ? info.p[6] : info.k[5];
  const char* matrix = rectified ? "P" : "K";
  const char* field = rectified ? "p" : "k";
  if (fx == 0.0 && fy == 0.0)
    throw CameraInfoError(field, std::string("the matrix ") + matrix +
                                     " is zero: the camera is not calibrated, or its driver found no calibration file");
  const bool upper = std::all_of(zeros.begin(), zeros.end(), [](double value) { return value == 0.0; });
  if (!(fx > 0.0 && fy > 0.0) || !std::isfinite(camera->cx_px + camera->cy_px + fx + fy) || !upper ||
      (one != 1.0 && one != 0.0))
    throw CameraInfoError(field, std::string("the matrix ") + matrix +
                                     " must be fx 0 cx 0 fy cy 0 0 1 with fx, fy > 0; skew is not supported");
}

// As ROS, OpenCV and others call them.
bool is_one_of(const std::string& model, std::initializer_list<const char*> names) {
  return std::find(names.begin(), names.end(), model) != names.end();
}

// What drivers call lenses whose coefficients are zero, of which none is left then. Not so of a fisheye.
bool is_pinhole_without_coefficients(const std::string& model) {
  std::string lower = model;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower.find("brown") != std::string::npos ||
         is_one_of(lower, {"", "none", "pinhole", "plumb_bob", "rational_polynomial", "radtan"});
}

void take_lens(const CameraInfo& info, InfoReading* reading) {
  Camera& camera = reading->camera;
  const std::string& model = info.distortion_model;
  const bool finite = std::all_of(info.d.begin(), info.d.end(), [](double d) { return std::isfinite(d); });
  if (!finite) throw CameraInfoError("d", "D holds numbers that are not finite");
  const bool equidistant = is_one_of(model, {"equidistant", "fisheye", "kannala_brandt"});
  if (all_zero(info.d) && is_pinhole_without_coefficients(model)) return;
  if (equidistant) {
    if (info.d.size() < 4 || !all_zero(info.d, 4))
      throw CameraInfoError("d", "equidistant has four coefficients, D has " + std::to_string(info.d.size()));
    camera.lens = Lens::kKannalaBrandt;
    std::copy_n(info.d.begin(), 4, camera.distortion.begin());
  } else if (!is_one_of(model, {"plumb_bob", "rational_polynomial", "brown_conrady", "radtan", ""})) {
    throw CameraInfoError("distortion_model", "the distortion_model \"" + for_message(model) +
                                                  "\" is not supported; plumb_bob, rational_polynomial and "
                                                  "equidistant are");
  } else if (all_zero(info.d, 5)) {
    camera.lens = Lens::kBrownConrady;
    std::copy_n(info.d.begin(), std::min<std::size_t>(5, info.d.size()), camera.distortion.begin());
  } else {
    const RationalFit fit = fit_rational_lens(info.d, &camera);
    reading->notes.push_back(fit.note);
    if (!fit.is_met) reading->to_undo.assign(info.d.begin(), info.d.begin() + 8);
  }
}

// Region of interest first, then super-pixels, whose centres lie between those of their pixels.
void take_region(const CameraInfo& info, Camera* camera) {
  const auto& roi = info.roi;
  const bool part = roi.width > 0 && roi.height > 0;
  if (part &&
      (std::uint64_t{roi.x_offset} + roi.width > info.width || std::uint64_t{roi.y_offset} + roi.height > info.height))
    throw CameraInfoError("roi", "the region of interest reaches beyond the image");
  const std::uint32_t bx = std::max(1U, info.binning_x), by = std::max(1U, info.binning_y);
  camera->cx_px = (camera->cx_px - roi.x_offset - 0.5 * (bx - 1)) / bx;
  camera->cy_px = (camera->cy_px - roi.y_offset - 0.5 * (by - 1)) / by;
  camera->fx_px /= bx;
  camera->fy_px /= by;
  camera->width_px = static_cast<int>((part ? roi.width : info.width) / bx);
  camera->height_px = static_cast<int>((part ? roi.height : info.height) / by);
}

bool is_identity(const std::array<double, 9>& r) {
  static constexpr std::array<double, 9> kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return r == kIdentity || r == std::array<double, 9>{};
}

}  // namespace

InfoReading camera_of_info(const CameraInfo& info, bool rectified) {
  if (info.width == 0 || info.height == 0 || info.width > kMaxSide || info.height > kMaxSide)
    throw CameraInfoError("width", "a size of " + std::to_string(info.width) + "x" + std::to_string(info.height));
  InfoReading reading;
  take_matrix(info, rectified, &reading.camera);
  take_region(info, &reading.camera);
  if (rectified) {
    reading.notes.emplace_back(
        "images are rectified: the matrix P and no distortion" +
        std::string(is_identity(info.r) ? "" : "; poses are those of the rectified frame, which R turns"));
  } else {
    take_lens(info, &reading);
  }
  return reading;
}

}  // namespace rigproof
