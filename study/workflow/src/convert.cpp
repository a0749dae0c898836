#include "rigproof/study/workflow/convert.h"

#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/calib/vision/stops.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/study/workflow/folder_in_making.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

void step(const ConvertOptions& options, std::size_t done, std::size_t total) {
  if (options.progress && !options.progress(done, total)) throw Error("interrupted", ExitCode::kTryAgain);
}

template <typename Value, typename Read>
Value read_or_throw(const Recording& recording, const std::string& name, const Read& read) {
  auto value = read(path_inside(recording.folder, name));
  if (const auto* failure = std::get_if<Unreadable>(&value)) throw Error(name + ": " + failure->reason);
  return std::get<Value>(std::move(value));
}

std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& all, int most) {
  const std::size_t stride = all.size() / static_cast<std::size_t>(most) + 1;
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < all.size(); i += stride) points.push_back(all[i]);
  return points;
}

std::vector<Eigen::Vector3f> points_of(const Recording& recording, const RigCamera& camera, const CameraFrame& frame,
                                       int most) {
  if (!frame.cloud_file.empty())
    return thinned(read_or_throw<std::vector<Eigen::Vector3f>>(recording, frame.cloud_file, read_point_cloud), most);
  const auto image = read_or_throw<Image16>(recording, frame.depth_file, read_depth_image);
  return sampled_depth(image, camera, most).points;
}

void add_stops(const Recording& recording, WriteJob* job) {
  const detection::StopPlan plan = detection::plan_stops(recording, ObserveOptions());
  for (const detection::PlannedStop& planned : plan.stops) {
    StopFrames stop{planned.stop, {}};
    for (const std::vector<int>& frames : planned.frames)
      stop.frames.push_back(frames.empty() ? -1 : frames[frames.size() / 2]);
    job->stops.push_back(std::move(stop));
  }
  job->frames_without_stop = plan.exclusions.size();
}

}  // namespace

ConvertReport convert(const Recording& recording, const std::string& format, const fs::path& folder,
                      const ConvertOptions& options) {
  const Format& to = writable_format(format);
  if (to.equal_squares && recording.rig.board.has_tags())
    throw Error((recording.folder / "rig.yaml").string() + ": board.type: " + recording.rig.board.type + ": " +
                to.what + " knows boards of equal squares alone; --to euroc tells it as Kalibr does");
  if (!recording.rig.more_boards.empty() && !to.several_boards)
    throw Error((recording.folder / "rig.yaml").string() + ": more_boards: " + to.what +
                " knows one board, and this recording has " + std::to_string(recording.rig.boards()) +
                "; calibrate it with rigproof, or take out all but one");
  FolderInMaking making(folder);
  WriteJob job{recording, making.path(), {}, 0, {}, {}, {}};
  if (to.wants_stops) add_stops(recording, &job);
  job.points_of = [&](const RigCamera& camera, const CameraFrame& frame) {
    return points_of(recording, camera, frame, options.max_cloud_points);
  };
  job.observations = [&] {
    ObserveOptions observe_options;
    observe_options.progress = options.progress;
    return options.observations != nullptr ? *options.observations : observe(recording, observe_options);
  };
  job.step = [&](std::size_t done, std::size_t total) { step(options, done, total); };
  ConvertReport report = to.write(job);
  making.finish();
  return report;
}

}  // namespace rigproof
