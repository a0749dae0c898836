#include "lasting_errors.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace rigproof {
namespace {

// Of a few thousand numbers; two drives tell no more of them.
double rounded(double value) { return parse_number(short_text(value, 10)).value_or(value); }

// An unknown with its rows of both covariances.
struct Line {
  LastingErrors::Unknown unknown;
  std::vector<double> covariance, with_cameras;
};

std::vector<Line> lines_of(const LastingErrors& lasting) {
  std::vector<Line> lines;
  for (std::size_t i = 0; i < lasting.unknowns.size(); ++i) {
    Line& line = lines.emplace_back();
    line.unknown = lasting.unknowns[i];
    const auto row = static_cast<Eigen::Index>(i);
    for (Eigen::Index j = row; j < lasting.covariance.cols(); ++j)
      line.covariance.push_back(rounded(lasting.covariance(row, j)));
    for (Eigen::Index j = 0; j < lasting.with_cameras.rows(); ++j)
      line.with_cameras.push_back(rounded(lasting.with_cameras(j, row)));
  }
  return lines;
}

bool fit_together(const std::vector<Line>& lines, std::size_t of_cameras) {
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (lines[i].covariance.size() != lines.size() - i || lines[i].with_cameras.size() != of_cameras) return false;
  return true;
}

// Of lines that fit together.
void take(const std::vector<Line>& lines, std::size_t of_cameras, LastingErrors* lasting) {
  const auto size = static_cast<Eigen::Index>(lines.size());
  lasting->covariance.resize(size, size);
  lasting->with_cameras.resize(static_cast<Eigen::Index>(of_cameras), size);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    lasting->unknowns.push_back(line.unknown);
    const auto row = static_cast<Eigen::Index>(i);
    for (std::size_t j = 0; j < line.covariance.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(i + j);
      lasting->covariance(row, column) = lasting->covariance(column, row) = line.covariance[j];
    }
    for (std::size_t j = 0; j < of_cameras; ++j)
      lasting->with_cameras(static_cast<Eigen::Index>(j), row) = line.with_cameras[j];
  }
}

bool repeat(const std::vector<LastingErrors::Unknown>& unknowns) {
  std::set<std::tuple<std::string, int, std::string>> seen;
  return std::any_of(unknowns.begin(), unknowns.end(), [&seen](const LastingErrors::Unknown& unknown) {
    return !seen.emplace(unknown.of.camera, unknown.of.board, unknown.name).second;
  });
}

// Whether it is known of each what was stated of the camera or board that it is of.
bool all_stated(const LastingErrors& lasting) {
  return std::all_of(lasting.unknowns.begin(), lasting.unknowns.end(), [&](const LastingErrors::Unknown& unknown) {
    return std::any_of(lasting.stated.begin(), lasting.stated.end(),
                       [&](const LastingErrors::Stated& stated) { return stated.of == unknown.of; });
  });
}

// Whether all of the cameras and the errors together have variances that are positive, and no combination a negative
// one.
bool is_covariance_with(const Eigen::MatrixXd& joint, const LastingErrors& lasting) {
  const Eigen::Index first = joint.rows(), size = lasting.covariance.rows();
  Eigen::MatrixXd all(first + size, first + size);
  all << joint, lasting.with_cameras, lasting.with_cameras.transpose(), lasting.covariance;
  const Eigen::VectorXd variances = all.diagonal();
  if (!all.allFinite() || !(variances.array() > 0.0).all()) return false;
  const Eigen::VectorXd scale = variances.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * all * scale.asDiagonal(),
                                                             Eigen::EigenvaluesOnly);
  constexpr double kRounding = 1e-6;
  return eigen.eigenvalues()[0] > -kRounding;
}

void visit_owner(FieldVisitor& visitor, LastingErrors::Owner& owner) {
  visitor.optional("camera", owner.camera, "of which camera");
  if (visitor.takes("board", owner.board > 0))
    visitor.field("board", owner.board, {1.0, 1e3}, "or of which board: 1 is the first");
  visitor.check(owner.camera.empty() != (owner.board == 0), "", "must be of a camera or of a board");
}

