// Is a world suitable? A few stops of it are generated, observed like any recording, and compared with the truth.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/image.h"

namespace rigproof {

struct SceneCheckOptions {
  int poses = 8;            ///< stops that are rendered
  int planned_poses = 100;  ///< stops that are planned, to tell what the cameras would see
  int jobs = 0;             ///< processes and threads, 0 = one a core
  int device = -2;          ///< as RenderOptions::device
  /// (images done, images in all); return false to interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress;
};

/// The measurements, with the rig husky_3x_d455 and its sensors' noise.
struct SceneCheck {
  std::string name;
  std::string description;
  bool outdoor = false;
  double planned_whole_share = 0.0;       ///< of the planned images, those with the whole board
  bool planned_board_everywhere = false;  ///< at every planned stop one camera at least has the whole board
  std::size_t images = 0;                 ///< rendered at the viewpoints
  std::size_t boards_visible = 0;         ///< of them with the whole board, by the truth
  std::size_t boards_found = 0;
  std::size_t depth_images = 0;
  std::size_t grounds_found = 0;         ///< that observing accepted
  double worst_normal_deg = 0.0;         ///< of those, against the true vertical
  double worst_height_mm = 0.0;          ///< of those, against the true height of the camera
  double least_floor_share = 1.0;        ///< of the depth measured in one image: the rest is walls, fronts, things
  double keypoints = 0.0;                ///< SIFT's on an image, mean
  Image8 towards_board, straight_ahead;  ///< two of the pictures, RGB; the second is empty without a straight path

  /// The ground's normal is true to 1 degree and its height to 5 mm and 0.3 % (a D455's scale error, one sigma), and
  /// no more than one depth image in twenty gave none.
  bool ground_is_good() const;
  bool board_is_good() const;
};

/// Generates into a folder for temporary files, which is removed. Throws Error if the scene cannot be used.
SceneCheck check_scene(const std::string& name_or_file, const SceneCheckOptions& options = {});

/// A table with a line for each scene.
std::string format_checks(const std::vector<SceneCheck>& checks);

/// Both pictures of every scene side by side, with names; a JPEG of at most 300 kB, or a PNG by the file's extension.
/// Throws Error if it cannot be written.
void write_scenes_picture(const std::vector<SceneCheck>& checks, const std::filesystem::path& file);

}  // namespace rigproof
