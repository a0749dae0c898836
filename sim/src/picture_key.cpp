// What a picture depends on, as hashes.
#include <string>
#include <type_traits>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/sim/world.h"
#include "world_impl.h"

namespace rigproof {
namespace {

class Bytes {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>, "only plain numbers have no padding");
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename T>
  void add(const T* values, std::size_t count) {
    text_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  template <typename Values>
  void add_all(const Values& values) {
    for (const auto& value : values) add(value);
  }
  void add(const std::string& value) { text_ += value + '\0'; }
  void add(const Rigid3& T) {
    for (int i = 0; i < 3; ++i) add(T.translation[i]);
    for (int i = 0; i < 4; ++i) add(T.rotation.coeffs()[i]);
  }
  void add(const Camera& camera) {
    add(camera.width_px);
    add(camera.height_px);
    for (const double value : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) add(value);
    add(camera.lens);
    add_all(camera.distortion);
  }
  std::string hash() const { return sha256_hex(text_); }

 private:
  std::string text_;
};

}  // namespace

std::string World::content_hash() const {
  const mjModel* model = impl_->model.get();
  std::vector<char> compiled(static_cast<std::size_t>(mj_sizeModel(model)));
  mj_saveModel(model, nullptr, compiled.data(), static_cast<int>(compiled.size()));
  const WorldDescription& description = impl_->description;
  const SceneDescription& scene = description.scene;
  Bytes bytes;
  bytes.add(sha256_hex({compiled.data(), compiled.size()}));
  bytes.add(mujoco_version());
  // What the renderer takes from the description instead of the model: the sky, the clip planes, the board's region.
  bytes.add_all(scene.sky_zenith);
  bytes.add_all(scene.sky_horizon);
  bytes.add(scene.cloud_cover);
  bytes.add_all(scene.cloud_color);
  bytes.add(scene.near_m);
  bytes.add(scene.far_m);
  bytes.add(scene.shadows);
  // Shadows are drawn on the floor that they can be seen on.
  for (const double end :
       {scene.drivable_area.x_min, scene.drivable_area.x_max, scene.drivable_area.y_min, scene.drivable_area.y_max})
    bytes.add(end);
  bytes.add(description.scene_seed);
  for (std::size_t i = 0; i < description.boards(); ++i) {
    const WorldBoard& board = description.board_at(i);
    bytes.add(board.board.squares_x);
    bytes.add(board.board.squares_y);
    bytes.add(board.board.square_m);
    bytes.add(board.board_margin_m);
    bytes.add(board.T_world_board);
  }
  return bytes.hash();
}

std::string World::view_hash(std::size_t camera) const {
  const mjModel* model = impl_->model.get();
  const mjData* data = impl_->data.get();
  const WorldCamera& entry = impl_->description.cameras.at(camera);
  const auto geoms = static_cast<std::size_t>(model->ngeom), lights = static_cast<std::size_t>(model->nlight);
  Bytes bytes;
  bytes.add(T_world_camera(camera));
  bytes.add(entry.camera);
  if (entry.depth_camera) {
    bytes.add(entry.depth_camera->T_color_depth);
    bytes.add(entry.depth_camera->camera);
  }
  if (entry.lens_residual) {
    bytes.add(entry.lens_residual->cell_px);
    bytes.add(entry.lens_residual->columns);
    bytes.add_all(entry.lens_residual->dx_px);
    bytes.add_all(entry.lens_residual->dy_px);
  }
  bytes.add(data->geom_xpos, 3 * geoms);
  bytes.add(data->geom_xmat, 9 * geoms);
  bytes.add(data->light_xpos, 3 * lights);
  bytes.add(data->light_xdir, 3 * lights);
  return bytes.hash();
}

}  // namespace rigproof