void visit_line(FieldVisitor& visitor, Line& line) {
  visitor.on_one_line();
  visit_owner(visitor, line.unknown.of);
  visitor.require("name", "what was estimated, with its unit");
  visitor.field("name", line.unknown.name, TextChoices{}, "what, with its unit");
  visitor.required("value", line.unknown.value, {-1e6, 1e6}, "the estimate; zero where all is as stated");
  visitor.require("covariance", "numbers, at least one");
  visitor.field("covariance", line.covariance, {}, 1, 100000, "with itself and with each of the lines that follow");
  visitor.field("with_cameras", line.with_cameras, {}, 0, 100000,
                "covariance with tx ty tz rx ry rz of each of camera_to_robot, metres and radians");
}

void visit_fine(FieldVisitor& visitor, LastingErrors::FineGrid& grid) {
  visitor.on_one_line();
  visitor.require("camera", "a camera's name");
  visitor.field("camera", grid.camera, TextChoices{}, "of which camera");
  visitor.require("cells", "a whole number");
  visitor.field("cells", grid.cells, {1.0, 64.0}, "of the grid across the image's longer side");
  visitor.required("sigma_px", grid.sigma_px, {0.0, 1e3}, "root mean square of its coefficients");
  visitor.required("share", grid.share, {0.0, 1.0}, "how likely it is");
}

void visit_stated(FieldVisitor& visitor, LastingErrors::Stated& stated) {
  visitor.on_one_line();
  visit_owner(visitor, stated.of);
  visitor.require("hash", "sixteen digits");
  visitor.field("hash", stated.hash, TextChoices{}, "of what was stated of it, which the errors go with");
}

void check_and_take(FieldVisitor& visitor, const std::vector<Line>& lines, const std::optional<Eigen::MatrixXd>& joint,
                    LastingErrors* lasting) {
  constexpr std::size_t kMost = 2000;
  const std::size_t of_cameras = joint ? static_cast<std::size_t>(joint->rows()) : 0;
  visitor.check(joint.has_value(), "", "goes with a joint_covariance_m_rad, which is missing");
  visitor.check(!lines.empty() && lines.size() <= kMost, "unknowns", "must be 1 to 2000 lines");
  if (!joint || lines.empty() || lines.size() > kMost) return;
  const bool fit = fit_together(lines, of_cameras);
  visitor.check(
      fit, "unknowns",
      "must have rows of an upper triangle, and " + std::to_string(of_cameras) + " numbers with_cameras each");
  if (!fit) return;
  take(lines, of_cameras, lasting);
  visitor.check(!repeat(lasting->unknowns), "unknowns", "hold one of a camera or board twice");
  visitor.check(all_stated(*lasting), "stated", "must have a line for each camera and board of unknowns");
  visitor.check(is_covariance_with(*joint, *lasting), "unknowns",
                "are no covariance together with the cameras': variances must be positive, also of combinations");
}

void visit_block(FieldVisitor& visitor, LastingErrors& lasting, const std::optional<Eigen::MatrixXd>& joint) {
  std::vector<Line> lines = lines_of(lasting);
  const std::size_t before = visitor.is_reading() ? visitor.problems()->all().size() : 0;
  visitor.require("unknowns", "a list");
  visitor.nested_list("unknowns", lines, "with their covariance", visit_line);
  visitor.nested_list("fine_fields", lasting.fine_fields, "by how much no polynomial follows a lens", visit_fine);
  visitor.nested_list("stated", lasting.stated, "of which cameras and boards", visit_stated);
  visitor.tolerate("x-");
  if (visitor.is_reading() && visitor.problems()->all().size() == before)
    check_and_take(visitor, lines, joint, &lasting);
}

}  // namespace

void visit_lasting(FieldVisitor& visitor, std::optional<LastingErrors>& lasting,
                   const std::optional<Eigen::MatrixXd>& joint) {
  if (!visitor.takes("lasting_errors", lasting.has_value() && joint.has_value())) return;
  LastingErrors here = lasting.value_or(LastingErrors());
  visitor.section(
      "lasting_errors", [&](FieldVisitor& block) { visit_block(block, here, joint); },
      "of lenses, boards and depth, which another drive meets again: rigproof moved starts from them");
  if (visitor.is_reading()) lasting = std::move(here);
}

}  // namespace rigproof
