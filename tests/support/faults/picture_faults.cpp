#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "recording_faults.h"
#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

using Codes = std::vector<std::string>;
using EditImage = FaultyRecording::EditImage;

const Codes kOrder = {"frames.shifted", "stop.contradicts", "frames.contradict", "frames.repeat"};
// All that is left of a camera may be one image.
const Codes kFrozen = {"images.frozen", "frames.repeat", "camera.no_view", "camera.no_pose", "pose.too_uncertain"};
// A board that is found in one or two images still leaves their number as the cause.
const Codes kUnseen = {"board.nowhere", "board.never_seen", "camera.no_view", "camera.no_pose", "motion.too_few_poses"};
const Codes kTurned = {"images.mirrored"};
// Turned images move as those of a camera that hangs upside down: with depth that is turned the other way.
const Codes kHalfTurned = {"images.mirrored", "depth.mirrored"};
const Codes kCentre = {"lens.principal_point", "lens.half_pixel_slip"};
const Codes kAnyLens = {"lens.intrinsics", "lens.principal_point", "corners.off"};

RecordingFault of_one(const std::string& name, const Codes& codes, const EditImage& edit) {
  return {
      name, "pictures", codes, {Files::kColor}, [edit](FaultyRecording* r) { r->edit_color(r->any_camera(), edit); }};
}

RecordingFault of_all(const std::string& name, const Codes& codes, const EditImage& edit) {
  return {name, "pictures", codes, {Files::kColor}, [edit](FaultyRecording* r) {
            for (std::size_t k = 0; k < r->cameras(); ++k) r->edit_color(k, edit);
          }};
}

EditImage flipped(int about) {
  return [about](std::size_t, cv::Mat* image) { cv::flip(cv::Mat(image->clone()), *image, about); };
}

EditImage warped(const cv::Matx23d& source_to_target) {
  return [source_to_target](std::size_t, cv::Mat* image) {
    cv::warpAffine(cv::Mat(image->clone()), *image, source_to_target, image->size(), cv::INTER_CUBIC,
                   cv::BORDER_REPLICATE);
  };
}

EditImage shifted(double x_px, double y_px) { return warped({1.0, 0.0, x_px, 0.0, 1.0, y_px}); }

EditImage blurred(double sigma_px) {
  return [sigma_px](std::size_t, cv::Mat* image) { cv::GaussianBlur(*image, *image, {}, sigma_px); };
}

EditImage smeared(int length_px) {
  return [length_px](std::size_t, cv::Mat* image) { cv::blur(*image, *image, {length_px, 1}); };
}

EditImage compressed(int quality) {
  return [quality](std::size_t, cv::Mat* image) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", *image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    *image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  };
}

EditImage levels(double gain, double offset) {
  return [=](std::size_t, cv::Mat* image) { image->convertTo(*image, -1, gain, offset); };
}

EditImage sharpened(double amount) {
  return [amount](std::size_t, cv::Mat* image) {
    cv::Mat smooth;
    cv::GaussianBlur(*image, smooth, {}, 1.0);
    cv::addWeighted(*image, 1.0 + amount, smooth, -amount, 0.0, *image);
  };
}

// Of every camera the images are noisy by so many levels.
RecordingFault noisy(double levels_8bit) {
  return {"images with noise of " + number_text(levels_8bit) + " levels",
          "pictures",
          kUnseen,
          {Files::kColor},
          [levels_8bit](FaultyRecording* r) {
            for (std::size_t k = 0; k < r->cameras(); ++k)
              r->edit_color(k, [&](std::size_t frame, cv::Mat* image) {
                cv::RNG random(0x5eed + 1000 * k + frame);
                cv::Mat noise(image->size(), CV_16SC(image->channels()));
                random.fill(noise, cv::RNG::NORMAL, 0.0, levels_8bit);
                cv::add(*image, noise, *image, {}, image->type());
              });
          }};
}

