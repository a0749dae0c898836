// What forks processes: generated runs, and sweeps with Python functions among their methods.
#include <pthread.h>

#include "bindings.h"
#include "python_method.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/generator/generate.h"
#include "rigproof/study/sweep/run_config.h"
#include "rigproof/study/sweep/sweep.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/words/sentences.h"
#include "watch.h"

namespace rigproof::python {
namespace {

// A process that is forked runs Python only if the one that forks it holds Python's lock at that moment.
thread_local bool children_run_python = false;
thread_local PyGILState_STATE state_at_fork;

void before_fork() {
  if (!children_run_python) return;
  state_at_fork = PyGILState_Ensure();
  PyOS_BeforeFork();
}

void after_fork(void (*tell_python)()) {
  if (!children_run_python) return;
  tell_python();
  PyGILState_Release(state_at_fork);
}

class ForkingPython {
 public:
  ForkingPython() {
    static const int registered = pthread_atfork(
        before_fork, [] { after_fork(PyOS_AfterFork_Parent); }, [] { after_fork(PyOS_AfterFork_Child); });
    if (registered != 0) throw Error("pthread_atfork: no memory");
    children_run_python = true;
  }
  ~ForkingPython() { children_run_python = false; }
  ForkingPython(const ForkingPython&) = delete;
  ForkingPython& operator=(const ForkingPython&) = delete;
};

// Of work in this very thread, which it has to be where processes are forked.
class InPlace {
 public:
  explicit InPlace(py::object progress) : progress_(std::move(progress)) {}
  bool keep_going() {
    if (!watch_.keep_going()) return false;
    const py::gil_scoped_acquire acquired;
    raised_ = look_at_python(watch_, progress_);
    if (raised_) watch_.stop();
    return watch_.keep_going();
  }
  bool tell(std::size_t done, std::size_t all) {
    watch_.tell(done, all);
    return keep_going();
  }
  /// With Python's lock.
  void rethrow() {
    if (raised_) throw std::move(*raised_);
  }

 private:
  py::object progress_;
  Watch watch_;
  std::optional<py::error_already_set> raised_;
};

// Work without Python's lock; what Python raised meanwhile goes before what came of it.
template <typename Work>
auto in_place(InPlace* place, const Work& work) {
  try {
    const py::gil_scoped_release released;
    return work();
  } catch (const Error&) {
    place->rethrow();
    throw;
  }
}

py::dict report_of(const GenerateReport& report, const std::filesystem::path& output) {
  py::dict answer;
  answer["run"] = output.string();
  answer["images"] = report.images;
  answer["images_rendered"] = report.images_rendered;
  answer["bytes"] = report.bytes;
  answer["seconds"] = report.seconds;
  return answer;
}

py::dict make_run(const GenerateConfig& config, GenerateOptions options, const py::object& progress) {
  InPlace place(progress);
  options.progress = [&place](std::size_t done, std::size_t all) { return place.tell(done, all); };
  options.on_the_way = [&place](std::size_t, std::size_t) { return place.keep_going(); };
  const GenerateReport report = in_place(&place, [&] { return generate(config, options); });
  place.rethrow();
  return report_of(report, options.output);
}

py::dict generate_run(const std::string& config, const std::filesystem::path& output,
                      const std::vector<std::string>& set, int jobs, const std::filesystem::path& cache, bool fresh,
                      const py::object& progress) {
  const GenerateConfig chosen = run_config(config, set);
  if (!chosen.scenes.empty()) throw Error("scenes: one run at a time; give `scene`");
  GenerateOptions options;
  options.output = output;
  options.jobs = jobs;
  options.cache = cache;
  options.fresh = fresh;
  return make_run(chosen, options, progress);
}

py::dict sense_run(const std::filesystem::path& source, const std::filesystem::path& output,
                   const std::filesystem::path& cache, const std::vector<std::string>& set, int jobs,
                   const py::object& progress) {
  GenerateOptions options;
  options.output = output;
  options.jobs = jobs;
  options.cache = cache;
  options.render = false;
  return make_run(sense_config(source, set), options, progress);
}

// ---------------------------------------------------------------------------------------------------------- sweeps

template <typename Of>
py::array strings_of(const std::vector<SweepRow>& rows, const Of& of) {
  py::list all;
  for (const SweepRow& row : rows) all.append(py::str(of(row)));
  return py::module_::import("numpy").attr("array")(all, py::arg("dtype") = "U");
}

py::array_t<double> figures_of(const std::vector<SweepRow>& rows, AxisFigures SweepRow::*figures) {
  return rows_of(rows, 6, [figures](const SweepRow& row) {
    Eigen::Matrix<double, 1, 6> numbers;
    for (std::size_t i = 0; i < 6; ++i) numbers(static_cast<Eigen::Index>(i)) = (row.*figures)[i].value_or(kNaN);
    return numbers;
  });
}

// Levels of an axis in each row: its labels, and its values where levels are numbers.
void add_axis(const SweepRows& all, std::size_t axis, py::dict* labels, py::dict* values) {
  const std::string& name = all.axes[axis];
  (*labels)[name.c_str()] = strings_of(all.rows, [axis](const SweepRow& row) { return row.levels[axis]; });
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(all.rows.size()));
  for (std::size_t i = 0; i < all.rows.size(); ++i) {
    const auto& known = all.levels[axis];
    const auto at = std::find(known.begin(), known.end(), all.rows[i].levels[axis]) - known.begin();
    numbers(static_cast<Eigen::Index>(i)) = all.level_values[axis].at(static_cast<std::size_t>(at));
  }
  (*values)[name.c_str()] = array_of(numbers);
}

py::dict sweep_rows(const std::filesystem::path& folder) {
  SweepRows all;
  {
    const py::gil_scoped_release released;
    all = load_sweep_rows(folder);
  }
  const std::vector<SweepRow>& rows = all.rows;
  py::dict table, labels, values;
  for (std::size_t axis = 0; axis < all.axes.size(); ++axis) add_axis(all, axis, &labels, &values);
  table["task"] = strings_of(rows, [](const SweepRow& row) { return row.task; });
  table["levels"] = labels;
  table["level_values"] = values;
  table["method"] = strings_of(rows, [](const SweepRow& row) { return row.method; });
  table["subject"] = strings_of(rows, [](const SweepRow& row) { return sweep_subject_name(row.subject); });
  table["camera"] = strings_of(rows, [](const SweepRow& row) { return row.camera; });
  table["status"] = strings_of(rows, [](const SweepRow& row) { return sweep_status_name(row.status); });
  table["code"] = strings_of(rows, [](const SweepRow& row) { return code_of(row.reasons); });
  table["reason"] = strings_of(rows, [](const SweepRow& row) { return words::text_of(row.reasons); });
  table["error_cm_deg"] = figures_of(rows, &SweepRow::error);
  table["sigma_cm_deg"] = figures_of(rows, &SweepRow::sigma);
  table["bound_cm_deg"] = figures_of(rows, &SweepRow::bound);
  py::array_t<std::int64_t> seeds(static_cast<py::ssize_t>(rows.size()));
  Eigen::VectorXd nees(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    seeds.mutable_data()[i] = rows[i].seed;
    nees(static_cast<Eigen::Index>(i)) = rows[i].nees.value_or(kNaN);
  }
  table["seed"] = seeds;
  table["nees"] = array_of(nees);
  return table;
}

py::dict sweep(const std::string& config, const std::filesystem::path& folder, const py::list& methods,
               const std::vector<std::string>& set, int jobs, const std::filesystem::path& cache,
               const std::vector<std::string>& redo, const py::object& progress) {
  const std::filesystem::path file =
      std::filesystem::is_directory(config) ? sweep_config_file(config) : find_data_file("config", config);
  SweepOptions options;
  options.folder = folder;
  options.cache = cache;
  options.jobs = jobs;
  options.redo = redo;
  std::vector<std::shared_ptr<const Method>> functions;
  for (const auto& method : methods) {
    if (py::isinstance<py::str>(method)) {
      options.add.push_back(method.cast<std::string>());
      continue;
    }
    functions.push_back(std::make_shared<PythonMethod>(py::reinterpret_borrow<py::object>(method)));
    options.add.push_back(kPython + functions.back()->traits().name);
  }
  const PythonMethods known(functions);
  const ForkingPython forking;
  InPlace place(progress);
  options.keep_going = [&place] { return place.keep_going(); };
  options.progress = [&place](const SweepProgress& told) {
    place.tell(told.images_done + told.answers_done, told.images + told.answers);
  };
  in_place(&place, [&] { return run_sweep(load_sweep_config(file, set), options); });
  place.rethrow();
  return sweep_rows(folder);
}

}  // namespace

