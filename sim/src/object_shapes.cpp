#include "object_shapes.h"

#include <algorithm>
#include <cmath>

#include "mjcf_text.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

// A panel is this thick: thin against everything, thick against the depth buffer.
constexpr double kPanelM = 0.01;

std::string place(const std::array<double, 3>& at) { return " pos=" + quoted(numbers({at[0], at[1], at[2]})); }

std::string half_lengths(const std::array<double, 3>& lengths) {
  return " size=" + quoted(numbers({0.5 * lengths[0], 0.5 * lengths[1], 0.5 * lengths[2]}));
}

}  // namespace

Paint plain(double r, double g, double b) { return {"", {r, g, b}}; }

Paint glow(double r, double g, double b) { return {kGlowMaterial, {r, g, b}}; }

Paint shaded(Paint paint, double factor) {
  for (double& channel : paint.color) channel = std::min(1.0, factor * channel);
  return paint;
}

std::string object_material(const std::string& texture) { return "rigproof_object_" + texture; }

ObjectShapes::ObjectShapes(const SceneObject& object, const std::array<double, 3>& size_m, RandomStream random_in)
    : depth(size_m[0]), width(size_m[1]), height(size_m[2]), random(random_in), object_(object) {}

Paint ObjectShapes::main(const Paint& otherwise) const {
  if (object_.texture.empty()) return object_.color ? Paint{"", *object_.color} : otherwise;
  return {object_material(object_.texture), object_.color.value_or(std::array<double, 3>{1.0, 1.0, 1.0})};
}

Paint ObjectShapes::second(const Paint& otherwise) const {
  if (object_.second_texture.empty()) return otherwise;
  return {object_material(object_.second_texture), {1.0, 1.0, 1.0}};
}

void ObjectShapes::add(const char* type, const std::string& attributes, const Paint& paint) {
  mjcf_ += std::string("    <geom type=\"") + type + "\"" + attributes;
  if (!paint.material.empty()) mjcf_ += " material=" + quoted(paint.material);
  mjcf_ += " rgba=" + quoted(numbers({paint.color[0], paint.color[1], paint.color[2], 1.0})) + "/>\n";
}

void ObjectShapes::box(std::array<double, 3> at, std::array<double, 3> lengths, const Paint& paint) {
  add("box", place(at) + half_lengths(lengths), paint);
}

void ObjectShapes::leaning_box(std::array<double, 3> at, std::array<double, 3> lengths, double pitch_deg,
                               const Paint& paint) {
  // Axes instead of angles: independent of the unit that a compiler setting chooses.
  const double c = std::cos(deg_to_rad(pitch_deg)), s = std::sin(deg_to_rad(pitch_deg));
  add("box", place(at) + half_lengths(lengths) + " xyaxes=" + quoted(numbers({c, 0.0, -s, 0.0, 1.0, 0.0})), paint);
}

void ObjectShapes::ellipsoid(std::array<double, 3> at, std::array<double, 3> lengths, const Paint& paint) {
  add("ellipsoid", place(at) + half_lengths(lengths), paint);
}

void ObjectShapes::upright(std::array<double, 3> at, double radius, double length, const Paint& paint) {
  add("cylinder", place(at) + " size=" + quoted(numbers({radius, 0.5 * length})), paint);
}

void ObjectShapes::rod(std::array<double, 3> from, std::array<double, 3> to, double radius, const Paint& paint) {
  add("cylinder",
      " fromto=" + quoted(numbers({from[0], from[1], from[2], to[0], to[1], to[2]})) +
          " size=" + quoted(numbers({radius})),
      paint);
}

void ObjectShapes::panel(std::array<double, 3> at, double panel_width, double panel_height, const Paint& paint) {
  add("box", place(at) + half_lengths({panel_width, panel_height, kPanelM}) + " xyaxes=\"0 1 0 0 0 1\"", paint);
}

}  // namespace rigproof
