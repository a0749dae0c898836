#include "rigproof/calib/estimate/problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "board_in_camera.h"
#include "factors.h"
#include "repeating_couplings.h"
#include "step_scan.h"

namespace rigproof::ml {
namespace {

// visit(a, b) for every block of H on and below the diagonal: the numbers of two segments of the block.
template <typename Visit>
void for_each_pair(const LocalBlock& block, const Visit& visit) {
  for (std::size_t a = 0; a < static_cast<std::size_t>(block.count); ++a)
    for (std::size_t b = 0; b <= a; ++b) visit(a, b);
}

// Rows and columns are counted where their number is known: the compiler unrolls these loops.
template <int kRows, int kColumns>
void add_to(const Meeting<double>& place, const double* from, int rows, int columns) {
  constexpr int kStride = LocalBlock::kMaxUnknowns;
  const int m = kRows > 0 ? kRows : rows, n = kColumns > 0 ? kColumns : columns;
  if (place.row == 1) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < m; ++i) place.data[i + j * place.column] += from[i + j * kStride];
  } else {
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < n; ++j) place.data[i * place.row + j] += from[i + j * kStride];
  }
}

// Where local segments meet in an arrow system. Of the globals' block only the part below the diagonal is filled.
class Assembler : public BlockSink {
 public:
  Assembler(ArrowSystem* system, double* cost, GroupSums* sums, BlockSink* also)
      : system_(system),
        blocks_{system->diagonal.data(), system->coupling.data(), system->pose_global.data(), system->global.data(),
                system->globals()},
        cost_(cost),
        sums_(sums),
        also_(also) {}

  void add(const LocalBlock& block) override {
    *cost_ += block.cost;
    if (also_ != nullptr) also_->add(block);
    if (sums_ != nullptr) sum_of(*sums_, block.group, block.camera) += block.sum;
    for (std::size_t a = 0; a < static_cast<std::size_t>(block.count); ++a) {
      const Segment& s = block.segments[a];
      double* gradient =
          s.pose < 0 ? &system_->global_gradient[s.offset] : &system_->pose_gradient[6 * s.pose + s.offset];
      for (int i = 0; i < s.size; ++i) gradient[i] += block.g[block.starts[a] + i];
    }
    for_each_pair(block, [&](std::size_t a, std::size_t b) {
      const Segment &rows = block.segments[a], &columns = block.segments[b];
      const Meeting<double> place = blocks_.at(rows, columns);
      const double* H = &block.H(block.starts[a], block.starts[b]);
      if (rows.size == 6 && columns.size == 6)
        add_to<6, 6>(place, H, 6, 6);
      else
        add_to<0, 0>(place, H, rows.size, columns.size);
    });
  }

 private:
  ArrowSystem* system_;
  ArrowBlocks<Matrix6d, double> blocks_;
  double* cost_;
  GroupSums* sums_;
  BlockSink* also_;
};

// Trace of H times the covariance of the block's unknowns.
class LeverageSink : public BlockSink {
 public:
  LeverageSink(const EliminatedSystem::PoseCovariance& poses, const Eigen::MatrixXd& globals, GroupSums* sums)
      : blocks_{poses.diagonal.data(), poses.with_previous.data(), poses.with_globals.data(), globals.data(),
                globals.rows()},
        sums_(sums) {}

  void add(const LocalBlock& block) override {
    double trace = 0.0;
    for_each_pair(block, [&](std::size_t a, std::size_t b) {
      const auto covariance = blocks_.at(block.segments[a], block.segments[b]);
      double part = 0.0;
      for (int j = 0; j < block.segments[b].size; ++j)
        for (int i = 0; i < block.segments[a].size; ++i)
          part += block.H(block.starts[a] + i, block.starts[b] + j) *
                  covariance.data[i * covariance.row + j * covariance.column];
      trace += (a == b ? 1.0 : 2.0) * part;  // both are symmetric
    });
    sum_of(*sums_, block.group, block.camera).leverage += trace;
  }

 private:
  ArrowBlocks<const Matrix6d, const double> blocks_;
  GroupSums* sums_;
};

