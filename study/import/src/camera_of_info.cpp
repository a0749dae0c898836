#include "camera_of_info.h"

#include <algorithm>
#include <cmath>

#include "rational_lens.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr std::uint32_t kMaxSide = 32768;

bool all_zero(const std::vector<double>& values, std::size_t from = 0) {
  return std::all_of(values.begin() + static_cast<std::ptrdiff_t>(std::min(from, values.size())), values.end(),
                     [](double value) { return value == 0.0; });
}

void take_matrix(const RosCameraInfo& info, bool rectified, Camera* camera) {
  const double fx = rectified ? info.p[0] : info.k[0], fy = rectified ? info.p[5] : info.k[4];
  const double skew = rectified ? info.p[1] : info.k[1];
  camera->fx_px = fx;
  camera->fy_px = fy;
  camera->cx_px = rectified ? info.p[2] : info.k[2];
  camera->cy_px = rectified ? info.p[6] : info.k[5];
  const char* matrix = rectified ? "P" : "K";
  if (fx == 0.0 && fy == 0.0)
    throw Error(std::string("the matrix ") + matrix +
                " is zero: the camera is not calibrated, or its driver found no "
                "calibration file");
  if (!(fx > 0.0 && fy > 0.0) || !std::isfinite(camera->cx_px + camera->cy_px + fx + fy) || skew != 0.0)
    throw Error(std::string("the matrix ") + matrix +
                " must be fx 0 cx 0 fy cy 0 0 1 with fx, fy > 0; skew is not supported");
}

void take_lens(const RosCameraInfo& info, InfoReading* reading) {
  Camera& camera = reading->camera;
  const std::string& model = info.distortion_model;
  const bool finite = std::all_of(info.d.begin(), info.d.end(), [](double d) { return std::isfinite(d); });
  if (!finite) throw Error("D holds numbers that are not finite");
  if (all_zero(info.d) && model != "equidistant" && model != "fisheye")
    return;  // a pinhole, whatever its model is called
  if (model == "equidistant" || model == "fisheye" || model == "kannala_brandt") {
    if (info.d.size() < 4 || !all_zero(info.d, 4))
      throw Error("equidistant has four coefficients, D has " + std::to_string(info.d.size()));
    camera.lens = Lens::kKannalaBrandt;
    std::copy_n(info.d.begin(), 4, camera.distortion.begin());
  } else if ((model == "plumb_bob" || model == "rational_polynomial" || model.empty()) && all_zero(info.d, 5)) {
    camera.lens = Lens::kBrownConrady;
    std::copy_n(info.d.begin(), std::min<std::size_t>(5, info.d.size()), camera.distortion.begin());
  } else if (model == "rational_polynomial" || model == "plumb_bob") {
    const RationalFit fit = fit_rational_lens(info.d, &camera);
    reading->notes.push_back(fit.note);
    if (!fit.is_met) reading->to_undo.assign(info.d.begin(), info.d.begin() + 8);
  } else {
    throw Error("the distortion_model \"" + for_message(model) +
                "\" is not supported; plumb_bob, rational_polynomial and equidistant are");
  }
}

// Region of interest first, then super-pixels, whose centres lie between those of their pixels.
void take_region(const RosCameraInfo& info, bool full_size_known, Camera* camera) {
  const auto& roi = info.roi;
  const bool part = roi.width > 0 && roi.height > 0;
  if (part &&
      (std::uint64_t{roi.x_offset} + roi.width > info.width ||
       std::uint64_t{roi.y_offset} + roi.height > info.height) &&
      full_size_known)
    throw Error("the region of interest reaches beyond the image");
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

InfoReading camera_of_info(const RosCameraInfo& info, bool rectified) {
  if (info.width == 0 || info.height == 0 || info.width > kMaxSide || info.height > kMaxSide)
    throw Error("a size of " + std::to_string(info.width) + "x" + std::to_string(info.height));
  InfoReading reading;
  take_matrix(info, rectified, &reading.camera);
  take_region(info, true, &reading.camera);
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
