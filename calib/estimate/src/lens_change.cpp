#include "rigproof/calib/estimate/lens_change.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <filesystem>

namespace rigproof::ml {

bool is_cloud(const PlaneObservation& plane, const RigCamera& camera) {
  if (!camera.depth || camera.depth->own_camera || plane.file.empty()) return false;
  const std::filesystem::path extension = std::filesystem::path(plane.file).extension();
  return extension == ".pcd" || extension == ".txt";
}

bool is_registered(const PlaneObservation& plane, const RigCamera& camera) {
  return camera.depth && !camera.depth->own_camera && !plane.file.empty() && !is_cloud(plane, camera);
}

namespace {

// Radius over the focal length, or angle, by which the lens moves the farthest corner.
double farthest_radius(const Camera& lens) {
  double farthest = 0.0;
  for (const double u : {0.0, lens.width_px - 1.0})
    for (const double v : {0.0, lens.height_px - 1.0}) {
      Eigen::Vector3d ray;
      // Where the lens has no ray the distance in the image stands for radius or angle.
      double reach = std::hypot((u - lens.cx_px) / lens.fx_px, (v - lens.cy_px) / lens.fy_px);
      if (lens.unproject({u, v}, &ray)) {
        const double radius = ray.head<2>().norm();
        reach = lens.lens == Lens::kKannalaBrandt ? std::atan(radius) : radius;
      }
      farthest = std::max(farthest, reach);
    }
  return farthest;
}

// The plane a' of changed rays r + d that is most like a plane a of rays r over the image: a' . (r + d) = a . r.
Eigen::Matrix3d plane_by_distortion(const Lenses& lenses, const Camera& lens) {
  constexpr int kColumns = 16, kRows = 12;
  constexpr double kStep_px = 0.1;
  LensChange step = LensChange::Zero();
  step[4] = kStep_px;
  const Camera more = lenses.changed(step), less = lenses.changed(-step);
  Eigen::Matrix3d rays = Eigen::Matrix3d::Zero(), changes = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Eigen::Vector2d pixel((i % kColumns + 0.5) * lens.width_px / kColumns,
                                (i / kColumns + 0.5) * lens.height_px / kRows);
    Eigen::Vector3d ray, after, before;
    if (!lens.unproject(pixel, &ray) || !more.unproject(pixel, &after) || !less.unproject(pixel, &before)) continue;
    rays += ray * ray.transpose();
    changes += ray * (after - before).transpose() / (2.0 * kStep_px);
  }
  const Eigen::Matrix3d by = rays.ldlt().solve(changes);
  return by.allFinite() ? Eigen::Matrix3d(-by) : Eigen::Matrix3d::Zero();
}

}  // namespace

// The farthest corner then moves by a pixel.
double coefficient_by_px(const Camera& lens) {
  const double radius = farthest_radius(lens);
  return radius > 0.0 ? 1.0 / (std::sqrt(lens.fx_px * lens.fy_px) * radius * radius * radius) : 0.0;
}

Lenses::Lenses(const Camera& stated)
    : stated_(stated),
      coefficient_by_px_(ml::coefficient_by_px(stated)),
      plane_by_distortion_(plane_by_distortion(*this, stated)) {}

Camera Lenses::changed(const LensChange& change) const {
  Camera lens = stated_;
  if (change[4] != 0.0) {
    lens.distortion[0] += change[4] * coefficient_by_px_;
    if (lens.lens == Lens::kPinhole) lens.lens = Lens::kBrownConrady;
  }
  lens.fx_px *= (1.0 + change[0]) * (1.0 + 0.5 * change[3]);
  lens.fy_px *= (1.0 + change[0]) * (1.0 - 0.5 * change[3]);
  lens.cx_px += change[1];
  lens.cy_px += change[2];
  return lens;
}

Eigen::Matrix<double, 3, 5> Lenses::plane_by(const Eigen::Vector3d& plane_per_m) const {
  Eigen::Matrix<double, 3, 5> by_lens = Eigen::Matrix<double, 3, 5>::Zero();
  by_lens.col(0).head<2>() = plane_per_m.head<2>();
  by_lens(2, 1) = plane_per_m.x() / stated_.fx_px;
  by_lens(2, 2) = plane_per_m.y() / stated_.fy_px;
  by_lens.col(3).head<2>() = Eigen::Vector2d(0.5, -0.5).cwiseProduct(plane_per_m.head<2>());
  by_lens.col(4) = plane_by_distortion_ * plane_per_m;
  return by_lens;
}

void change_lens(int camera, const Eigen::Vector3d& change, Observations* observations) {
  RigCamera& rig_camera = observations->cameras[static_cast<std::size_t>(camera)];
  const Lenses lenses(rig_camera.camera);
  Eigen::Matrix3d to;  // of planes
  for (int i = 0; i < 3; ++i)
    to.col(i) = Eigen::Vector3d::Unit(i) + lenses.plane_by(Eigen::Vector3d::Unit(i)).leftCols<3>() * change;
  for (auto* planes : {&observations->ground_planes, &observations->board_planes})
    for (PlaneObservation& plane : *planes) {
      if (plane.camera != camera || !is_registered(plane, rig_camera)) continue;
      plane.inverse_depth_plane = (to * plane.inverse_depth_plane).eval();
      plane.covariance_per_m2 = (to * plane.covariance_per_m2 * to.transpose()).eval();
    }
  LensChange all = LensChange::Zero();
  all.head<3>() = change;
  rig_camera.camera = lenses.changed(all);
}

}  // namespace rigproof::ml
