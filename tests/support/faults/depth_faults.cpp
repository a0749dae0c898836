#include <cmath>
#include <opencv2/imgproc.hpp>

#include "recording_faults.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

using Codes = std::vector<std::string>;
using Counts = cv::Mat_<std::uint16_t>;

const Codes kUnit = {"depth.unit", "depth.unit_of_all"};
// One scale of all depth cameras, or of the only one, and one of the board cannot be told apart by images and depth.
const Codes kAll = {"depth.scale_of_all", "depth.scale",      "depth.unit_of_all", "depth.unit",
                    "board.size",         "depth.board_size", "prior.strained"};
const Codes kOne = {"depth.scale", "depth.differs", "depth.scale_of_all", "depth.unit_of_all",
                    "depth.unit",  "board.size",    "depth.board_size",   "prior.strained"};
// Another shape is another scale of what is looked at, or none that all images share.
const Codes kShape = {"depth.scale",       "depth.scale_of_all", "depth.board_size", "depth.differs",
                      "depth.contradicts", "ground.contradicts", "ground.off",       "ground.off_slightly",
                      "prior.strained",    "depth.misplaced"};
const Codes kLost = {"ground.unseen", "depth.contradicts", "depth.unit", "depth.differs"};
const Codes kRepeats = {"depth.frames_repeat", "depth.contradicts", "ground.unseen"};
const Codes kMirrored = {"depth.mirrored"};

// What a measured depth, in metres, becomes at a pixel.
using EditDepth = std::function<double(double depth_m, int u, int v, const RigCamera&)>;

void edit_depths(FaultyRecording* r, std::size_t k, const EditDepth& edit) {
  const RigCamera& camera = r->now().rig.cameras[k];
  r->edit_depth(k, [&](std::size_t, cv::Mat* image) {
    Counts counts = *image;
    for (int v = 0; v < counts.rows; ++v)
      for (int u = 0; u < counts.cols; ++u)
        if (counts(v, u) > 0)
          counts(v, u) = cv::saturate_cast<std::uint16_t>(
              std::lround(edit(camera.depth->unit_m * counts(v, u), u, v, camera) / camera.depth->unit_m));
  });
}

RecordingFault of_one(const std::string& name, const Codes& codes, const EditDepth& edit) {
  return {
      name, "depth", codes, {Files::kDepth}, [edit](FaultyRecording* r) { edit_depths(r, r->depth_camera(), edit); }};
}

RecordingFault of_all(const std::string& name, const Codes& codes, const EditDepth& edit) {
  return {name, "depth", codes, {Files::kDepth}, [edit](FaultyRecording* r) {
            for (std::size_t k = 0; k < r->cameras(); ++k)
              if (r->now().rig.cameras[k].depth) edit_depths(r, k, edit);
          }};
}

RecordingFault pictures(const std::string& name, const Codes& codes, const FaultyRecording::EditImage& edit) {
  return {
      name, "depth", codes, {Files::kDepth}, [edit](FaultyRecording* r) { r->edit_depth(r->depth_camera(), edit); }};
}

RecordingFault arranged(const std::string& name, const Codes& codes,
                        const std::function<std::size_t(std::size_t, std::size_t)>& source) {
  const auto apply = [source](FaultyRecording* r) {
    const std::size_t k = r->depth_camera(), count = r->now().frames[k].size();
    r->rearrange(k, &CameraFrame::depth_file, [&](std::size_t i) { return source(i, count); });
  };
  return {name, "depth", codes, {Files::kDepth}, apply};
}

EditDepth scaled(double factor) {
  return [factor](double depth_m, int, int, const RigCamera&) { return factor * depth_m; };
}

EditDepth moved(double by_m) {
  return [by_m](double depth_m, int, int, const RigCamera&) { return depth_m + by_m; };
}

// As a depth sensor that looks down by so much more than the colour camera: every plane turns about the camera's x.
EditDepth tilted(double angle_deg) {
  return [slope = std::tan(deg_to_rad(angle_deg))](double depth_m, int, int v, const RigCamera& camera) {
    return depth_m / (1.0 + slope * (v - camera.camera.cy_px) / camera.camera.fy_px);
  };
}

