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

// What is read of files or hashed once for all tasks.
struct Seen {
  std::map<std::string, std::string> inputs;    // by the part of the configuration that names them
  std::map<std::string, std::string> contents;  // hashes of files
};

// The next point, the last axis fastest; false after the last one.
bool next(const SweepConfig& config, std::vector<std::size_t>* levels) {
  for (std::size_t i = levels->size(); i-- > 0;) {
    if (++(*levels)[i] < config.axes[i].levels.size()) return true;
    (*levels)[i] = 0;
  }
  return false;
}

// What a task's fields are read from.
struct TaskBlocks {
  YamlTree run, geometric, images;
};

TaskBlocks blocks_of(const SweepConfig& config, const std::vector<std::size_t>& levels, std::int64_t seed) {
  TaskBlocks blocks{config.run, config.geometric_block, {}};
  for (const std::string& field : config.seed_fields) set_field(&blocks.run, field, YamlTree::integer(seed));
  const std::string prefix = "geometric.";
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (const auto& [field, value] : config.axes[i].levels[levels[i]].fields) {
      if (field == "images")
        blocks.images = value;
      else if (field.rfind(prefix, 0) == 0)
        set_field(&blocks.geometric, field.substr(prefix.size()), value);
      else
        set_field(&blocks.run, field, value);
    }
  }
  return blocks;
}

std::int64_t read_images(const YamlTree& images, const GenerateConfig& run, Problems* problems) {
  if (images.is_null()) return 0;
  const std::int64_t count = read_integer(images, "images", {1, 1e6}, problems).value_or(0);
  if (run.viewpoints.draws() && count > run.poses)
    problems->add({images.file, images.line, "images", images.shown(),
                   "must be at most the run's poses, " + std::to_string(run.poses)});
  return count;
}

// Fields that would have no effect are a slip of whoever varies them.
void check_fields(const SweepConfig& config, Problems* problems) {
  static const std::set<std::string> effective = {"seed",
                                                  "poses",
                                                  "odometry.model",
                                                  "odometry.lambda",
                                                  "odometry.scale",
                                                  "odometry.yaw_factor",
                                                  "odometry.declared",
                                                  "odometry.seed"};
  for (const SweepAxis& axis : config.axes)
    for (const SweepLevel& level : axis.levels)
      for (const auto& [field, value] : level.fields)
        if (effective.count(field) == 0 && field != "images" && field.rfind("geometric.", 0) != 0)
          problems->add({value.file, value.line, "axes." + axis.name, field,
                         "has no effect in mode geometric unless geometric.rig is run"});
}

void check_geometric(const SweepConfig& config, const TaskSettings& task, Problems* problems) {
  if (!config.geometric) return;
  const GenerateConfig& run = task.config;
  const auto problem = [&](const char* field, const std::string& value, const char* message) {
    problems->add({config.run.file, config.run.line, std::string("run.") + field, value, message});
  };
  if (run.motion != "teleport") problem("motion", run.motion, "must be teleport in mode geometric");
  if (task.geometric.rig == "run") return;
  if (!run.more_boards.empty())
    problem("more_boards", std::to_string(run.more_boards.size()),
            "must be none in mode geometric, unless geometric.rig is run: the reference rig has one board");
  if (run.odometry.model != "per_increment" && run.odometry.model != "per_pose")
    problem("odometry.model", run.odometry.model,
            "must be per_increment or per_pose in mode geometric, unless geometric.rig is run");
}

TaskSettings read_settings(const SweepConfig& config, const std::vector<std::size_t>& levels, std::int64_t seed,
                           Problems* problems) {
  TaskSettings settings;
  const TaskBlocks blocks = blocks_of(config, levels, seed);
  read_fields_of_block(blocks.run, "run", problems,
                       [&settings](FieldVisitor& visitor) { settings.config.visit(visitor); });
  settings.config.scenes.clear();
  settings.config.name.clear();
  if (config.geometric)
    read_fields_of_block(blocks.geometric, "geometric", problems,
                         [&settings](FieldVisitor& visitor) { settings.geometric.visit(visitor); });
  settings.images = read_images(blocks.images, settings.config, problems);
  check_geometric(config, settings, problems);
  return settings;
}

const std::string& inputs_of(const GenerateConfig& config, Seen* seen) {
  GenerateConfig part;
  part.scene = config.scene;
  part.rig = config.rig;
  part.randomize = config.randomize;
  part.board = config.board;
  part.more_boards = config.more_boards;
  part.seed = config.seed;
  std::string& text = seen->inputs[resolved_text(part)];
  if (text.empty()) text = joined(run_inputs(config), "\n") + "\n";
  return text;
}