void add_studies(py::module_& module) {
  const std::vector<std::string> none;
  module.def(
      "generate", generate_run, py::arg("config"), py::arg("output"), py::arg("set") = none, py::arg("jobs") = 0,
      py::arg("cache") = "", py::arg("fresh") = false, py::arg("progress") = py::none(),
      "Renders a run, as `rigproof generate`; resumes what was interrupted. config: a file, or a name that ships;\n"
      "set: FIELD=VALUE. Returns run, images, images_rendered, bytes, seconds.");
  module.def(
      "sense", sense_run, py::arg("source"), py::arg("output"), py::arg("cache"), py::arg("set") = none,
      py::arg("jobs") = 0, py::arg("progress") = py::none(),
      "Another noise realisation of a run, or configuration, whose clean renders `cache` holds; nothing is drawn.");
  module.def(
      "sweep", sweep, py::arg("config"), py::arg("folder"), py::arg("methods") = py::list(), py::arg("set") = none,
      py::arg("jobs") = 0, py::arg("cache") = "", py::arg("redo") = none, py::arg("progress") = py::none(),
      "Runs or resumes a sweep in processes that are forked from this one; returns sweep_rows(folder).\n\n"
      "methods: beside those of the configuration; names, or functions that take Observations and return a\n"
      "Result or a dict of poses, called without starting a program. What a function raises is a failed answer.\n"
      "A function whose code has changed answers anew; say `redo` where something else that it uses has. Threads\n"
      "of this process are not in the forked ones.");
  module.def(
      "sweep_rows", sweep_rows, py::arg("folder"),
      "The rows of a sweep, finished or not, as arrays of one length: task, seed, method, subject (rig, camera,\n"
      "pair), camera, status, code, reason, nees; error_cm_deg, sigma_cm_deg, bound_cm_deg (n, 6): tx ty tz [cm],\n"
      "rx ry rz [deg]; levels and level_values: dicts of arrays by axis. NaN where there is no figure.");
}

}  // namespace rigproof::python
