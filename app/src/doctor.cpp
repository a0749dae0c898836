// `rigproof doctor`: of this machine, or of a run.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "commands.h"
#include "json_text.h"
#include "observing.h"
#include "print_result.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/version.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/render_device.h"
#include "rigproof/sim/renderer.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/integrity.h"
#include "rigproof/validate/proof.h"
#include "rigproof/words/sentences.h"
#include "terminal.h"

namespace rigproof {
namespace {

/// What rendering one small frame on a device tells.
struct RenderTrial {
  std::string gl_renderer;
  std::string gl_version;
  std::string problem;  ///< empty if it worked
};

RenderTrial try_to_render(int device) {
  RenderTrial trial;
  try {
    const RigModel rig = load_rig_model("husky_3x_d455");
    const SceneModel scene = load_scene_model("indoor_lab");
    const Board board = rig.rig.board;
    const auto world = World::compose(describe_world(rig, scene, board, place_board(board, scene.board.middle()), 0));
    RenderOptions options;
    options.device = device;
    Renderer renderer(*world, options);
    RenderedView view;
    renderer.render(0, &view);
    trial.gl_renderer = renderer.gl_renderer();
    trial.gl_version = renderer.gl_version();
  } catch (const Error& error) {
    trial.problem = error.what();
  }
  return trial;
}

nlohmann::json device_as_json(const RenderDevice& device) {
  return {
      {"device", device.index}, {"name", device.name}, {"drm_file", device.drm_file}, {"software", device.is_software}};
}

int doctor_of_machine(const DoctorArguments& arguments) {
  std::string enumeration_problem;
  const std::vector<RenderDevice> devices = enumerate_render_devices(&enumeration_problem);
  const RenderTrial trial = try_to_render(arguments.device);
  const bool good = trial.problem.empty();
  if (arguments.common.json) {
    nlohmann::json json = {{"mujoco", World::mujoco_version()},
                           {"data", data_folder().string()},
                           {"cores", std::thread::hardware_concurrency()},
                           {"gl_renderer", trial.gl_renderer},
                           {"gl_version", trial.gl_version},
                           {"problem", trial.problem},
                           {"devices", nlohmann::json::array()}};
    for (const RenderDevice& device : devices) json["devices"].push_back(device_as_json(device));
    std::puts(json_text(json).c_str());
    return static_cast<int>(good ? ExitCode::kGood : ExitCode::kBadInput);
  }
  const Terminal terminal(arguments.common.quiet);
  std::vector<std::vector<std::string>> rows = {{"rigproof", version()},
                                                {"MuJoCo", World::mujoco_version()},
                                                {"cores", std::to_string(std::thread::hardware_concurrency())},
                                                {"data", data_folder().string()}};
  for (const RenderDevice& device : devices)
    rows.push_back(
        {"device " + std::to_string(device.index), (device.name.empty() ? std::string("EGL device") : device.name) +
                                                       (device.drm_file.empty() ? "" : "  " + device.drm_file) +
                                                       (device.is_software ? "  software" : "")});
  if (!enumeration_problem.empty()) rows.push_back({"devices", enumeration_problem});
  rows.push_back({"rendering", good ? "works: " + trial.gl_renderer + ", OpenGL " + trial.gl_version : trial.problem});
  // The values are sentences: only the names are padded.
  for (const auto& row : rows)
    terminal.line(row[0] + std::string(row[0].size() < 11 ? 11 - row[0].size() : 1, ' ') + row[1]);
  terminal.line(good ? terminal.colored("GOOD", Color::kGood) : terminal.colored("FAIL", Color::kBad));
  return static_cast<int>(good ? ExitCode::kGood : ExitCode::kBadInput);
}

int doctor_of_run(const DoctorArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const Input input = open_input(arguments.run);
  if (!input.run)
    throw Error(arguments.run.string() + ": is no generated run (it has no run.yaml); doctor checks runs");
  const RunFolder& run = *input.run;
  const IntegrityReport integrity = verify_manifest(run);
  terminal.text(integrity.text());
  const Observations observations = observe_with_progress(input, 0, terminal);
  const Proof proof = prove_run(run, input, observations, words::sentence_of);
  terminal.text(format_proof(proof, words::sentence_of));
  const bool good = integrity.intact() && proof.passed;
  if (arguments.common.json) {
    nlohmann::json json = {{"good", good},
                           {"files", integrity.files},
                           {"integrity_problems", nlohmann::json::array()},
                           {"convention_problems", nlohmann::json::array()},
                           {"convention_findings", json_of(proof.problems)}};
    for (const IntegrityProblem& problem : integrity.problems) json["integrity_problems"].push_back(problem.text());
    for (const Finding& problem : proof.problems) json["convention_problems"].push_back(words::sentence_of(problem));
    std::puts(json_text(json).c_str());
  }
  terminal.line(good ? terminal.colored("GOOD", Color::kGood) : terminal.colored("FAIL", Color::kBad));
  return static_cast<int>(good ? ExitCode::kGood : ExitCode::kGateFailed);
}

}  // namespace

int doctor_command(const DoctorArguments& arguments) {
  return arguments.run.empty() ? doctor_of_machine(arguments) : doctor_of_run(arguments);
}

}  // namespace rigproof
