#include "rigproof/study/import/init.h"

#include <algorithm>
#include <map>

#include "bag_import.h"
#include "board_coverage.h"
#include "folder_import.h"
#include "rig_files.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/pcd.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"
#include "rigproof/study/workflow/folder_in_making.h"
#include "ros_cloud.h"
#include "ros_pictures.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

void step(const InitOptions& options, const char* what, std::uint64_t done, std::uint64_t total) {
  if (options.progress && !options.progress(what, done, total)) throw Error("interrupted", ExitCode::kTryAgain);
}

const ImageTopic& topic_of(const PlannedPicture& picture, const ImportPlan& plan) {
  return picture.is_depth ? *plan.depth[picture.camera] : *plan.images[picture.camera];
}

// Where its frame names the picture's file.
std::string& file_name(const PlannedPicture& picture, ImportPlan* plan) {
  CameraFrame& frame = plan->recording.frames[picture.camera][picture.frame];
  if (!picture.is_depth) return frame.color_file;
  return topic_of(picture, *plan).is_cloud() ? frame.cloud_file : frame.depth_file;
}

// Makes files of messages.
class PictureReader {
 public:
  PictureReader(const BagSurvey& survey, const ImportPlan& plan) : survey_(survey), plan_(plan) {}

  // Its bytes stay valid until the next call or the end of the message.
  PictureFile read(const PlannedPicture& picture, const BagMessage& message) {
    const ImageTopic& topic = topic_of(picture, plan_);
    if (topic.is_cloud()) return cloud(picture, message);
    const RigCamera& camera = plan_.recording.rig.cameras[picture.camera];
    const bool own = picture.is_depth && camera.depth->own_camera;
    const Rectifier* rectifier = own ? nullptr : rectifier_of(picture.camera);
    const PictureFile file = picture.is_depth ? maker_.depth(topic.type, message.data, camera.depth->unit_m, rectifier)
                                              : maker_.color(topic.type, message.data, rectifier);
    const Camera& optics = own ? camera.depth->own_camera->camera : camera.camera;
    if (file.width != optics.width_px || file.height != optics.height_px)
      throw Error("an image of " + std::to_string(file.width) + "x" + std::to_string(file.height) +
                  ", the intrinsics are of " + std::to_string(optics.width_px) + "x" +
                  std::to_string(optics.height_px));
    return file;
  }

 private:
  const Rectifier* rectifier_of(std::size_t camera) {
    const std::vector<double>& d = plan_.to_undo[camera];
    if (d.empty()) return nullptr;
    return &rectifiers_.try_emplace(camera, plan_.recording.rig.cameras[camera].camera, d).first->second;
  }

  PictureFile cloud(const PlannedPicture& picture, const BagMessage& message) {
    const std::optional<Rigid3> T_camera_cloud =
        survey_.tf_static.between(plan_.images[picture.camera]->frame_id(), plan_.depth[picture.camera]->frame_id());
    cloud_ = encode_pcd(points_of_message(message.data, T_camera_cloud.value()));
    return {".pcd", cloud_};
  }

  const BagSurvey& survey_;
  const ImportPlan& plan_;
  PictureMaker maker_;
  std::map<std::size_t, Rectifier> rectifiers_;  // by camera
  std::string cloud_;
};

fs::path write_picture(const PictureFile& file, const PlannedPicture& picture, ImportPlan* plan) {
  std::string& name = file_name(picture, plan);
  name += file.extension;
  const fs::path path = plan->recording.folder / name;
  write_file_atomically_unsynced(path, file.bytes);
  InitCamera& report = plan->report.cameras[picture.camera];
  ++(picture.is_depth ? report.depth_kept : report.images_kept);
  return path;
}

// By topic: how many, and why the first.
using Unreadable = std::map<std::string, std::pair<std::size_t, std::string>>;

// Frames without an image. Throws Error with every camera that has no other.
void drop_unreadable(const Unreadable& unreadable, ImportPlan* plan) {
  for (const auto& [topic, why] : unreadable)
    plan->report.notes.push_back(topic + ": " + std::to_string(why.first) +
                                 " images cannot be used, the first: " + why.second);
  Problems problems;
  for (std::size_t i = 0; i < plan->recording.frames.size(); ++i) {
    std::vector<CameraFrame>& frames = plan->recording.frames[i];
    const bool any = !frames.empty();
    frames.erase(
        std::remove_if(frames.begin(), frames.end(), [](const CameraFrame& frame) { return frame.color_file.empty(); }),
        frames.end());
    if (any && frames.empty())
      problems.add({"", 0, "topic " + plan->images[i]->name, "",
                    "no image can be used: " + unreadable.at(plan->images[i]->name).second});
  }
  problems.throw_if_any();
}

