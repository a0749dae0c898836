// Domain randomisation: the same place with other surfaces, another light, things moved about.
#pragma once

#include <cstdint>

#include "rigproof/core/distribution.h"
#include "rigproof/core/fields.h"
#include "rigproof/sim/models.h"

namespace rigproof {

/// What is drawn anew for each seed. The defaults change nothing; patterns of textures follow the seed anyway, and
/// where the board stands is a distribution of the scene or of the configuration.
struct SceneVariation {
  Distribution texture_scale = 1.0;     ///< factor, for each texture
  Distribution texture_contrast = 1.0;  ///< factor, for each texture
  Distribution texture_color = 1.0;     ///< factor, for each texture and each of red, green, blue
  Distribution light_brightness = 1.0;  ///< factor, once
  Distribution light_turn_deg = 0.0;    ///< of all lights about the vertical, once
  Distribution light_warmth = 0.0;      ///< -1 bluish to 1 reddish, once
  Distribution cloud_cover = 0.0;       ///< added to the scene's, once
  double clutter_share = 1.0;           ///< of the movable objects (no doors, no trees) that are there
  Distribution clutter_shift_m = 0.0;   ///< along x and along y, for each movable object
  Distribution clutter_turn_deg = 0.0;  ///< for each movable object

  void visit(FieldVisitor& visitor);
};

/// The scene as the variation and the seed make it. No object is moved to where it would be in the robot's way, in the
/// drivable area or on the straight path: it stays where it was.
SceneModel varied(const SceneModel& scene, const SceneVariation& variation, std::uint64_t seed);

}  // namespace rigproof
