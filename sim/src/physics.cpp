#include "rigproof/sim/physics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mjcf_text.h"
#include "mujoco_compat.h"
#include "rigproof/core/error.h"
#include "rigproof/core/rotation_between.h"
#include "world_impl.h"

namespace rigproof {
namespace {

// How long the robot is given to settle on flat ground before its frame is read.
constexpr double kSettle_s = 2.0;
// A rolling part of the robot whose lowest point is nearer than this to the ground at rest stands on it.
constexpr double kStandsOnGround_m = 0.02;
constexpr double kPaint_m = 0.005;
// MuJoCo's friction is soft: a robot that stands on a slope of 5 % creeps by 0.24 mm/s. Tyres do not; with friction
// stiffer than contact by this factor it is 0.01 mm/s. On level ground nothing pulls.
constexpr double kStiction = 30.0;
// One motor drives the wheels of a side. Where one of them hangs in the air it must not turn for the others.
constexpr double kGear_per_s = 10.0;
// Ground planes of the wheels have collision bits of their own.
constexpr int kFirstGroundBit = 8;
constexpr std::size_t kMaxGroundPlanes = 16;
const char* const kGroundPrefix = "floor_rigproof_";

// Physics needs no pictures.
WorldDescription without_pictures(WorldDescription description) {
  for (SceneTexture& texture : description.scene.textures) texture.size_px = 16;
  return description;
}

// Planes for the wheels. A pose other than the world's keeps MuJoCo from taking it for granted.
std::string ground_planes_mjcf(const GroundRelief& ground) {
  std::string text;
  for (std::size_t i = 0; !ground.flat() && i < kMaxGroundPlanes; ++i) {
    text += "  <geom name=\"" + (kGroundPrefix + std::to_string(i)) +
            "\" type=\"plane\" size=\"1 1 1\" pos=\"1 2 -9\" quat=\"0.9 0.3 0.3 0.1\" contype=\"0\" "
            "conaffinity=\"0\"/>\n";
  }
  return text;
}

bool rolls(int geom_type) {
  return geom_type == mjGEOM_SPHERE || geom_type == mjGEOM_CYLINDER || geom_type == mjGEOM_CAPSULE ||
         geom_type == mjGEOM_ELLIPSOID;
}

// Where the things of a scene are, to tell quickly that a robot is far from all of them.
class Surroundings {
 public:
  /// @param data the scene at rest
  Surroundings(const mjModel& model, const mjData& data, const std::vector<ObjectKind>& kinds, int robot_body) {
    const Eigen::Vector3d origin = Eigen::Map<const Eigen::Vector3d>(data.xpos + 3 * robot_body);
    for (int geom = 0; geom < model.ngeom; ++geom) {
      const Eigen::Vector3d centre = Eigen::Map<const Eigen::Vector3d>(data.geom_xpos + 3 * geom);
      const ObjectKind kind = kinds[static_cast<std::size_t>(geom)];
      if (kind == ObjectKind::kRobot) reach_m_ = std::max(reach_m_, (centre - origin).norm() + model.geom_rbound[geom]);
      if (kind != ObjectKind::kRobot && kind != ObjectKind::kFloor) boxes_.push_back(box_around(model, data, geom));
    }
  }

  /// True unless every thing is farther than this from a robot whose body's origin is there.
  bool may_be_near(const Eigen::Vector3d& origin, double clearance_m) const {
    const double reach = reach_m_ + clearance_m, squared = reach * reach;
    return std::any_of(boxes_.begin(), boxes_.end(),
                       [&](const Eigen::AlignedBox3d& box) { return box.squaredExteriorDistance(origin) <= squared; });
  }

 private:
  static Eigen::AlignedBox3d box_around(const mjModel& model, const mjData& data, int geom) {
    const Eigen::Vector3d centre = Eigen::Map<const Eigen::Vector3d>(data.geom_xpos + 3 * geom);
    Eigen::Vector3d half = Eigen::Vector3d::Constant(model.geom_rbound[geom]);
    // What has no bound is a plane.
    if (!(half.x() > 0.0)) half.setConstant(std::numeric_limits<double>::infinity());
    if (model.geom_type[geom] == mjGEOM_BOX) {
      using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
      half = Eigen::Map<const Matrix>(data.geom_xmat + 9 * geom).cwiseAbs() *
             Eigen::Map<const Eigen::Vector3d>(model.geom_size + 3 * geom);
    }
    return {centre - half, centre + half};
  }

