#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/statistics.h"
#include "rigproof/validate/validate.h"

namespace rigproof {
namespace {

constexpr int kRobot = -1;

// A statement of the result in the truth's direction: parent is the robot or the earlier camera.
struct Statement {
  int parent = kRobot;
  int child = 0;
  Rigid3 T_parent_child;
  std::optional<Matrix6d> covariance;
  std::array<bool, 6> observable = {true, true, true, true, true, true};
  bool reversed = false;
  int joint_index = -1;  // block in Result::joint_covariance, -1 = none
};

bool is_whole(const std::array<bool, 6>& observable) {
  return std::all_of(observable.begin(), observable.end(), [](bool b) { return b; });
}

class Statements {
 public:
  Statements(const Result& result, const Truth& truth, const std::string& file);

  const Statement* find(int parent, int child) const {
    const auto found = by_pair_.find({parent, child});
    return found == by_pair_.end() ? nullptr : &found->second;
  }
  // Covariance of the errors of two cameras in the robot frame together; absent without a joint one.
  std::optional<Eigen::MatrixXd> joint(const std::vector<int>& cameras) const;

 private:
  int index_of(const std::string& name) const;
  void add(const EstimatedTransform& estimate, int joint_index);
  void problem(const EstimatedTransform& estimate, const std::string& message) {
    problems_.add({file_, 0, estimate.parent + " -> " + estimate.child, "", message});
  }
  // "(cameras: left, right); did you mean "right"?", for the first of the names that is near a camera's.
  std::string cameras_near(const std::vector<std::string>& names) const;

