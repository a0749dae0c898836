// `rigproof board`.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "board_options.h"
#include "commands.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/sim/board_pdf.h"
#include "terminal.h"

namespace rigproof {

int board_command(const BoardArguments& arguments) {
  const Board board = board_of({arguments.preset, arguments.type, arguments.squares, arguments.square_mm});
  const std::filesystem::path output = arguments.output.empty() ? "board.pdf" : arguments.output;
  if (output.extension() != ".pdf" && output.extension() != ".PDF")
    throw Error("--output: " + for_message(output.string()) + ": boards are written as .pdf, and nothing else");
  const std::string pdf = board_pdf(board, {arguments.paper, 1e-3 * arguments.border_mm});
  write_file_atomically(output, pdf);
  if (arguments.common.json) {
    std::puts(json_text({{"file", output.string()}}).c_str());
    return 0;
  }
  Terminal(arguments.common.quiet).line("board      " + output.string() + "  print at 100 %, then check the ruler");
  return 0;
}

}  // namespace rigproof
