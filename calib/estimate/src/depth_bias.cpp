#include "rigproof/calib/estimate/depth_bias.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "planes_of_cameras.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/median.h"

namespace rigproof {
namespace {

// Cubic B-splines over independent numbers, one cell apart, correlate as a Gaussian of this many cells.
constexpr double kCorrelationCells = 0.816;
constexpr double kNodesPerCell = 4.0;
constexpr double kMaxNodesAcross = 40.0;
constexpr double kPointsAcross = 64.0;
constexpr int kBisections = 12;
constexpr double kRidge = 1e-6;  // of the mean variance: a covariance that can be inverted

bool states_bias(const RigCamera& camera) { return camera.depth && camera.depth->noise.has_bias(); }

// Where the depth sensor sees things, and how alike its errors are there.
class BiasedView {
 public:
  explicit BiasedView(const RigCamera& camera) : camera_(camera), noise_(camera.depth->noise) {
    if (camera.depth->own_camera) R_color_depth_ = camera.depth->own_camera->T_color_depth.rotation.toRotationMatrix();
    cell_px_ = optics().fx_px * std::tan(deg_to_rad(noise_.bias_cell_deg));
  }

  const Camera& optics() const { return camera_.depth_optics(); }
  double cell_px() const { return cell_px_; }
  // Of 1/z, one sigma.
  double sigma(double inverse_depth) const { return noise_.inverse_depth_bias(inverse_depth); }

  // The ray in the colour camera, z = 1, of a pixel of the depth sensor; the millimetres between both do not matter.
  std::optional<Eigen::Vector3d> ray_of(const Eigen::Vector2d& depth_pixel) const {
    Eigen::Vector3d ray;
    if (!optics().unproject(depth_pixel, &ray)) return std::nullopt;
    ray = R_color_depth_ * ray;
    if (ray.z() <= 0.0) return std::nullopt;
    return Eigen::Vector3d(ray / ray.z());
  }

  // The pixel of the depth sensor at which it sees what the colour camera sees at another one.
  std::optional<Eigen::Vector2d> depth_pixel_of(const Eigen::Vector2d& color_pixel) const {
    Eigen::Vector3d ray;
    Eigen::Vector2d pixel;
    if (!camera_.camera.unproject(color_pixel, &ray)) return std::nullopt;
    if (!optics().project(R_color_depth_.transpose() * ray, &pixel)) return std::nullopt;
    return pixel;
  }

  Eigen::MatrixXd correlation(const std::vector<Eigen::Vector2d>& depth_pixels) const {
    const auto count = static_cast<Eigen::Index>(depth_pixels.size());
    const double scale = -0.5 / std::pow(kCorrelationCells * cell_px_, 2);
    Eigen::MatrixXd K(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j <= i; ++j)
        K(i, j) = K(j, i) = std::exp(
            scale *
            (depth_pixels[static_cast<std::size_t>(i)] - depth_pixels[static_cast<std::size_t>(j)]).squaredNorm());
    return K;
  }

 private:
  const RigCamera& camera_;
  const DepthNoise& noise_;
  Eigen::Matrix3d R_color_depth_ = Eigen::Matrix3d::Identity();
  double cell_px_ = 0.0;
};

// A place between the nodes of a grid, and how much of each node's bias it has.
using Place = std::vector<std::pair<std::size_t, double>>;

// How a least-squares plane answers to one sigma of bias at each node: 3 x nodes [1/m].
class PlaneResponse {
 public:
  PlaneResponse(const BiasedView& view, const DepthNoise& noise, const Eigen::Vector3d& plane)
      : view_(view), noise_(noise), plane_(plane) {}

  void add(const Place& place, const Eigen::Vector3d& ray) {
    const double inverse_depth = plane_.dot(ray);
    const double sigma = noise_.inverse_depth_sigma(1.0 / inverse_depth), weight = 1.0 / (sigma * sigma);
    information_ += weight * ray * ray.transpose();
    columns_.push_back({place, weight * view_.sigma(inverse_depth) * ray});
  }

  // Mean of 1/z over the points, by their weights.
  double mean_inverse_depth() const { return plane_.dot(information_.col(2)) / information_(2, 2); }

