// The layouts that data lies in on disk. A format is one file in core/formats/src, which tells whether a path is of
// that format, reads it and may write it, and one line of the registry in formats.cpp.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/run_folder.h"

namespace rigproof {

struct Format;

/// What was opened. At least one of `recording` and `observations` is there.
struct Input {
  const Format* format = nullptr;
  std::filesystem::path path;
  std::optional<RunFolder> run;  ///< where the input is a run
  std::optional<Recording> recording;
  std::optional<Observations> observations;  ///< only where the input itself is observations

  bool is_bare_observations() const { return !run && !recording; }
};

/// A recording told stop by stop, for layouts without time.
struct StopFrames {
  Stop stop;
  std::vector<int> frames;  ///< [camera] of Recording::frames[camera], the middle one of the stop; -1 = none
};

/// What a format writes from. The images' contents are read by functions of the caller: this library decodes none.
struct WriteJob {
  const Recording& recording;
  std::filesystem::path folder;   ///< empty; whoever calls gives it its name when it is whole
  std::vector<StopFrames> stops;  ///< of a format that wants stops
  std::size_t frames_without_stop = 0;
  /// Points of a frame's cloud or depth image in the colour camera's frame [m], thinned.
  std::function<std::vector<Eigen::Vector3f>(const RigCamera&, const CameraFrame&)> points_of;
  /// The corners in the recording's images, for layouts that hold corners: their stops are not those above. Throws
  /// Error.
  std::function<Observations()> observations;
  /// Called after each image with (done, all); throws to interrupt.
  std::function<void(std::size_t, std::size_t)> step;
};

struct ConvertReport {
  std::size_t images = 0;
  std::size_t clouds = 0;
  std::vector<std::string> notes;  ///< what the other layout has no place for, in sentences
};

struct Format {
  std::string name;        ///< as --to takes it: "memroc"
  std::string what;        ///< "the MEMROC layout"
  std::string given_as;    ///< what a user gives: "a folder in the MEMROC layout"
  std::string marker;      ///< the file that tells a folder of this format
  std::string suffix;      ///< ".json" where a single file is an input, too
  bool has_images = true;  ///< false: its Input never has a recording
  /// True if a folder is of this format. What else than the marker tells it stands here. Null as `read` is.
  bool (*detect)(const std::filesystem::path& folder) = nullptr;
  /// Throws Error with every problem found. Null: it is only written, and has no marker.
  Input (*read)(const std::filesystem::path& path) = nullptr;
  /// Null: it is only read. Throws Error with every problem for what the format cannot say.
  ConvertReport (*write)(const WriteJob& job) = nullptr;
  bool wants_stops = false;     ///< its writer asks for WriteJob::stops
  bool several_boards = false;  ///< it can tell of more than one board
  bool equal_squares = false;   ///< it can tell boards of equal squares alone, no AprilGrids
};

/// All of them, in the order in which a folder is tried.
const std::vector<Format>& formats();
/// By name, one that can be written. Throws Error with the nearest name.
const Format& writable_format(const std::string& name);
/// Names of those that can be written, in the order of the registry.
std::vector<std::string> writable_formats();
/// "a run, a recording, or a folder in the MEMROC layout": what a command takes.
std::string inputs_in_words(bool with_images_only);

/// Tells by the shape of the folder (or file) what it is. Throws Error that says what was looked for.
const Format& detect_format(const std::filesystem::path& path);
/// Opens whatever a user points at. Throws Error with every problem found.
Input open_input(const std::filesystem::path& path);

// For the files of the formats.

bool has_file(const std::filesystem::path& folder, const std::string& name);
/// Folders above `to` are made. Throws Error.
void copy_file_into(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace rigproof