FaultyRecording::EditImage shifted(int by_px) {
  return [by_px](std::size_t, cv::Mat* image) {
    cv::Mat moved = cv::Mat::zeros(image->size(), image->type());
    const int width = image->cols - by_px;
    (*image)(cv::Rect(0, 0, width, image->rows)).copyTo(moved(cv::Rect(by_px, 0, width, image->rows)));
    *image = moved;
  };
}

RecordingFault unit_fault(const std::string& name, bool all, double factor) {
  return {name, "depth", kUnit, {Files::kRig}, [all, factor](FaultyRecording* r) {
            const std::size_t one = all ? 0 : r->depth_camera();
            r->edit_rig([&](Rig* rig) {
              for (std::size_t k = 0; k < rig->cameras.size(); ++k)
                if (rig->cameras[k].depth && (all || k == one)) rig->cameras[k].depth->unit_m *= factor;
            });
          }};
}

RecordingFault cloud_fault(const std::string& name, const Codes& codes,
                           const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& move) {
  return {name, "depth", codes, {Files::kDepth, Files::kClouds}, [move](FaultyRecording* r) {
            r->depth_to_clouds(r->depth_camera(), move);
          }};
}

void add_scales(std::vector<RecordingFault>* faults) {
  for (const double factor : {0.1, 0.5, 10.0})
    faults->push_back(unit_fault("depth unit of one camera x " + number_text(factor), false, factor));
  for (const double factor : {0.1, 0.25, 10.0, 1000.0})
    faults->push_back(unit_fault("depth unit of all cameras x " + number_text(factor), true, factor));
  for (const double percent : {0.5, 1.0, 2.0, 5.0, -10.0})
    faults->push_back(of_one(sized("depth counts of one camera", percent, " %"), kOne, scaled(1.0 + percent / 100.0)));
  for (const double percent : {1.0, 3.0, -3.0, 10.0})
    faults->push_back(of_all(sized("depth counts of all cameras", percent, " %"), kAll, scaled(1.0 + percent / 100.0)));
}

void add_shapes(std::vector<RecordingFault>* faults) {
  for (const double mm : {5.0, 10.0, 20.0, 50.0, -50.0, 200.0})
    faults->push_back(of_one(sized("depth of one camera", mm, " mm"), kShape, moved(1e-3 * mm)));
  for (const double mm : {20.0, 50.0})
    faults->push_back(of_all(sized("depth of all cameras", mm, " mm"), kShape, moved(1e-3 * mm)));
  for (const double deg : {0.2, 0.5, 1.0, 3.0, 10.0})
    faults->push_back(of_one("depth of one camera tilted by " + number_text(deg) + " deg", kShape, tilted(deg)));
  for (const int px : {1, 3, 10, 40})
    faults->push_back(pictures("depth of one camera aside by " + std::to_string(px) + " px", kShape, shifted(px)));
  faults->push_back(of_one("depth of one camera clamped at 2 m", {"depth.clamped"},
                           [](double depth_m, int, int, const RigCamera&) { return std::min(depth_m, 2.0); }));
  faults->push_back(
      of_one("depth of one camera in steps of 50 mm", kShape,
             [](double depth_m, int, int, const RigCamera&) { return 0.05 * std::round(20.0 * depth_m); }));
  faults->push_back(
      of_one("depth of one camera along the ray", kShape, [](double depth_m, int u, int v, const RigCamera& camera) {
        Eigen::Vector3d ray;
        return camera.camera.unproject({u, v}, &ray) ? depth_m * ray.norm() : depth_m;
      }));
}

