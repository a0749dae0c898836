#include "frame_list.h"

#include <algorithm>
#include <map>
#include <set>

#include "csv.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// More files than this in one folder are refused.
constexpr std::size_t kMaxFiles = 1000000;
constexpr std::uintmax_t kMaxListBytes = 256U << 20U;
const std::vector<std::string> kColumns = {"file", "stamp_s", "exposure_s", "depth", "cloud"};
constexpr const char* kNeeded = "; it needs rows of file,stamp_s, or must go";
const std::vector<std::string> kColorFolders = {"color", "image", "."};
const std::vector<std::string> kDepthFolders = {"depth"};
const std::vector<std::string> kCloudFolders = {"cloud", "clouds"};
const std::set<std::string> kColorTypes = {".png", ".jpg", ".jpeg"};
const std::set<std::string> kDepthTypes = {".png"};
const std::set<std::string> kCloudTypes = {".pcd", ".txt"};

/// Files of one kind by stem; values are relative to the recording.
using FilesByStem = std::map<std::string, std::string>;

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return extension;
}

// Files of the first of the folders that holds any.
FilesByStem files_of(const fs::path& recording, const std::string& camera_folder,
                     const std::vector<std::string>& folders, const std::set<std::string>& types, Problems* problems) {
  FilesByStem files;
  for (const std::string& folder : folders) {
    const std::string relative = (fs::path(camera_folder) / folder).lexically_normal().generic_string();
    std::error_code error;
    if (!fs::is_directory(recording / relative, error)) continue;
    fs::directory_iterator it(path_inside(recording, relative), error), end;
    for (; !error && it != end; it.increment(error)) {
      if (types.count(lower_extension(it->path())) == 0) continue;
      const std::string name = (fs::path(relative) / it->path().filename()).lexically_normal().generic_string();
      const auto [place, inserted] = files.emplace(it->path().stem().string(), name);
      if (!inserted)
        problems->add({(recording / relative).string(), 0, "", place->second + ", " + name,
                       "two files with one stem; one of them must go"});
      if (files.size() > kMaxFiles) throw Error((recording / relative).string() + ": more than a million files");
    }
    if (error) throw_system_error(recording / relative, "read the folder", error.value());
    if (!files.empty()) break;
  }
  return files;
}

std::string find_stem(const FilesByStem& files, const std::string& color_file) {
  const auto found = files.find(fs::path(color_file).stem().string());
  return found == files.end() ? "" : found->second;
}

// ------------------------------------------------------------------------------------------------------- frames.csv

class FramesCsvReader {
 public:
  FramesCsvReader(const fs::path& recording, const RigCamera& camera, Problems* problems)
      : recording_(recording), camera_(camera), problems_(problems) {
    file_ = (recording / camera.folder / "frames.csv").string();
    depth_ = files_of(recording, camera.folder, kDepthFolders, kDepthTypes, problems);
    clouds_ = files_of(recording, camera.folder, kCloudFolders, kCloudTypes, problems);
  }

  std::vector<CameraFrame> read() {
    const std::string text = read_text_file(file_, kMaxListBytes);
    if (is_binary(text) || text.empty()) {
      problems_->add({file_, 0, "", "", (text.empty() ? "is empty" : "is no text") + std::string(kNeeded)});
      return {};
    }
    LimitedProblems limited(file_);
    CsvLines lines(text);
    std::vector<std::string_view> fields;
    Problems header;
    if (lines.next(&fields) && !columns_.read_header(fields, kColumns, 2, file_, lines.line(), &header))
      limited.add(lines.line(), "", "", "the first line must name the columns: file,stamp_s,exposure_s");
    while (header.empty() && lines.next(&fields)) read_row(fields, lines.line(), &limited);
    problems_->append(header);
    limited.move_to(problems_);
    return std::move(frames_);
  }

 private:
  // A name in the file is relative to the camera's folder; in the recording it is relative to the recording.
  std::string inside(std::string_view name, const char* field, int line, LimitedProblems* problems) const {
    if (name.empty()) return "";
    const fs::path relative = (fs::path(camera_.folder) / std::string(name)).lexically_normal();
    try {
      if (fs::path(std::string(name)).is_absolute()) throw Error("is absolute");
      path_inside(recording_, relative.generic_string());
      return relative.generic_string();
    } catch (const Error&) {
      problems->add(line, field, name, "leaves the recording; a path inside of the camera's folder is allowed");
      return "";
    }
  }

