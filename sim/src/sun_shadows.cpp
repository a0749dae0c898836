#include "sun_shadows.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/conventions.h"
#include "world_impl.h"

namespace rigproof {
namespace {

constexpr double kPixelM = 0.0125, kCellM = 0.5;
constexpr double kStandingSideM = 32.0, kRobotSideM = 5.0;
// Heights of a floor that is not flat; of one without end so much about the middle.
constexpr double kReliefCellM = 0.05, kReliefM = 20.0;
// What rises less than this share of the camera's height above the floor counts as floor: lines, rugs, kerb stones.
constexpr float kFloorTolerance = 0.03F;
// The sun's disc blurs edges by a hundredth of the distance that the shadow falls.
constexpr double kPenumbraM = 0.012;

// The corners of a board's sheet, its border included.
std::vector<Eigen::Vector3d> sheet_of(const WorldBoard& board) {
  std::vector<Eigen::Vector3d> sheet;
  for (const Eigen::Vector3d& corner : board.board.outline()) {
    const Eigen::Vector3d out = corner - board.board.centre();
    const double margin = board.board_margin_m;
    sheet.push_back(board.T_world_board *
                    (corner + Eigen::Vector3d(std::copysign(margin, out.x()), std::copysign(margin, out.y()), 0.0)));
  }
  return sheet;
}

// Points whose convex hull is the geom, or nearly: circles become polygons. None for planes and meshes.
std::vector<Eigen::Vector3d> points_of(const mjModel& model, int geom) {
  const mjtNum* size = model.geom_size + 3 * geom;
  std::vector<Eigen::Vector3d> points;
  constexpr int kAround = 20, kRings = 7;
  const auto add_ring = [&](double radius_x, double radius_y, double z) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * kPi * i / kAround;
      points.emplace_back(radius_x * std::cos(angle), radius_y * std::sin(angle), z);
    }
  };
  switch (model.geom_type[geom]) {
    case mjGEOM_BOX:
      for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
          for (const double z : {-1.0, 1.0}) points.emplace_back(x * size[0], y * size[1], z * size[2]);
      break;
    case mjGEOM_CYLINDER:
      for (const double z : {-1.0, 1.0}) add_ring(size[0], size[0], z * size[1]);
      break;
    case mjGEOM_CAPSULE:
    case mjGEOM_SPHERE:
    case mjGEOM_ELLIPSOID: {
      const bool is_ellipsoid = model.geom_type[geom] == mjGEOM_ELLIPSOID;
      const double stretch = model.geom_type[geom] == mjGEOM_CAPSULE ? size[1] : 0.0;
      for (int ring = 1; ring < kRings; ++ring) {
        const double latitude = kPi * (static_cast<double>(ring) / kRings - 0.5);
        const double share = std::cos(latitude), up = std::sin(latitude);
        const double half_height = is_ellipsoid ? size[2] : size[0];
        add_ring(share * size[0], share * (is_ellipsoid ? size[1] : size[0]),
                 up * half_height + std::copysign(stretch, up));
      }
      break;
    }
    default:
      break;
  }
  return points;
}

}  // namespace

void SunShadows::Relief::measure(const GroundRelief& ground) {
  if (ground.flat()) return;
  const GroundRelief::Extent e = ground.extent.value_or(GroundRelief::Extent{0.0, 0.0, kReliefM, kReliefM, 0.0});
  corner_ = Eigen::Vector2d(e.x_m - e.half_x_m - e.fall_m, e.y_m - e.half_y_m - e.fall_m).cast<float>();
  heights_.create(static_cast<int>(std::ceil(2.0 * (e.half_y_m + e.fall_m) / kReliefCellM)) + 1,
                  static_cast<int>(std::ceil(2.0 * (e.half_x_m + e.fall_m) / kReliefCellM)) + 1, CV_32F);
  for (int row = 0; row < heights_.rows; ++row)
    for (int column = 0; column < heights_.cols; ++column)
      heights_.at<float>(row, column) = static_cast<float>(
          ground.height(corner_.cast<double>() + kReliefCellM * Eigen::Vector2d(column + 0.5, row + 0.5)));
}