// The image of one camera shakes from frame to frame.
RecordingFault shaken(double sigma_px) {
  return {"images of one camera shaken by " + number_text(sigma_px) + " px",
          "pictures",
          {"corners.off", "images.shaken"},
          {Files::kColor},
          [sigma_px](FaultyRecording* r) {
            r->edit_color(r->any_camera(), [&](std::size_t frame, cv::Mat* image) {
              RandomStream random = r->random("shaken", static_cast<std::int64_t>(frame));
              const double x_px = random.normal(0.0, sigma_px), y_px = random.normal(0.0, sigma_px);
              shifted(x_px, y_px)(frame, image);
            });
          }};
}

RecordingFault arranged(const std::string& name, const Codes& codes,
                        const std::function<std::size_t(std::size_t, std::size_t)>& source) {
  const auto apply = [source](FaultyRecording* r) {
    const std::size_t k = r->any_camera(), count = r->now().frames[k].size();
    r->rearrange(k, &CameraFrame::color_file, [&](std::size_t i) { return source(i, count); });
  };
  return {name, "pictures", codes, {Files::kColor}, apply};
}

// The first two cameras exchange the images (or the depth) of frames first .. first + count - 1.
void exchange(FaultyRecording* r, std::string CameraFrame::*which, std::size_t first, std::size_t count) {
  const auto &a = r->now().frames[0], &b = r->now().frames[1];
  for (std::size_t i = first; i < std::min(first + count, a.size()); ++i) {
    const std::string aside = a[i].*which + ".tmp";
    std::filesystem::rename(r->folder() / (a[i].*which), r->folder() / aside);
    r->replace(a[i].*which, b[i].*which);
    r->replace(b[i].*which, aside);
    std::filesystem::remove(r->folder() / aside);
  }
}

void add_mirrors(std::vector<RecordingFault>* faults) {
  faults->push_back(of_one("images of one camera mirrored", kTurned, flipped(1)));
  faults->push_back(of_all("images of all cameras mirrored", kTurned, flipped(1)));
  faults->push_back(of_one("images of one camera upside down", kTurned, flipped(0)));
  // Without depth they would be those of a camera that hangs upside down.
  faults->push_back({"images of one camera with depth turned by 180 deg",
                     "pictures",
                     kHalfTurned,
                     {Files::kColor},
                     [](FaultyRecording* r) { r->edit_color(r->depth_camera(), flipped(-1)); }});
}

void add_orders(std::vector<RecordingFault>* faults) {
  faults->push_back({"images of two cameras swapped",
                     "pictures",
                     {"frames.exchanged"},
                     {Files::kColor},
                     [](FaultyRecording* r) { exchange(r, &CameraFrame::color_file, 0, 1000); },
                     has_two_cameras});
  faults->push_back({"folders of two cameras swapped",
                     "pictures",
                     {"frames.exchanged"},
                     {Files::kRig},
                     [](FaultyRecording* r) {
                       r->edit_rig([](Rig* rig) { std::swap(rig->cameras[0].folder, rig->cameras[1].folder); });
                     },
                     has_two_cameras});
  faults->push_back({"three images of two cameras swapped",
                     "pictures",
                     {"frames.swapped"},
                     {Files::kColor},
                     [](FaultyRecording* r) { exchange(r, &CameraFrame::color_file, 5, 3); },
                     has_two_cameras});
  faults->push_back(arranged("images of one camera frozen", kFrozen, [](std::size_t, std::size_t) { return 0; }));
  faults->push_back(arranged("images of one camera frozen at half time", kFrozen,
                             [](std::size_t i, std::size_t count) { return std::min(i, count / 2); }));
  faults->push_back(
      arranged("one image of one camera repeated", kOrder, [](std::size_t i, std::size_t) { return i == 6 ? 5 : i; }));
  faults->push_back(arranged("every other image of one camera repeated", kFrozen,
                             [](std::size_t i, std::size_t) { return i - i % 2; }));
  // Of the only camera, late images are odometry that runs ahead, and in another order they are the recording's.
  const auto push = [faults](RecordingFault fault, const char* code_if_alone) {
    fault.codes_if_alone = {code_if_alone};
    faults->push_back(std::move(fault));
  };
  push(arranged("images of one camera one frame late", kOrder,
                [](std::size_t i, std::size_t) { return i == 0 ? i : i - 1; }),
       "odometry.stamps");
  push(arranged("images of one camera two frames early", kOrder,
                [](std::size_t i, std::size_t count) { return std::min(i + 2, count - 1); }),
       "odometry.stamps");
  faults->push_back(arranged("a frame of one camera lost at half time", kOrder, [](std::size_t i, std::size_t count) {
    return i < count / 2 ? i : std::min(i + 1, count - 1);
  }));
  faults->push_back(arranged("two images of one camera swapped", kOrder, [](std::size_t i, std::size_t) {
    return i == 4 ? 9 : i == 9 ? std::size_t{4} : i;
  }));
  push(arranged("images of one camera in backward order", {"frames.misordered"},
                [](std::size_t i, std::size_t count) { return count - 1 - i; }),
       "frames.misordered");
}

