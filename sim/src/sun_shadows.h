// Shadows on the floor, in sunlight. MuJoCo's own draw everything twice more; these cost a few milliseconds: the floor
// is flat, or nearly, so that a thing's shadow is its outline along the sun's rays on the plane z = 0, the same for
// every picture but the robot's.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "gl_scene.h"

namespace rigproof {

class SunShadows {
 public:
  /// Draws the shadows of all that stands. Without `shadows` in the scene, or a directional light that casts shadows
  /// in its MJCF, there are none.
  explicit SunShadows(const World& world);

  bool exist() const { return !standing_.mask.empty(); }
  /// Takes over where the robot is.
  void follow_robot(const World& world);
  /// Darkens the pixels that show floor in shadow, of a picture drawn through the frustum.
  /// @param depth, rows_from_bottom GL's memory of the same picture
  void paint(const Frustum& frustum, const Rigid3& T_world_camera, const std::uint32_t* depth,
             const mujoco::DepthLaw& law, std::uint8_t* rows_from_bottom) const;

 private:
  /// How much of the sun is hidden, 0 to 255, over a square of floor.
  struct Map {
    cv::Mat mask;
    cv::Mat near;  ///< the same by cells, 0 where there is no shadow within a cell's distance
    Eigen::Vector2d corner = Eigen::Vector2d::Zero();

    void clear(const Eigen::Vector2d& centre, double side_m);
    /// Blurs the edges over a penumbra of this width, once all shadows are drawn.
    void blur(double sigma_m);
    int at(const Eigen::Vector2f& floor_m) const;
    bool may_be_near(const Eigen::Vector2f& floor_m) const;
  };
  /// Heights of a floor that is not flat.
  class Relief {
   public:
    void measure(const GroundRelief& ground);
    bool empty() const { return heights_.empty(); }
    float at(const Eigen::Vector2f& floor_m) const;

   private:
    cv::Mat heights_;
    Eigen::Vector2f corner_ = Eigen::Vector2f::Zero();
  };
  struct Row;
  void paint_pixels(const Row& row, int begin, int end) const;
  bool find_on_relief(const Row& row, int column, Eigen::Vector2f* on_plane) const;
  bool may_have_shadow(const Row& row, int begin, int end) const;
  void add_geom(const World::Impl& impl, int geom, Map* map) const;
  void add_points(const std::vector<Eigen::Vector3d>& points, Map* map) const;
  void measure_light(const mjModel& model, int sun);

  Eigen::Vector3d sun_ray_ = -Eigen::Vector3d::UnitZ();  // the way that light goes
  std::array<float, 3> light_left_{};                    // in full shadow, of each color
  Relief relief_;
  Map standing_, robot_;
};

}  // namespace rigproof
