#include "rigproof/study/workflow/external.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "external_matrices.h"
#include "rigproof/calib/diagnose/ml_settings.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/child_process.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/result.h"
#include "rigproof/core/text.h"
#include "rigproof/study/workflow/convert.h"
#include "rigproof/study/workflow/scratch_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxAnswerBytes = 16U << 20U;
constexpr std::uintmax_t kMaxLogBytes = 64U << 20U;
constexpr std::size_t kShownLines = 3;
constexpr double kFarthestM = 1e6;  // as in a result's file

// The beginning of a file that somebody else wrote; empty if there is none.
std::string text_of(const fs::path& file, std::uintmax_t max_bytes) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  if (fs::file_size(file, error) > max_bytes) return "(longer than " + std::to_string(max_bytes >> 20U) + " MB)\n";
  return read_text_file(file, max_bytes);
}

std::vector<std::string> last_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end > at) lines.push_back(for_message(text.substr(at, end - at)));
    at = end + 1;
  }
  if (lines.size() > kShownLines) lines.erase(lines.begin(), lines.end() - kShownLines);
  return lines;
}

/// A reason to refuse, found while looking at what the program left behind.
struct Garbage {
  std::string reason;
};

class ExternalMethod : public Method {
 public:
  ExternalMethod(ExternalConfig config, const fs::path& file, ExternalOptions options)
      : config_(std::move(config)),
        file_(fs::absolute(file)),
        here_(file_.parent_path()),
        options_(std::move(options)) {}

  // By the content of the description and of every file that its command names.
  std::string settings_text() const override {
    std::string text = sha256_hex_of_file(file_);
    for (const std::string& word : config_.command) {
      const fs::path named = here_ / replaced(word, "{here}", here_.string());
      std::error_code ignored;
      if (fs::is_regular_file(named, ignored)) text += " " + sha256_hex_of_file(named);
    }
    return sha256_hex(text);
  }

  MethodTraits traits() const override {
    const std::string what = config_.summary.empty() ? joined(config_.command, " ") : config_.summary;
    MethodTraits traits = {config_.name, what, "as it says; it is given a copy of the " + config_.input, "as it says",
                           config_.input == "observations" ? MethodReads::kObservations : MethodReads::kFiles};
    traits.several_boards = config_.several_boards;
    return traits;
  }

  std::optional<Finding> why_not(const MethodInput& input) const override {
    if (config_.input == "observations" || input.recording != nullptr) return std::nullopt;
    return Finding("method.needs_recording", {{"input", config_.input}});
  }

  Result solve(const Observations& observations) const override { return solve_recording({observations}); }

  Result solve_recording(const MethodInput& input) const override {
    Result result;
    result.method = config_.name;
    const ScratchFolder scratch("external");
    const ProgramReport report = start(input, scratch.path());
    keep_log(scratch.path());
    if (report.interrupted) throw Error("interrupted", ExitCode::kTryAgain);
    if (!report.failure.empty()) {
      result.reasons.push_back(Finding("program.failed", {{"text", report.failure}}));
      for (const std::string& line : last_lines(text_of(scratch.path() / kErrorName, kMaxLogBytes)))
        result.notes.push_back(Finding("program.said", {{"text", line}}));
      return result;
    }
    try {
      result = answer(input.observations, scratch.path());
    } catch (const Garbage& garbage) {
      result.reasons.push_back(Finding("program.bad_answer", {{"text", garbage.reason}}));
    }
    result.method = config_.name;
    return result;
  }

 private:
  static constexpr const char* kOutName = "standard_output.txt";
  static constexpr const char* kErrorName = "standard_error.txt";

  // The program's working folder holds its input and, afterwards, its answer: nothing in it leads to the truth.
  ProgramReport start(const MethodInput& input, const fs::path& scratch) const {
    const fs::path work = scratch / "work";
    create_folder(work);
    const fs::path copy = copy_input(input, work);
    const fs::path output = config_.output_file == "-" ? work / "-" : work / config_.output_file;
    std::vector<std::string> argv;
    for (std::string word : config_.command) {
      word = replaced(word, "{input}", copy.string());
      word = replaced(word, "{output}", output.string());
      argv.push_back(replaced(word, "{here}", here_.string()));
    }
    return run_program(
        {argv, work, scratch / kOutName, scratch / kErrorName, config_.time_limit_s, options_.keep_going});
  }

  fs::path copy_input(const MethodInput& input, const fs::path& work) const {
    ConvertOptions options;
    options.observations = &input.observations;
    if (options_.keep_going) options.progress = [this](std::size_t, std::size_t) { return options_.keep_going(); };
    if (config_.input == "observations") {
      Observations copy = input.observations;
      copy.source.clear();  // names the folder that the truth lies beside
      save_observations(copy, work / "observations.json");
      return work / "observations.json";
    }
    convert(*input.recording, config_.input, work / config_.input, options);
    return work / config_.input;
  }