// Of unknowns that are believed none.
Eigen::MatrixXd information_of(const Eigen::MatrixXd& covariance) {
  if (!covariance.isDiagonal(0.0)) return Eigen::Matrix3d(covariance).inverse();
  return covariance.diagonal().unaryExpr([](double v) { return v > 0.0 ? 1.0 / v : 0.0; }).asDiagonal();
}

// visit(row, camera or board) for every nuisance that is among the unknowns, of rows of the rig for 0.
template <typename Visit>
void for_each_nuisance(const Layout& layout, const Visit& visit) {
  for (std::size_t n = 0; n < kNuisances; ++n) {
    const Nuisance nuisance = static_cast<Nuisance>(n);
    if (!layout.has(nuisance)) continue;
    for (int c = 0; c < layout.count(nuisance); ++c) visit(nuisance, c);
  }
}

}  // namespace

Problem::Problem(const Observations& observations, const Priors& priors, const NoiseLevels& noise_levels,
                 std::shared_ptr<const Whitened> whitened_before)
    : noise(noise_levels),
      view_left_out(observations.board_views.size(), false),
      camera_fixed(observations.cameras.size(), false),
      observations_(observations),
      layout_(Layout::of(observations, priors)),
      priors_(priors),
      whitened_(whitened_before ? std::move(whitened_before)
                                : std::make_shared<const Whitened>(whitened(observations))) {
  const Eigen::Vector2d& turns_about_m = observations.odometry_noise.rotation_centre_m;
  for (std::size_t i = 0; i + 1 < observations.stops.size(); ++i)
    increments_.push_back(veering_increment(observations.stops[i], observations.stops[i + 1], turns_about_m));
  for (std::size_t i = 0; noise_levels.law.along_way && i + 1 < observations.stops.size(); ++i)
    ways_.emplace_back(observations.stops[i], observations.stops[i + 1], turns_about_m);
}

Evaluation Problem::at(const State& state, Weighting weighting) const {
  return {observations_, whitened_->lenses, layout_, noise, loss, state, weighting};
}

void Problem::visit_odometry(const Evaluation& at, int stop, BlockSink* sink) const {
  if (noise.law.model != OdometryModel::kPerIncrement) return odometry_pose(at, stop, sink);
  if (stop == 0) return;
  const std::size_t from = static_cast<std::size_t>(stop) - 1;
  if (noise.law.along_way)
    odometry_along_way(at, stop, ways_[from], sink);
  else
    odometry_increment(at, stop, increments_[from], sink);
}

void Problem::visit_blocks(const State& state, Weighting weighting, BlockSink* sink) const {
  const Evaluation here = at(state, weighting);
  for (std::size_t v = 0; v < whitened_->views.size(); ++v)
    if (!view_left_out[v]) corners(here, whitened_->views[v], sink);
  const std::vector<bool> shown = shown_boards();
  for (const WhitenedPlane& plane : whitened_->board_planes)
    if (shown[static_cast<std::size_t>(plane.board)]) board_plane(here, plane, sink);
  for (const WhitenedPlane& plane : whitened_->ground_planes) ground_plane(here, plane, sink);
  for (int stop = 0; stop < layout_.poses; ++stop) {
    visit_odometry(here, stop, sink);
    suspension(here, stop, sink);
  }
}

bool Problem::counts(Nuisance nuisance) const {
  return noise.law.model == OdometryModel::kPerIncrement || !row_of(nuisance).increments_only;
}

void Problem::for_each_prior(const std::function<void(Nuisance, int, const Eigen::MatrixXd&)>& visit) const {
  for_each_nuisance(layout_, [&](Nuisance nuisance, int c) {
    if (counts(nuisance)) visit(nuisance, layout_.place(nuisance, c), information_of(priors_.covariance(nuisance, c)));
  });
}

void Problem::add_priors(const State& state, ArrowSystem* system, double* cost) const {
  for_each_nuisance(layout_, [&](Nuisance nuisance, int c) {
    if (!counts(nuisance)) return;
    const Eigen::MatrixXd information = information_of(priors_.covariance(nuisance, c));
    const Eigen::VectorXd value = state.nuisances.of(nuisance, c), g = information * value;
    const int place = layout_.place(nuisance, c), size = row_of(nuisance).size();
    system->global.block(place, place, size, size) += information;
    system->global_gradient.segment(place, size) += g;
    *cost += g.dot(value);
  });
  for (const PlaceError& error : place_errors(state)) {
    const Eigen::MatrixXd J = error.by_globals(layout_), JW = J.transpose() * error.information();
    system->global.topLeftCorner(J.cols(), J.cols()) += JW * J;
    system->global_gradient.head(J.cols()) += JW * error.value;
    *cost += error.value.dot(error.information() * error.value);
  }
}

