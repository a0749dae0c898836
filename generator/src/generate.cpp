#include "rigproof/generator/generate.h"

#include <sched.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include "drive_store.h"
#include "exposures.h"
#include "frame_maker.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/sim/render_device.h"
#include "run_state.h"
#include "scenario.h"
#include "worker_pool.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// How often the caller hears of progress, and can interrupt, at least.
constexpr int kProgressPeriodMs = 100;
// A render process that is silent for this long hangs: a frame takes a fraction of a second, a start a few.
constexpr double kPatienceS = 300.0;

// Bytes a pixel and milliseconds a megapixel on one core, measured in the indoor lab: CPU time of `generate` less that
// of `--dry-run`, with llvmpipe on a shared machine of two cores, three runs each. Clean images took 66 to 76 ms, noisy
// ones 69 to 93; with all that is on by default 2.0 times noisy ones.
constexpr double kColorBytesClean = 1.15, kColorBytesNoisy = 1.5, kColorBytesJpeg = 0.17;  // JPEG of quality 90
constexpr double kDepthBytesClean = 0.3, kDepthBytesNoisy = 0.72;
constexpr double kMillisecondsClean = 70.0, kMillisecondsNoisy = 78.0, kMillisecondsEffects = 155.0;
// Of each further picture of an image that is put together from several: 49 to 54.
constexpr double kMillisecondsPicture = 50.0;
constexpr double kCloudBytes = 12.0;
// The estimate is good to a third; below that the disk decides.
constexpr double kSureShareOfSize = 0.7;

int available_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return std::max(1, CPU_COUNT(&set));
}

double megapixels(const Scenario& scenario, const FrameJob& job) {
  const Camera& camera = scenario.rig.rig.cameras[job.camera].camera;
  return 1e-6 * camera.width_px * camera.height_px;
}

double megapixels(const Scenario& scenario) {
  double sum = 0.0;
  for (const FrameJob& job : scenario.frames) sum += megapixels(scenario, job);
  return sum;
}

double milliseconds_a_megapixel(const Scenario& scenario, const FrameJob& job) {
  if (scenario.config.sensor_noise == "none") return kMillisecondsClean;
  const std::optional<ImageSensing>& image = scenario.sensors[job.camera].image;
  return !image || image->is_noise_alone() ? kMillisecondsNoisy : kMillisecondsEffects;
}

double expected_seconds(const Scenario& scenario, int jobs) {
  double milliseconds = 0.0;
  for (const FrameJob& job : scenario.frames) {
    const auto more = static_cast<double>(pictures_of(scenario, job) - 1);
    milliseconds += megapixels(scenario, job) * (milliseconds_a_megapixel(scenario, job) + more * kMillisecondsPicture);
  }
  // More processes than cores take as long.
  const int processes = jobs > 0 ? std::min(jobs, available_cores()) : available_cores();
  return milliseconds / processes / 1000.0;
}

double expected_mb(const Scenario& scenario) {
  const bool noisy = scenario.config.sensor_noise != "none";
  double bytes = noisy ? kColorBytesNoisy + kDepthBytesNoisy : kColorBytesClean + kDepthBytesClean;
  if (scenario.sensor_images_are_jpeg()) bytes += kColorBytesJpeg - kColorBytesNoisy;
  if (scenario.config.clouds != "none") {
    bytes += kCloudBytes / static_cast<double>(scenario.config.cloud_stride_px * scenario.config.cloud_stride_px);
  }
  return bytes * megapixels(scenario);
}

// What a render process reports of a frame.
struct FrameNews {
  bool rendered = true;  ///< false: its clean render came from the cache
  FileEntries entries;
};

// A line that says whether it was rendered; then one line a file: size, hash, path.
std::string text_of(bool rendered, const FileEntries& entries) {
  std::string text = rendered ? "1\n" : "0\n";
  for (const auto& [path, entry] : entries) {
    text += std::to_string(entry.size_bytes) + " " + entry.sha256 + " " + path + "\n";
  }
  return text;
}

FrameNews news_of(const std::string& text) {
  FrameNews news;
  std::istringstream in(text);
  in >> news.rendered;
  FileEntry entry;
  std::string path;
  while (in >> entry.size_bytes >> entry.sha256 && in.get() == ' ' && std::getline(in, path))
    news.entries[path] = entry;
  return news;
}