  void keep_log(const fs::path& scratch) const {
    if (options_.log_folder.empty()) return;
    std::string log;
    for (const char* name : {kOutName, kErrorName}) {
      const std::string text = text_of(scratch / name, kMaxLogBytes);
      if (!text.empty()) log += std::string("--- ") + name + "\n" + text + (text.back() == '\n' ? "" : "\n");
    }
    write_file_atomically(options_.log_folder / (config_.name + ".log"), log);
  }

  fs::path answer_file(const fs::path& scratch) const {
    return config_.output_file == "-" ? scratch / kOutName : scratch / "work" / config_.output_file;
  }

  Result answer(const Observations& observations, const fs::path& scratch) const {
    const fs::path file = answer_file(scratch);
    std::error_code error;
    const std::string name = config_.output_file == "-" ? "its standard output" : config_.output_file;
    if (!fs::is_regular_file(file, error) || fs::is_symlink(file, error))
      throw Garbage{"The program ended well but wrote no " + name + "."};
    if (fs::file_size(file, error) > kMaxAnswerBytes) throw Garbage{"More than 16 MB in " + name + "."};
    Result result =
        config_.output == "matrices" ? result_of_matrices(observations, file, name) : result_of_file(file, name);
    check_frames(observations, &result);
    return result;
  }

  static Result result_of_file(const fs::path& file, const std::string& name) {
    try {
      return load_result(file);
    } catch (const Error& error) {
      const std::string folder = file.parent_path().string() + "/";
      throw Garbage{"What it wrote in " + name + " is no result: " + replaced(error.what(), folder, "")};
    }
  }

  Result result_of_matrices(const Observations& observations, const fs::path& file, const std::string& name) const {
    std::vector<std::string> cameras = config_.cameras;
    if (cameras.empty())
      for (const RigCamera& camera : observations.cameras) cameras.push_back(camera.name);
    const std::vector<Rigid3> matrices = find_matrices(read_text_file(file, kMaxAnswerBytes));
    if (matrices.size() != cameras.size())
      throw Garbage{std::to_string(matrices.size()) + " rigid 4x4 matrices in " + name + " for " +
                    std::to_string(cameras.size()) + " cameras."};
    for (const Rigid3& matrix : matrices)
      if (const double far = matrix.translation.cwiseAbs().maxCoeff(); far > kFarthestM)
        throw Garbage{"A matrix in " + name + " has a translation of " + number_text(far) + " m; allowed are at most " +
                      number_text(kFarthestM) + " m."};
    Result result;
    result.status = ResultStatus::kSolved;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      EstimatedTransform transform;
      transform.parent = observations.robot_frame;
      transform.child = cameras[k];
      transform.T_parent_child = config_.direction == "robot_from_camera" ? matrices[k] : matrices[k].inverse();
      result.camera_to_robot.push_back(transform);
    }
    return result;
  }

  // One name that is no camera is the robot. Anything else that is unknown, or given twice, makes no result.
  static void check_frames(const Observations& observations, Result* result) {
    std::set<std::string> cameras, robots, placed;
    for (const RigCamera& camera : observations.cameras) cameras.insert(camera.name);
    std::set<std::set<std::string>> pairs;
    for (auto* list : {&result->camera_to_robot, &result->camera_to_camera}) {
      for (const EstimatedTransform& transform : *list) {
        const bool parent = cameras.count(transform.parent) > 0, child = cameras.count(transform.child) > 0;
        if (!parent && !child)
          throw Garbage{"Neither " + for_message(transform.parent) + " nor " + for_message(transform.child) +
                        " is a camera of the rig (" + joined({cameras.begin(), cameras.end()}) + ")."};
        if (!pairs.insert({transform.parent, transform.child}).second)
          throw Garbage{"The pose between " + transform.parent + " and " + transform.child + " is given twice."};
        if (parent && child) continue;
        robots.insert(parent ? transform.child : transform.parent);
        placed.insert(parent ? transform.parent : transform.child);
      }
    }
    if (robots.size() > 1)
      throw Garbage{"More than one name is no camera of the rig, so that the robot cannot be told: " +
                    joined({robots.begin(), robots.end()}) + "."};
    if (result->status != ResultStatus::kSolved || placed.empty() || placed.size() == cameras.size()) return;
    result->status = ResultStatus::kPartial;
    for (const std::string& camera : cameras)
      if (placed.count(camera) == 0) result->reasons.push_back(Finding("program.no_pose").of(camera));
  }

  const ExternalConfig config_;
  const fs::path file_;
  const fs::path here_;
  const ExternalOptions options_;
};

}  // namespace