// Reads the pictures where they lie in the bag and writes them.
void write_pictures(Bag& bag, const BagSurvey& survey, const InitOptions& options, ImportPlan* plan) {
  std::map<BagPlace, std::vector<const PlannedPicture*>> pictures;
  for (const PlannedPicture& picture : plan->pictures) pictures[picture.place].push_back(&picture);
  std::vector<BagPlace> places;
  for (const auto& [place, of_place] : pictures) places.push_back(place);
  PictureReader reader(survey, *plan);
  Unreadable unreadable;
  std::vector<fs::path> written;
  std::size_t done = 0;
  bag.read_at(places, [&](const BagMessage& message) {
    for (const PlannedPicture* picture : pictures.at(message.place)) {
      try {
        written.push_back(write_picture(reader.read(*picture, message), *picture, plan));
      } catch (const Error& error) {
        if (error.exit_code() == ExitCode::kTryAgain) throw;
        auto& [count, first] = unreadable[topic_of(*picture, *plan).name];
        if (count++ == 0) first = error.what();
        file_name(*picture, plan).clear();
      }
      step(options, "write", ++done, plan->pictures.size());
    }
  });
  sync_files(written);
  drop_unreadable(unreadable, plan);
}

// "more_boards: [{type: charuco, ..}, {..}]" of those from one on.
std::string more_boards_text(const std::vector<std::string>& boards, std::size_t first) {
  std::string text = "more_boards: [";
  for (std::size_t i = first; i < boards.size(); ++i) text += (i == first ? "{" : ", {") + boards[i] + "}";
  return text + "]";
}

std::string note_of_others(const BoardCoverage& coverage, const std::vector<InitCamera>& cameras) {
  std::vector<std::string> blind;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    if (coverage.stops[c] == 0) blind.push_back(cameras[c].name);
  if (blind.size() == cameras.size())
    return "the board is in no image; another one seems to be there, apart from its size: {" + coverage.seen.front() +
           "}";
  return (blind.empty()
              ? "beside the board " + std::string(coverage.seen.size() > 1 ? "others seem" : "another one seems") +
                    " to be there"
              : "where " + joined(blind) + " never sees the board another one seems to be") +
         ", apart from its size: `" + more_boards_text(coverage.seen, 0) + "` in rig.yaml";
}

// What is wrong with the images, the first of it, by the name that the recording will have.
std::string note_of_problem(const std::string& problem, const fs::path& making, const fs::path& output) {
  const std::size_t end = problem.find('\n');
  std::string text = problem.substr(0, end);
  const std::string from = making.string(), to = output.string();
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return "the board could not be looked for, and `calibrate` will say so" +
         std::string(end == std::string::npos ? ": " : ", too; the first reason: ") + text;
}

// How often each camera sees the boards that are known or guessed.
void take_coverage(const BoardCoverage& coverage, const fs::path& making, const fs::path& output, InitReport* report) {
  if (!coverage.problem.empty()) return report->notes.push_back(note_of_problem(coverage.problem, making, output));
  for (std::size_t i = 0; i < report->cameras.size(); ++i) {
    report->cameras[i].board_stops = coverage.stops[i];
    report->cameras[i].board_cells = coverage.cells.empty() ? 0 : coverage.cells[i];
  }
}

std::vector<std::string> missing_boards(const std::vector<std::string>& seen) {
  const bool any = !seen.empty();
  const std::string board = any ? seen.front() : "type: checkerboard, squares: [6, 5], square_mm: 100";
  std::vector<std::string> missing = {
      (any ? "the board, which seems to be this one; measure a row of its squares: `board: {"
           : "the board, of which none was found in the images: `board: {") +
      board + "}` in rig.yaml"};
  if (seen.size() > 1)
    missing.push_back("boards beside it, which seem to be there; measure their squares, too: `" +
                      more_boards_text(seen, 1) + "` in rig.yaml");
  return missing;
}

void look_for_board(const InitOptions& options, const Recording& recording, InitReport* report) {
  const CoverageProgress progress = [&options](std::uint64_t done, std::uint64_t total) {
    return !options.progress || options.progress("board", done, total);
  };
  if (options.board) {
    const BoardCoverage coverage = find_board(recording, options.threads, progress);
    take_coverage(coverage, recording.folder, options.output, report);
    if (!coverage.seen.empty()) report->notes.push_back(note_of_others(coverage, report->cameras));
    return;
  }
  const BoardCoverage guess = guess_board(recording, progress);
  report->missing = missing_boards(guess.seen);
  if (guess.boards.empty()) return;
  Recording with_guess = recording;
  with_guess.rig.board = guess.boards.front();
  with_guess.rig.more_boards.assign(guess.boards.begin() + 1, guess.boards.end());
  take_coverage(cover_board(with_guess, options.threads, progress), recording.folder, options.output, report);
}