void add_quality(std::vector<RecordingFault>* faults) {
  for (const double px : {0.7, 1.5, 3.0, 6.0})
    faults->push_back(of_all("images blurred by " + number_text(px) + " px", kUnseen, blurred(px)));
  for (const int px : {3, 9, 25})
    faults->push_back(of_all("images smeared by " + std::to_string(px) + " px", kUnseen, smeared(px)));
  for (const int quality : {90, 50, 15, 3})
    faults->push_back(of_all("JPEG of quality " + std::to_string(quality), kUnseen, compressed(quality)));
  for (const double noise : {3.0, 10.0, 40.0}) faults->push_back(noisy(noise));
  faults->push_back(of_all("images at a tenth of their brightness", kUnseen, levels(0.1, 0.0)));
  faults->push_back(of_all("images overexposed", kUnseen, levels(3.0, 60.0)));
  faults->push_back(of_all("images sharpened", {}, sharpened(1.5)));
  faults->push_back(of_all("images at half the resolution, enlarged", {"corners.off"}, [](std::size_t, cv::Mat* image) {
    cv::Mat small;
    cv::resize(*image, small, {}, 0.5, 0.5, cv::INTER_AREA);
    cv::resize(small, *image, image->size(), 0.0, 0.0, cv::INTER_LINEAR);
  }));
}

void add_geometry(std::vector<RecordingFault>* faults) {
  // Images that are shifted against their depth leave depth that is shifted against them.
  std::vector<std::string> aside = kCentre;
  aside.emplace_back("depth.misplaced");
  for (const double px : {0.5, 3.0, 12.0})
    faults->push_back(of_one("images of one camera aside by " + number_text(px) + " px", aside, shifted(px, 0.0)));
  faults->push_back(of_one("images of one camera 1 % wider", kAnyLens, warped({1.01, 0.0, -3.2, 0.0, 1.0, 0.0})));
  std::vector<std::string> enlarged = kAnyLens;
  enlarged.emplace_back("depth.misplaced");
  faults->push_back(of_one("images of one camera enlarged by 4 %", enlarged, [](std::size_t frame, cv::Mat* image) {
    warped({1.04, 0.0, -0.02 * image->cols, 0.0, 1.04, -0.02 * image->rows})(frame, image);
  }));
  for (const double px : {0.3, 2.0, 10.0}) faults->push_back(shaken(px));
  faults->push_back(of_one("images of one camera at half the size", {kError}, [](std::size_t, cv::Mat* image) {
    cv::resize(cv::Mat(image->clone()), *image, {}, 0.5, 0.5, cv::INTER_AREA);
  }));
}

}  // namespace

std::vector<RecordingFault> picture_faults() {
  std::vector<RecordingFault> faults;
  add_mirrors(&faults);
  add_orders(&faults);
  add_quality(&faults);
  add_geometry(&faults);
  return faults;
}

}  // namespace rigproof::faults
