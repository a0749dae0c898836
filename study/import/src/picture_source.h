// One image of each stop and camera, of whatever holds a drive.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/unreadable.h"
#include "rigproof/study/import/init.h"

namespace rigproof {

class PictureSource {
 public:
  /// Camera, and frame in Recording::frames[camera].
  using Place = std::pair<std::size_t, std::size_t>;
  /// Reads the picture; may be called from any thread, also after read() is through.
  using Picture = std::function<std::variant<Image8, Unreadable>()>;
  using Take = std::function<void(const Place&, Picture)>;

  virtual ~PictureSource() = default;
  /// As the source is now: rig, odometry, and the frames that are worth a look. Throws Error.
  virtual Recording choose() = 0;
  /// Frames of the latest choice, in any order; of a bag the message is held by the picture.
  virtual void read(const std::vector<Place>& wanted, const Take& take) = 0;
  /// Whether its rig says which board it is.
  virtual bool knows_board() const { return false; }
};

/// @param options of `init`, but for its output
/// @param growing the last line of a list may be half-written
/// @param scratch an empty folder
/// Throws Error where the source is none.
std::unique_ptr<PictureSource> open_pictures(const InitOptions& options, bool growing,
                                             const std::filesystem::path& scratch);

}  // namespace rigproof
