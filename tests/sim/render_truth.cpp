#include "render_truth.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "rigproof/sim/models.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The robot trails behind its cameras, which look along its z axis, and so never gets into the picture.
constexpr double kRobotBehind = 2.0;

// Sub-pixels per pixel of the analytic picture.
constexpr int kFine = 8;

// A square array with an origin in pixels.
struct Patch {
  int size = 0;
  std::vector<double> values;

  explicit Patch(int size_in) : size(size_in), values(static_cast<std::size_t>(size_in * size_in), 0.0) {}
  double& at(int x, int y) { return values[static_cast<std::size_t>(y * size + x)]; }
  double at(int x, int y) const { return values[static_cast<std::size_t>(y * size + x)]; }
};

// Point of the board plane that a pixel shows, in the board frame.
bool board_point(const Camera& camera, const Rigid3& T_board_camera, const Vector2d& pixel, Vector2d* point) {
  Vector3d ray;
  if (!camera.unproject(pixel, &ray)) return false;
  const Vector3d direction = T_board_camera.rotation * ray;
  const double distance = -T_board_camera.translation.z() / direction.z();
  if (!(distance > 0.0)) return false;
  *point = (T_board_camera.translation + distance * direction).head<2>();
  return true;
}

// Board coordinates relative to the corner at the nodes of the pixel grid around `first`.
struct Nodes {
  Patch x, y;
};
std::optional<Nodes> board_nodes(const Camera& camera, const Rigid3& T_board_camera, const Vector2d& origin,
                                 const Vector2d& corner, int count) {
  Nodes nodes{Patch(count), Patch(count)};
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      Vector2d point;
      if (!board_point(camera, T_board_camera, origin + Vector2d(i, j), &point)) return std::nullopt;
      nodes.x.at(i, j) = point.x() - corner.x();
      nodes.y.at(i, j) = point.y() - corner.y();
    }
  }
  return nodes;
}

// +1 on one side of the line value = 0, -1 on the other, linear within the sub-pixel that it crosses.
double soft_sign(double value, double change_per_step) {
  return std::clamp(2.0 * value / std::max(change_per_step, 1e-300), -1.0, 1.0);
}

// The ideal corner, -1 dark to 1 light, on the fine grid that starts half a pixel before node 1. Within a pixel the
// board's coordinates are blended linearly: the map bends by less than 1e-4 px there.
Patch ideal_corner(const Nodes& nodes, double sign) {
  const int cells = nodes.x.size - 1;
  Patch fine(cells * kFine);
  for (int y = 0; y < fine.size; ++y) {
    for (int x = 0; x < fine.size; ++x) {
      const double u = (x + 0.5) / kFine, v = (y + 0.5) / kFine;
      const int i = static_cast<int>(u), j = static_cast<int>(v);
      const double s = u - i, t = v - j;
      const auto value = [&](const Patch& n) {
        return (1 - t) * ((1 - s) * n.at(i, j) + s * n.at(i + 1, j)) +
               t * ((1 - s) * n.at(i, j + 1) + s * n.at(i + 1, j + 1));
      };
      const auto change = [&](const Patch& n) {
        return (std::abs(n.at(i + 1, j) - n.at(i, j)) + std::abs(n.at(i, j + 1) - n.at(i, j))) / kFine;
      };
      fine.at(x, y) = sign * soft_sign(value(nodes.x), change(nodes.x)) * soft_sign(value(nodes.y), change(nodes.y));
    }
  }
  return fine;
}

// Gaussian and pixel box as one kernel on the fine grid.
std::vector<double> pixel_kernel(double sigma_px) {
  const int reach = static_cast<int>(std::ceil((4.0 * sigma_px + 0.5) * kFine)) + 1;
  std::vector<double> kernel;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    // Integral of the Gaussian over the box seen from this offset.
    const double offset = static_cast<double>(k) / kFine;
    const double weight = sigma_px > 0.0 ? std::erf((offset + 0.5) / (sigma_px * std::sqrt(2.0))) -
                                               std::erf((offset - 0.5) / (sigma_px * std::sqrt(2.0)))
                                         : (std::abs(offset) < 0.5 ? 1.0 : (std::abs(offset) == 0.5 ? 0.5 : 0.0));
    kernel.push_back(weight);
    sum += weight;
  }
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

// Convolves columns, then rows; what the kernel cannot reach stays zero and is not used.
Patch blurred(const Patch& in, const std::vector<double>& kernel) {
  const int reach = static_cast<int>(kernel.size()) / 2;
  Patch middle(in.size), out(in.size);
  for (int y = reach; y < in.size - reach; ++y)
    for (int k = -reach; k <= reach; ++k)
      for (int x = 0; x < in.size; ++x)
        middle.at(x, y) += kernel[static_cast<std::size_t>(k + reach)] * in.at(x, y + k);
  for (int y = reach; y < in.size - reach; ++y)
    for (int x = reach; x < in.size - reach; ++x)
      for (int k = -reach; k <= reach; ++k)
        out.at(x, y) += kernel[static_cast<std::size_t>(k + reach)] * middle.at(x + k, y);
  return out;
}

