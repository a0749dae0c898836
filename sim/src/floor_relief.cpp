#include "floor_relief.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mjcf_text.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"
#include "world_impl.h"

namespace rigproof {
namespace {

// Higher boxes are kerbs and islands, whose tops stay level.
constexpr double kFlat_m = 0.015;
// So many chords follow the shortest wave, or the rise of a ramp.
constexpr double kCellsPerWave = 12.0, kCellsPerRise = 12.0;
constexpr double kFinest_m = 0.04, kCoarsest_m = 0.1;
constexpr double kMostCells = 320.0;
// A flat underside, out of sight, gives the mesh the volume that MuJoCo asks for.
constexpr double kUnderside_m = -0.5;
// Longer planes than this end beyond every far plane.
constexpr double kLongest_m = 200.0;

// A rectangle of floor.
struct Patch {
  Eigen::Vector3d centre;         ///< of its upper side
  Eigen::Vector2d along, across;  ///< directions of its local axes
  Eigen::Vector2d half;           ///< half lengths
  Eigen::Vector2d texture_per_m;

  Eigen::Vector2d at(double x, double y) const { return centre.head<2>() + x * along + y * across; }
  Eigen::Vector2d local(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d d = p - centre.head<2>();
    return {d.dot(along), d.dot(across)};
  }
};

// MuJoCo lays a flat texture over the local x and y of a plane or box: half a material's `texrepeat` is how often a
// metre, or half a length of the geom.
Patch patch_of(const mjModel& model, int geom) {
  Patch patch;
  const mjtNum *p = model.geom_pos + 3 * geom, *size = model.geom_size + 3 * geom, *q = model.geom_quat + 4 * geom;
  const bool is_plane = model.geom_type[geom] == mjGEOM_PLANE;
  const Eigen::Matrix3d R = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  patch.centre = {p[0], p[1], p[2] + (is_plane ? 0.0 : size[2])};
  patch.along = R.col(0).head<2>().normalized();
  patch.across = {-patch.along.y(), patch.along.x()};
  patch.texture_per_m.setZero();
  const int material = model.geom_matid[geom];
  for (int i = 0; i < 2; ++i) {
    patch.half[i] = size[i] > 0.0 ? std::min<double>(size[i], kLongest_m) : kLongest_m;
    if (material < 0) continue;
    const auto repeat = static_cast<double>(model.mat_texrepeat[2 * material + i]);
    patch.texture_per_m[i] = 0.5 * (model.mat_texuniform[material] ? repeat : repeat / patch.half[i]);
  }
  return patch;
}

bool can_be_draped(const mjModel& model, int geom) {
  const mjtNum *size = model.geom_size + 3 * geom, *q = model.geom_quat + 4 * geom;
  const bool is_level = std::abs(q[1]) < 1e-9 && std::abs(q[2]) < 1e-9;
  const bool is_flat_box = model.geom_type[geom] == mjGEOM_BOX && size[2] <= kFlat_m;
  return model.geom_bodyid[geom] == 0 && is_level && (model.geom_type[geom] == mjGEOM_PLANE || is_flat_box);
}

double cell_of(const GroundRelief& relief) {
  double cell = kCoarsest_m;
  for (const GroundRelief::Wave& wave : relief.waves)
    cell = std::min(cell, 2.0 * kPi / std::max(1e-9, wave.wavenumber.norm()) / kCellsPerWave);
  for (const GroundRelief::Ramp& ramp : relief.ramps) cell = std::min(cell, ramp.rise_m / kCellsPerRise);
  if (relief.extent) {
    const GroundRelief::Extent& e = *relief.extent;
    cell = std::max(cell, 2.0 * (std::max(e.half_x_m, e.half_y_m) + e.fall_m) / kMostCells);
  }
  return std::max(cell, kFinest_m);
}

// From -half to half; `cell` apart within [low, high], at whole multiples of it from -shift.
std::vector<double> grid_lines(double half, double low, double high, double cell, double shift) {
  constexpr double kLeast = 1e-6;
  const double first = std::max(-half, low), last = std::min(half, high);
  cell = std::max(cell, (last - first) / kMostCells);
  std::vector<double> lines = {-half};
  for (double i = std::ceil((first + shift) / cell); i * cell - shift <= last; ++i) {
    const double line = i * cell - shift;
    if (line > lines.back() + kLeast && line < half - kLeast) lines.push_back(line);
  }
  lines.push_back(half);
  return lines;
}

void append(std::initializer_list<double> values, std::string* text) {
  for (const double value : values) *text += short_text(value, 9) + " ";
}

class PatchMesh {
 public:
  PatchMesh(const Patch& patch, const GroundRelief& relief, double cell) : patch_(patch), relief_(relief) {
    Eigen::Array2d low(-kLongest_m, -kLongest_m), high = -low;
    if (relief.extent) {
      const GroundRelief::Extent& e = *relief.extent;
      const double reach_x = e.half_x_m + e.fall_m, reach_y = e.half_y_m + e.fall_m;
      std::swap(low, high);
      for (const double x : {e.x_m - reach_x, e.x_m + reach_x})
        for (const double y : {e.y_m - reach_y, e.y_m + reach_y}) {
          const Eigen::Vector2d corner = patch.local({x, y});
          low = low.min(corner.array());
          high = high.max(corner.array());
        }
      low -= cell;
      high += cell;
    }
    // Patches that lie one upon the other share their grid, or one would peep through the other.
    const bool is_turned = patch.along.x() < 1.0 - 1e-12;
    const Eigen::Vector2d shift = is_turned ? Eigen::Vector2d::Zero() : Eigen::Vector2d(patch.centre.head<2>());
    xs_ = grid_lines(patch.half.x(), low.x(), high.x(), cell, shift.x());
    ys_ = grid_lines(patch.half.y(), low.y(), high.y(), cell, shift.y());
  }