  double reach_m_ = 0.0;
  std::vector<Eigen::AlignedBox3d> boxes_;
};

struct Side {
  std::vector<int> actuators, joint_positions;

  void command(double speed_rad_s, mjData* data) const {
    for (const int actuator : actuators) data->ctrl[actuator] = speed_rad_s;
  }
  /// Keeps the wheels at one angle, as a belt does.
  void command_together(double speed_rad_s, mjData* data) const {
    const double mean = angle(data);
    for (std::size_t i = 0; i < actuators.size(); ++i)
      data->ctrl[actuators[i]] = speed_rad_s + kGear_per_s * (mean - data->qpos[joint_positions[i]]);
  }
  double angle(const mjData* data) const {
    double sum = 0.0;
    for (const int position : joint_positions) sum += data->qpos[position];
    return sum / static_cast<double>(joint_positions.size());
  }
};

/// The wheels of both sides.
struct Wheels {
  Side left, right;
};

Wheels wheels_of(const mjModel& model, int robot_body, const std::string& robot_file) {
  Wheels wheels;
  for (int i = 0; i < model.nu; ++i) {
    if (model.actuator_trntype[i] != mjTRN_JOINT) continue;
    const int joint = model.actuator_trnid[2 * i];
    const int body = model.jnt_bodyid[joint];
    // A velocity actuator feeds its speed back.
    const bool is_velocity = model.actuator_biasprm[i * mjNBIAS + 2] < 0.0;
    if (!is_velocity || model.jnt_type[joint] != mjJNT_HINGE || model.body_parentid[body] != robot_body) continue;
    Side& side = model.body_pos[3 * body + 1] > 0.0 ? wheels.left : wheels.right;
    side.actuators.push_back(i);
    side.joint_positions.push_back(model.jnt_qposadr[joint]);
  }
  if (wheels.left.actuators.empty() || wheels.right.actuators.empty())
    throw Error(robot_file +
                ": cannot drive: needs <velocity> actuators on hinges of wheels to the left and to the "
                "right of the body `robot`");
  return wheels;
}

Rigid3 pose_in(const mjData& state, int position) {
  const mjtNum* q = state.qpos + position;
  return Rigid3(Eigen::Quaterniond(q[3], q[4], q[5], q[6]), Eigen::Vector3d(q[0], q[1], q[2]));
}

// The chassis sinks into its contacts by a hair: where it comes to rest on flat ground defines the robot frame. Returns
// T_body_ground, of a ground whose origin and x axis are below the body's; leaves the model as it was and the state
// reset.
Rigid3 settle_on_flat_ground(const std::vector<ObjectKind>& kinds, int position, mjModel* model, mjData* state) {
  const std::vector<int> contype(model->geom_contype, model->geom_contype + model->ngeom);
  const std::vector<int> conaffinity(model->geom_conaffinity, model->geom_conaffinity + model->ngeom);
  for (int geom = 0; geom < model->ngeom; ++geom) {
    const ObjectKind kind = kinds[static_cast<std::size_t>(geom)];
    if (kind == ObjectKind::kRobot || kind == ObjectKind::kFloor) continue;
    model->geom_contype[geom] = model->geom_conaffinity[geom] = 0;
  }
  set_pose(state, position, Rigid3());
  while (state->time < kSettle_s) mj_step(model, state);
  const Rigid3 T = pose_in(*state, position);
  mj_resetData(model, state);
  std::copy(contype.begin(), contype.end(), model->geom_contype);
  std::copy(conaffinity.begin(), conaffinity.end(), model->geom_conaffinity);
  return T.inverse() * planar_pose(T.translation.x(), T.translation.y(), yaw_of(T));
}

/// A plane under a part that stands on the ground, both geoms.
struct GroundPlane {
  int plane, part;
};

// Lays every plane against the ground under its part.
void follow_ground(const GroundRelief& ground, const std::vector<GroundPlane>& planes, const mjData& state,
                   mjModel* model) {
  for (const GroundPlane& entry : planes) {
    const mjtNum* centre = state.geom_xpos + 3 * entry.part;
    const Eigen::Vector2d below(centre[0], centre[1]);
    const GroundRelief::Surface surface = ground.at(below);
    const Eigen::Vector3d normal = Eigen::Vector3d(-surface.slope.x(), -surface.slope.y(), 1.0).normalized();
    const Eigen::Quaterniond q = rotation_between(Eigen::Vector3d::UnitZ(), normal);
    mjtNum* position = model->geom_pos + 3 * entry.plane;
    position[0] = below.x();
    position[1] = below.y();
    position[2] = surface.height_m;
    const std::array<double, 4> quat = {q.w(), q.x(), q.y(), q.z()};
    std::copy(quat.begin(), quat.end(), model->geom_quat + 4 * entry.plane);
  }
}

}  // namespace

class DrivePhysics::Snapshot {
 public:
  Snapshot(const mjModel* model, const mjData* data) : data_(mj_makeData(model)) {
    mj_copyData(data_.get(), model, data);
  }
  const mjData* get() const { return data_.get(); }