// Smallest distance in the image from a corner to its neighbours on the board.
double spacing_px(const Camera& camera, const Rigid3& T_camera_board, const Board& board, const Vector3d& corner) {
  Vector2d here, there;
  if (!camera.project(T_camera_board * corner, &here)) return 0.0;
  double smallest = 1e9;
  for (const double step : {-board.square_m, board.square_m}) {
    for (const Vector3d& offset : {Vector3d(step, 0, 0), Vector3d(0, step, 0)}) {
      if (!camera.project(T_camera_board * (corner + offset), &there)) return 0.0;
      smallest = std::min(smallest, (there - here).norm());
    }
  }
  return smallest;
}

double luminance(const Image8& color, int x, int y) {
  return (color.at(x, y, 0) + color.at(x, y, 1) + color.at(x, y, 2)) / 3.0;
}

}  // namespace

void ShiftStatistics::add(const Vector2d& shift_px) {
  ++corners;
  sum += shift_px;
  sum_of_squares += shift_px.cwiseAbs2();
  largest_px = std::max(largest_px, shift_px.norm());
}

std::optional<Vector2d> corner_shift(const Image8& color, const Camera& camera, const Rigid3& T_camera_board,
                                     const Board& board, int corner, double psf_sigma_px) {
  const Vector3d p_board = board.corner(corner);
  const double spacing = spacing_px(camera, T_camera_board, board, p_board);
  // Edges of the neighbouring squares stay out of the window and of the PSF's reach.
  const int half = std::min(8, static_cast<int>(0.6 * spacing - 4.0 * psf_sigma_px - 1.0));
  Vector2d pixel;
  if (half < 2 || !camera.project(T_camera_board * p_board, &pixel)) return std::nullopt;
  const int cx = static_cast<int>(std::lround(pixel.x())), cy = static_cast<int>(std::lround(pixel.y()));
  if (cx < half || cy < half || cx >= color.width - half || cy >= color.height - half) return std::nullopt;

  const std::vector<double> kernel = pixel_kernel(psf_sigma_px);
  const int border = half + static_cast<int>(kernel.size()) / 2 / kFine + 2;
  // Nodes are at pixel centres; the fine grid's pixel (cx, cy) starts half a pixel before its centre.
  const auto nodes = board_nodes(camera, T_camera_board.inverse(), Vector2d(cx - border, cy - border),
                                 p_board.head<2>(), 2 * border + 1);
  if (!nodes) return std::nullopt;
  const bool dark_outside = board.is_dark(corner % board.inner_corners_x(), corner / board.inner_corners_x());
  const Patch model = blurred(ideal_corner(*nodes, dark_outside ? -1.0 : 1.0), kernel);

  // I = a + b T - b dx T_x - b dy T_y
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      // The pixel's centre lies between fine cells: average the four around it.
      const int fx = (border + x) * kFine, fy = (border + y) * kFine;
      const auto t = [&](int dx, int dy) {
        return 0.25 * (model.at(fx + dx, fy + dy) + model.at(fx + dx - 1, fy + dy) + model.at(fx + dx, fy + dy - 1) +
                       model.at(fx + dx - 1, fy + dy - 1));
      };
      const Eigen::Vector4d row(1.0, t(0, 0), -0.5 * kFine * (t(1, 0) - t(-1, 0)), -0.5 * kFine * (t(0, 1) - t(0, -1)));
      normal += row * row.transpose();
      right += row * luminance(color, cx + x, cy + y);
    }
  }
  const Eigen::Vector4d solution = normal.ldlt().solve(right);
  return Vector2d(solution[2] / solution[1], solution[3] / solution[1]);
}

void add_plane_depth(const World& world, const RenderedView& view, ObjectKind kind, const Camera& camera,
                     const Rigid3& T_camera_plane, const Eigen::AlignedBox2d& limits, DepthStatistics* statistics) {
  const Rigid3 T_plane_camera = T_camera_plane.inverse();
  const Vector3d normal = T_camera_plane.rotation * Vector3d::UnitZ();
  const double offset = normal.dot(T_camera_plane.translation);
  const auto is_kind = [&](int x, int y) { return world.kind_of_object(view.object_ids.at(x, y)) == kind; };
  for (int y = 2; y < camera.height_px - 2; ++y) {
    for (int x = 2; x < camera.width_px - 2; ++x) {
      if (!is_kind(x, y) || !is_kind(x - 2, y) || !is_kind(x + 2, y) || !is_kind(x, y - 2) || !is_kind(x, y + 2))
        continue;
      Vector3d ray;
      if (!camera.unproject({x, y}, &ray)) continue;
      const double depth = offset / normal.dot(ray);
      if (!(depth >= 0.4 && depth <= 4.0)) continue;
      if (!limits.contains((T_plane_camera * (depth * ray)).head<2>())) continue;
      const double difference = std::abs(static_cast<double>(view.depth_m.at(x, y)) - depth);
      ++statistics->pixels;
      statistics->sum_of_squares_m2 += difference * difference;
      statistics->largest_m = std::max(statistics->largest_m, difference);
    }
  }
}

