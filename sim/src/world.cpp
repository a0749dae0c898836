#include "rigproof/sim/world.h"

#include <algorithm>
#include <limits>
#include <set>

#include "board_model.h"
#include "floor_relief.h"
#include "mujoco_compat.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "textures.h"
#include "world_impl.h"

namespace rigproof {
namespace {

void require_readable(const std::filesystem::path& file, const char* what) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw Error(file.string() + ": there is no such " + what + " (MJCF file)");
}

void require_sane(const WorldDescription& description) {
  const SceneDescription& scene = description.scene;
  require_readable(description.robot_mjcf, "robot");
  require_readable(scene.mjcf, "scene");
  if (!(scene.near_m > 0.0 && scene.far_m > scene.near_m))
    throw Error(scene.mjcf.string() + ": near_m " + std::to_string(scene.near_m) + " and far_m " +
                std::to_string(scene.far_m) + " must be positive, near before far");
  for (std::size_t i = 0; i < description.boards(); ++i) {
    const WorldBoard& board = description.board_at(i);
    const std::string which = i == 0 ? "the board" : "board " + std::to_string(i + 1);
    if (board.board.squares_x < 2 || board.board.squares_y < 2 || !(board.board.square_m > 0.0))
      throw Error(which + " needs at least 2x2 squares of a positive size");
    if (!(board.board_margin_m >= 0.0) || !(board.board_thickness_m >= 1e-4))
      throw Error(which + " needs a margin of at least 0 and a thickness of at least 0.0001 m");
  }
}

// Compiles, and on failure finds out whose file is to blame by leaving the robot out.
mujoco::ModelPtr compile_world(const WorldDescription& description) {
  std::string complaint;
  mujoco::ModelPtr model = mujoco::compile(compose_mjcf(description), base_folder(description), &complaint);
  if (model) return model;
  WorldDescription scene_only = description;
  scene_only.robot_mjcf.clear();
  std::string scene_complaint;
  const bool scene_is_good =
      mujoco::compile(compose_mjcf(scene_only), base_folder(scene_only), &scene_complaint) != nullptr;
  const std::filesystem::path& culprit = scene_is_good ? description.robot_mjcf : description.scene.mjcf;
  const std::string& reason = scene_is_good ? complaint : scene_complaint;
  const bool lacks_texture = !scene_is_good && reason.find("texture '") != std::string::npos;
  throw Error(culprit.string() + ": MuJoCo does not accept it: " + reason +
              (lacks_texture ? "; textures are declared under `textures` in the scene's YAML" : ""));
}

// Things stand on the ground where the middle of their foot is.
WorldDescription set_down(WorldDescription description) {
  for (SceneObject& object : description.scene.objects)
    object.z_m += description.ground.height({object.x_m, object.y_m});
  return description;
}

// The same world with another floor to look at. Rays and contacts keep the flat one: the relief is low.
mujoco::ModelPtr compile_with_relief(const WorldDescription& description, const mjModel& flat) {
  const int robot = mj_name2id(&flat, mjOBJ_BODY, "robot");
  std::vector<ObjectKind> kinds;
  for (int geom = 0; geom < flat.ngeom; ++geom) kinds.push_back(kind_of_geom(&flat, geom, robot));
  const FloorRelief floor = drape_floor(flat, kinds, description.ground);
  std::string complaint;
  mujoco::ModelPtr model = mujoco::compile(compose_mjcf(set_down(description), floor.geoms, floor.assets),
                                           base_folder(description), &complaint);
  if (!model) throw Error(description.scene.mjcf.string() + ": its floor cannot be made uneven: " + complaint);
  for (int geom = 0; geom < model->ngeom; ++geom) {
    int& group = model->geom_group[geom];
    const std::string name = name_of_geom(model.get(), geom);
    if (name.rfind(kReliefPrefix, 0) != 0 && (group == kReliefGroup || group == kFlatFloorGroup)) group = 0;
  }
  for (const int geom : floor.replaced) model->geom_group[geom] = kFlatFloorGroup;
  return model;
}

void fill_texture(mjModel* model, const std::string& name, const std::vector<std::uint8_t>& rgb) {
  const int id = mj_name2id(model, mjOBJ_TEXTURE, name.c_str());
  std::uint8_t* bytes = id < 0 ? nullptr : mujoco::texture_bytes(model, id);
  if (bytes == nullptr) throw Error("texture " + name + " is not in the compiled model as three channels");
  // A cube's six sides lie one below the other.
  const int copies = model->tex_type[id] == mjTEXTURE_CUBE ? 6 : 1;
  for (int i = 0; i < copies; ++i) bytes = std::copy(rgb.begin(), rgb.end(), bytes);
}

// Turns and tints all lights together.
void change_lights(mjModel* model, const LightChange& change) {
  const Eigen::Quaterniond turn = rotation_z(deg_to_rad(change.turn_deg));
  const double tint[3] = {1.0 + 0.25 * change.warmth, 1.0, 1.0 - 0.25 * change.warmth};
  for (int i = 0; i < model->nlight; ++i) {
    const Eigen::Vector3d direction = turn * Eigen::Vector3d(Eigen::Map<Eigen::Vector3d>(model->light_dir + 3 * i));
    std::copy(direction.data(), direction.data() + 3, model->light_dir + 3 * i);
    for (int c = 0; c < 3; ++c) {
      const float factor = static_cast<float>(change.brightness * tint[c]);
      model->light_diffuse[3 * i + c] *= factor;
      model->light_ambient[3 * i + c] *= factor;
    }
  }
}

// Finds the robot and prepares what later calls rely on.
void index_model(World::Impl* impl) {
  mjModel* model = impl->model.get();
  const std::string file = impl->description.robot_mjcf.string();
  impl->robot_body = mj_name2id(model, mjOBJ_BODY, "robot");
  if (impl->robot_body < 0) throw Error(file + ": it has no body named `robot`, whose origin is the robot frame");
  const int joint = model->body_jntadr[impl->robot_body];
  if (joint < 0 || model->jnt_type[joint] != mjJNT_FREE)
    throw Error(file + ": the body `robot` needs a <freejoint/>, so that it can be placed");
  impl->robot_position = model->jnt_qposadr[joint];
  for (int geom = 0; geom < model->ngeom; ++geom) {
    impl->geom_kinds.push_back(kind_of_geom(model, geom, impl->robot_body));
    if (impl->geom_kinds.back() == ObjectKind::kRobot) model->geom_group[geom] = kRobotGroup;
  }
  if (std::count(impl->geom_kinds.begin(), impl->geom_kinds.end(), ObjectKind::kFloor) == 0)
    throw Error(impl->description.scene.mjcf.string() +
                ": the scene has no floor: at least one geom's name must start with `floor`");
}

// The first geom that is not the robot; the flat floor in place of its relief.
double ray_to_geom(const World::Impl& world, const Eigen::Vector3d& origin_world,
                   const Eigen::Vector3d& direction_world, int* geom) {
  mjtByte groups[mjNGROUP];
  for (int i = 0; i < mjNGROUP; ++i) groups[i] = i != kRobotGroup;
  if (world.has_relief()) groups[kReliefGroup] = 0;
  const Eigen::Vector3d unit = direction_world.normalized();
  return mujoco::cast_ray(world.model.get(), world.data.get(), origin_world.data(), unit.data(), groups, geom);
}

}  // namespace