  // Absent where the places do not make a plane.
  std::optional<Eigen::MatrixXd> over(std::size_t nodes) const {
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(information_);
    if (columns_.size() < 4 || !(ldlt.rcond() > 1e-9)) return std::nullopt;
    Eigen::MatrixXd response = Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(nodes));
    for (const auto& [place, column] : columns_)
      for (const auto& [node, share] : place) response.col(static_cast<Eigen::Index>(node)) += share * column;
    return Eigen::MatrixXd(ldlt.solve(response));
  }

 private:
  const BiasedView& view_;
  const DepthNoise& noise_;
  const Eigen::Vector3d plane_;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  std::vector<std::pair<Place, Eigen::Vector3d>> columns_;
};

using ViewOfPlane = std::map<std::pair<int, int>, const BoardView*>;  // by stop and camera

ViewOfPlane views_by_place(const Observations& observations) {
  ViewOfPlane views;
  for (const BoardView& view : observations.board_views) views[{view.stop, view.camera}] = &view;
  return views;
}

// One camera's floor and boards on a grid of the depth image.
class CameraBias {
 public:
  explicit CameraBias(const RigCamera& camera) : camera_(camera), view_(camera) {
    const Camera& optics = view_.optics();
    const double step = std::max(view_.cell_px() / kNodesPerCell, optics.width_px / kMaxNodesAcross);
    columns_ = std::max(2, static_cast<int>(std::ceil(optics.width_px / step)));
    rows_ = std::max(2, static_cast<int>(std::ceil(optics.height_px / step)));
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column)
        nodes_.emplace_back((optics.width_px - 1.0) * column / (columns_ - 1),
                            (optics.height_px - 1.0) * row / (rows_ - 1));
  }

  // Per sigma of bias at each node. Furniture and walls end a floor before the sensor's range does, and the far points
  // of a floor weigh most: it reaches as far as makes the mean of 1/z that its planes have.
  std::optional<Eigen::MatrixXd> of_ground(const Eigen::Vector3d& plane, double mean_inverse_depth) const {
    const std::vector<FloorPoint> points = floor_points(plane);
    double least = 1.0 / camera_.depth->max_m, most = std::max(least, mean_inverse_depth);
    for (int i = 0; i < kBisections; ++i) {
      const double middle = 0.5 * (least + most);
      (response_beyond(middle, plane, points).mean_inverse_depth() < mean_inverse_depth ? least : most) = middle;
    }
    return response_beyond(least, plane, points).over(nodes_.size());
  }

  Eigen::Matrix3d covariance(const Eigen::MatrixXd& response) const {
    Eigen::Matrix3d result = response * view_.correlation(nodes_) * response.transpose();
    result.diagonal().array() += kRidge * result.trace() / 3.0;
    return result;
  }

 private:
  struct FloorPoint {
    Place place;
    Eigen::Vector3d ray;
    double inverse_depth;
  };

  std::vector<FloorPoint> floor_points(const Eigen::Vector3d& plane) const {
    const Camera& optics = view_.optics();
    const double step = optics.width_px / kPointsAcross;
    std::vector<FloorPoint> points;
    for (double y = 0.5 * step; y < optics.height_px; y += step)
      for (double x = 0.5 * step; x < optics.width_px; x += step) {
        const std::optional<Eigen::Vector3d> ray = view_.ray_of({x, y});
        const double inverse_depth = ray ? plane.dot(*ray) : 0.0;
        if (inverse_depth * camera_.depth->max_m < 1.0 || inverse_depth * camera_.depth->min_m > 1.0) continue;
        points.push_back({place_of({x, y}), *ray, inverse_depth});
      }
    return points;
  }

  PlaneResponse response_beyond(double least_inverse_depth, const Eigen::Vector3d& plane,
                                const std::vector<FloorPoint>& points) const {
    PlaneResponse response(view_, camera_.depth->noise, plane);
    for (const FloorPoint& point : points)
      if (point.inverse_depth >= least_inverse_depth) response.add(point.place, point.ray);
    return response;
  }

