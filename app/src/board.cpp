// `rigproof board`.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "board_options.h"
#include "commands.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/sim/board_print.h"
#include "terminal.h"

namespace rigproof {
namespace {

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

void check_options(const BoardArguments& arguments, const std::filesystem::path& output) {
  const std::string ending = ending_of(output);
  const bool drawing = ending == ".svg" || ending == ".dxf";
  Problems problems;
  if (ending != ".pdf" && !drawing)
    problems.add({"", 0, "--output", for_message(output.string()), "boards are written as .pdf, .svg or .dxf"});
  if (arguments.tiles && drawing)
    problems.add({"", 0, "--tiles", "", "contradicts " + ending + ", which has one page; write a .pdf"});
  if (arguments.tiles && arguments.paper == "fit")
    problems.add({"", 0, "--tiles", "", "contradicts --paper fit; name the printer's paper, e.g. --paper a4"});
  if (arguments.overlap_mm && !arguments.tiles)
    problems.add({"", 0, "--overlap-mm", "", "says how --tiles overlap, which is not given"});
  problems.throw_if_any();
}

std::string pages_words(const TileGrid& grid, const std::string& paper) {
  if (grid.count() == 1) return "";
  return "  " + std::to_string(grid.rows) + " rows x " + std::to_string(grid.columns) + " columns of " + paper +
         ", and a page that says how to glue them;";
}

}  // namespace

int board_command(const BoardArguments& arguments) {
  const std::filesystem::path output = arguments.output.empty() ? "board.pdf" : arguments.output;
  check_options(arguments, output);
  const Board board = board_of({arguments.preset, arguments.type, arguments.squares, arguments.square_mm});
  BoardPrint print;
  print.paper = arguments.paper;
  print.border_m = 1e-3 * arguments.border_mm;
  print.printer_margin_m = 1e-3 * arguments.printer_margin_mm;
  print.tiles = arguments.tiles;
  print.overlap_m = 1e-3 * arguments.overlap_mm.value_or(1e3 * print.overlap_m);
  const std::string ending = ending_of(output);
  write_file_atomically(output, ending == ".svg"   ? board_svg(board, print)
                                : ending == ".dxf" ? board_dxf(board, print)
                                                   : board_pdf(board, print));
  const TileGrid grid = tile_grid(board, print);
  if (arguments.common.json) {
    const int pages = grid.count() == 1 ? 1 : grid.count() + 1;
    std::puts(json_text({{"file", output.string()}, {"pages", pages}}).c_str());
    return 0;
  }
  Terminal(arguments.common.quiet)
      .line("board      " + output.string() + pages_words(grid, arguments.paper) +
            "  print at 100 %, then check the rulers");
  return 0;
}

}  // namespace rigproof