// Everything but images: small, quickly made, written anew whenever a generation starts.
FileEntries write_texts(const RunFolder& run, const Scenario& scenario) {
  write_file_atomically(run.config_file(), config_file_text(scenario));
  save_truth(scenario.truth, run.truth_file());
  Recording recording = scenario.recording;
  recording.folder = run.recording();
  save_recording(recording);
  std::vector<std::string> files = {"truth/config.yaml", "truth/truth.yaml", "recording/rig.yaml",
                                    "recording/" + recording.rig.odometry_file};
  if (!scenario.drive_bytes.empty()) {
    write_file_atomically(run.drive_file(), scenario.drive_bytes);
    files.push_back("truth/" + run.drive_file().filename().string());
  }
  for (const RigCamera& camera : recording.rig.cameras) files.push_back("recording/" + camera.folder + "/frames.csv");
  if (!recording.segments.empty()) files.push_back("recording/segments.csv");
  FileEntries entries;
  for (const std::string& file : files) {
    entries[file] = {fs::file_size(run.root / file), sha256_hex_of_file(run.root / file)};
  }
  return entries;
}

// A picture that was looked at is done where looking at it is all that is wanted.
std::vector<std::uint32_t> missing_frames(const Scenario& scenario, const Manifest& manifest,
                                          const GenerateOptions& options) {
  const auto looked_at = [&](const std::string& file) {
    return options.look && manifest.not_kept.count(file) > 0 &&
           options.again.count(fs::path(file).lexically_relative("recording").generic_string()) == 0;
  };
  std::vector<std::uint32_t> missing;
  for (std::size_t frame = 0; frame < scenario.frame_count(); ++frame) {
    const std::vector<std::string> files = files_of_frame(scenario, frame);
    const bool done = std::all_of(files.begin(), files.end(), [&](const std::string& file) {
      return looked_at(file) || manifest.files.find(file) != manifest.files.end();
    });
    if (!done) missing.push_back(static_cast<std::uint32_t>(frame));
  }
  return missing;
}

std::string name_of_job(const Scenario& scenario, std::uint32_t job) {
  return job == WorkerEvent::kNoJob ? "before its first image"
                                    : "while making " + files_of_frame(scenario, job).front();
}

// What a cache holds of some frames, and which drivers drew them.
struct CacheContent {
  std::size_t held = 0;
  std::set<std::string> drivers;
};

CacheContent content_of(const CleanCache& cache, const std::vector<std::string>& keys,
                        const std::vector<std::uint32_t>& frames) {
  CacheContent content;
  for (const std::uint32_t frame : frames) {
    const std::string driver = cache.renderer_of(keys[frame]);
    if (driver.empty()) continue;
    ++content.held;
    content.drivers.insert(driver);
  }
  return content;
}

CacheContent content_of(const std::filesystem::path& cache, const Scenario& scenario) {
  if (cache.empty()) return {};
  std::vector<std::uint32_t> frames(scenario.frame_count());
  std::iota(frames.begin(), frames.end(), 0U);
  return content_of(CleanCache(cache), clean_frame_keys(scenario), frames);
}

bool is_whole(const CacheContent& content, std::size_t frames) {
  return content.held == frames && content.drivers.size() == 1;
}

// Before anything is written.
void require_cached(const Scenario& scenario, const std::filesystem::path& folder) {
  const CacheContent content = content_of(folder, scenario);
  if (is_whole(content, scenario.frame_count())) return;
  throw Error(folder.string() + ": holds " + std::to_string(content.held) + " of " +
              std::to_string(scenario.frame_count()) + " clean renders" +
              (content.drivers.size() > 1 ? ", drawn by " + std::to_string(content.drivers.size()) + " drivers" : "") +
              "; `rigproof generate CONFIG --cache " + folder.string() + "` makes them");
}

// Before anything is written or removed. In a process of its own, for this one is to fork and must not inherit what a
// driver starts.
void require_renderer(int device) {
  const WorkerPool::Prepare open = [device](std::string*) {
    require_render_device(device);
    return [](std::uint32_t) { return std::string(); };
  };
  WorkerPool pool(1, open, kPatienceS);
  pool.submit(0);  // one that has nothing to do may be silent for ever
  std::vector<WorkerEvent> events;
  while (events.empty()) events = pool.wait(kProgressPeriodMs);
  const WorkerEvent& event = events.front();
  if (event.kind == WorkerEvent::Kind::kFailed) throw Error(event.text, event.exit_code);
  if (event.kind == WorkerEvent::Kind::kDied)
    throw Error("a render process " + event.text + " while it opened the render device", ExitCode::kTryAgain);
}

// Of a run that is begun anew; one that goes on is kept as far as it came whatever happens.
void require_renderer_of_new_run(const Scenario& scenario, const RunFolder& run, const GenerateOptions& options) {
  if (!options.fresh && fs::exists(run.manifest_file())) return;
  if (!is_whole(content_of(options.cache, scenario), scenario.frame_count())) require_renderer(options.device);
}