  void read_row(const std::vector<std::string_view>& fields, int line, LimitedProblems* problems) {
    if (const std::string surplus = columns_.surplus(fields); !surplus.empty()) {
      problems->add(line, "", "", surplus);
      return;
    }
    CameraFrame frame;
    frame.line = line;
    const std::string_view name = columns_.get(fields, 0), stamp = columns_.get(fields, 1);
    if (name.empty()) problems->add(line, "file", "", "is empty; it must name an image");
    frame.color_file = inside(name, "file", line, problems);
    frame.depth_file = columns_.has(3) ? inside(columns_.get(fields, 3), "depth", line, problems)
                                       : find_stem(depth_, frame.color_file);
    frame.cloud_file = columns_.has(4) ? inside(columns_.get(fields, 4), "cloud", line, problems)
                                       : find_stem(clouds_, frame.color_file);
    const auto stamp_s = parse_number(stamp);
    if (!stamp_s) problems->add(line, "stamp_s", stamp, "must be a finite number");
    frame.stamp_s = stamp_s.value_or(0.0);
    const std::string_view exposure = columns_.get(fields, 2);
    const auto exposure_s = exposure.empty() ? std::optional<double>(0.0) : parse_number(exposure);
    if (!exposure_s || *exposure_s < 0.0 || *exposure_s > 100.0)
      problems->add(line, "exposure_s", exposure, "must be a number, 0 to 100; 0 = unknown");
    frame.exposure_s = exposure_s.value_or(0.0);
    if (!frame.color_file.empty() && stamp_s) frames_.push_back(std::move(frame));
  }

  fs::path recording_;
  const RigCamera& camera_;
  Problems* problems_;
  std::string file_;
  CsvColumns columns_;
  FilesByStem depth_, clouds_;
  std::vector<CameraFrame> frames_;
};

// -------------------------------------------------------------------------------------------------- images by name

// "1699999.123" is seconds, 16 digits and more are nanoseconds; "000012" is a number, not a stamp.
std::optional<double> stamp_of_stem(const std::string& stem) {
  const auto value = parse_number(stem);
  if (!value || *value < 0.0 || stem.find_first_not_of("0123456789.") != std::string::npos) return std::nullopt;
  if (stem.find('.') != std::string::npos) return value;
  if (stem.size() >= 16) return *value * 1e-9;
  return std::nullopt;
}

bool all_stems_are_stamps(const FilesByStem& images) {
  return !images.empty() &&
         std::all_of(images.begin(), images.end(), [](const auto& image) { return stamp_of_stem(image.first); });
}

bool any_stamp_meets(const FilesByStem& images, const std::vector<OdometrySample>& odometry) {
  if (odometry.empty()) return false;
  return std::any_of(images.begin(), images.end(), [&](const auto& image) {
    const double stamp_s = *stamp_of_stem(image.first);
    return stamp_s >= odometry.front().stamp_s && stamp_s <= odometry.back().stamp_s;
  });
}

// "2.png" before "10.png": runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    std::size_t i_end = i, j_end = j;
    while (i_end < a.size() && digit(a[i_end])) ++i_end;
    while (j_end < b.size() && digit(b[j_end])) ++j_end;
    if (i_end - i != j_end - j) return i_end - i < j_end - j;
    const int order = a.compare(i, i_end - i, b, j, j_end - j);
    if (order != 0) return order < 0;
    i = i_end;
    j = j_end;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