 private:
  mujoco::DataPtr data_;
};

struct DrivePhysics::Impl {
  std::string robot_file;
  GroundRelief ground;
  mujoco::ModelPtr scene_model;  ///< of everything: what could be touched
  mujoco::ModelPtr model;        ///< of the robot and its floor alone: what is stepped, some times faster
  mujoco::DataPtr data, probe;
  int robot_body = -1, robot_position = -1, robot_velocity = -1, probe_position = -1;
  std::vector<ObjectKind> kinds, scene_kinds;  ///< by geom
  std::unique_ptr<Surroundings> surroundings;
  Wheels wheels;
  std::vector<GroundPlane> ground_planes;
  Rigid3 T_body_robot, T_ground_robot;

  Impl(const WorldDescription& description, const PhysicsOptions& options);
  void compile_scene(const WorldDescription& description);
  void compile_robot(const WorldDescription& description, const GroundRelief& relief);
  bool floor_is_plane(const FloorArea& area) const;
  void change_robot(const PhysicsOptions& options);
  void add_payload(double mass_kg, const Eigen::Vector3d& at);
  Rigid3 T_world_body() const { return pose_in(*data, robot_position); }
  std::string obstacle(const Rigid3& T_world_body, double clearance_m) const;
  void use_ground(const GroundRelief& relief);
};

DrivePhysics::Impl::Impl(const WorldDescription& description, const PhysicsOptions& options)
    : robot_file(description.robot_mjcf.string()) {
  compile_scene(description);
  compile_robot(description, description.ground);
  wheels = wheels_of(*model, robot_body, robot_file);
  data.reset(mj_makeData(model.get()));
  probe.reset(mj_makeData(scene_model.get()));
  if (!data || !probe) throw Error("MuJoCo could not allocate the state of the world");
  mj_kinematics(scene_model.get(), probe.get());
  surroundings = std::make_unique<Surroundings>(*scene_model, *probe, scene_kinds,
                                                mj_name2id(scene_model.get(), mjOBJ_BODY, "robot"));
  T_body_robot = settle_on_flat_ground(kinds, robot_position, model.get(), data.get());
  change_robot(options);
  if (options.changes_stance())
    T_ground_robot = settle_on_flat_ground(kinds, robot_position, model.get(), data.get()).inverse() * T_body_robot;
  use_ground(description.ground);
}

void DrivePhysics::Impl::compile_scene(const WorldDescription& description) {
  std::string complaint;
  const WorldDescription plain = without_pictures(description);
  scene_model = mujoco::compile(compose_mjcf(plain), base_folder(plain), &complaint);
  if (!scene_model) throw Error(robot_file + ": MuJoCo does not accept it: " + complaint);
  const int body = mj_name2id(scene_model.get(), mjOBJ_BODY, "robot");
  const int joint = body < 0 ? -1 : scene_model->body_jntadr[body];
  if (joint < 0 || scene_model->jnt_type[joint] != mjJNT_FREE)
    throw Error(robot_file + ": needs a body `robot` with a <freejoint/>");
  probe_position = scene_model->jnt_qposadr[joint];
  for (int geom = 0; geom < scene_model->ngeom; ++geom) {
    scene_kinds.push_back(kind_of_geom(scene_model.get(), geom, body));
    // Obstacles are seen from afar.
    if (scene_kinds.back() == ObjectKind::kRobot || scene_kinds.back() == ObjectKind::kFloor) continue;
    scene_model->geom_margin[geom] = scene_model->geom_gap[geom] = kMaxClearance_m;
  }
}

// Paint, mats and kerbs: what a wheel would not notice, or would not meet, is no floor of its own.
bool DrivePhysics::Impl::floor_is_plane(const FloorArea& area) const {
  for (int geom = 0; geom < scene_model->ngeom; ++geom) {
    const bool counts = scene_kinds[static_cast<std::size_t>(geom)] == ObjectKind::kFloor &&
                        (scene_model->geom_contype[geom] != 0 || scene_model->geom_conaffinity[geom] != 0);
    if (!counts || scene_model->geom_type[geom] == mjGEOM_PLANE) continue;
    if (scene_model->geom_type[geom] != mjGEOM_BOX || scene_model->geom_bodyid[geom] != 0) return false;
    const mjtNum *p = scene_model->geom_pos + 3 * geom, *size = scene_model->geom_size + 3 * geom;
    const mjtNum* q = scene_model->geom_quat + 4 * geom;
    const Eigen::Vector3d half = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix().cwiseAbs() *
                                 Eigen::Vector3d(size[0], size[1], size[2]);
    const bool is_beside = p[0] + half.x() < area.x_min - kWheelReach_m ||
                           p[0] - half.x() > area.x_max + kWheelReach_m ||
                           p[1] + half.y() < area.y_min - kWheelReach_m || p[1] - half.y() > area.y_max + kWheelReach_m;
    if (!is_beside && p[2] + half.z() > kPaint_m) return false;
  }
  return true;
}

// A floor of other shapes is stepped with everything else.
void DrivePhysics::Impl::compile_robot(const WorldDescription& description, const GroundRelief& relief) {
  const std::string planes = ground_planes_mjcf(relief);
  const std::string robot = description.robot_mjcf.filename().string();
  const std::string alone =
      "<mujoco model=\"rigproof_drive\">\n<compiler autolimits=\"true\"/>\n<include file=" + quoted(robot) +
      "/>\n<worldbody>\n  <geom name=\"floor\" type=\"plane\" size=\"1 1 1\"/>\n" + planes +
      "</worldbody>\n</mujoco>\n";
  const WorldDescription plain = without_pictures(description);
  std::string complaint;
  model = mujoco::compile(floor_is_plane(description.scene.drivable_area) ? alone : compose_mjcf(plain, planes),
                          base_folder(plain), &complaint);
  if (!model) throw Error(robot_file + ": MuJoCo does not accept it: " + complaint);
  robot_body = mj_name2id(model.get(), mjOBJ_BODY, "robot");
  const int joint = model->body_jntadr[robot_body];
  robot_position = model->jnt_qposadr[joint];
  robot_velocity = model->jnt_dofadr[joint];
  for (int geom = 0; geom < model->ngeom; ++geom) kinds.push_back(kind_of_geom(model.get(), geom, robot_body));
}

void DrivePhysics::Impl::add_payload(double mass_kg, const Eigen::Vector3d& at) {
  // The body's centre of mass moves; both inertias about it follow from the parallel axis theorem. MuJoCo keeps the
  // principal moments and their axes.
  mjtNum* mass = model->body_mass + robot_body;
  Eigen::Map<Eigen::Vector3d> centre(model->body_ipos + 3 * robot_body);
  mjtNum* q = model->body_iquat + 4 * robot_body;
  Eigen::Map<Eigen::Vector3d> moments(model->body_inertia + 3 * robot_body);
  const Eigen::Matrix3d axes = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  const auto of_point = [](double m, const Eigen::Vector3d& r) {
    return Eigen::Matrix3d(m * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose()));
  };
  const Eigen::Vector3d together = (*mass * centre + mass_kg * at) / (*mass + mass_kg);
  const Eigen::Matrix3d inertia = axes * moments.asDiagonal() * axes.transpose() + of_point(*mass, centre - together) +
                                  of_point(mass_kg, at - together);
  mjtNum full[9], values[3], vectors[9], quat[4];
  for (int i = 0; i < 9; ++i) full[i] = inertia(i / 3, i % 3);
  mju_eig3(values, vectors, quat, full);
  *mass += mass_kg;
  centre = together;
  for (int i = 0; i < 3; ++i) moments[i] = values[i];
  for (int i = 0; i < 4; ++i) q[i] = quat[i];
}

