// What the things of a scene are built of: boxes, cylinders, ellipsoids and panels in a frame of their own.
#pragma once

#include <array>
#include <map>
#include <string>

#include "rigproof/core/random.h"
#include "rigproof/sim/world.h"

namespace rigproof {

/// Surface of a shape.
struct Paint {
  std::string material;  ///< empty = none
  std::array<double, 3> color = {1.0, 1.0, 1.0};
};
Paint plain(double r, double g, double b);
/// Shines by itself: lamps, windows by day.
Paint glow(double r, double g, double b);
/// The same, darker or lighter.
Paint shaded(Paint paint, double factor);

/// Writes the shapes of one object as MJCF. x points where its front looks, y to its left, z up; the origin is the
/// middle of its foot. Places are middles, lengths are whole lengths [m].
class ObjectShapes {
 public:
  ObjectShapes(const SceneObject& object, const std::array<double, 3>& size_m, RandomStream random);

  const double depth, width, height;
  RandomStream random;

  /// The object's own textures, or plain in these colors where it names none.
  Paint main(const Paint& otherwise) const;
  Paint second(const Paint& otherwise) const;

  void box(std::array<double, 3> at, std::array<double, 3> lengths, const Paint& paint);
  /// Leans: turned by `pitch_deg` about y, the front end down if positive.
  void leaning_box(std::array<double, 3> at, std::array<double, 3> lengths, double pitch_deg, const Paint& paint);
  void ellipsoid(std::array<double, 3> at, std::array<double, 3> lengths, const Paint& paint);
  void upright(std::array<double, 3> at, double radius, double length, const Paint& paint);
  /// A cylinder from one point to another.
  void rod(std::array<double, 3> from, std::array<double, 3> to, double radius, const Paint& paint);
  /// A sheet that faces the front, with a flat texture the right way up.
  void panel(std::array<double, 3> at, double panel_width, double panel_height, const Paint& paint);

  const std::string& mjcf() const { return mjcf_; }

 private:
  void add(const char* type, const std::string& attributes, const Paint& paint);

  const SceneObject& object_;
  std::string mjcf_;
};

/// How a kind of object is built.
struct ObjectPattern {
  std::array<double, 3> size_m;  ///< depth, width, height unless the scene says otherwise
  void (*build)(ObjectShapes*);
  bool is_fixed = false;  ///< part of a building, or rooted: randomisation leaves it where it is
};
using ObjectKinds = std::map<std::string, ObjectPattern>;
const ObjectKinds& indoor_object_kinds();
const ObjectKinds& outdoor_object_kinds();

inline constexpr const char* kGlowMaterial = "rigproof_glow";
/// Name of the material with which objects wear a texture.
std::string object_material(const std::string& texture);

}  // namespace rigproof
