// `rigproof convert`: recordings from one format to another.
#include "rigproof/study/workflow/convert.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/formats/format.h"
#include "terminal.h"

namespace rigproof {

int convert_command(const ConvertArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const Input input = open_input(arguments.input);
  if (!input.recording)
    throw Error(arguments.input.string() + ": holds observations without images; there is nothing to convert");
  // Ours, which a run holds, becomes the MEMROC layout, and everything else becomes ours.
  const bool ours = input.run || input.format->name == "recording";
  const std::string to = arguments.to.empty() ? (ours ? "memroc" : "recording") : arguments.to;
  ProgressLine progress(terminal, "convert", "images");
  ConvertOptions options;
  options.max_cloud_points = arguments.cloud_points;
  options.progress = progress.callback();
  const ConvertReport report = convert(*input.recording, to, arguments.output, options);
  if (arguments.common.json) {
    const nlohmann::json json = {{"output", arguments.output.string()},
                                 {"layout", to},
                                 {"images", report.images},
                                 {"clouds", report.clouds},
                                 {"notes", report.notes}};
    std::puts(json_text(json).c_str());
    return 0;
  }
  terminal.line(to + "  " + arguments.output.string() + "  " + std::to_string(report.images) + " images, " +
                std::to_string(report.clouds) + " clouds");
  for (const std::string& note : report.notes) terminal.line(terminal.colored("NOTE", Color::kWarning) + " " + note);
  return 0;
}

}  // namespace rigproof