// Hands the missing frames to processes and books what they finish.
class Generation {
 public:
  Generation(const Scenario& scenario, const RunFolder& run, const GenerateOptions& options, ManifestKeeper* keeper)
      : scenario_(scenario), run_(run), options_(options), keeper_(keeper), cache_(options.cache) {
    source_.device = options.device;
    source_.look = options.look;
    if (options.cache.empty()) return;
    source_.cache = &cache_;
    source_.keys = clean_frame_keys(scenario);
  }

  /// Returns false if the caller interrupted.
  bool render(const std::vector<std::uint32_t>& frames) {
    const std::size_t jobs = static_cast<std::size_t>(options_.jobs > 0 ? options_.jobs : available_cores());
    already_done_ = scenario_.frame_count() - frames.size();
    bool go_on = report();
    if (!go_on || frames.empty()) return go_on;
    look_into_cache(frames);
    WorkerPool pool(
        static_cast<int>(std::min(jobs, frames.size())), [this](std::string* greeting) { return prepare(greeting); },
        kPatienceS);
    // Not before: a process that is forked while another thread works may inherit what that thread has locked.
    if (options_.on_started) options_.on_started();
    std::size_t next = 0;
    while (rendered_ < frames.size()) {
      while (go_on && next < frames.size() && pool.wants_job()) pool.submit(frames[next++]);
      if (pool.jobs_in_flight() == 0) break;
      for (const WorkerEvent& event : pool.wait(kProgressPeriodMs)) take(event);
      go_on = report() && go_on;
      keeper_->tick();
    }
    return go_on;
  }

  std::size_t made() const { return rendered_; }
  std::size_t from_cache() const { return from_cache_; }

 private:
  // Without a context where the cache has it all, drawn by one driver.
  void look_into_cache(const std::vector<std::uint32_t>& frames) {
    if (source_.cache == nullptr) return;
    const CacheContent content = content_of(cache_, source_.keys, frames);
    source_.may_render = !is_whole(content, frames.size());
    if (!source_.may_render) take_renderer(*content.drivers.begin());
  }

  // Runs in the render process.
  WorkerPool::Handler prepare(std::string* greeting) const {
    // Mesa's own threads only get into the way of the other processes.
    ::setenv("LP_NUM_THREADS", "1", 1);
    const auto maker = std::make_shared<FrameMaker>(scenario_, run_.root, source_);
    *greeting = maker->gl_renderer();
    return [maker](std::uint32_t frame) {
      const FileEntries entries = maker->make(frame);
      return text_of(maker->rendered(), entries);
    };
  }

  void take(const WorkerEvent& event) {
    switch (event.kind) {
      case WorkerEvent::Kind::kReady:
        return event.text.empty() ? void() : take_renderer(event.text);
      case WorkerEvent::Kind::kDone:
        return take_news(news_of(event.text));
      case WorkerEvent::Kind::kFailed:
        throw Error(event.text, event.exit_code);
      case WorkerEvent::Kind::kDied:
        throw Error("a render process " + event.text + " " + name_of_job(scenario_, event.job) +
                        "; what is finished is kept: the same command goes on from there",
                    ExitCode::kTryAgain);
    }
  }

  void take_news(const FrameNews& news) {
    if (options_.look)
      keeper_->add_not_kept(news.entries);
    else
      keeper_->add(news.entries);
    ++rendered_;
    if (!news.rendered) ++from_cache_;
  }

  void take_renderer(const std::string& gl_renderer) {
    const std::string& known = keeper_->gl_renderer();
    if (!known.empty() && known != gl_renderer) {
      throw Error(run_.root.string() + ": was begun with " + known + ", this is " + gl_renderer +
                  ", whose images differ in single bits; go on where it was begun, or start over with --fresh");
    }
    keeper_->set_gl_renderer(gl_renderer);
    if (options_.on_renderer && !renderer_told_) options_.on_renderer(gl_renderer);
    renderer_told_ = true;
  }

  bool report() const {
    return !options_.progress || options_.progress(already_done_ + rendered_, scenario_.frame_count());
  }

  const Scenario& scenario_;
  RunFolder run_;
  const GenerateOptions& options_;
  ManifestKeeper* keeper_;
  CleanCache cache_;
  FrameSource source_;
  std::size_t already_done_ = 0, rendered_ = 0, from_cache_ = 0;
  bool renderer_told_ = false;
};

