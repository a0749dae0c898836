// Pictures of a robot that moves: how far things smear and lean, against what its velocity says.
#include "rigproof/sim/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <variant>

#include "light_sum.h"
#include "render_truth.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

constexpr double kGamma = 2.2, kFocal_px = 600.0, kDistance_m = 1.6;

Exposure resting(std::size_t parts, const Rigid3& T_world_robot, double exposure_s, double readout_s) {
  Exposure exposure;
  exposure.T_world_robot.assign(parts, T_world_robot);
  exposure.exposure_s = exposure_s;
  exposure.readout_s = readout_s;
  return exposure;
}

TEST(Exposure, RowsOfARollingShutterAreExposedOneAfterTheOther) {
  constexpr int kHeight = 101;
  constexpr double kReadout_s = 0.020;
  for (const double exposure_s : {0.010, 0.0033, 0.0012, 0.0003}) {
    constexpr std::size_t kParts = 60;
    const Exposure exposure = resting(kParts, Rigid3(), exposure_s, kReadout_s);
    const double part_s = (exposure_s + kReadout_s) / kParts;
    for (int row = 0; row < kHeight; ++row) {
      const RowParts parts = parts_of_row(exposure, row, kHeight);
      EXPECT_NEAR(std::accumulate(parts.shares.begin(), parts.shares.end(), 0.0), 1.0, 1e-12);
      double middle_s = 0.0;
      for (std::size_t i = 0; i < parts.shares.size(); ++i)
        middle_s += parts.shares[i] * part_s * (static_cast<double>(parts.first + i) + 0.5);
      // Before the first part's middle and behind the last one's there is none to make up for it.
      const double moment_s = 0.5 * exposure_s + kReadout_s * (row + 0.5) / kHeight,
                   least_s = std::max(0.0, 0.5 * (part_s - exposure_s));
      const bool inner = moment_s > 0.5 * part_s && moment_s < (kParts - 0.5) * part_s;
      EXPECT_NEAR(middle_s, moment_s, inner ? 1e-12 : least_s + 1e-12) << row;
      EXPECT_GE(*std::min_element(parts.shares.begin(), parts.shares.end()), -1e-15);
      EXPECT_LE(parts.first + parts.shares.size(), exposure.parts());
    }
  }
  EXPECT_NEAR(0.0005 * static_cast<double>(parts_of_row(resting(60, Rigid3(), 0.01, 0.02), 50, kHeight).first), 0.010,
              1e-9)
      << "the middle row is in the middle of the whole time";
}

TEST(Exposure, GlobalShutterExposesAllRowsAlikeAndAFrozenRowIsOfOneMoment) {
  const RowParts all = parts_of_row(resting(8, Rigid3(), 0.01, 0.0), 17, 100);
  EXPECT_EQ(all.first, 0U);
  EXPECT_EQ(all.shares, std::vector<double>(8, 0.125));
  const RowParts moment = parts_of_row(resting(10, Rigid3(), 0.0, 0.02), 55, 100);
  EXPECT_EQ(moment.first, 5U);
  EXPECT_EQ(moment.shares, std::vector<double>{1.0});
  EXPECT_EQ(parts_of_row(resting(1, Rigid3(), 0.01, 0.02), 99, 100).shares, std::vector<double>{1.0});
}

TEST(LightSum, KeepsLevelsThatDoNotChangeAndMeansLight) {
  std::vector<std::uint8_t> levels(256), black(256, 0);
  std::iota(levels.begin(), levels.end(), std::uint8_t{0});
  for (const double gamma : {1.0, 2.2, 3.0}) {
    LightSum same(256, 1, 1, gamma), half(256, 1, 1, gamma);
    for (const double share : {0.3, 0.125, 0.575}) same.add_row(0, share, levels.data());
    half.add_row(0, 0.5, levels.data());
    half.add_row(0, 0.5, black.data());
    Image8 image;
    same.write(&image);
    EXPECT_EQ(image.pixels, levels) << gamma;
    half.write(&image);
    for (const std::size_t level : {40U, 128U, 255U})
      EXPECT_NEAR(static_cast<double>(image.pixels[level]), std::pow(0.5, 1.0 / gamma) * static_cast<double>(level),
                  0.6);
  }
}

