#include "rigproof/study/import/record_check.h"

#include <algorithm>
#include <bitset>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include "board_coverage.h"
#include "picture_source.h"
#include "record_advice.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/calib/vision/parallel.h"
#include "rigproof/calib/vision/sharpness.h"
#include "rigproof/core/error.h"
#include "rigproof/core/exclusions.h"
#include "rigproof/core/image_cell.h"
#include "rigproof/core/median.h"
#include "rigproof/core/text.h"
#include "rigproof/study/workflow/scratch_folder.h"

namespace rigproof {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kBlurred_px = 3.0;  // a sharp edge has 1 to 2

// For the board of which it shows the most corners.
PictureCheck checked(const Image8& grey, const std::vector<Board>& boards) {
  PictureCheck check;
  check.why_not = Finding("board.not_found");
  std::vector<CornerObservation> corners;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    CheckerboardOptions options;
    for (const Board& other : boards)
      if (&other != &boards[b]) options.others.push_back(other);
    const BoardDetection found = detect_board(grey, boards[b], options);
    const auto* seen = std::get_if<std::vector<CornerObservation>>(&found);
    if (seen == nullptr && b == 0) check.why_not = std::get<BoardNotFound>(found).why;
    if (seen == nullptr || seen->size() <= corners.size()) continue;
    corners = *seen;
    check.which = static_cast<int>(b);
  }
  check.board = !corners.empty();
  if (check.board) check.why_not.reset();
  if (check.board) check.edge_px = edge_width_px(grey, boards[static_cast<std::size_t>(check.which)], corners);
  for (const CornerObservation& corner : corners) check.corners.push_back(corner.pixel);
  const Exposure exposure = exposure_of(grey, corners);
  check.overexposed = exposure == Exposure::kOver;
  check.underexposed = exposure == Exposure::kUnder;
  return check;
}

PictureCheck unreadable(const std::string& reason) {
  PictureCheck check;
  check.why_not = Finding("image.unreadable", {{"text", reason}});
  return check;
}

bool is_blurred(const PictureCheck& picture) {
  return picture.edge_px.value_or(0.0) > kBlurred_px || (picture.why_not && picture.why_not->is("board.blurred"));
}

CameraCheck told(const RigCamera& camera, std::size_t index, const RecordCheck& check) {
  CameraCheck told;
  told.name = camera.name;
  std::bitset<kImageCells> cells;
  std::vector<double> edges;
  std::vector<Finding> left_out;
  for (const auto& stop : check.pictures) {
    if (!stop[index]) continue;
    const PictureCheck& picture = *stop[index];
    ++told.stops;
    told.board_stops += picture.board;
    told.blurred += is_blurred(picture);
    told.overexposed += picture.overexposed;
    told.underexposed += picture.underexposed;
    told.unreadable += picture.why_not && picture.why_not->is("image.unreadable");
    if (picture.why_not) left_out.push_back(*picture.why_not);
    if (picture.edge_px) edges.push_back(*picture.edge_px);
    for (const Eigen::Vector2d& corner : picture.corners) cells.set(image_cell(camera.camera, corner));
  }
  told.cells = cells.count();
  told.left_out = counted(left_out);
  if (!edges.empty()) told.edge_px = median(std::move(edges));
  return told;
}

std::vector<PairCheck> pairs_of(const RecordCheck& check) {
  std::vector<PairCheck> pairs;
  for (std::size_t a = 0; a < check.cameras.size(); ++a)
    for (std::size_t b = a + 1; b < check.cameras.size(); ++b) {
      PairCheck pair{check.cameras[a].name, check.cameras[b].name};
      for (const auto& stop : check.pictures)
        pair.stops += stop[a] && stop[b] && stop[a]->board && stop[b]->board && stop[a]->which == stop[b]->which;
      pairs.push_back(pair);
    }
  return pairs;
}

}  // namespace