void DrivePhysics::Impl::change_robot(const PhysicsOptions& options) {
  for (const Side* side : {&wheels.left, &wheels.right}) {
    const double factor = 1.0 + (side == &wheels.right ? 0.5 : -0.5) * (options.wheel_diameter_ratio - 1.0);
    for (const int actuator : side->actuators) {
      const int body = model->jnt_bodyid[model->actuator_trnid[2 * actuator]];
      for (int i = 0; i < model->body_geomnum[body]; ++i) {
        const int geom = model->body_geomadr[body] + i;
        if (model->geom_contype[geom] == 0 && model->geom_conaffinity[geom] == 0) continue;
        model->geom_size[3 * geom] *= factor;
        if (options.friction > 0.0) model->geom_friction[3 * geom] = options.friction;
        // Of two frictions MuJoCo takes the larger one, unless a priority decides.
        if (options.friction > 0.0) model->geom_priority[geom] = 1;
      }
    }
  }
  if (options.payload_kg > 0.0) add_payload(options.payload_kg, options.payload_at_m);
  mj_setConst(model.get(), data.get());
  mj_resetData(model.get(), data.get());
}

// Where the ground is not flat every wheel stands on a plane of its own, which touches the ground under it.
void DrivePhysics::Impl::use_ground(const GroundRelief& relief) {
  ground = relief;
  std::vector<int> planes, parts;
  mj_kinematics(model.get(), data.get());
  for (int geom = 0; geom < model->ngeom; ++geom) {
    const char* name = mj_id2name(model.get(), mjOBJ_GEOM, geom);
    if (name != nullptr && std::string(name).rfind(kGroundPrefix, 0) == 0) planes.push_back(geom);
    if (kinds[static_cast<std::size_t>(geom)] != ObjectKind::kRobot || !rolls(model->geom_type[geom])) continue;
    if (model->geom_contype[geom] == 0 && model->geom_conaffinity[geom] == 0) continue;
    const double lowest = data->geom_xpos[3 * geom + 2] - model->geom_size[3 * geom];
    if (lowest < kStandsOnGround_m) parts.push_back(geom);
  }
  const std::size_t count = relief.flat() ? 0 : std::min({planes.size(), parts.size(), kMaxGroundPlanes});
  for (std::size_t i = 0; i < count; ++i) {
    const int bit = 1 << (kFirstGroundBit + static_cast<int>(i));
    model->geom_contype[planes[i]] = bit;
    model->geom_conaffinity[parts[i]] |= bit;
    ground_planes.push_back({planes[i], parts[i]});
  }
  if (relief.flat()) return;
  model->opt.impratio = kStiction;
  for (int geom = 0; geom < model->ngeom; ++geom) {
    if (kinds[static_cast<std::size_t>(geom)] != ObjectKind::kFloor || model->geom_type[geom] != mjGEOM_PLANE) continue;
    if (std::find(planes.begin(), planes.end(), geom) != planes.end()) continue;
    model->geom_contype[geom] = model->geom_conaffinity[geom] = 0;
  }
}

