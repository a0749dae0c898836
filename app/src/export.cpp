// `rigproof export`.
#include "rigproof/study/export/export.h"

#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>

#include "export_command.h"
#include "export_told.h"
#include "json_text.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/study/export/into_urdf.h"
#include "rigproof/words/sentences.h"
#include "terminal.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

/// What was made, and where it went.
struct Done {
  std::string to;
  std::vector<WrittenFile> files;
  std::string text;  ///< that went nowhere
  std::vector<ChangedJoint> joints;
  std::vector<std::string> notes;
};

// UTC.
std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  char text[16] = "";
  if (gmtime_r(&now, &parts) != nullptr) std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
  return text;
}

std::vector<std::string> doubts_of(const Result& result) {
  std::vector<Finding> suspects;
  for (const Finding& note : result.notes)
    if (note.severity == Severity::kSuspect) suspects.push_back(note);
  return words::sentences_of(suspects);
}

// Nobody wants what was read to be replaced by what is made of it.
void refuse_inputs(const ExportArguments& arguments, const fs::path& result_file) {
  std::error_code ignored;
  for (const fs::path& input : {result_file, arguments.rig})
    if (!arguments.output.empty() && fs::equivalent(arguments.output, input, ignored))
      throw Error(arguments.output.string() + ": is what is read; name another file");
}

std::string format_name(const ExportArguments& arguments) {
  if (!arguments.into.empty()) {
    if (!arguments.to.empty() && arguments.to != "urdf" && arguments.to != "xacro")
      throw Error("--into: changes URDF and xacro files; leave out --to " + for_message(arguments.to));
    return "urdf";
  }
  if (arguments.to.empty()) throw Error("--to: is missing; one of " + joined(export_format_names()));
  return export_format(arguments.to).name;
}

Done export_into(const ExportArguments& arguments, const ExportJob& job) {
  IntoUrdf into = export_into_urdf(job, read_text_file(arguments.into), arguments.into.string());
  Done done;
  done.to = "urdf";
  done.joints = std::move(into.joints);
  done.notes = std::move(into.notes);
  done.files.push_back(write_with_backup(arguments.output.empty() ? arguments.into : arguments.output, into.text));
  return done;
}

Done export_new(const ExportArguments& arguments, const ExportJob& job, const ExportFormat& format) {
  ExportOutput output = write_export(job, format);
  Done done;
  done.to = format.name;
  done.notes = std::move(output.notes);
  const bool several = output.files.size() > 1;
  if (arguments.output.empty()) {
    if (several) throw Error("--output: is missing; " + format.name + " has a file for each camera, name a folder");
    done.text = output.files.front().text;
  }
  for (const ExportFile& file : output.files)
    if (!arguments.output.empty())
      done.files.push_back(write_with_backup(several ? arguments.output / file.name : arguments.output, file.text));
  return done;
}

nlohmann::json joint_json(const ChangedJoint& joint) {
  return {{"camera", joint.camera},
          {"joint", joint.joint},
          {"line", joint.line},
          {"parent", joint.parent},
          {"child", joint.child},
          {"optical_frame", joint.optical},
          {"before", {{"xyz", joint.xyz_before}, {"rpy", joint.rpy_before}}},
          {"after", {{"xyz", joint.xyz_after}, {"rpy", joint.rpy_after}}},
          {"moved_m", joint.moved_m},
          {"turned_rad", joint.turned_rad},
          {"others", joint.others}};
}

std::string as_json(const ExportJob& job, const Done& done) {
  nlohmann::json json = {{"to", done.to},
                         {"result", job.result_file},
                         {"status", result_status_name(job.status)},
                         {"files", nlohmann::json::array()},
                         {"joints", nlohmann::json::array()},
                         {"remarks", remarks_of(job)},
                         {"notes", done.notes}};
  for (const WrittenFile& written : done.files)
    json["files"].push_back({{"file", written.file.string()},
                             {"backup", written.backup ? nlohmann::json(written.backup->string()) : nlohmann::json()},
                             {"changed", written.changed}});
  for (const ChangedJoint& joint : done.joints) json["joints"].push_back(joint_json(joint));
  if (done.files.empty()) json["text"] = done.text;
  return json_text(json);
}

std::string or_nothing(const std::string& text) { return text.empty() ? "not given" : text; }

void print_joint(const Terminal& terminal, const ChangedJoint& joint) {
  terminal.line("joint " + for_message(joint.joint) + " (line " + std::to_string(joint.line) + ")  " +
                for_message(joint.child) + " in " + for_message(joint.parent) + ", for " + joint.camera + " at " +
                for_message(joint.optical));
  terminal.line(" before  xyz " + for_message(or_nothing(joint.xyz_before)) + "  rpy " +
                for_message(or_nothing(joint.rpy_before)));
  terminal.line(" after   xyz " + joint.xyz_after + "  rpy " + joint.rpy_after);
  terminal.line(" moved   " + short_text(100.0 * joint.moved_m, 3) + " cm, " +
                short_text(rad_to_deg(joint.turned_rad), 3) + " deg" +
                (joint.others.empty() ? "" : "; --joint changes another: " + joined(joint.others)));
}

void print(const Terminal& terminal, const ExportJob& job, const Done& done) {
  for (const ChangedJoint& joint : done.joints) print_joint(terminal, joint);
  std::vector<std::string> notes = remarks_of(job);
  notes.insert(notes.end(), done.notes.begin(), done.notes.end());
  for (const std::string& note : notes) terminal.line(terminal.colored("NOTE", Color::kWarning) + "  " + note);
  for (const WrittenFile& written : done.files)
    terminal.line(done.to + "  " + written.file.string() +
                  (written.backup ? "  (before: " + written.backup->string() + ")" : "") +
                  (written.changed ? "" : "  (as it was)"));
}

// What the command line alone gets wrong, all of it at once.
ExportOptions checked_options(const ExportArguments& arguments, const Result& result) {
  Problems problems;
  ExportOptions options;
  options.cameras = arguments.cameras;
  const auto attempt = [&problems](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      if (error.exit_code() == ExitCode::kTryAgain) throw;
      problems.add({"", 0, "", "", error.what()});
    }
  };
  attempt([&] { format_name(arguments); });
  attempt([&] { options = export_options(arguments, result); });
  attempt([&] { check_export_names(result, options); });
  problems.throw_if_any();
  return options;
}

}  // namespace

int export_command(const ExportArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const fs::path result_file = find_result_file(arguments.result);
  const Result result = load_result(result_file);
  refuse_inputs(arguments, result_file);
  ExportOptions options = checked_options(arguments, result);
  const std::string to = format_name(arguments);
  options.result_file = result_file.string();
  options.date = today();
  options.warnings = doubts_of(result);
  const RigFacts rig = arguments.rig.empty() ? find_rig_facts(result_file) : read_rig_facts(arguments.rig);
  const ExportJob job = prepare_export(result, rig, options);
  const Done done =
      arguments.into.empty() ? export_new(arguments, job, export_format(to)) : export_into(arguments, job);
  if (arguments.common.json)
    std::puts(as_json(job, done).c_str());
  else if (done.files.empty())
    std::fputs(done.text.c_str(), stdout);
  else
    print(terminal, job, done);
  return 0;
}

}  // namespace rigproof