  // Bilinear: a cell has several nodes.
  Place place_of(const Eigen::Vector2d& depth_pixel) const {
    const Camera& optics = view_.optics();
    const auto position = [](double place, double size, int count) {
      return std::clamp(place / (size - 1.0) * (count - 1), 0.0, count - 1.0);
    };
    const double x = position(depth_pixel.x(), optics.width_px, columns_);
    const double y = position(depth_pixel.y(), optics.height_px, rows_);
    const int column = std::min(static_cast<int>(x), columns_ - 2), row = std::min(static_cast<int>(y), rows_ - 2);
    const double u = x - column, v = y - row;
    const auto first = static_cast<std::size_t>(row * columns_ + column),
               below = first + static_cast<std::size_t>(columns_);
    return {{first, (1.0 - u) * (1.0 - v)}, {first + 1, u * (1.0 - v)}, {below, (1.0 - u) * v}, {below + 1, u * v}};
  }

  const RigCamera& camera_;
  BiasedView view_;
  int columns_ = 0, rows_ = 0;
  std::vector<Eigen::Vector2d> nodes_;
};

// Where the boards of a camera are seen. Errors of a field that n boards at one place share do not average out: as
// independent ones, n times as large, they leave as much in a mean.
class SharedPlaces {
 public:
  explicit SharedPlaces(const RigCamera& camera) : camera_(camera) {}

  void add(const BoardView& view) {
    const Eigen::Vector2d bin = bin_of(view);
    ++count_[{static_cast<int>(bin.x()), static_cast<int>(bin.y())}];
  }
  // How many boards have the error of this one, itself among them.
  double sharing(const BoardView& view) const {
    const Eigen::Vector2d bin = bin_of(view);
    double sum = 0.0;
    for (const auto& [other, count] : count_)
      sum += count * std::exp(-0.5 * (Eigen::Vector2d(other.first, other.second) - bin).squaredNorm() *
                              std::pow(1.0 / (kBinsPerCell * kCorrelationCells), 2));
    return sum;
  }

 private:
  static constexpr double kBinsPerCell = 4.0;

  Eigen::Vector2d bin_of(const BoardView& view) const {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const CornerObservation& corner : view.corners)
      middle += corner.pixel / static_cast<double>(view.corners.size());
    const BiasedView biased(camera_);
    const double bin_px = biased.cell_px() / kBinsPerCell;
    return biased.depth_pixel_of(middle).value_or(middle).unaryExpr([=](double x) { return std::floor(x / bin_px); });
  }

  const RigCamera& camera_;                   // with depth, where boards are added
  std::map<std::pair<int, int>, int> count_;  // by bin
};

Eigen::Matrix3d of_board_plane(const RigCamera& camera, const BoardView& view, const PlaneObservation& plane) {
  const BiasedView biased(camera);
  PlaneResponse response(biased, camera.depth->noise, plane.inverse_depth_plane);
  std::vector<Eigen::Vector2d> pixels;  // of the depth sensor
  for (const CornerObservation& corner : view.corners) {
    const std::optional<Eigen::Vector2d> pixel = biased.depth_pixel_of(corner.pixel);
    const std::optional<Eigen::Vector3d> ray = pixel ? biased.ray_of(*pixel) : std::nullopt;
    if (!ray || !(plane.inverse_depth_plane.dot(*ray) > 0.0)) continue;
    response.add({{pixels.size(), 1.0}}, *ray);
    pixels.push_back(*pixel);
  }
  const std::optional<Eigen::MatrixXd> J = response.over(pixels.size());
  if (!J) return Eigen::Matrix3d::Zero();
  return *J * biased.correlation(pixels) * J->transpose();
}

}  // namespace

double mean_inverse_depth(const PlaneObservation& plane) {
  const Eigen::Vector3d moments = plane.covariance_per_m2.ldlt().solve(Eigen::Vector3d::UnitZ());
  return plane.inverse_depth_plane.dot(moments) / moments.z();
}

Eigen::Matrix3d plane_by_depth_offset(const Eigen::Vector3d& measured, double mean_inverse_depth) {
  const double m = mean_inverse_depth;
  Eigen::Matrix3d by_offset;
  by_offset.col(0) = 2.0 * m * measured - m * m * Eigen::Vector3d::UnitZ();
  by_offset.col(1) = -Eigen::Vector3d::UnitX().cross(measured);
  by_offset.col(2) = -Eigen::Vector3d::UnitY().cross(measured);
  return by_offset;
}