  std::string file_;
  std::vector<std::string> cameras_;
  std::set<std::string> robots_;
  std::map<std::pair<int, int>, Statement> by_pair_;
  std::optional<Eigen::MatrixXd> joint_covariance_;
  Problems problems_;
};

Statements::Statements(const Result& result, const Truth& truth, const std::string& file)
    : file_(file), joint_covariance_(result.joint_covariance) {
  for (const TrueCamera& camera : truth.cameras) cameras_.push_back(camera.name);
  int joint_index = 0;
  for (const EstimatedTransform& estimate : result.camera_to_robot) add(estimate, joint_index++);
  for (const EstimatedTransform& estimate : result.camera_to_camera) add(estimate, -1);
  const std::vector<std::string> robots(robots_.begin(), robots_.end());
  if (robots.size() > 1)
    problems_.add({file_, 0, "", joined(robots),
                   "more than one name that is no camera of the truth, so that the robot cannot be told " +
                       cameras_near(robots)});
  problems_.throw_if_any();
}

std::string Statements::cameras_near(const std::vector<std::string>& names) const {
  const std::string cameras = "(cameras: " + joined(cameras_) + ")";
  for (const std::string& name : names)
    if (const auto nearest = nearest_name(name, cameras_)) return cameras + "; did you mean \"" + *nearest + "\"?";
  return cameras;
}

int Statements::index_of(const std::string& name) const {
  const auto found = std::find(cameras_.begin(), cameras_.end(), name);
  return found == cameras_.end() ? kRobot : static_cast<int>(found - cameras_.begin());
}

void Statements::add(const EstimatedTransform& stated, int joint_index) {
  const EstimatedTransform estimate = index_of(stated.parent) == kRobot ? heading_free(stated) : stated;
  Statement statement{index_of(estimate.parent),
                      index_of(estimate.child),
                      estimate.T_parent_child,
                      estimate.covariance,
                      estimate.observable,
                      false,
                      joint_index};
  if (statement.parent == kRobot && statement.child == kRobot)
    return problem(estimate, "names no camera of the truth " + cameras_near({estimate.child, estimate.parent}));
  if (statement.parent == statement.child) return problem(estimate, "a pose of a camera in itself");
  if (statement.parent == kRobot) robots_.insert(estimate.parent);
  if (statement.child == kRobot) robots_.insert(estimate.child);
  if (statement.child < statement.parent) {
    if (!estimate.fully_observable())
      return problem(estimate, "degrees of freedom that are not observable are told in the robot's axes only");
    const Matrix6d J = inverse_error_jacobian(statement.T_parent_child);
    if (statement.covariance) statement.covariance = Matrix6d(J * *statement.covariance * J.transpose());
    std::swap(statement.parent, statement.child);
    statement.T_parent_child = statement.T_parent_child.inverse();
    statement.reversed = true;
  }
  if (!by_pair_.emplace(std::make_pair(statement.parent, statement.child), statement).second)
    problem(estimate, "this pair is stated twice");
}

std::optional<Eigen::MatrixXd> Statements::joint(const std::vector<int>& cameras) const {
  const Eigen::Index n = static_cast<Eigen::Index>(cameras.size());
  if (!joint_covariance_ || n == 0) return std::nullopt;
  const Eigen::Index size = joint_covariance_->rows();
  Eigen::MatrixXd select = Eigen::MatrixXd::Zero(6 * n, size);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Statement* statement = find(kRobot, cameras[static_cast<std::size_t>(i)]);
    if (statement == nullptr || statement->joint_index < 0 || 6 * statement->joint_index + 6 > size)
      return std::nullopt;
    // T_parent_child is the inverse of what was stated, hence the Jacobian is taken at the inverse again.
    select.block<6, 6>(6 * i, 6 * statement->joint_index) =
        statement->reversed ? inverse_error_jacobian(statement->T_parent_child.inverse()) : Matrix6d::Identity();
  }
  return Eigen::MatrixXd(select * *joint_covariance_ * select.transpose());
}

std::optional<Vector6d> sigma_of(const std::optional<Matrix6d>& covariance) {
  if (!covariance) return std::nullopt;
  return Vector6d(covariance->diagonal().cwiseMax(0.0).cwiseSqrt());
}

TransformError error_of(const Statement& statement, const std::string& parent, const std::string& child,
                        const Rigid3& T_true) {
  TransformError error;
  error.parent = parent;
  error.child = child;
  error.observable = statement.observable;
  error.between_cameras = statement.parent != kRobot;
  error.T_true = T_true;
  error.T_estimate = with_unobservable_from(T_true, statement.T_parent_child, statement.observable);
  error.error = transform_error(error.T_estimate, T_true);
  if (!error.between_cameras && !error.observable[5]) {  // sigmas are in the axes of heading_free()
    const double yaw_rad = roll_pitch_yaw(T_true.rotation * optical_from_body()).z();
    error.error.tail<3>() = rotation_z(-yaw_rad) * Eigen::Vector3d(error.error.tail<3>());
  }
  error.sigma = sigma_of(statement.covariance);
  return error;
}

// The pose of camera k in camera j as its two poses in the robot frame imply it.
std::optional<Statement> compose(const Statements& statements, int j, int k) {
  const Statement* first = statements.find(kRobot, j);
  const Statement* second = statements.find(kRobot, k);
  if (first == nullptr || second == nullptr) return std::nullopt;
  if (!is_whole(first->observable) || !is_whole(second->observable)) return std::nullopt;
  Statement composed;
  composed.parent = j;
  composed.child = k;
  composed.T_parent_child = first->T_parent_child.inverse() * second->T_parent_child;
  if (const auto joint = statements.joint({j, k})) {
    const auto J = relative_error_jacobian(first->T_parent_child, second->T_parent_child);
    composed.covariance = Matrix6d(J * *joint * J.transpose());
  }
  return composed;
}

void compare_cameras(const Statements& statements, const Truth& truth, const std::string& robot,
                     Comparison* comparison) {
  for (std::size_t i = 0; i < truth.cameras.size(); ++i) {
    const TrueCamera& camera = truth.cameras[i];
    if (const Statement* statement = statements.find(kRobot, static_cast<int>(i)))
      comparison->camera_to_robot.push_back(error_of(*statement, robot, camera.name, camera.T_robot_camera));
    else
      comparison->missing_cameras.push_back(camera.name);
  }
}

void compare_pairs(const Statements& statements, const Truth& truth, Comparison* comparison) {
  const int count = static_cast<int>(truth.cameras.size());
  for (int j = 0; j < count; ++j) {
    for (int k = j + 1; k < count; ++k) {
      const Statement* stated = statements.find(j, k);
      const std::optional<Statement> statement = stated ? *stated : compose(statements, j, k);
      if (!statement) continue;
      const TrueCamera& parent = truth.cameras[static_cast<std::size_t>(j)];
      const TrueCamera& child = truth.cameras[static_cast<std::size_t>(k)];
      comparison->camera_to_camera.push_back(
          error_of(*statement, parent.name, child.name, parent.T_robot_camera.inverse() * child.T_robot_camera));
    }
  }
}

void add_nees(const Statements& statements, const Truth& truth, Comparison* comparison) {
  std::vector<int> cameras;
  std::vector<Rigid3> estimates, truths;
  for (std::size_t i = 0; i < truth.cameras.size(); ++i) {
    const Statement* statement = statements.find(kRobot, static_cast<int>(i));
    if (statement == nullptr || !is_whole(statement->observable)) continue;
    cameras.push_back(static_cast<int>(i));
    estimates.push_back(statement->T_parent_child);
    truths.push_back(truth.cameras[i].T_robot_camera);
    if (!statement->covariance) continue;
    if (const auto nees = normalised_error_squared({estimates.back()}, {truths.back()}, *statement->covariance))
      comparison->camera_nees.push_back({truth.cameras[i].name, *nees, 6});
  }
  const auto joint = statements.joint(cameras);
  if (!joint) return;
  comparison->nees = normalised_error_squared(estimates, truths, *joint);
  if (comparison->nees) comparison->nees_degrees_of_freedom = static_cast<int>(joint->rows());
}

}  // namespace

std::optional<double> TransformError::z(int axis) const {
  if (!sigma || !observable[static_cast<std::size_t>(axis)] || !((*sigma)[axis] > 0.0)) return std::nullopt;
  return error[axis] / (*sigma)[axis];
}

bool TransformError::fully_observable() const { return is_whole(observable); }

std::string TransformError::name() const { return between_cameras ? parent + "-" + child : child + " in " + parent; }

double worst_error(const std::vector<TransformError>& errors, bool rotation) {
  double worst = 0.0;
  for (const TransformError& error : errors)
    worst = std::max(worst, rotation ? error.error.tail<3>().norm() : error.error.head<3>().norm());
  return worst;
}

double Comparison::worst_between_m() const { return worst_error(camera_to_camera, false); }
double Comparison::worst_between_rad() const { return worst_error(camera_to_camera, true); }

Comparison compare(const Result& result, const Truth& truth, const std::string& file) {
  const Statements statements(result, truth, file);
  Comparison comparison;
  comparison.method = result.method;
  comparison.status = result.status;
  comparison.reasons = result.reasons;
  for (const TrueCamera& camera : truth.cameras) comparison.cameras.push_back(camera.name);
  compare_cameras(statements, truth, "robot", &comparison);
  compare_pairs(statements, truth, &comparison);
  add_nees(statements, truth, &comparison);
  comparison.suspicion = find_convention_suspicion(comparison.camera_to_robot);
  return comparison;
}

}  // namespace rigproof
