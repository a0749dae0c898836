#include "picture_source.h"

#include <map>
#include <optional>

#include "bag_import.h"
#include "folder_import.h"
#include "frame_choice.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/run_folder.h"
#include "ros_pictures.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Without the line that is being written.
void copy_whole_lines(const fs::path& from, const fs::path& to) {
  const std::string text = read_text_file(from);
  write_file_atomically_unsynced(to, text.substr(0, text.rfind('\n') + 1));
}

class RecordingPictures : public PictureSource {
 public:
  RecordingPictures(fs::path folder, bool growing, fs::path scratch)
      : folder_(std::move(folder)), growing_(growing), scratch_(std::move(scratch)) {}

  Recording choose() override {
    Recording recording = load_recording(growing_ && mirror_lists() ? scratch_ : folder_);
    recording.folder = folder_;
    std::vector<std::vector<double>> stamps_s;
    for (const std::vector<CameraFrame>& frames : recording.frames) {
      stamps_s.emplace_back();
      for (const CameraFrame& frame : frames) stamps_s.back().push_back(frame.stamp_s);
    }
    const FrameChoice choice = choose_frames(stamps_s, recording.odometry, {false, 1});
    for (std::size_t camera = 0; camera < recording.frames.size(); ++camera) {
      std::vector<CameraFrame> kept;
      for (const std::size_t i : choice.kept[camera]) kept.push_back(recording.frames[camera][i]);
      recording.frames[camera] = std::move(kept);
    }
    chosen_ = recording;
    return recording;
  }

  void read(const std::vector<Place>& wanted, const Take& take) override {
    for (const Place& place : wanted)
      take(place, [file = path_inside(folder_, chosen_.frames[place.first][place.second].color_file)] {
        return read_grey_image(file);
      });
  }

  bool knows_board() const override { return true; }

 private:
  // What describes the recording, in whole lines; false where files' names are the lists.
  bool mirror_lists() const {
    bool any = false;
    std::error_code ignored;
    for (const fs::directory_entry& entry : folder_tree(folder_)) {
      const fs::path& file = entry.path();
      const bool list = file.extension() == ".csv";
      if (!list && file.extension() != ".yaml" && file.extension() != ".json") continue;
      const fs::path copy = scratch_ / file.lexically_relative(folder_);
      create_folder(copy.parent_path());
      if (list)
        copy_whole_lines(file, copy);
      else
        fs::copy_file(file, copy, fs::copy_options::overwrite_existing, ignored);
      any = any || file.filename() == "frames.csv";
    }
    return any;
  }

  fs::path folder_;
  bool growing_;
  fs::path scratch_;
  Recording chosen_;
};

class FolderPictures : public PictureSource {
 public:
  FolderPictures(const InitOptions& options, bool growing, fs::path scratch)
      : options_(options), growing_(growing), scratch_(std::move(scratch)) {}

  Recording choose() override {
    InitOptions options = options_;
    remove_tree(scratch_);
    create_folder(scratch_);
    if (growing_) {
      const fs::path trajectory = find_trajectory(options_);
      options.odometry = scratch_ / trajectory.filename();
      copy_whole_lines(trajectory, options.odometry);
    }
    FolderPlan plan = plan_folder_import(options);
    files_.clear();
    for (const auto& [from, to] : plan.copies) files_[to] = from;
    chosen_ = std::move(plan.recording);
    return chosen_;
  }

  void read(const std::vector<Place>& wanted, const Take& take) override {
    for (const Place& place : wanted)
      take(place,
           [file = files_.at(chosen_.frames[place.first][place.second].color_file)] { return read_grey_image(file); });
  }

 private:
  InitOptions options_;
  bool growing_;
  fs::path scratch_;
  std::map<std::string, fs::path> files_;  // by their names in a recording
  Recording chosen_;
};

// Of a bag that grows only what has come is read.
class BagPictures : public PictureSource {
 public:
  BagPictures(const InitOptions& options, fs::path scratch) : options_(options), scratch_(std::move(scratch)) {
    Bag check(options_.source, scratch_);
  }

