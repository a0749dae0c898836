#include <algorithm>
#include <map>
#include <set>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/generator/generator_version.h"
#include "rigproof/generator/parameters.h"
#include "rigproof/generator/plan_run.h"
#include "rigproof/sim/world.h"
#include "rigproof/study/sweep/config.h"

namespace rigproof {
namespace {

constexpr std::size_t kMaxTasks = 200000;
constexpr std::size_t kKeyDigits = 16;
// Raised whenever what a key stands for changes.
constexpr const char* kFormat = "rigproof sweep 1 ";

// Sets a field of a block by its dotted path; blocks on the way are made.
void set_field(YamlTree* block, const std::string& path, const YamlTree& value) {
  const std::size_t dot = path.find('.');
  const std::string key = path.substr(0, dot);
  if (!block->is_map()) *block = YamlTree::map();
  const auto same = [&key](const auto& entry) { return entry.first == key; };
  auto entry = std::find_if(block->entries.begin(), block->entries.end(), same);
  if (entry == block->entries.end()) {
    block->set(key, YamlTree::map());
    entry = std::prev(block->entries.end());
  }
  if (dot == std::string::npos)
    entry->second = value;
  else
    set_field(&entry->second, path.substr(dot + 1), value);
}

std::string text_of(const GeometricSweepConfig& config) { return emit_yaml(tree_of(config)); }

// Everything of a run but its odometry, where that is apart, and its name.
GenerateConfig picture_config(const GenerateConfig& config) {
  GenerateConfig pictures = config;
  pictures.name = "pictures";
  if (odometry_is_apart(config)) pictures.odometry = OdometryConfig();
  return pictures;
}

// What rendering depends on, but for the number of stops: the first of more stops stand where those of fewer do.
std::string render_group_of(const GenerateConfig& config) {
  GenerateConfig group = without_sense_keys(config);
  group.poses = GenerateConfig().poses;
  return sha256_hex(resolved_text(group));
}

class Planner {
 public:
  explicit Planner(const SweepConfig& config) : config_(config) {}

  SweepPlan plan() {
    std::size_t count = config_.seeds.size();
    for (const SweepAxis& axis : config_.axes) {
      count *= axis.levels.size();
      if (count > kMaxTasks)
        throw Error(config_.name + ": more than " + std::to_string(kMaxTasks) + " tasks: fewer levels or seeds");
    }
    std::vector<std::size_t> levels(config_.axes.size(), 0);
    do {
      for (const std::int64_t seed : config_.seeds) add_task(levels, seed);
    } while (next(&levels));
    problems_.throw_if_any();
    return std::move(plan_);
  }

 private:
  bool next(std::vector<std::size_t>* levels) const {
    for (std::size_t i = levels->size(); i-- > 0;) {
      if (++(*levels)[i] < config_.axes[i].levels.size()) return true;
      (*levels)[i] = 0;
    }
    return false;
  }

  void add_task(const std::vector<std::size_t>& levels, std::int64_t seed) {
    SweepTask task;
    task.levels = levels;
    task.seed = seed;
    YamlTree run = config_.run, geometric = config_.geometric_block, images;
    set_levels(levels, seed, &run, &geometric, &images);
    Problems problems;
    read_fields_of_block(run, "run", &problems, [&task](FieldVisitor& visitor) { task.config.visit(visitor); });
    task.config.scenes.clear();
    if (config_.seed_fields.empty()) task.seed = task.config.seed;
    task.config.name.clear();
    if (config_.geometric)
      read_fields_of_block(geometric, "geometric", &problems,
                           [&task](FieldVisitor& visitor) { task.geometric.visit(visitor); });
    read_images(images, &task, &problems);
    check_geometric(task, &problems);
    for (const Problem& problem : problems.all())
      if (told_.insert(problem.text()).second) problems_.add(problem);
    if (problems_.empty()) finish_task(std::move(task));
  }

  void set_levels(const std::vector<std::size_t>& levels, std::int64_t seed, YamlTree* run, YamlTree* geometric,
                  YamlTree* images) const {
    for (const std::string& field : config_.seed_fields) set_field(run, field, YamlTree::integer(seed));
    const std::string prefix = "geometric.";
    for (std::size_t i = 0; i < levels.size(); ++i) {
      for (const auto& [field, value] : config_.axes[i].levels[levels[i]].fields) {
        if (field == "images")
          *images = value;
        else if (field.rfind(prefix, 0) == 0)
          set_field(geometric, field.substr(prefix.size()), value);
        else
          set_field(run, field, value);
      }
    }
  }

