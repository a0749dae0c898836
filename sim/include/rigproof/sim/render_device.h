// The EGL devices that can render off-screen.
#pragma once

#include <string>
#include <vector>

namespace rigproof {

/// One device as EGL enumerates it, or Mesa's surfaceless platform, which needs no device at all.
struct RenderDevice {
  int index = -1;        ///< for --device; -1 = surfaceless Mesa
  std::string name;      ///< "NVIDIA H100", "llvmpipe", ... ; empty until a context was made
  std::string drm_file;  ///< "/dev/dri/card0" or empty
  bool is_software = false;
};

/// All devices, hardware first. Never throws: without libEGL the list is empty and `problem` says what to install.
std::vector<RenderDevice> enumerate_render_devices(std::string* problem = nullptr);

/// Makes an OpenGL context and lets it go. Throws Error that says what is missing and what to install.
/// @param device -2 = the first that works, -1 = surfaceless Mesa, else the index of enumerate_render_devices()
void require_render_device(int device);

}  // namespace rigproof