class RecordWatch::Impl {
 public:
  explicit Impl(RecordCheckOptions options)
      : options_(std::move(options)),
        scratch_("record-check"),
        source_(open_pictures(options_.source, options_.growing, scratch_.path() / "lists")),
        boards_(options_.source.board ? std::vector<Board>{*options_.source.board} : std::vector<Board>()),
        named_(!boards_.empty()) {}

  RecordCheck look() {
    const Recording recording = source_->choose();
    if (boards_.empty() && source_->knows_board())
      for (int b = 0; b < recording.rig.boards(); ++b) boards_.push_back(recording.rig.board_at(b));
    named_ = named_ || source_->knows_board();
    guessing_ = !named_;
    const std::vector<detection::PlannedStop> stops = detection::plan_stops(recording, {}).stops;
    waiting_ = 0;
    see(recording, stops);
    return told_of(recording, stops);
  }

 private:
  using Key = std::pair<std::string, double>;  // camera, stamp

  Key key_of(const Recording& recording, const PictureSource::Place& place) const {
    return {recording.rig.cameras[place.first].name, recording.frames[place.first][place.second].stamp_s};
  }

  // What has not been looked at yet.
  void see(const Recording& recording, const std::vector<detection::PlannedStop>& stops) {
    std::vector<PictureSource::Place> wanted;
    for (const detection::PlannedStop& stop : stops)
      for (std::size_t camera = 0; camera < stop.frames.size(); ++camera) {
        if (stop.frames[camera].empty()) continue;
        const PictureSource::Place place(camera, static_cast<std::size_t>(stop.frames[camera].front()));
        if (seen_.count(key_of(recording, place)) == 0) wanted.push_back(place);
      }
    done_ = 0;
    batch_.clear();  // of a look that was broken off
    source_->read(wanted, [&](const PictureSource::Place& place, PictureSource::Picture picture) {
      // Where the board is not known it is guessed from one picture after the other.
      batch_.push_back({place, std::move(picture)});
      if (batch_.size() >= (may_guess() ? 1 : most_at_once())) look_at_batch(recording, wanted.size());
    });
    look_at_batch(recording, wanted.size());
    if (!guessing_) return;
    guessing_ = false;  // each picture counts once
    std::vector<Board> guessed = guess_.boards();
    if (guessed == boards_) return;
    boards_ = std::move(guessed);
    seen_.clear();  // looked for other boards, or none
    see(recording, stops);
  }

  struct Waiting {
    PictureSource::Place place;
    PictureSource::Picture picture;
  };
  // What is held in memory: a few for each thread.
  std::size_t most_at_once() const {
    const int threads = options_.source.threads;
    return 4 * std::max<std::size_t>(
                   1, threads > 0 ? static_cast<std::size_t>(threads) : std::thread::hardware_concurrency());
  }

  void look_at_batch(const Recording& recording, std::size_t of) {
    const std::vector<Waiting> batch = std::exchange(batch_, {});
    std::vector<std::variant<PictureCheck, Unreadable>> results(batch.size());
    if (may_guess())
      for (const Waiting& waiting : batch) guess(recording, waiting);
    const auto look = [&](std::size_t i) { results[i] = looked_at(recording, batch[i]); };
    const auto proceed = [&](std::size_t) { return !options_.progress || options_.progress(done_++, of); };
    if (!detection::for_each_parallel(batch.size(), options_.source.threads, look, proceed))
      throw Error("interrupted", ExitCode::kTryAgain);
    for (std::size_t i = 0; i < batch.size(); ++i) keep(key_of(recording, batch[i].place), std::move(results[i]));
  }

  // Pictures looked at, each up to a second. Beside a board with markers may be others; a plain one is the only one.
  bool may_guess() const {
    constexpr int kMost = 24, kEnoughOfPlain = 8;
    if (!guessing_ || guesses_ >= kMost) return false;
    return guess_.images() < kEnoughOfPlain || guess_.boards().front().type != "checkerboard";
  }

