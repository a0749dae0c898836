#include "rigproof/generator/board_config.h"

#include "rigproof/core/random.h"

namespace rigproof {

void BoardDefectsConfig::visit(FieldVisitor& visitor) {
  visitor.field("print_scale_x", print_scale_x, {0.9, 1.1}, "true over nominal length along the board's x");
  visitor.field("print_scale_y", print_scale_y, {0.9, 1.1}, "true over nominal length along the board's y");
  visitor.field("bow_mm", bow_mm, {-50.0, 50.0},
                "the middle of the plate stands out by this, bent about the board's y");
  visitor.field("border_mm", border_mm, {0.0, 500.0}, "white around the squares");
  visitor.field("glare", glare, {0.0, 1.0}, "a lamp's reflection on the sheet: 1 = white in its middle");
  visitor.field("covered_percent", covered_percent, {0.0, 40.0}, "of the sheet, by a cloth over one corner");
  visitor.field("dirt", dirt, {0.0, 1.0}, "specks and smudges: 1 = filthy");
}

BoardDefectsDraw draw_board_defects(const BoardDefectsConfig& config, std::uint64_t seed) {
  BoardDefectsDraw result;
  RandomStream random(seed, "board defects");
  const auto draw = [&](const char* name, const Distribution& distribution) {
    return result.drawn[std::string("board.defects.") + name] = distribution.sample(random);
  };
  BoardDefects& defects = result.defects;
  defects.print_scale_x = draw("print_scale_x", config.print_scale_x);
  defects.print_scale_y = draw("print_scale_y", config.print_scale_y);
  defects.bow_m = 0.001 * draw("bow_mm", config.bow_mm);
  result.border_m = 0.001 * draw("border_mm", config.border_mm);
  defects.glare = draw("glare", config.glare);
  defects.covered = 0.01 * draw("covered_percent", config.covered_percent);
  defects.dirt = draw("dirt", config.dirt);
  defects.seed = seed;
  return result;
}

}  // namespace rigproof