std::string DrivePhysics::Impl::obstacle(const Rigid3& T_world_body, double clearance_m) const {
  if (!surroundings->may_be_near(T_world_body.translation, clearance_m)) return {};
  set_pose(probe.get(), probe_position, T_world_body);
  mj_kinematics(scene_model.get(), probe.get());
  mj_comPos(scene_model.get(), probe.get());
  mj_collision(scene_model.get(), probe.get());
  for (int i = 0; i < probe->ncon; ++i) {
    const mjContact& contact = probe->contact[i];
    if (contact.dist >= clearance_m) continue;
    const ObjectKind a = scene_kinds[static_cast<std::size_t>(contact.geom1)];
    const ObjectKind b = scene_kinds[static_cast<std::size_t>(contact.geom2)];
    if ((a == ObjectKind::kRobot) == (b == ObjectKind::kRobot)) continue;
    if (a == ObjectKind::kFloor || b == ObjectKind::kFloor) continue;
    return name_of_geom(scene_model.get(), a == ObjectKind::kRobot ? contact.geom2 : contact.geom1);
  }
  return {};
}

DrivePhysics::DrivePhysics(const WorldDescription& description, const PhysicsOptions& options)
    : impl_(std::make_unique<Impl>(description, options)) {}
DrivePhysics::~DrivePhysics() = default;

