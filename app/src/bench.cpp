// `rigproof bench export`: a case for somebody else's program: in its layout, with what to run on it and checksums. The
// truth lies apart.
#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "generating.h"
#include "json_text.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"
#include "rigproof/study/record/bag_of_recording.h"
#include "rigproof/study/workflow/convert.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/study/workflow/folder_in_making.h"
#include "rigproof/study/workflow/grey_images.h"
#include "rigproof/study/workflow/scratch_folder.h"
#include "rigproof/study/workflow/workflow.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

const std::string kCases = "bench-v1/";

// The run of a case, generated where it is not there yet.
fs::path run_of_case(const BenchExportArguments& arguments, const fs::path& folder, const Terminal& terminal) {
  const std::vector<std::string> known = bench_cases();
  if (std::find(known.begin(), known.end(), arguments.name) == known.end())
    throw Error("case: \"" + for_message(arguments.name) + "\": must be a run's folder or a case; " +
                suggestion(arguments.name, known));
  GenerateArguments generate;
  generate.common = arguments.common;
  generate.config = kCases + arguments.name;
  generate.set = arguments.set;
  generate.cache = arguments.cache;
  generate.device = arguments.device;
  generate.output = folder / "run";
  RunsAhead ahead({{generate, configuration_of(generate)}});
  generate_with_progress(&ahead, 0, terminal);
  return generate.output;
}

// A copy without colour, which is two thirds of the bytes, and which no calibrator looks at.
fs::path in_grey(const Recording& recording, const fs::path& folder, const Terminal& terminal) {
  ProgressLine progress(terminal, "to grey", "files");
  convert(recording, "recording", folder, {});
  make_images_grey(folder, progress.callback());
  progress.erase();
  return folder;
}

std::size_t write_layout(const Recording& recording, const std::string& layout, const fs::path& folder,
                         const std::function<bool(std::size_t, std::size_t)>& progress) {
  if (layout == kBagLayout) {
    BagOptions options;
    options.compressed_images = true;
    options.progress = progress;
    create_folder(folder);
    return write_bag(recording, folder / "recording.mcap", options).images;
  }
  ConvertOptions options;
  options.progress = progress;
  return convert(recording, layout, folder, options).images;
}

// What to run, by the program's own manual, with this rig's numbers in it.
std::string instructions(const Recording& recording, const std::string& layout) {
  std::string text = read_text_file(data_folder() / "config/bench-v1/layouts" / (layout + ".md"));
  const Board& board = recording.rig.board;
  std::vector<std::string> names, focals;
  for (const RigCamera& camera : recording.rig.cameras) {
    names.push_back(camera.name);
    focals.push_back(fixed_text(camera.camera.fx_px, 0));
  }
  const std::map<std::string, std::string> values = {{"{cameras}", joined(names)},
                                                     {"{focals}", joined(focals, ",")},
                                                     {"{corners_x}", std::to_string(board.inner_corners_x())},
                                                     {"{corners_y}", std::to_string(board.inner_corners_y())},
                                                     {"{square_m}", number_text(board.square_m)}};
  for (const auto& [key, value] : values) text = replaced(text, key, value);
  return text;
}

// As `sha256sum -c` reads it. Returns the size of all files.
std::uintmax_t write_sums(const fs::path& folder) {
  std::string sums;
  std::uintmax_t bytes = 0;
  for (const auto& entry : folder_tree(folder)) {
    if (!entry.is_regular_file()) continue;
    sums += sha256_hex_of_file(entry.path()) + "  " + entry.path().lexically_relative(folder).generic_string() + "\n";
    bytes += entry.file_size();
  }
  write_file_atomically_unsynced(folder / "SHA256SUMS", sums);
  return bytes;
}

// One truth for all layouts in a folder. Before these, so that the same command goes on if it cannot be written.
void write_truth(const fs::path& from, const fs::path& to) {
  const std::string truth = read_text_file(from);
  std::error_code ignored;
  if (fs::exists(to, ignored) && read_text_file(to) != truth)
    throw Error(to.string() + ": is the truth of another run; name a new folder");
  write_file_atomically(to, truth);
}

// A folder that only shares a case's name, as what was exported of it may, hides no case.
bool names_a_run(const std::string& name) {
  std::error_code ignored;
  const bool is_case = fs::exists(data_folder() / "config/bench-v1" / (name + ".yaml"), ignored);
  return fs::exists(fs::path(name) / "run.yaml", ignored) || (!is_case && fs::is_directory(name, ignored));
}

}  // namespace

std::vector<std::string> bench_cases() {
  std::vector<std::string> names = list_presets("config", "bench-v1");
  names.erase(std::remove(names.begin(), names.end(), "bench-v1"), names.end());  // the sweep over all
  return names;
}

std::vector<std::string> bench_layouts() { return {"mcalib", "mrcal", "opencv", "euroc", kBagLayout, "colmap"}; }

int bench_export_command(const BenchExportArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const bool is_run = names_a_run(arguments.name);
  const fs::path name = is_run ? fs::absolute(arguments.name).lexically_normal() : fs::path(arguments.name);
  const fs::path folder = arguments.output.empty()
                              ? fs::path("bench") / (name.has_filename() ? name : name.parent_path()).filename()
                              : arguments.output;
  const Input input = open_input(is_run ? name : run_of_case(arguments, folder, terminal));
  if (!input.run || !truth_beside(input)) throw Error(name.string() + ": must be a generated run, with its truth");
  const fs::path output = folder / arguments.to;
  FolderInMaking making(output);
  const fs::path truth = folder / "truth.yaml";
  write_truth(input.run->truth_file(), truth);
  const ScratchFolder scratch("bench-export");
  const Input grey = open_input(in_grey(*input.recording, scratch.path() / "recording", terminal));
  const Recording& recording = *grey.recording;
  ProgressLine progress(terminal, "export", "images");
  const std::size_t images = write_layout(recording, arguments.to, making.path() / "data", progress.callback());
  progress.erase();
  write_file_atomically_unsynced(making.path() / "README.md", instructions(recording, arguments.to));
  const std::uintmax_t bytes = write_sums(making.path());
  making.finish();
  if (arguments.common.json) {
    const nlohmann::json json = {{"output", output.string()},
                                 {"layout", arguments.to},
                                 {"images", images},
                                 {"bytes", bytes},
                                 {"truth", truth.string()}};
    std::puts(json_text(json).c_str());
    return 0;
  }
  terminal.line(arguments.to + "  " + output.string() + "  " + std::to_string(images) + " images  " +
                megabytes(static_cast<double>(bytes)));
  terminal.line("truth      " + truth.string());
  terminal.line("what to run: " + (output / "README.md").string());
  return 0;
}

}  // namespace rigproof