std::vector<CameraFrame> frames_from_names(const fs::path& recording, const RigCamera& camera,
                                           const std::vector<OdometrySample>& odometry, Problems* problems) {
  const FilesByStem images = files_of(recording, camera.folder, kColorFolders, kColorTypes, problems);
  const std::string place = (recording / camera.folder).string();
  if (images.empty()) {
    problems->add(
        {place, 0, "", "", "holds no image; PNG or JPEG are looked for in color/, image/ and the folder itself"});
    return {};
  }
  const bool stamps = all_stems_are_stamps(images);
  const bool one_a_row = images.size() == odometry.size();
  if (!stamps && !one_a_row) {
    problems->add(
        {place, 0, "", "",
         "tells no time of its " + std::to_string(images.size()) + " images, and the odometry has " +
             std::to_string(odometry.size()) +
             " rows. Give frames.csv (file,stamp_s), or images named by their stamp (1699999.123.png), or one "
             "row of odometry for each image"});
    return {};
  }
  const bool by_stamp = stamps && (any_stamp_meets(images, odometry) || !one_a_row);
  std::vector<std::pair<std::string, std::string>> ordered(images.begin(), images.end());
  std::sort(ordered.begin(), ordered.end(),
            [](const auto& a, const auto& b) { return natural_less(a.first, b.first); });
  const FilesByStem depth = files_of(recording, camera.folder, kDepthFolders, kDepthTypes, problems);
  const FilesByStem clouds = files_of(recording, camera.folder, kCloudFolders, kCloudTypes, problems);
  std::vector<CameraFrame> frames;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    CameraFrame frame;
    frame.color_file = ordered[i].second;
    frame.depth_file = find_stem(depth, frame.color_file);
    frame.cloud_file = find_stem(clouds, frame.color_file);
    frame.stamp_s = by_stamp ? *stamp_of_stem(ordered[i].first) : odometry[i].stamp_s;
    path_inside(recording, frame.color_file);
    frames.push_back(std::move(frame));
  }
  return frames;
}

void sort_by_stamp(const fs::path& recording, const RigCamera& camera, std::vector<CameraFrame>* frames,
                   Problems* problems) {
  std::stable_sort(frames->begin(), frames->end(),
                   [](const CameraFrame& a, const CameraFrame& b) { return a.stamp_s < b.stamp_s; });
  LimitedProblems limited((recording / camera.folder / "frames.csv").string());
  for (std::size_t i = 1; i < frames->size(); ++i) {
    const CameraFrame &before = (*frames)[i - 1], &frame = (*frames)[i];
    if (frame.stamp_s == before.stamp_s)
      limited.add(frame.line, "stamp_s", number_text(frame.stamp_s),
                  frame.color_file + " has the stamp of " + before.color_file + "; a camera takes one image at a time");
  }
  limited.move_to(problems);
}

// With those beside it: a camera's name may be misspelled.
[[noreturn]] void throw_no_folder(const fs::path& folder) {
  constexpr std::size_t kMostNames = 20;
  std::vector<std::string> there;
  std::error_code ignored;
  for (const fs::directory_entry& entry : folder_entries(folder.parent_path()))
    if (entry.is_directory(ignored)) there.push_back(entry.path().filename().string());
  throw Error(folder.string() + ": no such folder" +
              (there.empty() || there.size() > kMostNames ? "" : "; " + suggestion(folder.filename().string(), there)));
}

}  // namespace

std::vector<CameraFrame> list_frames(const fs::path& recording, const RigCamera& camera,
                                     const std::vector<OdometrySample>& odometry, Problems* problems) {
  std::vector<CameraFrame> frames;
  try {
    const fs::path folder = path_inside(recording, camera.folder);
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) throw_no_folder(folder);
    const bool listed = fs::exists(path_inside(recording, (fs::path(camera.folder) / "frames.csv").string()), ignored);
    frames = listed ? FramesCsvReader(recording, camera, problems).read()
                    : frames_from_names(recording, camera, odometry, problems);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    problems->add({"", 0, "", "", error.what()});
  }
  sort_by_stamp(recording, camera, &frames, problems);
  return frames;
}

std::string frames_csv(const std::vector<CameraFrame>& frames, const std::string& camera_folder) {
  const auto local = [&](const std::string& file) {
    return file.empty() ? file : fs::path(file).lexically_relative(camera_folder).generic_string();
  };
  const auto told_by_name = [&](const std::string& color, const std::string& file, const char* folder) {
    return file.empty() || (fs::path(file).stem() == fs::path(color).stem() &&
                            fs::path(file).parent_path() == (fs::path(camera_folder) / folder).lexically_normal());
  };
  const bool names_tell = std::all_of(frames.begin(), frames.end(), [&](const CameraFrame& frame) {
    return told_by_name(frame.color_file, frame.depth_file, "depth") &&
           told_by_name(frame.color_file, frame.cloud_file, "cloud");
  });
  std::string text = names_tell ? "file,stamp_s,exposure_s\n" : "file,stamp_s,exposure_s,depth,cloud\n";
  for (const CameraFrame& frame : frames) {
    text += local(frame.color_file) + "," + number_text(frame.stamp_s) + "," + number_text(frame.exposure_s);
    if (!names_tell) text += "," + local(frame.depth_file) + "," + local(frame.cloud_file);
    text += "\n";
  }
  return text;
}

}  // namespace rigproof
