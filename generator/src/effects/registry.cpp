#include "rigproof/generator/effect.h"

namespace rigproof {

// An effect is a line here. In this order their switches stand in a configuration, and they draw.
#define RIGPROOF_IMAGE_EFFECTS(EFFECT) \
  EFFECT(pixel_pattern)                \
  EFFECT(vignetting)                   \
  EFFECT(exposure)                     \
  EFFECT(defocus)                      \
  EFFECT(demosaicing)                  \
  EFFECT(sharpening)

#define RIGPROOF_DEPTH_EFFECTS(EFFECT) \
  EFFECT(coarse_noise)                 \
  EFFECT(bias_field)                   \
  EFFECT(occlusion)                    \
  EFFECT(edges)                        \
  EFFECT(texture_holes)                \
  EFFECT(daylight)                     \
  EFFECT(misregistration)

#define DECLARE_IMAGE_EFFECT(NAME) std::unique_ptr<ImageEffect> NAME##_effect();
#define DECLARE_DEPTH_EFFECT(NAME) std::unique_ptr<DepthEffect> NAME##_effect();
#define ADD_EFFECT(NAME) effects.push_back(NAME##_effect());

RIGPROOF_IMAGE_EFFECTS(DECLARE_IMAGE_EFFECT)
RIGPROOF_DEPTH_EFFECTS(DECLARE_DEPTH_EFFECT)

EffectList<ImageEffect> image_effects() {
  std::vector<std::unique_ptr<ImageEffect>> effects;
  RIGPROOF_IMAGE_EFFECTS(ADD_EFFECT)
  return EffectList<ImageEffect>(std::move(effects));
}

EffectList<DepthEffect> depth_effects() {
  std::vector<std::unique_ptr<DepthEffect>> effects;
  RIGPROOF_DEPTH_EFFECTS(ADD_EFFECT)
  return EffectList<DepthEffect>(std::move(effects));
}

}  // namespace rigproof
