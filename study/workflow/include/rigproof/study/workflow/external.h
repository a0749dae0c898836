// Methods from outside: any executable, run on a copy of what a robot could record, without the truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rigproof/calib/diagnose/method.h"
#include "rigproof/core/fields.h"

namespace rigproof {

/// What a file says that describes a method from outside; docs/guides/external-methods.md has an example.
struct ExternalConfig {
  std::string name;                             ///< as in tables and results/NAME.yaml; empty = the file's name
  std::string summary;                          ///< one sentence for people
  std::vector<std::string> command;             ///< program and arguments, with {input}, {output}, {here}
  std::string input = "recording";              ///< recording | observations | memroc
  std::string output = "result";                ///< result | matrices
  std::string output_file = "result.yaml";      ///< that the program writes; "-" is its standard output
  std::string direction = "robot_from_camera";  ///< of matrices: robot_from_camera | camera_from_robot
  std::vector<std::string> cameras;             ///< in the order of the matrices; empty = the rig's
  bool several_boards = false;                  ///< takes recordings of more than one
  double time_limit_s = 600.0;

  void visit(FieldVisitor& visitor);
};

/// Throws Error with every problem found.
ExternalConfig load_external_config(const std::filesystem::path& file);
std::string external_config_schema();

struct ExternalOptions {
  /// Everything that the program printed goes to NAME.log here; empty = nowhere.
  std::filesystem::path log_folder;
  /// Asked several times a second; false kills the program and throws Error with ExitCode::kTryAgain.
  std::function<bool()> keep_going;
};

/// Before the name of such a file where a method is named.
inline constexpr const char* kExternal = "external:";

/// The program as a method. A command that is missing, crashes, hangs, or prints garbage gives a refused Result with
/// the reason. Its working folder is a temporary one that holds the copy of the input and nothing else; it is removed
/// afterwards. The program is trusted as much as any other that the user starts: this is no sandbox.
/// @param file the description; paths in the command may begin with {here}, its folder
std::shared_ptr<const Method> make_external_method(const std::filesystem::path& file, const ExternalOptions& options);
/// Whether the program broke (missing, crash, time limit, garbage) rather than refusing.
bool program_broke(const Result& result);

/// Before the name of a method that is a function of the Python program that runs.
inline constexpr const char* kPython = "python:";

/// Methods that methods_by_name() knows as kPython and their names while this lives, in this process and in those that
/// it forks. One at a time.
class PythonMethods {
 public:
  /// Throws Error for a name that is another method's.
  explicit PythonMethods(const std::vector<std::shared_ptr<const Method>>& methods);
  ~PythonMethods();
  PythonMethods(const PythonMethods&) = delete;
  PythonMethods& operator=(const PythonMethods&) = delete;
};

/// Whether a name may name a file: letters, digits and these signs, no point in front, less than a hundred of them.
bool is_word(const std::string& text, const std::string& signs = "_-.+");
/// `text` with every `from` replaced.
std::string replaced(std::string text, const std::string& from, const std::string& to);

/// Methods by name, "external:FILE.yaml", "ml:KEY=VALUE,.." and "ml:FILE.yaml" among them; the default method for an
/// empty list. Throws Error that names the nearest for an unknown one, and every problem of a description.
std::vector<std::shared_ptr<const Method>> methods_by_name(const std::vector<std::string>& names,
                                                           const ExternalOptions& options = {});

}  // namespace rigproof