Eigen::Matrix<double, 3, 6> plane_by_depth_shape(const Eigen::Vector3d& measured) {
  const double x = measured.x(), y = measured.y(), z = measured.z();
  Eigen::Matrix<double, 3, 6> by_shape;
  by_shape << 0, 0, z, 0, x, -y,  //
      0, 0, 0, z, y, x,           //
      x, y, 0, 0, 0, 0;
  return -by_shape;
}

std::vector<Eigen::Matrix3d> ground_plane_biases(const Observations& observations) {
  const std::size_t cameras = observations.cameras.size();
  if (std::none_of(observations.cameras.begin(), observations.cameras.end(), states_bias)) return {};
  const std::vector<PlanesOfCamera> floors = planes_of_cameras(observations.ground_planes, cameras);
  std::vector<Eigen::Matrix3d> result(cameras, Eigen::Matrix3d::Zero());
  bool any = false;
  for (std::size_t c = 0; c < cameras; ++c) {
    if (!states_bias(observations.cameras[c]) || floors[c].empty()) continue;
    const CameraBias bias(observations.cameras[c]);
    const Eigen::Vector3d floor = median_plane(floors[c]);
    std::vector<double> mean_inverse_depths;
    for (const PlaneObservation* plane : floors[c]) mean_inverse_depths.push_back(mean_inverse_depth(*plane));
    const std::optional<Eigen::MatrixXd> response = bias.of_ground(floor, median(std::move(mean_inverse_depths)));
    if (!response) continue;
    result[c] = bias.covariance(*response);
    any = true;
  }
  return any ? result : std::vector<Eigen::Matrix3d>();
}

std::vector<double> relative_height_biases(const Observations& observations) {
  std::vector<double> result(observations.cameras.size(), 0.0);
  const std::vector<Eigen::Matrix3d> biases = ground_plane_biases(observations);
  const std::vector<PlanesOfCamera> floors = planes_of_cameras(observations.ground_planes, result.size());
  for (std::size_t c = 0; c < biases.size(); ++c) {
    if (floors[c].empty()) continue;
    const Eigen::Vector3d floor = median_plane(floors[c]);  // normal over height
    result[c] = std::sqrt(floor.dot(biases[c] * floor)) / floor.squaredNorm();
  }
  return result;
}

std::vector<Eigen::Matrix3d> board_plane_biases(const Observations& observations) {
  if (std::none_of(observations.cameras.begin(), observations.cameras.end(), states_bias)) return {};
  const ViewOfPlane views = views_by_place(observations);
  std::vector<Eigen::Matrix3d> result;
  for (const PlaneObservation& plane : observations.board_planes) {
    const RigCamera& camera = observations.cameras[static_cast<std::size_t>(plane.camera)];
    const auto view = views.find({plane.stop, plane.camera});
    const bool known = states_bias(camera) && view != views.end();
    result.push_back(known ? of_board_plane(camera, *view->second, plane) : Eigen::Matrix3d(Eigen::Matrix3d::Zero()));
  }
  return result;
}

std::vector<Eigen::Matrix3d> lasting_board_plane_biases(const Observations& observations) {
  std::vector<Eigen::Matrix3d> result = board_plane_biases(observations);
  if (result.empty()) return result;
  const ViewOfPlane views = views_by_place(observations);
  std::vector<SharedPlaces> places(observations.cameras.begin(), observations.cameras.end());
  const auto for_each_view = [&](const auto& act) {
    for (std::size_t i = 0; i < result.size(); ++i) {
      const PlaneObservation& plane = observations.board_planes[i];
      const auto view = views.find({plane.stop, plane.camera});
      if (view != views.end() && !result[i].isZero(0.0))
        act(i, *view->second, &places[static_cast<std::size_t>(plane.camera)]);
    }
  };
  for_each_view([](std::size_t, const BoardView& view, SharedPlaces* of_camera) { of_camera->add(view); });
  for_each_view([&](std::size_t i, const BoardView& view, const SharedPlaces* of_camera) {
    result[i] *= of_camera->sharing(view);
  });
  return result;
}

std::vector<Eigen::Matrix3d> sum_of(std::vector<Eigen::Matrix3d> of_each, const std::vector<Eigen::Matrix3d>& more) {
  if (of_each.empty()) return more;
  for (std::size_t i = 0; i < more.size(); ++i) of_each[i] += more[i];
  return of_each;
}

}  // namespace rigproof
