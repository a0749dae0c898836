#include "rigproof/calib/estimate/repeating_errors.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "fine_numbers.h"

namespace rigproof::ml {
namespace {

constexpr std::size_t kMostStops = 3000;
constexpr int kShapeModes = 10;

// What the offsets of a board's corners may not hold since other unknowns have it: translation, rotation, the side of
// the squares along x and y, the bow along x and y. 3 corners x 10, orthonormal.
Eigen::MatrixXd shape_modes(const Board& board) {
  const int corners = board.corner_count();
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(3 * corners, kShapeModes);
  for (int id = 0; id < corners; ++id) {
    const Eigen::Vector3d p = (board.corner(id) - board.centre()) / board.square_m;
    auto of_corner = modes.middleRows<3>(3 * id);
    of_corner.row(0).head<4>() << 1.0, 0.0, -p.y(), p.x();
    of_corner.row(1).head<3>() << 0.0, 1.0, p.x();
    of_corner(1, 4) = p.y();
    of_corner.row(2).tail<5>() << 1.0, p.x(), p.y(), p.x() * p.x(), p.y() * p.y();
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(modes);
  return qr.householderQ() * Eigen::MatrixXd::Identity(3 * corners, 3 * corners);
}

}  // namespace

RepeatingErrors::RepeatingErrors(const Observations& observations, const PriorSigmas& priors) {
  fields_.assign(observations.cameras.size(), -1);
  if (priors.believe_told || observations.stops.size() > kMostStops) return;
  for (int b = 0; b < observations.boards(); ++b) {
    prints_.push_back(-1);
    add_print(observations.board_at(b), b);
  }
  for (std::size_t c = 0; c < fields_.size(); ++c) {
    lens_fields_.emplace_back();
    if (observations.cameras[c].intrinsics_sigma.residual_px > 0.0)
      add_field(observations.cameras[c].camera, static_cast<int>(c));
  }
  if (groups_.empty()) return;
  const Group& last = groups_.back();
  raw_by_unknowns_ = Eigen::MatrixXd::Zero(last.raw + last.raw_size, last.first + last.size);
  for (const Group& group : groups_) {
    auto of_group = raw_by_unknowns_.block(group.raw, group.first, group.raw_size, group.size);
    if (group.camera < 0) {
      const Board& board = observations.board_at(group.board);
      of_group = board.print_sigma() * shape_modes(board).rightCols(group.size);
    } else {
      of_group.diagonal().setConstant(
          observations.cameras[static_cast<std::size_t>(group.camera)].intrinsics_sigma.residual_px);
    }
  }
}

void RepeatingErrors::add_print(const Board& board, int index) {
  const int corners = 3 * board.corner_count();
  if (!(board.print_sigma() > 0.0) || corners <= kShapeModes) return;
  Group group = next_group(corners - kShapeModes, corners);
  group.board = index;
  prints_.back() = group.raw;
  groups_.push_back(group);
}

void RepeatingErrors::add_field(const Camera& camera, int index) {
  const int size = lens_fields_.back().emplace(camera).size();
  Group group = next_group(size, size);
  group.camera = index;
  fields_[static_cast<std::size_t>(index)] = group.raw;
  groups_.push_back(group);
}

RepeatingErrors::Group RepeatingErrors::next_group(int size, int raw_size) const {
  Group group{-1, 0, size, 1.0, 0, 0, raw_size};
  if (groups_.empty()) return group;
  const Group& last = groups_.back();
  group.first = last.first + last.size;
  group.raw = last.raw + last.raw_size;
  return group;
}

Eigen::MatrixXd RepeatingErrors::by_unknowns(const Eigen::MatrixXd& by_raw) const {
  Eigen::MatrixXd rows(size(), by_raw.cols());
  for (const Group& group : groups_) {
    auto of_group = rows.middleRows(group.first, group.size);
    const auto block = raw_by_unknowns_.block(group.raw, group.first, group.raw_size, group.size);
    if (group.camera < 0)
      of_group.noalias() = block.transpose() * by_raw.middleRows(group.raw, group.raw_size);
    else
      of_group = block.diagonal().asDiagonal() * by_raw.middleRows(group.raw, group.size);
  }
  return rows;
}

void RepeatingErrors::enlarge(const Group& group, double factor) {
  raw_by_unknowns_.middleCols(group.first, group.size) *= factor;
  for (Group& own : groups_)
    if (own.first == group.first) own.level *= factor;
}

double RemovedErrors::cost() const {
  double sum = value.squaredNorm();
  for (const Fine& of_camera : fine) sum += of_camera.value.squaredNorm();
  return sum;
}

RemovedErrors none_removed(const Observations& observations, const PriorSigmas& priors) {
  RemovedErrors removed{RepeatingErrors(observations, priors), {}, {}, {}, {}, {}};
  removed.value = Eigen::VectorXd::Zero(removed.errors.size());
  for (std::size_t v = 0; removed.errors.any() && v < observations.board_views.size(); ++v) {
    const BoardView& view = observations.board_views[v];
    Eigen::MatrixXd& field = removed.fields.emplace_back();
    if (removed.errors.field(view.camera) < 0) continue;
    const LensField& of_lens = removed.errors.lens_field(view.camera);
    field.resize(2 * static_cast<Eigen::Index>(view.corners.size()), of_lens.size());
    for (std::size_t i = 0; i < view.corners.size(); ++i)
      field.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = of_lens.at(view.corners[i].pixel);
  }
  return removed;
}

void add_stated_fine_fields(const Observations& observations, RemovedErrors* removed) {
  // Before any data all grids and none are alike; root mean square of the prior of the size (fine_level).
  constexpr double kShare = 1.0 / (kFineGrids.size() + 1), kOfStated = 1.168;
  removed->fine.resize(observations.cameras.size());
  for (std::size_t c = 0; c < removed->fine.size(); ++c) {
    if (!removed->errors.any() || removed->errors.field(static_cast<int>(c)) < 0) continue;
    const double sigma_px = kOfStated * observations.cameras[c].intrinsics_sigma.residual_px / FineField::kRms;
    std::vector<RemovedErrors::Fine::Grid> grids;
    for (const int cells : kFineGrids) grids.push_back({cells, sigma_px, kShare});
    describe_by(grids, static_cast<int>(c), observations, removed);
  }
}

void describe_by(const std::vector<RemovedErrors::Fine::Grid>& grids, int camera, const Observations& observations,
                 RemovedErrors* removed) {
  constexpr double kTellsNothing = 1e-9;  // of the largest
  RemovedErrors::Fine& fine = removed->fine[static_cast<std::size_t>(camera)];
  const RemovedErrors::Fine before = fine;
  fine.grids = grids;
  fine.numbers = numbers_for(observations, camera, grids, fine.noise);
  fine.value = Eigen::VectorXd::Zero(fine.numbers ? fine.numbers->size() : 0);
  if (!before.numbers || !fine.numbers) return;
  const Eigen::Index n = fine.numbers->along_x();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n), right = Eigen::MatrixXd::Zero(n, 2);
  for (const BoardView& view : observations.board_views)
    for (const CornerObservation& corner : view.corners) {
      if (view.camera != camera) continue;
      const Eigen::VectorXd by_number = fine.numbers->at(corner.pixel);
      H += by_number * by_number.transpose();
      right += by_number * before.numbers->displacement(corner.pixel, before.value).transpose();
    }
  H.diagonal().array() += kTellsNothing * H.diagonal().maxCoeff();
  const Eigen::MatrixXd numbers = H.ldlt().solve(right);
  fine.value << numbers.col(0), numbers.col(1);
}

void remove_repeating(const RemovedErrors& removed, const std::vector<ViewPose>& views, Observations* observations) {
  const RepeatingErrors& errors = removed.errors;
  const Eigen::VectorXd raw = errors.raw_by_unknowns() * removed.value;
  for (const ViewPose& pose : views) {
    BoardView& view = observations->board_views[static_cast<std::size_t>(pose.view)];
    const auto camera = static_cast<std::size_t>(view.camera);
    const Camera& lens = observations->cameras[camera].camera;
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      CornerObservation& corner = view.corners[i];
      Eigen::Vector2d pixel, shift = Eigen::Vector2d::Zero();
      Eigen::Matrix<double, 2, 3> by_point;
      const Eigen::Vector3d place = observations->board_of(view).corner(corner.id);
      if (const int field = errors.field(view.camera); field >= 0) {
        const Eigen::MatrixXd& by_field = removed.fields[static_cast<std::size_t>(pose.view)];
        shift = by_field.middleRows<2>(2 * static_cast<Eigen::Index>(i)) * raw.segment(field, by_field.cols());
      }
      if (camera < removed.fine.size() && removed.fine[camera].numbers)
        shift += removed.fine[camera].numbers->displacement(corner.pixel, removed.fine[camera].value);
      if (const int print = errors.print(view.board, corner.id);
          print >= 0 && lens.project(pose.T_camera_board * place, &pixel, &by_point))
        shift += by_point * (pose.T_camera_board.rotation * raw.segment<3>(print));
      corner.pixel -= shift;
    }
  }
}

}  // namespace rigproof::ml
