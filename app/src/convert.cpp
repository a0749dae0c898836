// `rigproof convert`: recordings from one format to another, or into a bag.
#include "rigproof/study/workflow/convert.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "archiving.h"
#include "commands.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/formats/format.h"
#include "rigproof/study/record/bag_of_recording.h"
#include "rigproof/study/workflow/archive.h"
#include "terminal.h"

namespace rigproof {
namespace {

/// What was made, in words and for machines.
struct Converted {
  std::string what;
  std::size_t images = 0, clouds = 0;
  std::vector<std::string> notes;
};

// Ours, which a run holds, becomes the MEMROC layout, and everything else becomes ours; a name tells a bag.
std::string layout_for(const ConvertArguments& arguments, const Input& input) {
  if (!arguments.to.empty()) return arguments.to;
  if (arguments.output.extension() == ".mcap") return kBagLayout;
  const bool ours = input.run || input.format->name == "recording";
  return ours ? "memroc" : "recording";
}

Converted into_bag(const ConvertArguments& arguments, const Recording& recording, ProgressLine& progress) {
  BagOptions options;
  options.compressed_images = arguments.compressed;
  options.packing = arguments.packing;
  options.progress = progress.callback();
  const BagReport report = write_bag(recording, arguments.output, options);
  return {std::to_string(report.images) + " images, " + std::to_string(report.depth_images) + " depth images, " +
              (report.clouds > 0 ? std::to_string(report.clouds) + " clouds, " : "") + std::to_string(report.odometry) +
              " rows of odometry on " + std::to_string(report.topics.size()) + " topics",
          report.images, report.clouds, report.notes};
}

Converted into_archive(const ConvertArguments& arguments, const Input& input, ProgressLine& progress) {
  return {write_shards(input.path, arguments.output, arguments.shard_mib, &progress), 0, 0, {}};
}

Converted into_folder(const ConvertArguments& arguments, const Recording& recording, const std::string& to,
                      ProgressLine& progress) {
  ConvertOptions options;
  options.max_cloud_points = arguments.cloud_points;
  options.progress = progress.callback();
  const ConvertReport report = convert(recording, to, arguments.output, options);
  return {std::to_string(report.images) + " images, " + std::to_string(report.clouds) + " clouds", report.images,
          report.clouds, report.notes};
}

}  // namespace

int convert_command(const ConvertArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const Input input = open_input(arguments.input);
  if (!input.recording)
    throw Error(arguments.input.string() + ": holds observations without images; there is nothing to convert");
  const std::string to = layout_for(arguments, input);
  ProgressLine progress(terminal, "convert", to == kArchiveLayout ? "files" : "images");
  const Converted made = to == kBagLayout       ? into_bag(arguments, *input.recording, progress)
                         : to == kArchiveLayout ? into_archive(arguments, input, progress)
                                                : into_folder(arguments, *input.recording, to, progress);
  if (arguments.common.json) {
    const nlohmann::json json = {{"output", arguments.output.string()},
                                 {"layout", to},
                                 {"images", made.images},
                                 {"clouds", made.clouds},
                                 {"notes", made.notes}};
    std::puts(json_text(json).c_str());
    return 0;
  }
  terminal.line(to + "  " + arguments.output.string() + "  " + made.what);
  for (const std::string& note : made.notes) terminal.line(terminal.colored("NOTE", Color::kWarning) + " " + note);
  return 0;
}

}  // namespace rigproof
