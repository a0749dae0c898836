#include "rigproof/generator/board_config.h"

#include <Eigen/QR>
#include <cmath>

namespace rigproof {
namespace {

// What moves, turns or sizes the whole board, a column each; x and y of corner after corner.
Eigen::MatrixXd whole_motions(const Board& board) {
  const Eigen::Vector3d centre = board.centre();
  Eigen::MatrixXd motions(2 * board.corner_count(), 5);
  for (int id = 0; id < board.corner_count(); ++id) {
    const Eigen::Vector3d p = board.corner(id) - centre;
    motions.middleRows<2>(2 * id) << 1.0, 0.0, -p.y(), p.x(), 0.0,  //
        0.0, 1.0, p.x(), 0.0, p.y();
  }
  return motions;
}

std::vector<Eigen::Vector2d> corner_shifts(const Board& board, double sigma_m, RandomStream random) {
  Eigen::VectorXd shifts(2 * board.corner_count());
  for (Eigen::Index i = 0; i < shifts.size(); ++i) shifts[i] = random.normal();
  const Eigen::MatrixXd motions = whole_motions(board);
  shifts -= motions * motions.householderQr().solve(shifts);
  shifts *= sigma_m / std::sqrt(shifts.squaredNorm() / static_cast<double>(shifts.size()));
  std::vector<Eigen::Vector2d> result;
  for (int id = 0; id < board.corner_count(); ++id) result.emplace_back(shifts.segment<2>(2 * id));
  return result;
}

}  // namespace

void BoardDefectsConfig::visit(FieldVisitor& visitor) {
  visitor.field("print_scale_x", print_scale_x, {0.9, 1.1}, "true over nominal length along the board's x");
  visitor.field("print_scale_y", print_scale_y, {0.9, 1.1}, "true over nominal length along the board's y");
  visitor.field("bow_mm", bow_mm, {-50.0, 50.0},
                "the middle of the plate stands out by this, bent about the board's y");
  visitor.field(
      "print_error_mm", print_error_mm, {0.0, 5.0},
      "print and paper put each corner elsewhere by this, one sigma along either axis; shift, turn and size of "
      "the whole are not part of it");
  visitor.field("border_mm", border_mm, {0.0, 500.0}, "white around the squares");
  visitor.field("glare", glare, {0.0, 1.0}, "a lamp's reflection on the sheet: 1 = white in its middle");
  visitor.field("covered_percent", covered_percent, {0.0, 40.0}, "of the sheet, by a cloth over one corner");
  visitor.field("dirt", dirt, {0.0, 1.0}, "specks and smudges: 1 = filthy");
}

RandomStream stream_of_board(std::uint64_t seed, const std::string& purpose, std::size_t index) {
  return RandomStream(seed, purpose, -1, static_cast<std::int32_t>(index) - 1);
}

std::string key_of_board(std::size_t index) {
  return index == 0 ? "board" : "more_boards[" + std::to_string(index - 1) + "]";
}

BoardDefectsDraw draw_board_defects(const BoardDefectsConfig& config, const Board& board, std::uint64_t seed,
                                    std::size_t index) {
  BoardDefectsDraw result;
  RandomStream random = stream_of_board(seed, "board defects", index);
  const auto draw = [&](const char* name, const Distribution& distribution) {
    return result.drawn[key_of_board(index) + ".defects." + name] = distribution.sample(random);
  };
  BoardDefects& defects = result.defects;
  defects.print_scale_x = draw("print_scale_x", config.print_scale_x);
  defects.print_scale_y = draw("print_scale_y", config.print_scale_y);
  defects.bow_m = 0.001 * draw("bow_mm", config.bow_mm);
  result.print_error_m = 0.001 * draw("print_error_mm", config.print_error_mm);
  if (result.print_error_m > 0.0)
    defects.corner_shifts_m = corner_shifts(board, result.print_error_m, stream_of_board(seed, "board print", index));
  result.border_m = 0.001 * draw("border_mm", config.border_mm);
  defects.glare = draw("glare", config.glare);
  defects.covered = 0.01 * draw("covered_percent", config.covered_percent);
  defects.dirt = draw("dirt", config.dirt);
  defects.seed =
      index == 0 ? seed : seed ^ (std::uint64_t{stream_of_board(seed, "board surface", index).next_u32()} << 32U);
  return result;
}

}  // namespace rigproof