std::vector<PlaceError> Problem::place_errors(const State& state) const {
  std::vector<PlaceError> errors;
  if (observations_.boards() == 1) return errors;
  const std::vector<bool> shown = shown_boards();
  for (int b = 1; b < layout_.boards; ++b)
    if (const auto& place = observations_.board_at(b).place; place && shown[0] && shown[static_cast<std::size_t>(b)])
      errors.push_back(place_error(state, b, *place));
  return errors;
}

std::vector<bool> Problem::shown_boards() const {
  std::vector<bool> shown(static_cast<std::size_t>(layout_.boards), layout_.boards == 1);
  for (std::size_t v = 0; layout_.boards > 1 && v < whitened_->views.size(); ++v)
    if (!view_left_out[v]) shown[static_cast<std::size_t>(whitened_->views[v].board)] = true;
  return shown;
}

void Problem::fix_unknowns(ArrowSystem* system) const {
  // Increments say nothing about where the world is: the first pose does.
  if (noise.law.model == OdometryModel::kPerIncrement && layout_.poses > 0)
    for (int unknown = 0; unknown < 3; ++unknown) system->fix_pose_unknown(0, unknown);
  for (int c = 0; c < layout_.cameras; ++c)
    for (int unknown = 0; camera_fixed[static_cast<std::size_t>(c)] && unknown < 6; ++unknown)
      system->fix_global_unknown(layout_.camera(c) + unknown);
  const std::vector<bool> shown = shown_boards();
  for (int b = 0; b < layout_.boards; ++b)
    for (int unknown = 0; !shown[static_cast<std::size_t>(b)] && unknown < 6; ++unknown)
      system->fix_global_unknown(layout_.board(b) + unknown);
  for_each_nuisance(layout_, [&](Nuisance nuisance, int c) {
    for (int part = 0; part < row_of(nuisance).size(); ++part)
      if (!counts(nuisance) || !(priors_.covariance(nuisance, c)(part, part) > 0.0))
        system->fix_global_unknown(layout_.place(nuisance, c) + part);
  });
}

ArrowSystem Problem::linearise(const State& state, Weighting weighting, double* cost, GroupSums* sums) const {
  return linearised(state, weighting, {}, cost, sums);
}

ArrowSystem Problem::linearise_with(const RemovedErrors& removed, const State& state, Weighting weighting) const {
  return linearised(state, weighting, {&removed, nullptr}, nullptr, nullptr);
}

ArrowSystem Problem::linearised(const State& state, Weighting weighting, const Besides& besides, double* cost,
                                GroupSums* sums) const {
  const RemovedErrors* removed = besides.removed;
  ArrowSystem system(layout_.poses, layout_.globals() + (removed != nullptr ? removed->errors.size() : 0));
  double total = 0.0;
  if (sums != nullptr) *sums = empty_sums();
  Assembler assembler(&system, &total, sums, besides.also);
  visit_blocks(state, weighting, &assembler);
  system.global = system.global.selfadjointView<Eigen::Lower>().toDenseMatrix();
  if (removed != nullptr) {
    const Evaluation here = at(state, weighting);
    RepeatingCouplings couplings(*removed, layout_.poses, layout_.globals());
    for (std::size_t v = 0; v < whitened_->views.size(); ++v)
      if (!view_left_out[v]) couplings.add(here, v, whitened_->views[v]);
    couplings.add_to(&system);
  }
  add_priors(state, &system, &total);
  fix_unknowns(&system);
  if (cost != nullptr) *cost = total;
  return system;
}

void Problem::add_leverage(const State& state, const EliminatedSystem::PoseCovariance& poses,
                           const Eigen::MatrixXd& globals, GroupSums* sums) const {
  LeverageSink sink(poses, globals, sums);
  visit_blocks(state, Weighting::kInformation, &sink);
  for (std::size_t c = 0; c < corners_absorbed.size(); ++c)
    sum_of(*sums, Group::kCorners, static_cast<int>(c)).leverage += corners_absorbed[c];
}