Eigen::AlignedBox2d printed_face(const Board& board) {
  const std::vector<Vector3d> outline = board.outline();
  return {outline[0].head<2>(), outline[2].head<2>()};
}

Eigen::AlignedBox2d boundless() { return {Vector2d(-1e9, -1e9), Vector2d(1e9, 1e9)}; }

Rigid3 random_view_of_board(const Camera& camera, const Board& board, const Rigid3& T_world_board,
                            RandomStream* random) {
  for (;;) {
    const double distance = random->uniform(0.6, 4.0), oblique = deg_to_rad(random->uniform(0.0, 60.0));
    const double around = random->uniform(-kPi, kPi);
    // The printed face looks along -z of the board.
    const Vector3d place =
        board.centre() + distance * Vector3d(std::sin(oblique) * std::cos(around), std::sin(oblique) * std::sin(around),
                                             -std::cos(oblique));
    const Vector3d target =
        board.centre() + distance * Vector3d(random->uniform(-0.5, 0.5), random->uniform(-0.3, 0.3), 0.0);
    Eigen::Matrix3d R;
    R.col(2) = (target - place).normalized();
    R.col(0) = Vector3d::UnitY().cross(R.col(2)).normalized();
    R.col(1) = R.col(2).cross(R.col(0));
    const Eigen::Quaterniond roll(Eigen::AngleAxisd(random->uniform(-0.3, 0.3), Vector3d::UnitZ()));
    const Rigid3 T_board_camera(Eigen::Quaterniond(R) * roll, place);
    const Rigid3 T_world_camera = T_world_board * T_board_camera;
    if (T_world_camera.translation.z() < 0.3 || T_world_camera.translation.head<2>().norm() > 4.5) continue;
    bool inside = true;
    for (const Vector3d& p : board.outline()) {
      Vector2d pixel;
      inside = inside && camera.project(T_board_camera.inverse() * p, &pixel) && camera.contains(pixel, 8.0);
    }
    if (inside) return T_world_camera;
  }
}

std::vector<WorldCamera> figure_cameras() {
  const Camera symmetric = Camera::symmetric(1280, 720, 640.0);
  std::vector<WorldCamera> cameras(5);
  for (WorldCamera& camera : cameras) {
    camera.camera = symmetric;
    camera.T_robot_camera.translation.z() = kRobotBehind;
  }
  cameras[0].name = "pinhole";
  cameras[1].name = "off_centre";
  cameras[1].camera.cx_px = 603.3;
  cameras[1].camera.cy_px = 381.7;
  cameras[2].name = "fx_not_fy";
  cameras[2].camera.fy_px = 661.0;
  cameras[2].camera.cx_px = 648.9;
  cameras[3].name = "brown_conrady";
  cameras[3].camera.lens = Lens::kBrownConrady;
  cameras[3].camera.distortion = {-0.055, 0.064, 0.0006, -0.0004, -0.020};
  cameras[3].camera.cx_px = 645.2;
  cameras[4].name = "kannala_brandt";
  cameras[4].camera.lens = Lens::kKannalaBrandt;
  cameras[4].camera.fx_px = cameras[4].camera.fy_px = 620.0;
  cameras[4].camera.distortion = {-0.012, 0.002, -0.001, 0.0, 0.0};
  return cameras;
}

void place_camera(World* world, std::size_t camera, const Rigid3& T_world_camera) {
  world->place_robot(T_world_camera * world->description().cameras.at(camera).T_robot_camera.inverse());
}

WorldDescription figure_world(std::vector<WorldCamera> cameras) {
  const SceneModel scene = load_scene_model("indoor_lab");
  WorldDescription description;
  description.robot_mjcf = load_robot_model("husky").mjcf;
  description.scene = scene.world;
  description.cameras = std::move(cameras);
  BoardPlacement placement;
  placement.x_m = 2.0;
  placement.z_m = 1.1;
  placement.facing_deg = 176.0;
  placement.lean_deg = 7.0;
  placement.roll_deg = 3.0;
  description.T_world_board = place_board(description.board, placement);
  return description;
}

}  // namespace rigproof
