// A result in the formats of those who use it. A format is one file in study/export/src that writes an ExportJob, and
// one line of the registry in formats.cpp.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/fields.h"
#include "rigproof/core/result.h"
#include "rigproof/core/rig.h"
#include "rigproof/formats/frame_tree.h"

namespace rigproof {

/// The rig that a result belongs to, as far as exports need it.
struct RigFacts {
  std::string source;  ///< the file or folder that says it; empty: there is none
  std::vector<RigCamera> cameras;
  FrameTree tf_static;  ///< of the robot, from tf_static.json beside a rig.yaml
};

/// From a run, a recording, any other input, a rig.yaml or observations.json. Throws Error with every problem found.
RigFacts read_rig_facts(const std::filesystem::path& path);
/// The same from where results usually lie: rig.yaml or observations.json beside the result or its folder; empty if
/// neither is there.
RigFacts find_rig_facts(const std::filesystem::path& result_file);
/// The result file itself, or the only one of a folder: a run, a recording, or its results/. Throws Error.
std::filesystem::path find_result_file(const std::filesystem::path& path);

struct ExportOptions {
  std::vector<std::string> cameras;  ///< empty: all of the result
  bool partial = false;              ///< what is known of a partial result is exported, too
  /// The frame to give poses in. Where the robot's tree has it, they are moved there; else it is another name of the
  /// result's robot frame. Empty: that.
  std::string parent;
  std::optional<double> parent_height_m;  ///< of `parent`, or the result's, above the ground, whatever the tree says
  // What the user says of single cameras, by name; it prevails over the rig.
  std::map<std::string, std::string> links;           ///< in the tree, in place of RigCamera::link
  std::map<std::string, std::string> optical_frames;  ///< in the tree
  /// Pose of the optical frame in the link, where a driver or URDF fixes it.
  std::map<std::string, Rigid3> T_link_camera;
  std::map<std::string, std::string> joints;  ///< that change in an existing URDF
  std::string result_file;                    ///< for comments
  std::string date;                           ///< the same: "2026-11-23"
  std::vector<std::string> warnings;          ///< the same: what throws doubt on the result, in sentences
};

/// A camera of a result, as formats write it.
struct ExportCamera {
  std::string name;
  EstimatedTransform estimate;  ///< pose of the optical frame in the robot
  std::string link;
  std::string optical_frame;            ///< empty where nobody says
  std::optional<Rigid3> T_link_camera;  ///< where somebody says
  bool rig_says_frames = false;         ///< T_link_camera is the rig's, not what the user says of this export
  std::string joint;                    ///< where somebody says
  std::string parent;                   ///< what `link` hangs on in the robot's tree; empty: nobody says
  Rigid3 T_robot_parent;
  std::optional<Camera> told;       ///< intrinsics of the rig
  std::optional<Camera> estimated;  ///< those that the pose goes with, where they were estimated

  bool is_known() const { return estimate.fully_observable(); }
  /// Those that the pose goes with; null where nobody says.
  const Camera* intrinsics() const;
};

/// What every format writes from.
struct ExportJob {
  std::string method;
  ResultStatus status = ResultStatus::kSolved;
  std::string result_file;
  std::string rig_source;  ///< RigFacts::source
  std::string date;
  std::vector<ExportCamera> cameras;
  std::vector<EstimatedTransform> camera_to_camera;  ///< between cameras of the list
  std::vector<std::string> warnings;
  std::vector<std::string> frame_notes;  ///< what is taken of the frame that poses are given in, in sentences
};

/// Throws Error with every camera that options name and the result does not have.
void check_export_names(const Result& result, const ExportOptions& options);
/// Takes what is to be exported from a result. Throws Error with every unknown camera; with ExitCode::kRefused for a
/// result that is not solved without `partial`, and for one that knows no pose at all.
ExportJob prepare_export(const Result& result, const RigFacts& rig, const ExportOptions& options);

/// A transform as a tree of frames has it.
struct TreeTransform {
  std::string camera;
  std::string parent, child;
  Rigid3 T_parent_child;
  bool is_estimated = true;  ///< false: from the axes of a body to optical ones, as convention has it
};
/// What is to be published: one transform for each known camera, and the optical frame below where `link` is none and
/// nobody says where it lies. Throws Error where a frame would have two parents.
std::vector<TreeTransform> tree_transforms(const ExportJob& job);

/// What users must know about an export, in sentences: uncertainty, which intrinsics a pose goes with, what is left
/// out, whose axes a link has.
std::vector<std::string> remarks_of(const ExportJob& job);
/// One sigma of a known camera in words; empty where the result states none.
std::string sigma_text(const ExportCamera& camera);
/// Largest distance between the pixels that a direction has with either camera, over the image [px].
double largest_pixel_difference(const Camera& a, const Camera& b);

struct ExportFile {
  std::string name;  ///< where there are several
  std::string text;
};

struct ExportOutput {
  std::vector<ExportFile> files;
  std::vector<std::string> notes;  ///< what the format has no place for, in sentences
};

struct ExportFormat {
  std::string name;         ///< as --to takes it: "static-tf"
  std::string what;         ///< "tf2_ros command lines"
  bool is_tree = true;      ///< it holds transforms between links: tree_transforms()
  bool needs_poses = true;  ///< of at least one camera, all six degrees of freedom
  bool needs_intrinsics = false;
  bool file_per_camera = false;
  /// Throws Error with every problem for what the format cannot say.
  ExportOutput (*write)(const ExportJob& job) = nullptr;
};

/// All of them, in the order of help and documentation.
const std::vector<ExportFormat>& export_formats();
std::vector<std::string> export_format_names();
/// By name. Throws Error with the nearest name.
const ExportFormat& export_format(const std::string& name);
/// Checks what the format needs, then writes.
ExportOutput write_export(const ExportJob& job, const ExportFormat& format);
/// JSON Schema of what the format json writes.
std::string export_json_schema();

/// What was done to a file.
struct WrittenFile {
  std::filesystem::path file;
  std::optional<std::filesystem::path> backup;  ///< what was there before
  bool changed = true;                          ///< false: it already held the same bytes
};
/// Writes whole or not at all; a file that is there is kept as FILE.bak, with its permissions on the new one. Throws
/// Error for a link, a device's name that cannot be written, and a file that is read-only.
WrittenFile write_with_backup(const std::filesystem::path& file, const std::string& text);
/// For those who make the text for minutes: throws now what write_with_backup() would throw then.
void check_can_be_written(const std::filesystem::path& file);

}  // namespace rigproof
