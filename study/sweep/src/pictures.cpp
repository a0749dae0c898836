#include <chrono>
#include <optional>

#include "rigproof/core/error.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/generator/generate.h"
#include "rigproof/generator/plan_run.h"
#include "work.h"

namespace rigproof {
namespace {

constexpr std::chrono::milliseconds kLockPatience{300};

// Another sweep may be making the same pictures; they will do.
std::optional<FolderLock> wait_for_lock(const PictureSet& set, const PictureWork& work) {
  for (;;) {
    try {
      return std::optional<FolderLock>(std::in_place, work.cache->making_lock(set.key), "in use",
                                       FolderLock::Kind::kAlone, kLockPatience);
    } catch (const FolderInUse&) {
      if (!work.keep_going()) throw;
    }
  }
}

// A configuration that cannot be planned is the configuration's fault; everything else is the machine's.
bool can_be_planned(const PictureSet& set) {
  try {
    plan_run(set.config);
    return true;
  } catch (const Error&) {
    return false;
  }
}

bool generate_pictures(const PictureSet& set, const PictureWork& work) {
  GenerateOptions options;
  options.output = work.cache->pictures(set.key).root;
  options.jobs = work.jobs;
  options.device = work.device;
  options.cache = work.cache->clean_renders();
  options.progress = [&work](std::size_t done, std::size_t total) {
    work.progress(done, total);
    return work.keep_going();
  };
  try {
    const GenerateReport report = generate(set.config, options);
    if (!report.complete) throw Error("interrupted", ExitCode::kTryAgain);
    work.count("images rendered", report.images_rendered - report.images_from_cache);
    work.count("images from clean renders", report.images_from_cache);
    return true;
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain || can_be_planned(set)) throw;
    return false;
  }
}

void look_at_pictures(const PictureSet& set, const PictureWork& work) {
  const RunFolder run = work.cache->pictures(set.key);
  CachedFindings findings(*work.cache, run);
  ObserveOptions options;
  options.threads = work.jobs;
  options.progress = [&work](std::size_t, std::size_t) { return work.keep_going(); };
  try {
    observe(load_recording(run.recording()), options, &findings);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
  }
  findings.tell(work.count);
  findings.rethrow();
}

}  // namespace

void make_pictures(const PictureSet& set, bool with_images, const PictureWork& work) {
  const std::optional<FolderLock> lock = wait_for_lock(set, work);
  if (work.cache->is_observed(set.key) && work.cache->has_pictures(set.key, with_images)) {
    work.count("image sets from cache", 1);
    return;
  }
  if (!generate_pictures(set, work)) return;
  work.cache->mark_used(set.key);
  look_at_pictures(set, work);
  work.cache->mark_observed(set.key);
}

}  // namespace rigproof
