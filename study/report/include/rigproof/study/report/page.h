// The report: a run, a recording and what calibration made of it, a rig over time, or a sweep, as one HTML file that a
// browser opens without a network.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/study/report/inspect.h"
#include "rigproof/study/sweep/rows.h"
#include "rigproof/validate/budget.h"

namespace rigproof {

struct PageOptions {
  std::string method;                ///< shown first; empty = `ml`, or else the first result
  Budget budget = default_budget();  ///< that the errors are judged by, where there is truth
  int threads = 0;                   ///< that read images; 0 = one a core
  std::size_t max_frames = 3000;     ///< of more, so many spread over the drive are listed
  std::size_t max_images = 400;      ///< of these, so many are shown
  /// (images done, all); returns false to interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress = {};
};

/// What a report holds, as JSON texts: `data` all but the pictures, `images` a list with the two pictures of each of
/// data.frames (the image made small, and the board cut out of it; JPEG in base 64) and where in it the ground was
/// found, or null.
struct PageContent {
  std::string title;
  std::string data;
  std::string images;
};

/// Gathers it. A number that is not finite is null; text that is no UTF-8 is replaced. Missing pieces (truth, images,
/// poses that were refused) are null or empty. Throws Error if there is no result, or none of the method.
PageContent page_content(const InspectInput& input, const PageOptions& options = {});

/// The same of a sweep, finished or not: a row for each answer about a camera or a pair, errors to three significant
/// digits, and why answers failed. Throws Error if nothing has been answered.
PageContent sweep_page_content(const SweepRows& rows);

/// One of several recordings of a rig, and what calibration made of it.
struct HistoryEntry {
  std::string name;  ///< of its folder, or its path
  Observations observations;
  Result result;
};
/// A rig over time: each recording against the first result and against the one before, as `moved` judges it. In the
/// order of the images' stamps where those of all are dates (after the year 2000), else as given. Throws Error if there
/// are fewer than two, or if the first result states no uncertainty or has none of another recording's cameras.
PageContent history_page_content(std::vector<HistoryEntry> entries);

/// The page. Nothing in `content` can end the elements that it is placed in, or be run.
std::string page_html(const PageContent& content);

/// Gathered and placed into a file that appears whole or not at all. Throws Error.
void write_page(const InspectInput& input, const std::filesystem::path& file, const PageOptions& options = {});

}  // namespace rigproof
