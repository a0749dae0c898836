// Smaller images for programs that look at brightness alone.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

namespace rigproof {

/// Rewrites every 8-bit colour PNG below `folder` as the grey that our own detector sees, packed as tightly as PNG goes
/// in passable time. Other files stay. `progress` gets (files looked at, all) and returns false to interrupt, which
/// throws Error with ExitCode::kTryAgain; so does, with another code, an image that cannot be read.
void make_images_grey(const std::filesystem::path& folder,
                      const std::function<bool(std::size_t, std::size_t)>& progress = {});

}  // namespace rigproof