  std::string attributes() {
    for (const double y : ys_)
      for (const double x : xs_) add_top(x, y);
    const std::size_t columns = xs_.size();
    for (std::size_t row = 0; row + 1 < ys_.size(); ++row) {
      for (std::size_t column = 0; column + 1 < columns; ++column) {
        const std::size_t a = row * columns + column, b = a + 1, c = a + columns;
        add_face(a, b, c + 1);
        add_face(a, c + 1, c);
      }
    }
    const std::size_t under = columns * ys_.size();
    for (const double y : {ys_.front(), ys_.back()})
      for (const double x : {xs_.front(), xs_.back()}) add(x, y, kUnderside_m, -Eigen::Vector3d::UnitZ());
    add_face(under, under + 3, under + 1);
    add_face(under, under + 2, under + 3);
    return "vertex=" + rigproof::quoted(vertices_) + " normal=" + rigproof::quoted(normals_) +
           " texcoord=" + rigproof::quoted(coordinates_) + " face=" + rigproof::quoted(faces_);
  }

 private:
  void add_top(double x, double y) {
    const GroundRelief::Surface surface = relief_.at(patch_.at(x, y));
    add(x, y, patch_.centre.z() + surface.height_m,
        Eigen::Vector3d(-surface.slope.x(), -surface.slope.y(), 1.0).normalized());
  }

  void add(double x, double y, double z, const Eigen::Vector3d& normal) {
    const Eigen::Vector2d p = patch_.at(x, y);
    append({p.x(), p.y(), z}, &vertices_);
    append({normal.x(), normal.y(), normal.z()}, &normals_);
    append({patch_.texture_per_m.x() * x - 0.5, -patch_.texture_per_m.y() * y - 0.5}, &coordinates_);
  }

  void add_face(std::size_t a, std::size_t b, std::size_t c) {
    for (const std::size_t i : {a, b, c}) faces_ += std::to_string(i) + " ";
  }

  const Patch& patch_;
  const GroundRelief& relief_;
  std::vector<double> xs_, ys_;
  std::string vertices_, normals_, coordinates_, faces_;
};

std::string look_of(const mjModel& model, int geom) {
  const int material = model.geom_matid[geom];
  if (material >= 0) return "material=" + rigproof::quoted(mj_id2name(&model, mjOBJ_MATERIAL, material));
  const float* rgba = model.geom_rgba + 4 * geom;
  return "rgba=" + rigproof::quoted(numbers({static_cast<double>(rgba[0]), static_cast<double>(rgba[1]),
                                             static_cast<double>(rgba[2]), static_cast<double>(rgba[3])}));
}

}  // namespace

FloorRelief drape_floor(const mjModel& flat, const std::vector<ObjectKind>& kinds, const GroundRelief& relief) {
  FloorRelief result;
  const double cell = cell_of(relief);
  for (int geom = 0; geom < flat.ngeom; ++geom) {
    if (kinds[static_cast<std::size_t>(geom)] != ObjectKind::kFloor || !can_be_draped(flat, geom)) continue;
    const Patch patch = patch_of(flat, geom);
    const std::string name = rigproof::quoted(kReliefPrefix + std::to_string(geom));
    result.assets += "  <mesh name=" + name + " " + PatchMesh(patch, relief, cell).attributes() + "/>\n";
    result.geoms += "  <geom name=" + name + " type=\"mesh\" mesh=" + name + " " + look_of(flat, geom) +
                    " contype=\"0\" conaffinity=\"0\" group=" + rigproof::quoted(std::to_string(kReliefGroup)) + "/>\n";
    result.replaced.push_back(geom);
  }
  return result;
}

}  // namespace rigproof