// A camera that looks straight at the board, and moves along its own x axis.
class Sideways {
 public:
  explicit Sideways(Lens lens = Lens::kPinhole) {
    WorldCamera camera{"c", Rigid3(Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.6}),
                       Camera::symmetric(640, 480, kFocal_px)};
    camera.camera.lens = lens;
    if (lens == Lens::kBrownConrady) camera.camera.distortion = {-0.02, 0.0, 0.0, 0.0, 0.0};
    description_ = figure_world({camera});
    world_ = World::compose(description_);
    const Eigen::Vector3d centre = description_.board.centre();
    T_world_camera_ = description_.T_world_board * Rigid3(Eigen::Quaterniond::Identity(), centre) *
                      Rigid3(Eigen::Quaterniond::Identity(), {0.0, 0.0, -kDistance_m});
    renderer_ = std::make_unique<Renderer>(*world_, RenderOptions());
  }

  // The robot's pose with the camera this far along its x axis.
  Rigid3 robot_at(double x_m) const {
    return T_world_camera_ * Rigid3(Eigen::Quaterniond::Identity(), {x_m, 0.0, 0.0}) *
           description_.cameras[0].T_robot_camera.inverse();
  }

  Exposure moving(double speed_m_s, std::size_t parts, double exposure_s, double readout_s) const {
    Exposure exposure = resting(0, Rigid3(), exposure_s, readout_s);
    const double whole_s = exposure_s + readout_s;
    for (std::size_t i = 0; i < parts; ++i)
      exposure.T_world_robot.push_back(
          robot_at(speed_m_s * whole_s * ((static_cast<double>(i) + 0.5) / static_cast<double>(parts) - 0.5)));
    return exposure;
  }

  RenderedView still() {
    RenderedView view;
    world_->place_robot(robot_at(0.0));
    renderer_->render(0, &view);
    return view;
  }

  RenderedView shoot(const Exposure& color, const Exposure& depth) {
    RenderedView view;
    renderer_->render_moving(0, color, depth, &view);
    return view;
  }
  RenderedView shoot(const Exposure& color) { return shoot(color, resting(1, robot_at(0.0), 0.0, 0.0)); }

  const Camera& camera() const { return description_.cameras[0].camera; }
  const Board& board() const { return description_.board; }
  Eigen::Vector2d corner_px(int id) const {
    Eigen::Vector2d pixel;
    EXPECT_TRUE(camera().project(T_world_camera_.inverse() * description_.T_world_board * board().corner(id), &pixel));
    return pixel;
  }
  double square_px() const { return board().square_m * kFocal_px / kDistance_m; }

 private:
  WorldDescription description_;
  std::unique_ptr<World> world_;
  Rigid3 T_world_camera_;
  std::unique_ptr<Renderer> renderer_;
};

double light_at(const Image8& image, int x, int y) {
  return std::pow(static_cast<double>(image.at(x, y, 1)) / 255.0, kGamma);
}

struct EdgeProfile {
  double place_px = 0.0, variance_px2 = 0.0;
};

// Place and spread of the vertical edge about x0 in a row: mean and variance of the light's derivative.
EdgeProfile edge_in_row(const Image8& image, double x0, int y, int half) {
  double sum = 0.0, first = 0.0, second = 0.0;
  const int middle = static_cast<int>(std::lround(x0));
  for (int x = middle - half; x < middle + half; ++x) {
    const double step = light_at(image, x + 1, y) - light_at(image, x, y), place = x + 0.5;
    sum += step;
    first += step * place;
    second += step * place * place;
  }
  const double mean = first / sum;
  return {mean, second / sum - mean * mean};
}

// Vertical edges of the board: above inner corner `id` by a share of a square.
EdgeProfile edge_above(const Sideways& scene, const Image8& image, int id, double squares = 0.5) {
  const Eigen::Vector2d corner = scene.corner_px(id);
  const int half = static_cast<int>(0.45 * scene.square_px());
  return edge_in_row(image, corner.x(), static_cast<int>(std::lround(corner.y() - squares * scene.square_px())), half);
}

TEST(MovingRobot, WithoutMotionTheBytesAreThoseOfNoBlur) {
  for (const Lens lens : {Lens::kPinhole, Lens::kBrownConrady}) {
    Sideways scene(lens);
    const RenderedView still = scene.still();
    for (const std::size_t parts : {1U, 5U}) {
      const RenderedView same = scene.shoot(resting(parts, scene.robot_at(0.0), 0.01, 0.0));
      EXPECT_EQ(same.color.pixels, still.color.pixels) << parts;
      EXPECT_EQ(same.depth_m.pixels, still.depth_m.pixels) << parts;
    }
  }
}

