#include "clock_check.h"

#include <cmath>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

struct Span {
  double first_s = 0.0, last_s = 0.0;
  bool meets(const Span& other) const { return first_s <= other.last_s && other.first_s <= last_s; }
  std::string text() const { return fixed_text(first_s, 3) + " to " + fixed_text(last_s, 3) + " s"; }
};

Span span_of(const ImageTopic& images) {
  return {seconds(images.images.front().stamp_ns), seconds(images.images.back().stamp_ns)};
}

// Of a camera and of the odometry; null where the bag has none.
struct BothClocks {
  const Clocks* camera = nullptr;
  const Clocks* wheels = nullptr;

  bool known() const { return camera != nullptr && wheels != nullptr; }
};

const Clocks* clocks_of(const BagSurvey& survey, const std::string& topic) {
  const auto found = survey.clocks.find(topic);
  return found == survey.clocks.end() ? nullptr : &found->second;
}

std::string clock_remedy(const BothClocks& clocks, bool log_stamps) {
  const bool logs_meet = clocks.known() && clocks.camera->first_log_ns <= clocks.wheels->last_log_ns &&
                         clocks.wheels->first_log_ns <= clocks.camera->last_log_ns;
  if (log_stamps || !logs_meet) return ": they never meet; are both of one drive?";
  return ": their headers are of different clocks. Both were recorded at the same time: `--stamps log` takes the "
         "times of "
         "recording instead, late by what messages travel, which does no harm while the robot stands; better set the "
         "driver to the computer's clock";
}

// Headers of one clock lag behind the log alike. Empty where they do.
std::string note_of_lag(const std::string& images, const std::string& odometry, const BothClocks& clocks) {
  constexpr double kAlike_s = 0.5;
  if (!clocks.known()) return "";
  const double lag = seconds(clocks.camera->last_log_ns - clocks.camera->last_stamp_ns) -
                     seconds(clocks.wheels->last_log_ns - clocks.wheels->last_stamp_ns);
  if (std::abs(lag) <= kAlike_s) return "";
  return images + ": its headers are " + fixed_text(lag, 2) + " s further behind the time of recording than those of " +
         odometry + "; if their clocks differ, `--stamps log` takes the times of recording";
}

// Stamps that several images have; images lie by stamp.
std::vector<std::int64_t> shared_stamps(const std::vector<StampedPlace>& images) {
  std::vector<std::int64_t> shared;
  for (std::size_t i = 1; i < images.size(); ++i)
    if (images[i].stamp_ns == images[i - 1].stamp_ns && (shared.empty() || shared.back() != images[i].stamp_ns))
      shared.push_back(images[i].stamp_ns);
  return shared;
}

}  // namespace

double seconds(std::int64_t ns) {
  constexpr std::int64_t kNsPerS = 1000000000;
  return static_cast<double>(ns / kNsPerS) + 1e-9 * static_cast<double>(ns % kNsPerS);
}

std::vector<std::string> notes_of_clocks(const BagSurvey& survey, bool log_stamps, const std::string& odometry,
                                         const ImportPlan& plan) {
  std::vector<std::string> notes;
  const std::vector<OdometrySample>& rows = plan.recording.odometry;
  const Span driven{rows.front().stamp_s, rows.back().stamp_s};
  Problems problems;
  for (std::size_t i = 0; i < plan.images.size(); ++i) {
    const std::string& images = plan.images[i]->name;
    const BothClocks clocks{clocks_of(survey, images), clocks_of(survey, odometry)};
    const Span seen = span_of(*plan.images[i]);
    if (!seen.meets(driven))
      problems.add({"", 0, "camera " + plan.report.cameras[i].name, "",
                    images + " has stamps from " + seen.text() + ", " + odometry + " from " + driven.text() +
                        clock_remedy(clocks, log_stamps)});
    else if (const std::string text = log_stamps ? "" : note_of_lag(images, odometry, clocks); !text.empty())
      notes.push_back(text);
  }
  problems.throw_if_any();
  return notes;
}

void check_stamps_differ(const ImportPlan& plan, bool log_stamps) {
  Problems problems;
  for (std::size_t i = 0; i < plan.images.size(); ++i) {
    const std::vector<std::int64_t> shared = shared_stamps(plan.images[i]->images);
    if (shared.empty()) continue;
    problems.add({"", 0, "camera " + plan.report.cameras[i].name, "",
                  plan.images[i]->name + " has different images of one stamp, at " + std::to_string(shared.size()) +
                      " times, the first at " + fixed_text(seconds(shared.front()), 3) + " s: two drivers publish on " +
                      plan.images[i]->name + ". Each camera needs a topic of its own" +
                      (log_stamps ? ""
                                  : "; of a driver that repeats its stamps, `--stamps log` takes the times of "
                                    "recording")});
  }
  problems.throw_if_any();
}

}  // namespace rigproof