float SunShadows::Relief::at(const Eigen::Vector2f& floor_m) const {
  const Eigen::Vector2f cell = (floor_m - corner_) * static_cast<float>(1.0 / kReliefCellM);
  // Compared as numbers: far away there are more cells than an int counts.
  if (!(cell.x() >= 0.0F && cell.y() >= 0.0F && cell.x() < static_cast<float>(heights_.cols) &&
        cell.y() < static_cast<float>(heights_.rows)))
    return 0.0F;
  return heights_.at<float>(static_cast<int>(cell.y()), static_cast<int>(cell.x()));
}

void SunShadows::Map::clear(const Eigen::Vector2d& centre, double side_m) {
  const int side = static_cast<int>(std::lround(side_m / kPixelM));
  mask.create(side, side, CV_8UC1);
  mask.setTo(0);
  corner = centre - Eigen::Vector2d::Constant(0.5 * side_m);
}

void SunShadows::Map::blur(double sigma_m) {
  cv::GaussianBlur(mask, mask, {}, sigma_m / kPixelM);
  const int cells = mask.cols * static_cast<int>(std::lround(kPixelM * 1000.0)) / static_cast<int>(kCellM * 1000.0);
  cv::Mat shares;
  mask.convertTo(shares, CV_32F);
  cv::resize(shares, shares, {cells, cells}, 0, 0, cv::INTER_AREA);
  near = shares > 0.0F;
  cv::dilate(near, near, cv::Mat());
}

int SunShadows::Map::at(const Eigen::Vector2f& floor_m) const {
  const Eigen::Vector2f pixel = (floor_m - corner.cast<float>()) * static_cast<float>(1.0 / kPixelM);
  const int column = static_cast<int>(pixel.x()), row = static_cast<int>(pixel.y());
  if (column < 0 || row < 0 || column >= mask.cols || row >= mask.rows) return 0;
  return mask.ptr<std::uint8_t>(row)[column];
}

bool SunShadows::Map::may_be_near(const Eigen::Vector2f& floor_m) const {
  const Eigen::Vector2f cell = (floor_m - corner.cast<float>()) * static_cast<float>(1.0 / kCellM);
  const int column = std::clamp(static_cast<int>(cell.x()), -1, near.cols);
  const int row = std::clamp(static_cast<int>(cell.y()), -1, near.rows);
  if (column < 0 || row < 0 || column == near.cols || row == near.rows) return false;
  return near.ptr<std::uint8_t>(row)[column] != 0;
}

SunShadows::SunShadows(const World& world) {
  const WorldDescription& description = world.description();
  const World::Impl& impl = world.impl();
  const mjModel& model = *impl.model;
  int sun = 0;
  while (sun < model.nlight && !(model.light_castshadow[sun] && model.light_directional[sun])) ++sun;
  if (!description.scene.shadows || sun == model.nlight) return;
  sun_ray_ = Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(model.light_dir + 3 * sun)).normalized();
  if (sun_ray_.z() > -0.05) return;  // at the horizon everything would lie in shadow
  measure_light(model, sun);
  relief_.measure(description.ground);
  const FloorArea& area = description.scene.drivable_area;
  standing_.clear({0.5 * (area.x_min + area.x_max), 0.5 * (area.y_min + area.y_max)}, kStandingSideM);
  for (int geom = 0; geom < model.ngeom; ++geom)
    if (impl.geom_kinds[static_cast<std::size_t>(geom)] == ObjectKind::kScene &&
        model.geom_group[geom] != kCeilingGroup)
      add_geom(impl, geom, &standing_);
  for (std::size_t i = 0; i < description.boards(); ++i) add_points(sheet_of(description.board_at(i)), &standing_);
  standing_.blur(kPenumbraM);
}