void add_pictures(std::vector<RecordingFault>* faults) {
  faults->push_back(pictures("depth of one camera mirrored", kMirrored,
                             [](std::size_t, cv::Mat* image) { cv::flip(cv::Mat(image->clone()), *image, 1); }));
  faults->push_back(pictures("depth of one camera upside down", kMirrored,
                             [](std::size_t, cv::Mat* image) { cv::flip(cv::Mat(image->clone()), *image, 0); }));
  faults->push_back(pictures("depth of one camera empty", kLost, [](std::size_t, cv::Mat* image) { image->setTo(0); }));
  faults->push_back(pictures("depth of one camera with its low bytes only", kLost,
                             [](std::size_t, cv::Mat* image) { cv::bitwise_and(*image, cv::Scalar(255), *image); }));
  faults->push_back(pictures("depth of one camera at half the resolution", {"ground.unseen", kError},
                             [](std::size_t, cv::Mat* image) {
                               cv::resize(cv::Mat(image->clone()), *image, {}, 0.5, 0.5, cv::INTER_NEAREST);
                             }));
  faults->push_back(
      pictures("depth of one camera +10 % in every other image", kShape, [](std::size_t frame, cv::Mat* image) {
        if (frame % 2 == 1) *image *= 1.1;
      }));
  faults->push_back(arranged("depth of one camera one frame late", {"depth.shifted"},
                             [](std::size_t i, std::size_t) { return i == 0 ? i : i - 1; }));
  faults->push_back(arranged("depth of one camera three frames late", {"depth.contradicts", "depth.shifted"},
                             [](std::size_t i, std::size_t) { return i < 3 ? 0 : i - 3; }));
  faults->push_back(
      arranged("depth of one camera frozen", kRepeats, [](std::size_t, std::size_t) { return std::size_t{0}; }));
  faults->push_back(arranged("depth of one camera frozen at half time", kRepeats,
                             [](std::size_t i, std::size_t count) { return std::min(i, count / 2); }));
}

// The first two depth cameras exchange their images.
void add_exchange(std::vector<RecordingFault>* faults) {
  const auto apply = [](FaultyRecording* r) {
    std::vector<std::size_t> with;
    for (std::size_t k = 0; k < r->cameras(); ++k)
      if (r->now().rig.cameras[k].depth) with.push_back(k);
    const auto &a = r->now().frames[with[0]], &b = r->now().frames[with[1]];
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::string aside = a[i].depth_file + ".tmp";
      std::filesystem::rename(r->folder() / a[i].depth_file, r->folder() / aside);
      r->replace(a[i].depth_file, b[i].depth_file);
      r->replace(b[i].depth_file, aside);
      std::filesystem::remove(r->folder() / aside);
    }
  };
  faults->push_back({"depth of two cameras swapped",
                     "depth",
                     {"depth.of_another_camera"},
                     {Files::kDepth},
                     apply,
                     has_two_depth_cameras});
}

void add_clouds(std::vector<RecordingFault>* faults) {
  faults->push_back(cloud_fault("clouds in body axes (x ahead)", {"depth.body_axes"},
                                [](const Eigen::Vector3f& p) { return Eigen::Vector3f(p.z(), -p.x(), -p.y()); }));
  faults->push_back(cloud_fault("clouds with y up and z back", {"depth.body_axes", "depth.mirrored"},
                                [](const Eigen::Vector3f& p) { return Eigen::Vector3f(p.x(), -p.y(), -p.z()); }));
  faults->push_back(
      cloud_fault("clouds in millimetres", kUnit, [](const Eigen::Vector3f& p) { return Eigen::Vector3f(1e3F * p); }));
  for (const float mm : {5.0F, 20.0F, 50.0F})
    faults->push_back(
        cloud_fault("clouds " + number_text(static_cast<double>(mm)) + " mm low", kShape,
                    [mm](const Eigen::Vector3f& p) { return Eigen::Vector3f(p.x(), p.y() + 1e-3F * mm, p.z()); }));
}

}  // namespace

std::vector<RecordingFault> depth_faults() {
  std::vector<RecordingFault> faults;
  add_scales(&faults);
  add_shapes(&faults);
  add_pictures(&faults);
  add_exchange(&faults);
  add_clouds(&faults);
  return faults;
}

}  // namespace rigproof::faults