void DrivePhysics::place(double x_m, double y_m, double yaw_rad) {
  mj_resetData(impl_->model.get(), impl_->data.get());
  Rigid3 T = planar_pose(x_m, y_m, yaw_rad) * impl_->T_body_robot.inverse();
  if (!impl_->ground.flat()) {
    // High enough that no wheel starts within the ground.
    double top = -1e9;
    set_pose(impl_->data.get(), impl_->robot_position, T);
    mj_kinematics(impl_->model.get(), impl_->data.get());
    for (const GroundPlane& entry : impl_->ground_planes) {
      const mjtNum* centre = impl_->data->geom_xpos + 3 * entry.part;
      top = std::max(top, impl_->ground.height({centre[0], centre[1]}));
    }
    T.translation.z() += top;
  }
  set_pose(impl_->data.get(), impl_->robot_position, T);
  mj_kinematics(impl_->model.get(), impl_->data.get());
}

void DrivePhysics::step(double left_rad_s, double right_rad_s) {
  const auto command = impl_->ground.flat() ? &Side::command : &Side::command_together;
  (impl_->wheels.left.*command)(left_rad_s, impl_->data.get());
  (impl_->wheels.right.*command)(right_rad_s, impl_->data.get());
  follow_ground(impl_->ground, impl_->ground_planes, *impl_->data, impl_->model.get());
  mj_step(impl_->model.get(), impl_->data.get());
}

double DrivePhysics::step_s() const { return impl_->model->opt.timestep; }
double DrivePhysics::time_s() const { return impl_->data->time; }
Rigid3 DrivePhysics::T_world_robot() const { return impl_->T_world_body() * impl_->T_body_robot; }
Rigid3 DrivePhysics::T_ground_robot() const { return impl_->T_ground_robot; }
double DrivePhysics::left_wheels_rad() const { return impl_->wheels.left.angle(impl_->data.get()); }
double DrivePhysics::right_wheels_rad() const { return impl_->wheels.right.angle(impl_->data.get()); }

double DrivePhysics::speed_m_s() const {
  const mjtNum* v = impl_->data->qvel + impl_->robot_velocity;
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double DrivePhysics::turn_rate_rad_s() const {
  const mjtNum* w = impl_->data->qvel + impl_->robot_velocity + 3;
  return std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
}

double DrivePhysics::tilt_rad() const {
  const Eigen::Vector3d up = T_world_robot().rotation * Eigen::Vector3d::UnitZ();
  return std::acos(std::clamp(up.z(), -1.0, 1.0));
}

std::string DrivePhysics::touched() const { return impl_->obstacle(impl_->T_world_body(), 0.0); }

std::string DrivePhysics::obstacle(const Rigid3& T_world_robot, double clearance_m) const {
  return impl_->obstacle(T_world_robot * impl_->T_body_robot.inverse(), std::min(clearance_m, kMaxClearance_m));
}

std::shared_ptr<const DrivePhysics::Snapshot> DrivePhysics::save() const {
  return std::make_shared<const Snapshot>(impl_->model.get(), impl_->data.get());
}

void DrivePhysics::restore(const Snapshot& snapshot) {
  mj_copyData(impl_->data.get(), impl_->model.get(), snapshot.get());
}

}  // namespace rigproof