GenerateReport make_report(const Scenario& scenario, const Manifest& manifest) {
  GenerateReport report;
  report.images = scenario.frame_count();
  for (const auto& [path, entry] : manifest.files) report.bytes += entry.size_bytes;
  report.complete = manifest.complete;
  report.gl_renderer = manifest.gl_renderer;
  report.coverage = scenario.plan.coverage;
  return report;
}

DriveSource source_of(const GenerateOptions& options) {
  return {options.fresh ? fs::path() : options.output, options.cache, options.on_the_way};
}

// So that other noise realisations need not drive again either.
void keep_drive(const Scenario& scenario, const fs::path& cache) {
  if (cache.empty() || scenario.drive_bytes.empty()) return;
  const fs::path file = drive_in_cache(cache, scenario.drive_key);
  if (!fs::exists(file)) write_file_atomically_unsynced(file, scenario.drive_bytes);
}

// Renders and keeps the manifest; after a failure the manifest still tells what was finished.
GenerateReport render_missing(const Scenario& scenario, const RunFolder& run, const GenerateOptions& options,
                              const std::vector<std::uint32_t>& missing, ManifestKeeper* keeper) {
  Generation generation(scenario, run, options, keeper);
  try {
    const bool all = generation.render(missing);
    keeper->finish(all);
  } catch (...) {
    try {
      keeper->finish(false);
    } catch (const Error&) {
      // The first failure is the one to tell; often this one has the same cause, such as a full disk.
    }
    throw;
  }
  GenerateReport report = make_report(scenario, keeper->manifest());
  report.images_rendered = generation.made();
  report.images_from_cache = generation.from_cache();
  return report;
}

}  // namespace

GeneratePlan plan_generation(const GenerateConfig& config, const GenerateOptions& options) {
  const auto start = Clock::now();
  const Scenario scenario = resolve_scenario(config, source_of(options));
  const double preparing_s = std::chrono::duration<double>(Clock::now() - start).count();
  GeneratePlan plan;
  plan.stops = scenario.stop_count();
  plan.images = scenario.frame_count();
  plan.expected_mb = expected_mb(scenario);
  for (const FrameJob& job : scenario.frames) plan.pictures += pictures_of(scenario, job);
  plan.expected_minutes = (preparing_s + expected_seconds(scenario, options.jobs)) / 60.0;
  plan.coverage = scenario.plan.coverage;
  plan.cameras = scenario.coverage;
  ComposedViewpointWorld world(*scenario.world);
  plan.possible = possible_coverage(config.viewpoints, scenario.subject, world, scenario.viewpoint_poses());
  plan.viewpoints = scenario.stop_count() - scenario.plan.straight;
  return plan;
}

std::shared_ptr<const Scenario> prepare_generation(const GenerateConfig& config, const GenerateOptions& options) {
  return std::make_shared<const Scenario>(resolve_scenario(config, source_of(options)));
}

GenerateReport generate(const GenerateConfig& config, const GenerateOptions& options) {
  const auto start = Clock::now();
  GenerateReport report = generate(*prepare_generation(config, options), options);
  report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return report;
}

GenerateReport generate(const Scenario& scenario, const GenerateOptions& options) {
  const auto start = Clock::now();
  const RunFolder run{options.output};
  if (options.render)
    require_renderer_of_new_run(scenario, run, options);
  else
    require_cached(scenario, options.cache);
  const FolderLock lock(run.root, "another rigproof generates into this folder");
  Manifest manifest = open_run(run, scenario, options.fresh);
  const std::size_t files_known = manifest.files.size();
  drop_damaged(run, &manifest);
  const std::vector<std::uint32_t> missing = missing_frames(scenario, manifest, options);
  const bool has_texts = fs::exists(run.recording()) || fs::exists(run.observations_file());
  if (manifest.complete && missing.empty() && manifest.files.size() == files_known && has_texts) {
    if (options.progress) options.progress(scenario.frame_count(), scenario.frame_count());
    return make_report(scenario, manifest);
  }
  remove_temporary_files(run.root);
  const double share = static_cast<double>(missing.size()) / static_cast<double>(scenario.frame_count());
  if (!options.look) require_disk_space(run.root, 1e6 * expected_mb(scenario) * share, kSureShareOfSize);
  manifest.complete = false;
  save_manifest(manifest, run.manifest_file());
  ManifestKeeper keeper(run, std::move(manifest));
  keeper.add(write_texts(run, scenario));
  keep_drive(scenario, options.cache);
  GenerateReport report = render_missing(scenario, run, options, missing, &keeper);
  report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return report;
}

}  // namespace rigproof