  static bool fits(const Recording& recording, const PictureSource::Place& place,
                   const std::variant<Image8, Unreadable>& image) {
    const Camera& lens = recording.rig.cameras[place.first].camera;
    const auto* grey = std::get_if<Image8>(&image);
    return grey != nullptr && grey->width == lens.width_px && grey->height == lens.height_px;
  }

  std::variant<PictureCheck, Unreadable> looked_at(const Recording& recording, const Waiting& waiting) const {
    std::variant<Image8, Unreadable> image = waiting.picture();
    if (fits(recording, waiting.place, image)) return checked(std::get<Image8>(image), boards_);
    if (auto* why = std::get_if<Unreadable>(&image)) return std::move(*why);
    return Unreadable{"it has another size than its intrinsics"};
  }

  void keep(const Key& key, std::variant<PictureCheck, Unreadable> result) {
    if (auto* check = std::get_if<PictureCheck>(&result))
      seen_[key] = std::move(*check);
    else if (is_given_up(key))
      seen_[key] = unreadable(std::get<Unreadable>(result).reason);
    else
      ++waiting_;
  }

  // What is being written cannot be read for a while.
  bool is_given_up(const Key& key) {
    constexpr std::chrono::seconds kPatience(5);
    if (!options_.growing) return true;
    return Clock::now() - first_failed_.try_emplace(key, Clock::now()).first->second > kPatience;
  }

  void guess(const Recording& recording, const Waiting& waiting) {
    const std::variant<Image8, Unreadable> image = waiting.picture();
    if (!fits(recording, waiting.place, image)) return;
    ++guesses_;
    if (const std::optional<Board> board = any_board(std::get<Image8>(image))) guess_.add(*board);
  }

  RecordCheck told_of(const Recording& recording, const std::vector<detection::PlannedStop>& stops) const {
    RecordCheck check;
    check.stops = stops.size();
    check.waiting = waiting_;
    check.duration_s = stops.back().stop.stamp_s - stops.front().stop.stamp_s;
    check.board_guessed = !named_ && !boards_.empty();
    for (const Board& board : boards_)
      check.board += (check.board.empty() ? "" : ", ") + board.type + " " + std::to_string(board.squares_x) + "x" +
                     std::to_string(board.squares_y);
    for (const detection::PlannedStop& stop : stops) {
      check.pictures.emplace_back(stop.frames.size());
      for (std::size_t camera = 0; camera < stop.frames.size(); ++camera) {
        if (stop.frames[camera].empty()) continue;
        const auto found =
            seen_.find(key_of(recording, {camera, static_cast<std::size_t>(stop.frames[camera].front())}));
        if (found != seen_.end()) check.pictures.back()[camera] = found->second;
      }
    }
    for (std::size_t camera = 0; camera < recording.rig.cameras.size(); ++camera)
      check.cameras.push_back(told(recording.rig.cameras[camera], camera, check));
    check.pairs = pairs_of(check);
    if (!boards_.empty()) check.next = advice_for(recording.rig.cameras, stops, check, boards_.front());
    return check;
  }

  RecordCheckOptions options_;
  ScratchFolder scratch_;
  std::unique_ptr<PictureSource> source_;
  std::vector<Board> boards_;  // none: not known; one that is named for this check, or was guessed, or the recording's
  bool named_ = false;         // not guessed
  bool guessing_ = false;      // from the pictures of this look
  BoardGuess guess_;
  int guesses_ = 0;
  std::size_t waiting_ = 0;
  std::size_t done_ = 0;
  std::vector<Waiting> batch_;
  std::map<Key, PictureCheck> seen_;
  std::map<Key, Clock::time_point> first_failed_;
};

RecordWatch::RecordWatch(RecordCheckOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
RecordWatch::~RecordWatch() = default;
RecordCheck RecordWatch::look() { return impl_->look(); }

}  // namespace rigproof