std::vector<std::string> comments_of(const InitOptions& options, const InitReport& report) {
  std::vector<std::string> comments = {"Made by `rigproof init` of " + for_message(options.source.filename().string()) +
                                       "."};
  for (const std::string& missing : report.missing) comments.push_back("Missing: " + for_message(missing, 1200));
  comments.emplace_back(
      "About which point the robot turns is in no recording: if it is the middle of one driven axle, give odometry "
      "`noise: {rotation_centre_sigma_mm: 5}`; of one that skids, measure it, and give `rotation_centre_mm: [x, y]`, "
      "too.");
  return comments;
}

// What is imported the same way from every source.
struct Imported {
  Recording recording;
  InitReport report;
};

void write_descriptions(const InitOptions& options, const Imported& imported) {
  const RigText text{imported.recording.rig, options.board.has_value(), comments_of(options, imported.report)};
  write_file_atomically(imported.recording.folder / "rig.yaml", rig_yaml_text(text));
}

Imported import_bag(const InitOptions& options, const fs::path& making, const fs::path& scratch) {
  if (!options.odometry.empty())
    throw Error("--odometry: is for folders of images; of a bag name the topic: --topic odometry=/odom");
  Bag bag(options.source, scratch);
  bag.progress = [&options](std::uint64_t done, std::uint64_t total) {
    return !options.progress || options.progress("read", done, total);
  };
  const BagSurvey survey = survey_bag(bag, options.log_stamps, takes_frames(options));
  ImportPlan plan = plan_import(survey, options);
  plan.recording.folder = making;
  plan.report.notes.insert(plan.report.notes.begin(), survey.notes.begin(), survey.notes.end());
  write_pictures(bag, survey, options, &plan);
  if (!survey.tf_static.empty()) write_file_atomically(making / kFrameTreeFile, frame_tree_text(survey.tf_static));
  plan.report.bytes = bag.size_bytes();
  plan.report.unpacked_bytes = bag.unpacked_bytes();
  return {std::move(plan.recording), std::move(plan.report)};
}

// What calibrators of cameras alone have found, to be compared with.
void keep_chain(bool of_topics, Imported* imported) {
  const FrameTree poses = poses_of_chain(imported->report.cameras, of_topics);
  if (poses.empty()) return;
  write_file_atomically(imported->recording.folder / kCamchainFile, frame_tree_text(poses));
  imported->report.notes.push_back("how the camchain's cameras stand to each other is kept in " +
                                   std::string(kCamchainFile) + ", and compared with what `calibrate` finds");
}

Imported import_folder(const InitOptions& options, const fs::path& making) {
  if (!options.topics.empty()) throw Error("--topic: is for bags; cameras of a folder are called as its folders");
  FolderPlan plan = plan_folder_import(options);
  plan.recording.folder = making;
  std::size_t done = 0;
  for (const auto& [from, to] : plan.copies) {
    copy_file_into(from, making / to);
    std::error_code ignored;
    plan.report.bytes += fs::file_size(from, ignored);
    step(options, "write", ++done, plan.copies.size());
  }
  plan.report.unpacked_bytes = plan.report.bytes;
  return {std::move(plan.recording), std::move(plan.report)};
}

}  // namespace

InitReport init_recording(const InitOptions& options) {
  std::error_code ignored;
  const bool bag = is_bag(options.source);
  if (!fs::exists(options.source, ignored)) throw Error(options.source.string() + ": no such file or folder");
  if (!bag && !fs::is_directory(options.source, ignored))
    throw Error(options.source.string() +
                ": no bag of ROS 2 (.mcap, .db3, or the folder of one), and no folder of images");
  FolderInMaking making(options.output);
  const fs::path scratch = making.path() / ".scratch";
  Imported imported = bag ? import_bag(options, making.path(), scratch) : import_folder(options, making.path());
  save_recording(imported.recording);
  keep_chain(bag, &imported);
  look_for_board(options, imported.recording, &imported.report);
  write_descriptions(options, imported);
  remove_tree(scratch);
  making.finish();
  imported.report.folder = options.output;
  return imported.report;
}

}  // namespace rigproof
