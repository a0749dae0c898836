#include "rigproof/study/sweep/observed_run.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <variant>

#include "looking_run.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/error.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/core/folders.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Works in the render processes. The recording is read there as observe() will read it: text rounds.
std::function<void(const FramePictures&)> looking(const SweepCache& cache, const RunFolder& run) {
  const auto recording = std::make_shared<std::optional<Recording>>();
  return [cache, run, recording](const FramePictures& pictures) {
    if (!*recording) *recording = load_recording(run.recording());
    if ((*recording)->in_segment(pictures.files)) return;
    CachedFindings findings(cache, pictures.sha256);
    const std::vector<std::uint8_t> jpeg(pictures.color_jpeg.begin(), pictures.color_jpeg.end());
    const Image8 decoded = jpeg.empty() ? Image8() : std::get<Image8>(decode_grey_image(jpeg));
    look_at(**recording, {pictures.files, pictures.camera, jpeg.empty() ? pictures.color : decoded, pictures.depth},
            &findings);
    findings.rethrow();
  };
}

bool is_image(const std::pair<const std::string, FileEntry>& file) {
  return file.first.find("/color/") != std::string::npos;
}

void refuse_pictures(const RunFolder& run, const GenerateOptions& options) {
  if (options.fresh || !fs::exists(run.manifest_file())) return;
  const Manifest manifest = load_manifest(run.manifest_file());
  if (std::any_of(manifest.files.begin(), manifest.files.end(), is_image))
    throw Error(run.root.string() +
                ": holds a run with its pictures, which `rigproof observe` looks at; choose another folder, or start "
                "over with --fresh");
}

bool is_of_recording(const std::pair<const std::string, FileEntry>& file) {
  return file.first.rfind("recording/", 0) == 0;
}

// Observed to the end; what it was observed in may still lie there.
bool is_observed(const RunFolder& run) {
  if (!fs::exists(run.observations_file()) || !fs::exists(run.manifest_file())) return false;
  const Manifest manifest = load_manifest(run.manifest_file());
  return manifest.complete && std::none_of(manifest.files.begin(), manifest.files.end(), is_of_recording);
}

void remove_observed(const RunFolder& run, const SweepCache& cache) {
  const FolderLock lock(run.root, "another rigproof generates into this folder");
  remove_tree(run.recording());
  remove_tree(cache.findings());
}

// The manifest tells that it is observed before anything is removed: whatever ends that, the next start goes on.
void keep_only(const Observations& observations, const RunFolder& run) {
  const FolderLock lock(run.root, "another rigproof generates into this folder");
  save_observations(observations, run.observations_file());
  Manifest manifest = load_manifest(run.manifest_file());
  for (auto file = manifest.files.begin(); file != manifest.files.end();)
    file = is_of_recording(*file) ? manifest.files.erase(file) : std::next(file);
  save_manifest(manifest, run.manifest_file());
}

}  // namespace

LookedRun look_while_generating(const std::function<GenerateReport(const GenerateOptions&)>& generate,
                                GenerateOptions options, const SweepCache& cache, const ObserveOptions& observing,
                                const std::function<void(CachedFindings&)>& tell) {
  const RunFolder run{options.output};
  options.look = looking(cache, run);
  LookedRun looked;
  for (;;) {
    const std::size_t before = looked.report.images_rendered;
    looked.report = generate(options);
    if (!looked.report.complete)
      throw Error("interrupted; the same command resumes " + run.root.string(), ExitCode::kTryAgain);
    looked.report.images_rendered += before;
    CachedFindings findings(cache, run);
    try {
      looked.observations = observe(load_recording_of(run), observing, &findings);
      looked.failure = nullptr;
    } catch (const Error& error) {
      if (error.exit_code() == ExitCode::kTryAgain) throw;
      looked.failure = std::current_exception();
    }
    findings.rethrow();
    const bool is_second = !options.again.empty();
    if (findings.unanswered().empty() || is_second) {
      tell(findings);
      return looked;
    }
    options.again = findings.unanswered();
    options.fresh = false;
  }
}

ObservedRun generate_observed(const Scenario& scenario, const GenerateOptions& options) {
  const RunFolder run{options.output};
  refuse_pictures(run, options);
  const SweepCache cache(run.root);
  const auto make = [&scenario](const GenerateOptions& how) { return generate(scenario, how); };
  if (!options.fresh && is_observed(run)) {
    remove_observed(run, cache);
    GenerateOptions looking_only = options;
    looking_only.look = looking(cache, run);
    const GenerateReport report = make(looking_only);
    if (!fs::exists(run.recording())) return {report, load_observations(run.observations_file())};
  }
  ObserveOptions observing;
  observing.threads = options.jobs;
  if (options.progress)
    observing.progress = [&options](std::size_t, std::size_t all) { return options.progress(all, all); };
  LookedRun looked = look_while_generating(make, options, cache, observing, [](CachedFindings&) {});
  if (looked.failure) std::rethrow_exception(looked.failure);
  keep_only(looked.observations, run);
  remove_observed(run, cache);
  return {std::move(looked.report), std::move(looked.observations)};
}

}  // namespace rigproof