std::optional<GroupSums> Problem::sums_with_leverage(const State& state, const std::vector<int>& splits,
                                                     std::vector<StepScore>* scores) const {
  GroupSums sums;
  std::optional<StepScan> scan;
  if (scores != nullptr) scan.emplace(layout_, splits);
  const ArrowSystem system =
      linearised(state, Weighting::kInformation, {nullptr, scan ? &*scan : nullptr}, nullptr, &sums);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  const Eigen::MatrixXd covariance = invert_information(eliminated->schur()).covariance;
  add_leverage(state, eliminated->pose_covariance(covariance), covariance, &sums);
  if (scan) *scores = scan->scores(state, *eliminated, covariance);
  return sums;
}

double Problem::log_normalisation() const {
  double sum = 0.0;
  const auto log_odometry_sigmas = [&](int stop) -> double {
    if (!noise.law.along_way) return odometry_sigmas(observations_, noise, stop).array().log().sum();
    const std::size_t to = static_cast<std::size_t>(stop);
    return -way_noise(ways_[to - 1], noise, observations_.stops[to - 1], observations_.stops[to])
                .whitening.diagonal()
                .array()
                .log()
                .sum();
  };
  for (int stop = noise.law.model == OdometryModel::kPerIncrement ? 1 : 0; stop < layout_.poses; ++stop)
    sum += 2.0 * log_odometry_sigmas(stop);
  sum += 2.0 * layout_.poses * (std::log(noise.suspension_height_m) + 2.0 * std::log(noise.suspension_tilt_rad));
  for (std::size_t v = 0; v < whitened_->views.size(); ++v) {
    const WhitenedView& view = whitened_->views[v];
    if (view_left_out[v]) continue;
    sum += 4.0 * static_cast<double>(view.corners.size()) *
           std::log(noise.corner_scale[static_cast<std::size_t>(view.camera)]);
    if (is_displaced(observations_, layout_, view.stop, view.camera))
      sum += 2.0 * DisplacementRows::kParts * std::log(noise.displacement_scale);
  }
  for (const WhitenedPlane& plane : whitened_->ground_planes)
    sum += 6.0 * std::log(noise.ground_scale[static_cast<std::size_t>(plane.camera)]);
  const std::vector<bool> shown = shown_boards();
  for (const WhitenedPlane& plane : whitened_->board_planes)
    if (shown[static_cast<std::size_t>(plane.board)])
      sum += 6.0 * std::log(noise.board_plane_scale[static_cast<std::size_t>(plane.camera)]);
  return sum;
}

ViewFit Problem::view_fit(const State& state, std::size_t view) const {
  return ml::view_fit(at(state, Weighting::kRobust), whitened_->views[view]);
}

std::optional<std::vector<ViewPull>> Problem::view_pulls(const State& state) const {
  const ArrowSystem system = linearise(state, Weighting::kInformation, nullptr, nullptr);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  const Eigen::MatrixXd covariance = invert_information(eliminated->schur()).covariance;
  const EliminatedSystem::PoseCovariance poses = eliminated->pose_covariance(covariance);
  const Evaluation here = at(state, Weighting::kInformation);
  std::vector<ViewPull> pulls(whitened_->views.size());
  for (std::size_t v = 0; v < pulls.size(); ++v) {
    const WhitenedView& view = whitened_->views[v];
    if (view_left_out[v] || is_displaced(observations_, layout_, view.stop, view.camera)) continue;
    LocalBlock block(Group::kCorners, view.camera);
    GroupSums sums = empty_sums();
    pulls[v] = view_pull(here, view, &block);
    if (pulls[v].corners > 0) LeverageSink(poses, covariance, &sums).add(block);
    pulls[v].leverage = sum_of(sums, block.group, block.camera).leverage;
  }
  return pulls;
}

GroupSums Problem::empty_sums() const {
  GroupSums sums;
  for (std::vector<GroupSum>& group : sums)
    group.assign(static_cast<std::size_t>(std::max(1, layout_.cameras)), GroupSum());
  return sums;
}

}  // namespace rigproof::ml
