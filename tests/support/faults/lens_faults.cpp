#include <algorithm>
#include <array>
#include <utility>

#include "recording_faults.h"
#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

using Edit = std::function<void(Camera*)>;

const std::vector<std::string> kIntrinsics = {"lens.intrinsics", "prior.strained"};
const std::vector<std::string> kCentre = {"lens.principal_point", "lens.half_pixel_slip", "prior.strained"};
// Wrong coefficients leave corners off, or shift what the corners put the focal length and the centre to.
const std::vector<std::string> kAnyLens = {"lens.intrinsics", "lens.principal_point", "lens.half_pixel_slip",
                                           "corners.off", "prior.strained"};

RecordingFault of_one(const std::string& name, const std::vector<std::string>& codes, const Edit& edit) {
  return {name, "lens", codes, {Files::kRig}, [edit](FaultyRecording* r) {
            const std::size_t k = r->any_camera();
            r->edit_rig([&](Rig* rig) { edit(&rig->cameras[k].camera); });
          }};
}

RecordingFault of_all(const std::string& name, const std::vector<std::string>& codes, const Edit& edit) {
  return {name, "lens", codes, {Files::kRig}, [edit](FaultyRecording* r) {
            r->edit_rig([&](Rig* rig) {
              for (RigCamera& camera : rig->cameras) edit(&camera.camera);
            });
          }};
}

RecordingFault of_distorted(const std::string& name, Lens lens, const Edit& edit) {
  const auto holds = [lens](const RigCamera& camera) { return has_distortion(camera) && camera.camera.lens == lens; };
  const auto fits = [holds](const Rig& rig) { return std::any_of(rig.cameras.begin(), rig.cameras.end(), holds); };
  const auto apply = [edit, holds](FaultyRecording* r) {
    const std::size_t k = r->camera_with(holds);
    r->edit_rig([&](Rig* rig) { edit(&rig->cameras[k].camera); });
  };
  return {name, "lens", kAnyLens, {Files::kRig}, apply, fits};
}

Edit focal(double factor) {
  return [factor](Camera* camera) {
    camera->fx_px *= factor;
    camera->fy_px *= factor;
  };
}

Edit centre(double x_px, double y_px) {
  return [x_px, y_px](Camera* camera) {
    camera->cx_px += x_px;
    camera->cy_px += y_px;
  };
}

void add_focal_lengths(std::vector<RecordingFault>* faults) {
  for (const double percent : {0.2, 0.5, 1.0, 2.0, -2.0, 3.0, 5.0, -10.0, 50.0, 100.0, -50.0})
    faults->push_back(
        of_one(sized("focal length of one camera", percent, " %"), kIntrinsics, focal(1.0 + percent / 100.0)));
  for (const double percent : {1.0, -3.0, 10.0})
    faults->push_back(
        of_all(sized("focal length of all cameras", percent, " %"), kIntrinsics, focal(1.0 + percent / 100.0)));
  for (const double percent : {0.3, 1.0, 3.0})
    faults->push_back(of_one(sized("fx of one camera", percent, " %"), kIntrinsics,
                             [percent](Camera* camera) { camera->fx_px *= 1.0 + percent / 100.0; }));
}

void add_principal_points(std::vector<RecordingFault>* faults) {
  for (const double px : {1.0, 3.0, 10.0, 40.0})
    faults->push_back(of_one(sized("principal point of one camera", px, " px along x"), kCentre, centre(px, 0.0)));
  for (const double px : {3.0, -10.0})
    faults->push_back(of_one(sized("principal point of one camera", px, " px along y"), kCentre, centre(0.0, px)));
  for (const double px : {0.5, 6.0})
    faults->push_back(of_all(sized("principal points of all cameras", px, " px"), kCentre, centre(px, px)));
  faults->push_back(of_one("principal point of one camera with x and y swapped", kAnyLens,
                           [](Camera* camera) { std::swap(camera->cx_px, camera->cy_px); }));
}

void add_wrong_cameras(std::vector<RecordingFault>* faults) {
  faults->push_back(of_one("intrinsics of one camera at twice the resolution", kIntrinsics, [](Camera* camera) {
    focal(2.0)(camera);
    centre(camera->cx_px + 0.5, camera->cy_px + 0.5)(camera);
  }));
  faults->push_back(of_one("width and height of one camera swapped", {kError},
                           [](Camera* camera) { std::swap(camera->width_px, camera->height_px); }));
  const auto swap = [](FaultyRecording* r) {
    r->edit_rig([](Rig* rig) { std::swap(rig->cameras[0].camera, rig->cameras[1].camera); });
  };
  faults->push_back({"intrinsics of two cameras swapped",
                     "lens",
                     {"frames.exchanged", "lens.intrinsics", "prior.strained"},
                     {Files::kRig},
                     swap,
                     has_two_cameras});
}

void add_distortions(std::vector<RecordingFault>* faults) {
  using Coefficients = std::array<double, 5>;
  const auto with = [](const std::function<void(Coefficients*)>& edit) -> Edit {
    return [edit](Camera* camera) { edit(&camera->distortion); };
  };
  const auto scaled = [with](double factor) {
    return with([factor](Coefficients* k) {
      for (double& value : *k) value *= factor;
    });
  };
  const auto add = [faults](const std::string& name, const Edit& edit) {
    faults->push_back(of_distorted(name, Lens::kBrownConrady, edit));
  };
  add("distortion of one camera omitted", scaled(0.0));
  add("distortion of one camera of the wrong sign", scaled(-1.0));
  add("distortion of one camera halved", scaled(0.5));
  add("distortion of one camera +10 %", scaled(1.1));
  add("distortion of one camera in the order k1 k2 k3 p1 p2", with([](Coefficients* k) {
        *k = {(*k)[0], (*k)[1], (*k)[4], (*k)[2], (*k)[3]};
      }));
  add("distortion of one camera without k3", with([](Coefficients* k) { (*k)[4] = 0.0; }));
  add("tangential distortion of one camera swapped", with([](Coefficients* k) { std::swap((*k)[2], (*k)[3]); }));
  add("k1 of one camera +0.01", with([](Coefficients* k) { (*k)[0] += 0.01; }));
  const auto add_fisheye = [faults](const std::string& name, const Edit& edit) {
    faults->push_back(of_distorted(name, Lens::kKannalaBrandt, edit));
  };
  add_fisheye("a fisheye's coefficients as zero", scaled(0.0));
  add_fisheye("a fisheye's k1 +0.01", with([](Coefficients* k) { (*k)[0] += 0.01; }));
  add_fisheye("a fisheye told as a common lens", [](Camera* camera) { camera->lens = Lens::kBrownConrady; });
  add_fisheye("a fisheye told as a pinhole", [](Camera* camera) {
    camera->lens = Lens::kPinhole;
    camera->distortion = {};
  });
}

}  // namespace

std::vector<RecordingFault> lens_faults() {
  std::vector<RecordingFault> faults;
  add_focal_lengths(&faults);
  add_principal_points(&faults);
  add_wrong_cameras(&faults);
  add_distortions(&faults);
  return faults;
}

}  // namespace rigproof::faults
