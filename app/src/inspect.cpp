// `rigproof inspect`.
#include "rigproof/study/report/inspect.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "observing.h"
#include "rigproof/study/workflow/workflow.h"
#include "terminal.h"

namespace rigproof {
namespace {

std::vector<Result> results_to_draw(const InspectArguments& arguments, const Input& input) {
  if (arguments.results.empty()) return load_results(product_folder(input) / "results");
  std::vector<Result> results;
  for (const std::filesystem::path& file : arguments.results) results.push_back(load_result(file));
  return results;
}

}  // namespace

int inspect_command(const InspectArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  InspectInput scene;
  scene.input = open_input(arguments.input);
  const std::filesystem::path folder = product_place(scene.input, arguments.output, "pictures");
  scene.results = results_to_draw(arguments, scene.input);
  scene.truth = truth_beside(scene.input);
  scene.observations = observe_with_progress(scene.input, arguments.common.jobs, terminal);
  const std::vector<std::filesystem::path> files = write_pictures(scene, folder);
  if (arguments.common.json) {
    nlohmann::json json = nlohmann::json::array();
    for (const std::filesystem::path& file : files) json.push_back(file.string());
    std::puts(json_text(json).c_str());
  }
  for (const std::filesystem::path& file : files) terminal.line(file.string());
  return 0;
}

}  // namespace rigproof