void set_pose(mjData* state, int position, const Rigid3& T_world_body) {
  mjtNum* q = state->qpos + position;
  for (int i = 0; i < 3; ++i) q[i] = T_world_body.translation[i];
  q[3] = T_world_body.rotation.w();
  for (int i = 0; i < 3; ++i) q[4 + i] = T_world_body.rotation.vec()[i];
}

ObjectKind kind_of_geom(const mjModel* model, int geom, int robot_body) {
  if (model->body_rootid[model->geom_bodyid[geom]] == robot_body) return ObjectKind::kRobot;
  const char* name = mj_id2name(model, mjOBJ_GEOM, geom);
  const std::string text = name != nullptr ? name : "";
  if (board_of_name(text)) return ObjectKind::kBoard;
  return text.rfind("floor", 0) == 0 ? ObjectKind::kFloor : ObjectKind::kScene;
}

std::string name_of_geom(const mjModel* model, int geom) {
  const char* name = mj_id2name(model, mjOBJ_GEOM, geom);
  if (name != nullptr) return name;
  const char* body = mj_id2name(model, mjOBJ_BODY, model->geom_bodyid[geom]);
  return (body != nullptr ? std::string(body) + " geom " : "geom ") + std::to_string(geom);
}

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::~World() = default;

std::unique_ptr<World> World::compose(const WorldDescription& description) {
  require_sane(description);
  auto impl = std::make_unique<Impl>();
  impl->description = description;
  impl->model = compile_world(description);
  if (impl->has_relief()) impl->model = compile_with_relief(description, *impl->model);
  for (const SceneTexture& texture : description.scene.textures)
    fill_texture(impl->model.get(), texture.name, draw_texture(texture, description.scene_seed));
  for (std::size_t i = 0; i < description.boards(); ++i) {
    const WorldBoard& board = description.board_at(i);
    fill_texture(impl->model.get(), board_name(i),
                 draw_board(board.board, board.board_margin_m, board.board_defects).rgb);
  }
  change_lights(impl->model.get(), description.scene.light);
  index_model(impl.get());
  impl->data.reset(mj_makeData(impl->model.get()));
  if (!impl->data) throw Error("MuJoCo could not allocate the state of the world");
  std::unique_ptr<World> world(new World(std::move(impl)));
  world->place_robot(Rigid3());
  return world;
}