  Recording choose() override {
    plan_ = {};
    plan_ = plan_import(survey(), options_);
    return plan_.recording;
  }

  void read(const std::vector<Place>& wanted, const Take& take) override {
    std::map<BagPlace, Place> places;
    for (const PlannedPicture& picture : plan_.pictures)
      for (const Place& place : wanted)
        if (!picture.is_depth && place == Place(picture.camera, picture.frame)) places[picture.place] = place;
    std::vector<BagPlace> in_bag;
    for (const auto& [place, frame] : places) in_bag.push_back(place);
    bag_->read_at(in_bag, [&](const BagMessage& message) {
      const Place& place = places.at(message.place);
      take(place,
           [this, camera = place.first, bytes = std::string(message.data)] { return picture_of(camera, bytes); });
    });
  }

 private:
  const BagSurvey& survey() {
    const bool goes_on = surveyor_ && bag_->goes_on();
    // A survey that is broken off is begun anew.
    std::unique_ptr<BagSurveyor> surveyor = std::move(surveyor_);
    if (!goes_on) {
      surveyor = std::make_unique<BagSurveyor>(options_.log_stamps, takes_frames(options_));
      bag_.emplace(options_.source, scratch_);
      bag_->progress = [this](std::uint64_t done, std::uint64_t total) {
        return !options_.progress || options_.progress("read", done, total);
      };
    }
    const BagSurvey& survey = surveyor->read_on(*bag_);
    surveyor_ = std::move(surveyor);
    return survey;
  }

  std::variant<Image8, Unreadable> picture_of(std::size_t camera, const std::string& message) const {
    const std::vector<double>& to_undo = plan_.to_undo[camera];
    try {
      std::optional<Rectifier> rectifier;
      if (!to_undo.empty()) rectifier.emplace(plan_.recording.rig.cameras[camera].camera, to_undo);
      PictureMaker maker;
      const PictureFile file = maker.color(plan_.images[camera]->type, message, rectifier ? &*rectifier : nullptr);
      return decode_grey_image({file.bytes.begin(), file.bytes.end()});
    } catch (const Error& error) {
      return Unreadable{error.what()};
    }
  }

  InitOptions options_;
  fs::path scratch_;
  std::optional<Bag> bag_;
  std::unique_ptr<BagSurveyor> surveyor_;
  ImportPlan plan_;  // points into the survey
};

}  // namespace

std::unique_ptr<PictureSource> open_pictures(const InitOptions& options, bool growing, const fs::path& scratch) {
  std::error_code ignored;
  const fs::path& source = options.source;
  if (!fs::exists(source, ignored)) throw Error(source.string() + ": no such file or folder");
  InitOptions one = options;
  one.output = "watched";
  one.images_per_stop = 1;
  one.every_image = false;
  if (is_bag(source)) {
    if (!one.odometry.empty())
      throw Error("--odometry: is for folders of images; of a bag name the topic: --topic odometry=/odom");
    return std::make_unique<BagPictures>(one, scratch);
  }
  if (!fs::is_directory(source, ignored))
    throw Error(source.string() + ": no bag of ROS 2 (.mcap, .db3, or the folder of one), and no folder of images");
  const fs::path recording = fs::is_regular_file(source / "rig.yaml", ignored) ? source : source / "recording";
  if (fs::is_regular_file(recording / "rig.yaml", ignored)) {
    if (!one.topics.empty() || !one.odometry.empty() || !one.camera_infos.empty())
      throw Error("--topic, --odometry, --camera-info: " + recording.string() + " is a recording and has its own");
    return std::make_unique<RecordingPictures>(recording, growing, scratch);
  }
  if (!one.topics.empty()) throw Error("--topic: is for bags; cameras of a folder are called as its folders");
  return std::make_unique<FolderPictures>(one, growing, scratch);
}

}  // namespace rigproof
