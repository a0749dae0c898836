// Clean renders on disk, by the hash of everything that rendering depends on, so that one render is sensed many times.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/image.h"

namespace rigproof {

/// What the renderer gives of one frame: gamma-coded 8-bit colour, and depth.
struct CleanFrame {
  std::string gl_renderer;  ///< that drew it
  Image8 color;
  ImageF depth_m;  ///< empty where the camera has none
  Image8 imager;   ///< what a depth camera of its own sees, of the size of `depth_m`; else empty
};

/// A folder of clean frames. Any number of processes may read and write at once. Const: one thread at a time.
class CleanCache {
 public:
  explicit CleanCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Name of the driver that drew the frame, or empty if the cache does not hold it.
  std::string renderer_of(const std::string& key) const;
  /// Reads the frame into the memory that `frame` has. False if it is not there or damaged.
  bool load(const std::string& key, CleanFrame* frame) const;
  /// Writes it, whole or not at all, without loss. Throws Error.
  void save(const std::string& key, const CleanFrame& frame) const;

  std::filesystem::path file_of(const std::string& key) const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  mutable std::vector<std::uint8_t> file_, planes_;  ///< of the last frame, kept for the next
};

/// The bytes of a frame on disk, and back; false if they are damaged. `scratch` is memory that is kept for the next
/// one.
std::string encode_clean_frame(const CleanFrame& frame);
bool decode_clean_frame(const std::vector<std::uint8_t>& bytes, std::vector<std::uint8_t>* scratch, CleanFrame* frame);

}  // namespace rigproof
