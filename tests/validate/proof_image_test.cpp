// The photon transfer curve of a run, found in its files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/yaml.h"
#include "rigproof/validate/proof.h"
#include "synthetic.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using namespace testing_support;
using testing::HasSubstr;

constexpr double kFullWell = 6000.0, kReadNoise = 5.0, kGamma = 2.2;

struct ImageFaults {
  double sigmas = 1.0;      // realised over stated
  double pixel_gain = 0.0;  // fixed pattern, one sigma
  bool dirty = false;       // every fourth square has a pattern
  const char* extension = ".png";
};

class ProofOfImageNoise : public testing::Test {
 protected:
  ProofOfImageNoise() {
    truth_.board.square_m = 0.15;
    for (TrueCamera& camera : truth_.cameras)
      camera.sensing = {{"image_noise", 1.0},
                        {"full_well_electrons", kFullWell},
                        {"read_noise_electrons", kReadNoise},
                        {"image_gamma", kGamma}};
  }

  // Enough where nothing depends on the others: images are most of the work.
  void keep_first_camera() { truth_.cameras.resize(1); }

  // White and black squares under a light that fades to the right; around them grey.
  double light_at(std::size_t stop, std::size_t camera, const Eigen::Vector2d& pixel, bool dirty) const {
    const TrueCamera& c = truth_.cameras[camera];
    const Rigid3 T_board_camera = truth_.T_world_board.inverse() * truth_.stops[stop].T_world_robot * c.T_robot_camera;
    Eigen::Vector3d ray;
    c.camera.unproject(pixel, &ray);
    const double z = -T_board_camera.translation.z() / (T_board_camera.rotation * ray).z();
    const Eigen::Vector3d p = T_board_camera * (z * ray) / truth_.board.square_m;
    const int ix = static_cast<int>(std::floor(p.x())) + 1, iy = static_cast<int>(std::floor(p.y())) + 1;
    const bool inside = ix >= 0 && iy >= 0 && ix < truth_.board.squares_x && iy < truth_.board.squares_y;
    if (!inside) return 0.2 * kFullWell;
    double share = truth_.board.is_dark(ix, iy) ? 0.02 : 0.4;
    if (dirty && (ix + 2 * iy) % 4 == 0) share *= 1.0 + 0.3 * std::sin(90.0 * p.x());
    return kFullWell * share * (1.2 - 0.4 * pixel.x() / c.camera.width_px);
  }

  Proof prove_with(const ImageFaults& faults) {
    Recording recording = make_depth_recording(truth_, folder_.path(), {});
    for (std::size_t camera = 0; camera < truth_.cameras.size(); ++camera)
      for (std::size_t stop = 0; stop < truth_.stops.size(); ++stop) {
        CameraFrame& frame = recording.frames[camera][stop];
        frame.color_file = truth_.cameras[camera].name + "_color_" + std::to_string(stop) + faults.extension;
        cv::imwrite((folder_ / frame.color_file).string(), image_of(stop, camera, faults));
      }
    return prove(recording, make_observations(truth_, 0.02), truth_);
  }

  cv::Mat image_of(std::size_t stop, std::size_t camera, const ImageFaults& faults) const {
    const Camera& c = truth_.cameras[camera].camera;
    RandomStream noise(1, "image", static_cast<std::int64_t>(stop), static_cast<std::int32_t>(camera));
    RandomStream pattern(2, "pattern", 0, static_cast<std::int32_t>(camera));
    cv::Mat image(c.height_px, c.width_px, CV_8UC3);
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const double light = light_at(stop, camera, {u, v}, faults.dirty);
        for (int k = 0; k < 3; ++k) {
          double electrons = light * (1.0 + faults.pixel_gain * pattern.normal());
          electrons += faults.sigmas * std::sqrt(electrons + kReadNoise * kReadNoise) * noise.normal();
          const double level = 255.0 * std::pow(std::clamp(electrons / kFullWell, 0.0, 1.0), 1.0 / kGamma);
          image.ptr<std::uint8_t>(v)[3 * u + k] = static_cast<std::uint8_t>(std::lround(level));
        }
      }
    return image;
  }

  Truth truth_ = make_truth(4);
  const TempFolder folder_;
};

