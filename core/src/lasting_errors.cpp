#include "lasting_errors.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "covariance_triangle.h"

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

// What the lines hold in `lasting`; false if they do not fit together.
bool take(const std::vector<Line>& lines, std::size_t of_cameras, LastingErrors* lasting) {
  const auto size = static_cast<Eigen::Index>(lines.size());
  lasting->covariance.resize(size, size);
  lasting->with_cameras.resize(static_cast<Eigen::Index>(of_cameras), size);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    if (line.covariance.size() != lines.size() - i || line.with_cameras.size() != of_cameras) return false;
    lasting->unknowns.push_back(line.unknown);
    const auto row = static_cast<Eigen::Index>(i);
    for (std::size_t j = 0; j < line.covariance.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(i + j);
      lasting->covariance(row, column) = lasting->covariance(column, row) = line.covariance[j];
    }
    for (std::size_t j = 0; j < of_cameras; ++j)
      lasting->with_cameras(static_cast<Eigen::Index>(j), row) = line.with_cameras[j];
  }
  return true;
}

bool is_positive_covariance(const Eigen::MatrixXd& covariance) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(covariance.rows()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  return is_covariance(covariance, all) && (covariance.diagonal().array() > 0.0).all();
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
  visitor.field("value", line.unknown.value, {}, "the estimate; zero where all is as stated");
  visitor.field("covariance", line.covariance, {}, 1, 100000, "with itself and with each of the lines that follow");
  visitor.field("with_cameras", line.with_cameras, {}, 0, 100000,
                "covariance with tx ty tz rx ry rz of each of camera_to_robot, metres and radians");
}

void visit_fine(FieldVisitor& visitor, LastingErrors::FineGrid& grid) {
  visitor.on_one_line();
  visitor.require("camera", "a camera's name");
  visitor.field("camera", grid.camera, TextChoices{}, "of which camera");
  visitor.field("cells", grid.cells, {1.0, 64.0}, "of the grid across the image's longer side");
  visitor.field("sigma_px", grid.sigma_px, {0.0, 1e3}, "root mean square of its coefficients");
  visitor.field("share", grid.share, {0.0, 1.0}, "how likely it is");
}

void visit_stated(FieldVisitor& visitor, LastingErrors::Stated& stated) {
  visitor.on_one_line();
  visit_owner(visitor, stated.of);
  visitor.field("hash", stated.hash, TextChoices{}, "of what was stated of it, which the errors go with");
}

void visit_block(FieldVisitor& visitor, LastingErrors& lasting, std::size_t of_cameras) {
  std::vector<Line> lines = lines_of(lasting);
  visitor.nested_list("unknowns", lines, "with their covariance", visit_line);
  visitor.nested_list("fine_fields", lasting.fine_fields, "by how much no polynomial follows a lens", visit_fine);
  visitor.nested_list("stated", lasting.stated, "of which cameras and boards", visit_stated);
  visitor.tolerate("x-");
  if (!visitor.is_reading()) return;
  const bool fits = take(lines, of_cameras, &lasting);
  visitor.check(
      fits, "unknowns",
      "must have rows of an upper triangle, and " + std::to_string(of_cameras) + " numbers with_cameras each");
  visitor.check(!fits || is_positive_covariance(lasting.covariance), "unknowns",
                "have no covariance: variances must be positive, correlations at most 1");
}

}  // namespace

void visit_lasting(FieldVisitor& visitor, std::optional<LastingErrors>& lasting, std::size_t of_cameras) {
  if (!visitor.takes("lasting_errors", lasting.has_value())) return;
  LastingErrors here = lasting.value_or(LastingErrors());
  visitor.section(
      "lasting_errors", [&](FieldVisitor& block) { visit_block(block, here, of_cameras); },
      "of lenses, boards and depth, which another drive meets again: rigproof moved starts from them");
  if (visitor.is_reading()) lasting = std::move(here);
}

}  // namespace rigproof