  static void read_images(const YamlTree& images, SweepTask* task, Problems* problems) {
    if (images.is_null()) return;
    const auto count = read_integer(images, "images", {1, 1e6}, problems);
    if (!count) return;
    task->images = *count;
    if (task->config.viewpoints.planner == "sampled" && *count > task->config.poses)
      problems->add({images.file, images.line, "images", images.shown(),
                     "must be at most the run's poses, " + std::to_string(task->config.poses)});
  }

  // Fields that would have no effect are a slip of whoever varies them.
  void check_geometric(const SweepTask& task, Problems* problems) const {
    if (!config_.geometric) return;
    const GenerateConfig& config = task.config;
    const auto problem = [&](const char* field, const std::string& value, const char* message) {
      problems->add({config_.run.file, config_.run.line, std::string("run.") + field, value, message});
    };
    if (config.motion != "teleport") problem("motion", config.motion, "must be teleport in mode geometric");
    if (task.geometric.rig == "run") return;
    if (config.odometry.model != "per_increment" && config.odometry.model != "per_pose")
      problem("odometry.model", config.odometry.model,
              "must be per_increment or per_pose in mode geometric, unless geometric.rig is run");
    if (!plan_.tasks.empty()) return;
    static const std::set<std::string> effective = {"seed",
                                                    "poses",
                                                    "odometry.model",
                                                    "odometry.lambda",
                                                    "odometry.scale",
                                                    "odometry.yaw_factor",
                                                    "odometry.declared",
                                                    "odometry.seed"};
    for (const SweepAxis& axis : config_.axes)
      for (const SweepLevel& level : axis.levels)
        for (const auto& [field, value] : level.fields)
          if (effective.count(field) == 0 && field != "images" && field.rfind("geometric.", 0) != 0)
            problems->add({value.file, value.line, "axes." + axis.name, field,
                           "has no effect in mode geometric unless geometric.rig is run"});
  }

  const std::string& inputs_of(const GenerateConfig& config) {
    GenerateConfig part;
    part.scene = config.scene;
    part.rig = config.rig;
    part.randomize = config.randomize;
    part.board = config.board;
    part.seed = config.seed;
    std::string& text = inputs_[resolved_text(part)];
    if (text.empty()) text = joined(run_inputs(config), "\n") + "\n";
    return text;
  }

  // A file that the geometric mode takes noise from: another content, another task.
  const std::string& content_of(const std::string& file) {
    std::string& hash = contents_[file];
    if (!file.empty() && hash.empty()) {
      load_observations(file);
      hash = sha256_hex_of_file(file);
    }
    return hash;
  }

  void finish_task(SweepTask task) {
    const bool needs_world = !config_.geometric || task.geometric.rig == "run";
    std::string text = kFormat + std::string(version()) + "\n" + resolved_text(task.config);
    if (needs_world) text += std::string(World::mujoco_version()) + "\n" + inputs_of(task.config);
    if (config_.geometric) text += text_of(task.geometric) + content_of(task.geometric.measured);
    text += "images: " + std::to_string(task.images) + "\n";
    task.key = sha256_hex(text).substr(0, kKeyDigits);
    if (!config_.geometric) task.pictures = add_pictures(task.config);
    plan_.tasks.push_back(std::move(task));
  }

  std::string add_pictures(const GenerateConfig& config) {
    PictureSet set;
    set.config = picture_config(config);
    const std::string text = kFormat + generator_version() + " pictures\n" + resolved_text(set.config) +
                             World::mujoco_version() + "\n" + inputs_of(config);
    set.key = sha256_hex(text).substr(0, 2 * kKeyDigits);
    if (sets_.insert(set.key).second) {
      set.render_group = render_group_of(set.config);
      plan_.pictures.push_back(set);
    }
    return set.key;
  }

  const SweepConfig& config_;
  SweepPlan plan_;
  Problems problems_;
  std::set<std::string> told_;
  std::set<std::string> sets_;
  std::map<std::string, std::string> inputs_;
  std::map<std::string, std::string> contents_;
};

}  // namespace

SweepPlan plan_sweep(const SweepConfig& config) { return Planner(config).plan(); }

}  // namespace rigproof