// A file that the geometric mode takes noise from: another content, another task.
const std::string& content_of(const std::string& file, Seen* seen) {
  std::string& hash = seen->contents[file];
  if (!file.empty() && hash.empty()) {
    load_observations(file);
    hash = sha256_hex_of_file(file);
  }
  return hash;
}

std::string key_of(const TaskSettings& task, bool geometric, Seen* seen) {
  const bool needs_world = !geometric || task.geometric.rig == "run";
  std::string text = kFormat + std::string(version()) + "\n" + resolved_text(task.config);
  if (needs_world) text += std::string(World::mujoco_version()) + "\n" + inputs_of(task.config, seen);
  if (geometric) text += text_of(task.geometric) + content_of(task.geometric.measured, seen);
  text += "images: " + std::to_string(task.images) + "\n";
  return sha256_hex(text).substr(0, kKeyDigits);
}

std::string pictures_key_of(const GenerateConfig& config, Seen* seen) {
  const std::string text = kFormat + generator_version() + " pictures\n" + resolved_text(picture_config(config)) +
                           World::mujoco_version() + "\n" + inputs_of(config, seen);
  return sha256_hex(text).substr(0, 2 * kKeyDigits);
}

void give_keys(const SweepConfig& config, const TaskSettings& settings, Seen* seen, SweepTask* task) {
  task->key = key_of(settings, config.geometric, seen);
  if (!config.geometric) task->pictures = pictures_key_of(settings.config, seen);
}

// Calls back with every task, without its keys, and with its settings. Gathers each problem once.
template <typename Take>
void for_each_task(const SweepConfig& config, Problems* problems, const Take& take) {
  std::set<std::string> told;
  std::vector<std::size_t> levels(config.axes.size(), 0);
  bool is_first = true;
  do {
    for (const std::int64_t seed : config.seeds) {
      Problems of_task;
      const TaskSettings settings = read_settings(config, levels, seed, &of_task);
      if (is_first && config.geometric && settings.geometric.rig != "run") check_fields(config, &of_task);
      is_first = false;
      for (const Problem& problem : of_task.all())
        if (told.insert(problem.text()).second) problems->add(problem);
      take(SweepTask{{}, levels, config.seed_fields.empty() ? settings.config.seed : seed, {}}, settings);
    }
  } while (next(config, &levels));
}

void refuse_too_many(const SweepConfig& config) {
  std::size_t count = config.seeds.size();
  for (const SweepAxis& axis : config.axes) {
    count *= axis.levels.size();
    if (count > kMaxTasks)
      throw Error(config.name + ": more than " + std::to_string(kMaxTasks) + " tasks: fewer levels or seeds");
  }
}

}  // namespace

std::vector<SweepTask> plan_sweep(const SweepConfig& config) {
  refuse_too_many(config);
  std::vector<SweepTask> tasks;
  Problems problems;
  Seen seen;
  for_each_task(config, &problems, [&](const SweepTask& task, const TaskSettings& settings) {
    if (!problems.empty()) return;
    tasks.push_back(task);
    give_keys(config, settings, &seen, &tasks.back());
  });
  problems.throw_if_any();
  return tasks;
}

void check_sweep(const SweepConfig& config) {
  refuse_too_many(config);
  SweepConfig one_seed = config;
  one_seed.seeds.resize(1);
  plan_sweep(one_seed);
}

void check_planned(const SweepConfig& config, const std::vector<SweepTask>& tasks) {
  Seen seen;
  for (const SweepTask& task : tasks) {
    SweepTask now;
    give_keys(config, settings_of(config, task), &seen, &now);
    if (now.key != task.key || now.pictures != task.pictures)
      throw Error(config.name + ": task " + task.key +
                  ": was planned with other files or by another program than there are here: the same program and "
                  "the same files must be on every machine; else plan again");
  }
}

TaskSettings settings_of(const SweepConfig& config, const SweepTask& task) {
  Problems problems;
  TaskSettings settings = read_settings(config, task.levels, task.seed, &problems);
  problems.throw_if_any();
  return settings;
}

PictureSet pictures_of(const SweepConfig& config, const SweepTask& task) {
  PictureSet set{task.pictures, picture_config(settings_of(config, task).config), {}};
  set.render_group = render_group_of(set.config);
  return set;
}

}  // namespace rigproof
