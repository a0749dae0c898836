// The commands of `rigproof`: what the command line was parsed into, and what each does. Every function returns the
// process's exit code; bad input throws Error, which only main catches.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rigproof {

struct CommonArguments {
  bool quiet = false;
  bool json = false;  ///< machine-readable standard output instead of text
  int jobs = 0;       ///< 0 = one a core
};

struct GenerateArguments {
  CommonArguments common;
  std::string config;            ///< file or preset name; empty = all defaults
  std::vector<std::string> set;  ///< FIELD=VALUE overrides
  std::filesystem::path output;  ///< empty = runs/<config name>
  bool fresh = false;
  bool dry_run = false;
  int device = -2;
  std::filesystem::path cache;    ///< of clean renders; empty = nothing is kept
  bool render = true;             ///< false: only from the cache
  bool observations = false;      ///< only they are kept
  std::filesystem::path archive;  ///< the run as a few large files, too; empty: not
  int shard_mib = 1024;           ///< of files in a shard of it
};
int generate_command(const GenerateArguments& arguments);

struct SenseArguments {
  CommonArguments common;
  std::filesystem::path source;  ///< a run, or a configuration
  std::vector<std::string> set;
  std::int64_t seed = -1;  ///< of the sensors; -1 = as the source has it
  std::filesystem::path output;
  std::filesystem::path cache;
  bool fresh = false;
};
int sense_command(const SenseArguments& arguments);

/// How images are looked at besides for corners.
struct VisionArguments {
  std::string ground = "depth";   ///< depth, images, auto
  std::string features = "sift";  ///< or onnx:FILE
  std::string horizon;            ///< onnx:FILE; empty = geometry
};

struct InitArguments {
  CommonArguments common;
  std::filesystem::path source;
  std::filesystem::path output;
  std::string board;    ///< preset or file
  std::string squares;  ///< "6x5"
  double square_mm = 0.0;
  std::filesystem::path odometry;  ///< trajectory of a folder of images
  std::vector<std::string> topics;
  std::vector<std::string> camera_infos;
  std::vector<std::string> sensors;
  std::string robot_frame;
  std::string stamps = "header";  ///< or log
  bool every_image = false;
  int images_per_stop = 3;
};
int init_command(const InitArguments& arguments);

struct ObserveArguments {
  CommonArguments common;
  VisionArguments vision;
  std::filesystem::path input;
  std::filesystem::path output;  ///< empty = observations.json beside the recording
};
int observe_command(const ObserveArguments& arguments);

struct CalibrateArguments {
  CommonArguments common;
  VisionArguments vision;
  std::filesystem::path input;
  std::vector<std::string> methods;
  std::filesystem::path output;  ///< a folder; empty = results/ beside the input
  std::string accept;            ///< criteria, file or name; empty = no gates
  std::filesystem::path junit;   ///< of the gates
};
int calibrate_command(const CalibrateArguments& arguments);

struct ValidateArguments {
  CommonArguments common;
  std::filesystem::path run;
  std::vector<std::filesystem::path> results;  ///< empty = all in the run's results/
  std::filesystem::path budget;
  std::filesystem::path junit;
  bool paper = false;  ///< the published numbers beside
};
int validate_command(const ValidateArguments& arguments);

struct RunArguments {
  GenerateArguments generate;
  VisionArguments vision;
  std::vector<std::string> methods;
  std::filesystem::path budget;
  std::string accept;  ///< as for calibrate
  std::filesystem::path junit;
};
int run_command(const RunArguments& arguments);

struct SweepStartArguments {
  CommonArguments common;
  std::filesystem::path config;  ///< a sweep's file, or its folder
  std::filesystem::path output;  ///< empty = sweeps/<name>, or the folder that was given
  std::filesystem::path cache;
  double cache_limit_gb = 0.0;
  int device = -2;
  bool dry_run = false;
  std::vector<std::string> add;
  std::vector<std::string> redo;
  std::vector<std::string> set;
};
int sweep_start_command(const SweepStartArguments& arguments);
int sweep_plan_command(const SweepStartArguments& arguments);

struct SweepRunArguments {
  CommonArguments common;
  std::filesystem::path folder;
  std::string shard = "0/1";
  std::filesystem::path cache;
  int device = -2;
};
int sweep_run_command(const SweepRunArguments& arguments);

struct SweepFolderArguments {
  CommonArguments common;
  std::filesystem::path folder;
  bool follow = false;
};
int sweep_merge_command(const SweepFolderArguments& arguments);
int sweep_status_command(const SweepFolderArguments& arguments);
int sweep_summary_command(const SweepFolderArguments& arguments);

struct SweepSlurmArguments {
  CommonArguments common;
  std::filesystem::path folder;
  int array = 0;     ///< 0 = 100 tasks an array task
  int throttle = 0;  ///< array tasks at once; 0 = no limit
  int cpus = 2;      ///< of an array task
  std::vector<std::string> options;
  std::filesystem::path cache;
  bool submit = false;
};
int sweep_slurm_command(const SweepSlurmArguments& arguments);