// A few dozen squares of a hundred samples and more each: their median is known to about a per cent.
void expect_ratio(const Proof& proof, double ratio) {
  for (const CameraProof& camera : proof.cameras) {
    ASSERT_GE(camera.image_noise.size(), 2U) << "dark and bright squares";
    for (const RealisedImageNoise& noise : camera.image_noise)
      EXPECT_NEAR(noise.sigma_electrons / noise.stated_sigma_electrons, ratio, 0.03 * ratio)
          << camera.camera << " at " << noise.electrons;
    EXPECT_GT(camera.image_noise.back().electrons, 5.0 * camera.image_noise.front().electrons);
  }
}

TEST_F(ProofOfImageNoise, AsStatedIsFoundAsStated) {
  const Proof proof = prove_with({});
  expect_ratio(proof, 1.0);
  // Slope of variance over light: one electron of light is one of variance.
  const std::vector<RealisedImageNoise>& curve = proof.cameras[0].image_noise;
  const double rise = std::pow(curve.back().sigma_electrons, 2) - std::pow(curve.front().sigma_electrons, 2);
  EXPECT_NEAR(rise / (curve.back().electrons - curve.front().electrons), 1.0, 0.08);
}

TEST_F(ProofOfImageNoise, MoreThanStatedIsTold) {
  keep_first_camera();
  ImageFaults faults;
  faults.sigmas = 1.3;
  expect_ratio(prove_with(faults), 1.3);
}

TEST_F(ProofOfImageNoise, TheFixedPatternIsPartOfTheLaw) {
  keep_first_camera();
  ImageFaults faults;
  faults.pixel_gain = 0.03;
  for (TrueCamera& camera : truth_.cameras) camera.sensing["pixel_gain_percent"] = 3.0;
  expect_ratio(prove_with(faults), 1.0);
}

TEST_F(ProofOfImageNoise, DirtIsNoNoise) {
  keep_first_camera();
  ImageFaults faults;
  faults.dirty = true;
  const Proof proof = prove_with(faults);
  for (const RealisedImageNoise& noise : proof.cameras.at(0).image_noise)
    EXPECT_NEAR(noise.sigma_electrons / noise.stated_sigma_electrons, 1.0, 0.08) << noise.electrons;
}

TEST_F(ProofOfImageNoise, IsKeptInTheFile) {
  keep_first_camera();
  const Proof proof = prove_with({});
  const std::filesystem::path file = folder_ / "proof.yaml";
  save_proof(proof, file);
  const YamlTree camera = read_yaml_file(file).find("cameras")->items.at(0);
  const std::vector<YamlTree>& noise = camera.find("image_noise")->items;
  ASSERT_EQ(noise.size(), proof.cameras[0].image_noise.size());
  for (std::size_t i = 0; i < noise.size(); ++i)
    EXPECT_EQ(parse_number(noise[i].find("sigma_electrons")->scalar), proof.cameras[0].image_noise[i].sigma_electrons);
}

TEST_F(ProofOfImageNoise, IsNotComparedWhereThereIsNoneOrWhereJpegChangesIt) {
  keep_first_camera();
  ImageFaults faults;
  faults.extension = ".jpg";
  const Proof jpeg = prove_with(faults);
  EXPECT_TRUE(jpeg.cameras[0].image_noise.empty());
  EXPECT_THAT(jpeg.notes,
              testing::Contains(Finding("proof.image_noise_changed", {{"by", "jpeg"}}).of(jpeg.cameras[0].camera)));
  EXPECT_THAT(worded(jpeg.notes), testing::Contains(HasSubstr("JPEG")));
  for (TrueCamera& camera : truth_.cameras) camera.sensing.clear();
  EXPECT_TRUE(prove_with({}).cameras[0].image_noise.empty());
}

}  // namespace
}  // namespace rigproof