void ExternalConfig::visit(FieldVisitor& visitor) {
  visitor.field("name", name, TextChoices{},
                "Name of the method in tables and of its result's file; default the file's");
  visitor.field("summary", summary, TextChoices{}, "One sentence about the method");
  visitor.field("command", command,
                "The program and its arguments, one an item, no shell between. {input} is the copy of the input, "
                "{output} the file to write, {here} the folder of this description");
  std::vector<std::string> inputs = writable_formats();
  inputs.emplace_back("observations");
  visitor.field("input", input, TextChoices{inputs},
                "What the program is given: observations.json, or a folder as `convert --to` writes it");
  visitor.field("output", output, TextChoices{{"result", "matrices"}},
                "What it writes: a result in YAML or JSON, or text that holds a 4x4 matrix for each camera");
  visitor.field("output_file", output_file, TextChoices{},
                "Name of the file it writes in its working folder; - is its standard output");
  visitor.field("direction", direction, TextChoices{{"robot_from_camera", "camera_from_robot"}},
                "Of matrices: what they map to what; robot_from_camera is the camera's pose in the robot");
  visitor.field("cameras", cameras, "Of matrices: the cameras in their order; default the rig's order");
  visitor.field("several_boards", several_boards, "It can take recordings of more than one board");
  visitor.check(!several_boards || input == "observations" || writable_format(input).several_boards, "several_boards",
                "must be false with input " + input + ", which knows one board");
  visitor.field("time_limit_s", time_limit_s, NumberRange{0.01, 1e6}, "The program is killed after this many seconds");
  visitor.check(!command.empty() && !command.front().empty(), "command", "must name a program");
  visitor.check(name.empty() || is_word(name), "name", "must be letters, digits, _, -, + and .");
  visitor.check(output_file == "-" || is_word(output_file), "output_file", "must be a file's name, or -");
}

ExternalConfig load_external_config(const fs::path& file) {
  ExternalConfig config;
  read_fields(file, [&config](FieldVisitor& visitor) { config.visit(visitor); });
  if (config.name.empty()) config.name = file.stem().string();
  if (!is_word(config.name))
    throw Error(file.string() + ": name: must be letters, digits, _, -, + and .; the file's name is none");
  return config;
}

std::string external_config_schema() { return schema_of<ExternalConfig>("Rigproof external method"); }

bool program_broke(const Result& result) {
  return has_code(result.reasons, "program.failed") || has_code(result.reasons, "program.bad_answer");
}

namespace {

void refuse_our_names(const std::string& name, const std::string& place) {
  for (const Method* method : all_methods())
    if (method->traits().name == name) throw Error(place + ": name: " + name + ": is the name of a method of our own");
}

std::vector<std::shared_ptr<const Method>>& python_methods() {
  static std::vector<std::shared_ptr<const Method>> methods;
  return methods;
}

}  // namespace

std::shared_ptr<const Method> make_external_method(const fs::path& file, const ExternalOptions& options) {
  ExternalConfig config = load_external_config(file);
  refuse_our_names(config.name, file.string());
  return std::make_shared<ExternalMethod>(std::move(config), file, options);
}

namespace {

std::shared_ptr<const Method> make_ml_method(const std::string& settings) {
  auto method = std::make_shared<MlMethod>(read_ml_settings(settings));
  const std::string name = method->traits().name;
  for (const Method* other : all_methods())
    if (other->traits().name == name && other != &ml_method())
      throw Error(kMlPrefix + settings + ": name: " + name + ": is the name of another method");
  return method;
}

std::shared_ptr<const Method> python_method(const std::string& name) {
  for (const auto& method : python_methods())
    if (method->traits().name == name) return method;
  throw Error(kPython + for_message(name) + ": is a function of a Python program, which alone can run it");
}

// Results lie under their method's name.
void refuse_same_names(const std::vector<std::shared_ptr<const Method>>& methods) {
  std::set<std::string> names;
  for (const auto& method : methods)
    if (!names.insert(method->traits().name).second)
      throw Error("two methods of the name " + method->traits().name + "; `name=` gives one with settings another");
}

}  // namespace

PythonMethods::PythonMethods(const std::vector<std::shared_ptr<const Method>>& methods) {
  for (const auto& method : methods) refuse_our_names(method->traits().name, "a Python function");
  refuse_same_names(methods);
  python_methods() = methods;
}

PythonMethods::~PythonMethods() { python_methods().clear(); }

bool is_word(const std::string& text, const std::string& signs) {
  return !text.empty() && text.size() < 100 && text[0] != '.' &&
         std::all_of(text.begin(), text.end(), [&signs](unsigned char c) {
           return std::isalnum(c) != 0 || signs.find(static_cast<char>(c)) != std::string::npos;
         });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::vector<std::shared_ptr<const Method>> methods_by_name(const std::vector<std::string>& names,
                                                           const ExternalOptions& options) {
  const auto keep_nothing = [](const Method*) {};
  std::vector<std::shared_ptr<const Method>> methods;
  const std::string prefix = kExternal;
  for (const std::string& name : names) {
    if (name.rfind(prefix, 0) == 0)
      methods.push_back(make_external_method(name.substr(prefix.size()), options));
    else if (name.rfind(kMlPrefix, 0) == 0)
      methods.push_back(make_ml_method(name.substr(std::string(kMlPrefix).size())));
    else if (name.rfind(kPython, 0) == 0)
      methods.push_back(python_method(name.substr(std::string(kPython).size())));
    else
      methods.emplace_back(&find_method(name), keep_nothing);
  }
  if (methods.empty()) methods.emplace_back(&default_method(), keep_nothing);
  refuse_same_names(methods);
  return methods;
}

}  // namespace rigproof