void SunShadows::measure_light(const mjModel& model, int sun) {
  for (int c = 0; c < 3; ++c) {
    double all = 0.0, from_sun = 0.0;
    for (int light = 0; light < model.nlight; ++light) {
      const Eigen::Vector3d ray = Eigen::Map<const Eigen::Vector3d>(model.light_dir + 3 * light).normalized();
      const double diffuse = static_cast<double>(model.light_diffuse[3 * light + c]) * std::max(0.0, -ray.z());
      all += static_cast<double>(model.light_ambient[3 * light + c]) + diffuse;
      if (light == sun) from_sun = diffuse;
    }
    // GL cuts the light of a surface off at 1.
    light_left_[static_cast<std::size_t>(c)] =
        static_cast<float>(std::min(1.0, all - from_sun) / std::max(1e-6, std::min(1.0, all)));
  }
}

void SunShadows::add_geom(const World::Impl& impl, int geom, Map* map) const {
  const Eigen::Vector3d at = Eigen::Map<const Eigen::Vector3d>(impl.data->geom_xpos + 3 * geom);
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(impl.data->geom_xmat + 9 * geom);
  std::vector<Eigen::Vector3d> points = points_of(*impl.model, geom);
  for (Eigen::Vector3d& point : points) point = R * point + at;
  add_points(points, map);
}

void SunShadows::add_points(const std::vector<Eigen::Vector3d>& points, Map* map) const {
  constexpr int kFractionBits = 4;
  constexpr float kFraction = 1 << kFractionBits;
  std::vector<cv::Point2f> fallen, hull;
  for (const Eigen::Vector3d& point : points) {
    const double way = std::max(0.0, point.z()) / -sun_ray_.z();
    const Eigen::Vector2d on_floor = (point + way * sun_ray_).head<2>() - map->corner;
    fallen.emplace_back(static_cast<float>(on_floor.x() / kPixelM), static_cast<float>(on_floor.y() / kPixelM));
  }
  if (fallen.size() < 3) return;
  cv::convexHull(fallen, hull);
  const cv::Rect2f box = cv::boundingRect(hull);
  const bool outside = box.x > static_cast<float>(map->mask.cols) || box.y > static_cast<float>(map->mask.rows) ||
                       box.x + box.width < 0.0F || box.y + box.height < 0.0F;
  if (outside || hull.size() < 3) return;
  std::vector<cv::Point> corners;
  for (const cv::Point2f& corner : hull)
    corners.emplace_back(cvRound(kFraction * corner.x), cvRound(kFraction * corner.y));
  cv::fillConvexPoly(map->mask, corners, cv::Scalar(255), cv::LINE_AA, kFractionBits);
}

void SunShadows::follow_robot(const World& world) {
  if (!exist()) return;
  const World::Impl& impl = world.impl();
  robot_.clear(impl.T_world_robot.translation.head<2>(), kRobotSideM);
  for (int geom = 0; geom < impl.model->ngeom; ++geom)
    if (impl.geom_kinds[static_cast<std::size_t>(geom)] == ObjectKind::kRobot) add_geom(impl, geom, &robot_);
  robot_.blur(kPenumbraM);
}

// One row of a picture. Its rays, scaled to a depth of 1, are first + column * step.
struct SunShadows::Row {
  Eigen::Vector3f eye, first, step;
  const std::uint32_t* depth = nullptr;
  std::uint8_t* pixels = nullptr;
  float offset = 0.0F, slope = 0.0F;  // of one over depth

  Eigen::Vector3f ray(int column) const { return first + static_cast<float>(column) * step; }
  // One over the depth at which a ray meets the floor.
  float floor_per_m(int column) const { return -(first.z() + static_cast<float>(column) * step.z()) / eye.z(); }
  Eigen::Vector2f floor_at(int column) const { return eye.head<2>() + ray(column).head<2>() / floor_per_m(column); }
  // One over the depth of what is seen.
  float seen_per_m(int column) const {
    constexpr std::uint32_t kMaxCount = (1U << 24U) - 1U;
    return offset + slope * static_cast<float>(kMaxCount - (depth[column] >> 8U));
  }
  bool shows_floor(int column, float expected_per_m) const {
    return std::abs(seen_per_m(column) - expected_per_m) <= kFloorTolerance * expected_per_m;
  }
};

