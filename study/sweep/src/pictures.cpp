#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <optional>

#include "looking_run.h"
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

GenerateOptions options_of(const PictureSet& set, const PictureWork& work) {
  GenerateOptions options;
  options.output = work.cache->pictures(set.key).root;
  options.jobs = work.jobs;
  options.device = work.device;
  options.cache = work.cache->clean_renders();
  options.progress = [&work](std::size_t done, std::size_t total) {
    work.progress(done, total);
    return work.keep_going();
  };
  return options;
}

ObserveOptions observing(const PictureWork& work) {
  ObserveOptions options;
  options.threads = work.jobs;
  options.progress = [&work](std::size_t, std::size_t) { return work.keep_going(); };
  return options;
}

void count_images(const GenerateReport& report, const PictureWork& work) {
  work.count("images rendered", report.images_rendered - report.images_from_cache);
  work.count("images from clean renders", report.images_from_cache);
}

// Nothing is rendered where `make` fails for the configuration's sake.
bool generate_if_possible(const PictureSet& set, const std::function<void()>& make) {
  try {
    make();
    return true;
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain || can_be_planned(set)) throw;
    return false;
  }
}

void generate_pictures(const PictureSet& set, const PictureWork& work) {
  const GenerateReport report = generate(set.config, options_of(set, work));
  if (!report.complete) throw Error("interrupted", ExitCode::kTryAgain);
  count_images(report, work);
}

void look_at_pictures(const PictureSet& set, const PictureWork& work) {
  const RunFolder run = work.cache->pictures(set.key);
  CachedFindings findings(*work.cache, run);
  try {
    observe(load_recording(run.recording()), observing(work), &findings);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
  }
  findings.tell(work.count);
  findings.rethrow();
}

// Returns false where a board is nowhere to be seen: whoever says why looks at the pictures again.
bool look_without_keeping(const PictureSet& set, const PictureWork& work) {
  const auto generate_set = [&set](const GenerateOptions& options) { return generate(set.config, options); };
  std::map<std::string, std::uint64_t> told;
  const auto tell = [&told](CachedFindings& findings) {
    findings.tell([&told](const std::string& name, std::uint64_t more) { told[name] += more; });
  };
  const LookedRun looked =
      look_while_generating(generate_set, options_of(set, work), *work.cache, observing(work), tell);
  count_images(looked.report, work);
  // What a render process has found, observing finds in the cache.
  const std::uint64_t found = std::min<std::uint64_t>(told["corners from cache"], looked.report.images_rendered);
  told["corners from cache"] -= found;
  told["corners detected"] += found;
  for (const auto& [name, more] : told) work.count(name, more);
  return looked.failure == nullptr;
}

void generate_and_look(const PictureSet& set, bool with_images, const PictureWork& work) {
  if (!with_images && look_without_keeping(set, work)) return;
  generate_pictures(set, work);
  look_at_pictures(set, work);
}

}  // namespace

void make_pictures(const PictureSet& set, bool with_images, const PictureWork& work) {
  const std::optional<FolderLock> lock = wait_for_lock(set, work);
  if (work.cache->is_observed(set.key) && work.cache->has_pictures(set.key, with_images)) {
    work.count("image sets from cache", 1);
    return;
  }
  if (!generate_if_possible(set, [&] { generate_and_look(set, with_images, work); })) return;
  work.cache->mark_used(set.key);
  work.cache->mark_observed(set.key);
}

}  // namespace rigproof