// Blur of w pixels adds w^2 / 12 to the variance of an edge.
TEST(MovingRobot, BlurIsAsWideAsTheVelocitySays) {
  Sideways scene;
  const RenderedView still = scene.still();
  for (const double speed_m_s : {1.0, 2.0}) {
    constexpr double kExposure_s = 0.012;
    const double expected_px = speed_m_s * kExposure_s * kFocal_px / kDistance_m;  // 4.5 and 9
    const RenderedView view = scene.shoot(scene.moving(speed_m_s, 24, kExposure_s, 0.0));
    double variance = 0.0;
    const std::vector<int> corners = {0, 1, 2, 3};
    for (const int id : corners)
      variance += edge_above(scene, view.color, id).variance_px2 - edge_above(scene, still.color, id).variance_px2;
    const double width_px = std::sqrt(12.0 * variance / static_cast<double>(corners.size()));
    EXPECT_NEAR(width_px, expected_px, 0.03 * expected_px);
    EXPECT_EQ(view.depth_m.pixels, still.depth_m.pixels) << "depth is of the middle of the exposure";
  }
}

TEST(MovingRobot, CornersOfABlurredPictureAreWhereTheyWereAtMidExposure) {
  Sideways scene;
  const RenderedView view = scene.shoot(scene.moving(1.0, 16, 0.012, 0.0));
  const BoardDetection detection = detect_checkerboard(view.color, scene.board());
  const auto* corners = std::get_if<std::vector<CornerObservation>>(&detection);
  ASSERT_NE(corners, nullptr) << std::get<BoardNotFound>(detection).why.code;
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();
  for (const CornerObservation& corner : *corners) {
    const Eigen::Vector2d error = corner.pixel - scene.corner_px(corner.id);
    EXPECT_LT(error.norm(), 0.05) << corner.id;
    bias += error / static_cast<double>(corners->size());
  }
  ASSERT_GE(corners->size(), 10U);
  EXPECT_LT(bias.norm(), 0.02) << "of a blur of 4.5 px";
}

// Row v is read readout (v + 1/2) / h late: an edge leans by velocity times that.
TEST(MovingRobot, RollingShutterLeansEdgesByTheReadoutRate) {
  Sideways scene;
  const RenderedView still = scene.still();
  constexpr double kSpeed_m_s = 1.0, kReadout_s = 0.030;
  const double image_speed_px_s = -kSpeed_m_s * kFocal_px / kDistance_m;  // things move against the camera
  for (const double exposure_s : {0.0, 0.006}) {
    const RenderedView view = scene.shoot(scene.moving(kSpeed_m_s, 60, exposure_s, kReadout_s));
    // Straight line through shifts of a vertical edge against the still picture, over rows of the board.
    double n = 0.0, sv = 0.0, ss = 0.0, svv = 0.0, svs = 0.0;
    for (int id = 0; id < scene.board().corner_count(); ++id) {
      // Many rows, since a row is as exact as a part of the exposure is short.
      for (double squares = 0.2; squares < 0.81; squares += 0.05) {
        const double v = std::round(scene.corner_px(id).y() - squares * scene.square_px());
        const double s =
            edge_above(scene, view.color, id, squares).place_px - edge_above(scene, still.color, id, squares).place_px;
        n += 1.0;
        sv += v;
        ss += s;
        svv += v * v;
        svs += v * s;
      }
    }
    const double slope = (n * svs - sv * ss) / (n * svv - sv * sv), mean_v = sv / n;
    EXPECT_NEAR(slope, image_speed_px_s * kReadout_s / 480.0, 0.03 * std::abs(image_speed_px_s) * kReadout_s / 480.0);
    EXPECT_NEAR(ss / n, image_speed_px_s * kReadout_s * ((mean_v + 0.5) / 480.0 - 0.5), 0.1)
        << "the middle row is where it is without motion";
  }
}

// Towards the board by 1 m/s: a scanned depth image is nearer in its last rows than in its first.
TEST(MovingRobot, ScannedDepthIsOfEachRowsTime) {
  Sideways scene;
  const RenderedView still = scene.still();
  Exposure depth = resting(0, Rigid3(), 0.0, 0.03);
  constexpr int kParts = 30;
  const Rigid3 T_robot_camera(Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.6});
  for (int i = 0; i < kParts; ++i)
    depth.T_world_robot.push_back(
        scene.robot_at(0.0) * T_robot_camera *
        Rigid3(Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.03 * ((i + 0.5) / kParts - 0.5)}) *
        T_robot_camera.inverse());
  const RenderedView view = scene.shoot(resting(1, scene.robot_at(0.0), 0.0, 0.0), depth);
  const Eigen::Vector2d centre = 0.5 * (scene.corner_px(0) + scene.corner_px(scene.board().corner_count() - 1));
  for (const int offset : {-50, 0, 50}) {
    const int x = static_cast<int>(centre.x()), y = static_cast<int>(centre.y()) + offset;
    const double nearer = static_cast<double>(still.depth_m.at(x, y) - view.depth_m.at(x, y));
    EXPECT_NEAR(nearer, 0.03 * ((y + 0.5) / 480.0 - 0.5), 0.0006) << y;  // parts of 1 mm
  }
}

}  // namespace
}  // namespace rigproof