void World::place_robot(const Rigid3& T_world_robot) {
  Impl& w = *impl_;
  w.T_world_robot = T_world_robot;
  set_pose(w.data.get(), w.robot_position, T_world_robot);
  mj_kinematics(w.model.get(), w.data.get());
  mj_comPos(w.model.get(), w.data.get());
  mj_camlight(w.model.get(), w.data.get());
  w.collisions_are_current = false;
}

const Rigid3& World::T_world_robot() const { return impl_->T_world_robot; }

Rigid3 World::T_world_camera(std::size_t camera) const {
  return impl_->T_world_robot * impl_->description.cameras.at(camera).T_robot_camera;
}

std::vector<std::string> World::collisions() const {
  Impl& w = *impl_;
  if (!w.collisions_are_current) mj_collision(w.model.get(), w.data.get());
  w.collisions_are_current = true;
  std::set<std::string> names;
  for (int i = 0; i < w.data->ncon; ++i) {
    const mjContact& contact = w.data->contact[i];
    if (contact.dist > 0.0) continue;
    const auto kind = [&](int geom) { return w.geom_kinds[static_cast<std::size_t>(geom)]; };
    int other = -1;
    if (kind(contact.geom1) == ObjectKind::kRobot) other = contact.geom2;
    if (kind(contact.geom2) == ObjectKind::kRobot) other = contact.geom1;
    if (other < 0 || kind(other) == ObjectKind::kRobot || kind(other) == ObjectKind::kFloor) continue;
    names.insert(name_of_geom(w.model.get(), other));
  }
  return {names.begin(), names.end()};
}

double World::cast_ray(const Eigen::Vector3d& origin_world, const Eigen::Vector3d& direction_world,
                       ObjectKind* hit) const {
  int geom = -1;
  const double distance = ray_to_geom(*impl_, origin_world, direction_world, &geom);
  if (hit != nullptr) *hit = geom < 0 ? ObjectKind::kNothing : impl_->geom_kinds[static_cast<std::size_t>(geom)];
  return geom < 0 ? std::numeric_limits<double>::infinity() : distance;
}

std::optional<std::size_t> World::cast_ray_to_board(const Eigen::Vector3d& origin_world,
                                                    const Eigen::Vector3d& direction_world) const {
  int geom = -1;
  ray_to_geom(*impl_, origin_world, direction_world, &geom);
  if (geom < 0 || impl_->geom_kinds[static_cast<std::size_t>(geom)] != ObjectKind::kBoard) return std::nullopt;
  return board_of_name(name_of_geom(impl_->model.get(), geom));
}

FloorArea World::drivable_area() const { return impl_->description.scene.drivable_area; }
const WorldDescription& World::description() const { return impl_->description; }

ObjectKind World::kind_of_object(int object_id) const {
  if (object_id <= 0 || object_id > impl_->model->ngeom) return ObjectKind::kNothing;
  return impl_->geom_kinds[static_cast<std::size_t>(object_id - 1)];
}

std::string World::mujoco_version() { return mujoco::version(); }

}  // namespace rigproof
