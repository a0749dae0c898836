#include "cost.h"

#include <map>

#include "rigproof/sim/models.h"

namespace rigproof {
namespace {

// Seconds a view, medians over tasks of 40 to 300 views.
constexpr double kUsual = 3e-4, kOpenCv = 5e-5;
const std::map<std::string, double>& rates() {
  static const std::map<std::string, double> rates = {{"ml", 5e-4},
                                                      {"joint_memroc", 4e-4},
                                                      {"memroc", 1.5e-4},
                                                      {"robot_autocalib_board", 6e-5},
                                                      {"li", 2e-4},
                                                      {"memroc_reference", 4e-4},
                                                      {"sensorx2car", 2e-3},
                                                      {"joint_memroc_reference", 6e-4},
                                                      {"robot_autocalib", 4e-3}};
  return rates;
}

// Nobody knows what a program of somebody else's takes.
constexpr double kOutside_s = 1.0;
constexpr double kProcess_s = 0.005, kObserve_s = 8e-5;
constexpr double kSearch_s = 0.045, kSearchStart_s = 0.012, kMatching_s = 0.35;  // a megapixel, an image, a megapixel

struct RigSize {
  double cameras = 0.0, megapixels = 0.0;
};

// Each rig's file is read once.
const RigSize& size_of(const std::string& rig) {
  static std::map<std::string, RigSize> known;
  RigSize& size = known[rig];
  if (size.cameras > 0.0) return size;
  for (const RigCamera& camera : load_rig_model(rig).rig.cameras) {
    size.cameras += 1.0;
    size.megapixels += 1e-6 * camera.camera.width_px * camera.camera.height_px;
  }
  return size;
}

}  // namespace

double megapixels_of(const GenerateConfig& config) {
  const RigSize& size = size_of(config.rig);
  return size.megapixels / size.cameras * config.image_scale * config.image_scale;
}

double views_of(const SweepTask& task) {
  const auto stops = static_cast<double>(task.images > 0 ? task.images : task.config.poses);
  if (!task.pictures.empty() || task.geometric.rig == "run") return stops * size_of(task.config.rig).cameras;
  constexpr double kReferenceCameras = 3.0;
  return stops * (task.geometric.rig == "random" ? static_cast<double>(task.geometric.cameras) : kReferenceCameras);
}

double seconds_of_answer(const std::string& method, bool outside, double views) {
  if (outside) return kOutside_s;
  if (method.rfind("opencv_", 0) == 0) return kOpenCv * views;
  const auto rate = rates().find(method);
  return (rate == rates().end() ? kUsual : rate->second) * views;
}

double seconds_of_observations(double views) { return kProcess_s + kObserve_s * views; }

double seconds_of_search(double megapixels) { return kSearchStart_s + kSearch_s * megapixels; }

double seconds_of_matching(double megapixels) { return kMatching_s * megapixels; }

}  // namespace rigproof