// Where the ray of the sun through what is seen meets the plane that shadows are drawn on.
bool SunShadows::find_on_relief(const Row& row, int column, Eigen::Vector2f* on_plane) const {
  const Eigen::Vector3f seen = row.eye + row.ray(column) / row.seen_per_m(column);
  if (std::abs(seen.z() - relief_.at(seen.head<2>())) > kFloorTolerance * row.eye.z()) return false;
  const Eigen::Vector3f sun = sun_ray_.cast<float>();
  *on_plane = seen.head<2>() - seen.z() / sun.z() * sun.head<2>();
  return true;
}

// Looks at the ends only: a block of pixels this near is narrower than two cells.
bool SunShadows::may_have_shadow(const Row& row, int begin, int end) const {
  constexpr float kFarPerM = 1.0F / 15.0F;
  const float one = row.floor_per_m(begin), other = row.floor_per_m(end - 1);
  if (one <= 0.0F && other <= 0.0F) return false;
  if (std::min(one, other) < kFarPerM) return true;
  for (const int column : {begin, end - 1}) {
    const Eigen::Vector2f at = row.floor_at(column);
    if (standing_.may_be_near(at) || robot_.may_be_near(at)) return true;
  }
  return false;
}

void SunShadows::paint_pixels(const Row& row, int begin, int end) const {
  for (int column = begin; column < end; ++column) {
    const float floor_per_m = row.floor_per_m(column);
    Eigen::Vector2f at;
    if (!relief_.empty()) {
      if (!find_on_relief(row, column, &at)) continue;
    } else {
      if (floor_per_m <= 0.0F || !row.shows_floor(column, floor_per_m)) continue;
      at = row.floor_at(column);
    }
    const int shadow = std::max(standing_.at(at), robot_.at(at));
    if (shadow == 0) continue;
    std::uint8_t* pixel = row.pixels + 4 * static_cast<std::ptrdiff_t>(column);
    const float share = static_cast<float>(shadow) / 255.0F;
    for (std::size_t c = 0; c < 3; ++c) {
      const float factor = 1.0F - share * (1.0F - light_left_[c]);
      pixel[c] = static_cast<std::uint8_t>(static_cast<float>(pixel[c]) * factor + 0.5F);
    }
  }
}

void SunShadows::paint(const Frustum& frustum, const Rigid3& T_world_camera, const std::uint32_t* depth,
                       const mujoco::DepthLaw& law, std::uint8_t* rows_from_bottom) const {
  if (!exist()) return;
  constexpr int kBlock = 16;
  const Eigen::Matrix3f R = T_world_camera.rotation_matrix().cast<float>();
  const float step = static_cast<float>((frustum.x_max - frustum.x_min) / frustum.width);
  Row row;
  row.eye = T_world_camera.translation.cast<float>();
  row.step = step * R.col(0);
  row.offset = static_cast<float>(law.offset_per_m);
  row.slope = static_cast<float>(law.slope_per_m);
  for (int y = 0; y < frustum.height; ++y) {
    const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(y) * frustum.width;
    const double ray_y = frustum.y_max - (y + 0.5) * (frustum.y_max - frustum.y_min) / frustum.height;
    row.first =
        R.col(1) * static_cast<float>(ray_y) + R.col(2) + R.col(0) * (static_cast<float>(frustum.x_min) + 0.5F * step);
    row.depth = depth + start;
    row.pixels = rows_from_bottom + 4 * start;
    for (int begin = 0; begin < frustum.width; begin += kBlock) {
      const int end = std::min(begin + kBlock, frustum.width);
      if (may_have_shadow(row, begin, end)) paint_pixels(row, begin, end);
    }
  }
}

}  // namespace rigproof
