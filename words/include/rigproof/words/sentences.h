// Findings as people read them. The only place where they are turned into sentences.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof::words {

/// "left: z unobservable: no ground seen; add depth images that show the floor".
std::string sentence_of(const Finding& finding);

/// Without what differs from frame to frame: "blurred" for "blurred (edges 4.1 px wide)".
std::string short_of(const Finding& finding);

/// One after the other, without repetition. What holds for several cameras is said once, for `all_cameras` as "all
/// cameras: .."; alternative causes are one sentence.
std::vector<std::string> sentences_of(const std::vector<Finding>& findings,
                                      const std::vector<std::string>& all_cameras = {});

/// The same as one text.
std::string text_of(const std::vector<Finding>& findings);

/// Frames that were left out for one reason.
struct ReasonGroup {
  std::string reason;
  std::vector<int> stops;
};

/// The most frequent reason first; what differs from frame to frame is said only where it is the same for all.
std::vector<ReasonGroup> by_reason(const std::vector<Exclusion>& left_out);

/// what(), in words where the error is a finding.
std::string message_of(const std::exception& error);

}  // namespace rigproof::words