struct PaperArguments {
  CommonArguments common;
  std::string experiment;        ///< empty = list them
  std::filesystem::path config;  ///< a sweep in place of the shipped one; empty = none
  std::filesystem::path output;  ///< empty = paper/
  std::filesystem::path cache;   ///< empty = cache/ in the output
  bool dry_run = false;
  std::vector<std::string> set;
  int device = -2;
};
int paper_command(const PaperArguments& arguments);

struct RecordCheckArguments {
  CommonArguments common;
  std::filesystem::path source;
  bool follow = false;
  double until_idle_s = 0.0;  ///< 0: until interrupted
  std::string board;          ///< preset or file
  std::string squares;        ///< "6x5"
  std::filesystem::path odometry;
  std::vector<std::string> topics, camera_infos;
  std::string stamps = "header";
};
/// Tells what a drive shows of the board.
int record_check_command(const RecordCheckArguments& arguments);

struct SuggestArguments {
  CommonArguments common;
  std::filesystem::path input;
  std::string method = "ml";     ///< or ml:KEY=VALUE,.. or ml:FILE.yaml
  std::filesystem::path output;  ///< a configuration for `generate`; empty = none is written
  int stops = 3;
  std::string criterion = "worst";  ///< worst, D or E
  std::vector<double> area_m;       ///< x_min x_max y_min y_max; empty = near where the robot was
  double reach_m = 1.0;
  double clearance_m = 1.0;
  double min_turn_deg = 3.0;
  int min_cameras = 1;
  double min_gain_percent = 1.0;
  int candidates = 300;
  std::uint64_t seed = 0;
};
int suggest_command(const SuggestArguments& arguments);

struct MovedArguments {
  CommonArguments common;
  std::filesystem::path input;
  std::filesystem::path previous;  ///< a result file
  double significance_percent = 0.1;
  double smallest_cm = 2.0;
  double smallest_deg = 0.5;
};
int moved_command(const MovedArguments& arguments);

struct InspectArguments {
  CommonArguments common;
  std::filesystem::path input;
  std::vector<std::filesystem::path> results;
  std::filesystem::path output;  ///< empty = pictures/ beside the input
};
int inspect_command(const InspectArguments& arguments);

struct ReportArguments {
  CommonArguments common;
  std::vector<std::filesystem::path> inputs;  ///< several: recordings of one rig over time
  std::filesystem::path output;  ///< empty = report.html beside the input; of several: history.html beside the last
  std::string method;            ///< shown first; empty = ml
  std::filesystem::path budget;
};
int report_command(const ReportArguments& arguments);

struct ConvertArguments {
  CommonArguments common;
  std::filesystem::path input;
  std::filesystem::path output;
  std::string to;  ///< a writable format, or mcap; empty = by the output's name, else the one that the input is not
  int cloud_points = 12000;
  int shard_mib = 1024;          ///< of files in a shard of an archive
  bool compressed = false;       ///< pictures in a bag stay PNG or JPEG
  std::string packing = "zstd";  ///< of a bag's chunks
};
int convert_command(const ConvertArguments& arguments);

struct BenchExportArguments {
  CommonArguments common;
  std::string name;              ///< of a case, or a run's folder
  std::string to;                ///< one of bench_layouts()
  std::filesystem::path output;  ///< empty = bench/NAME
  std::vector<std::string> set;
  std::filesystem::path cache;
  int device = -2;
};
std::vector<std::string> bench_layouts();
/// The cases of bench-v1.
std::vector<std::string> bench_cases();
int bench_export_command(const BenchExportArguments& arguments);

struct DoctorArguments {
  CommonArguments common;
  std::filesystem::path run;  ///< empty = the machine
  int device = -2;
};
int doctor_command(const DoctorArguments& arguments);

struct ScenesArguments {
  CommonArguments common;
  std::vector<std::string> scenes;  ///< to be tried; empty = all that ship if there is an output, else only a list
  std::filesystem::path output;     ///< of a picture; empty = none
  int poses = 8;
  int device = -2;
};
int scenes_command(const ScenesArguments& arguments);

struct BoardArguments {
  CommonArguments common;
  std::string preset;   ///< empty = by squares
  std::string type;     ///< empty = the preset's, or checkerboard
  std::string squares;  ///< "6x5"; empty = the preset's
  double square_mm = 0.0;
  std::string paper = "fit";
  double border_mm = 10.0;
  double printer_margin_mm = 6.0;
  bool tiles = false;
  std::optional<double> overlap_mm;  ///< absent: 10
  std::filesystem::path output;      ///< .pdf, .svg or .dxf; empty = board.pdf
};
/// Writes a board to print, in the format that its ending says.
int board_command(const BoardArguments& arguments);

/// kind: scenes, rigs, sensors, boards or methods.
int list_command(const CommonArguments& common, const std::string& kind);

struct PlotSensorArguments {
  CommonArguments common;
  std::string name;
  std::filesystem::path output;  ///< empty = NAME_noise.png
};
/// Draws the noise of a sensor preset over distance.
int plot_sensor_command(const PlotSensorArguments& arguments);

/// Prints the JSON Schema of a file that people or rigproof write: run, rig, result, ... Without a name it lists them.
int schema_command(const std::string& name);
/// All of them, and "all".
std::vector<std::string> schema_names();

}  // namespace rigproof
