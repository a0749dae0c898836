// Sensors with the effects that two texts switch on and size, as a run's `sensing` and a preset's `simulation` do.
#pragma once

#include <string>

#include "rigproof/core/fields.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {

// By default most are on.
constexpr const char* kNoImageEffects =
    "{pixel_pattern: false, vignetting: false, exposure_jitter_percent: 0, demosaicing: false, sharpening: false, "
    "defocus_sigma_px: 0}";
constexpr const char* kNoDepthEffects =
    "{coarse_noise: false, bias_field: false, occlusion: false, edges: false, texture_holes: false}";

template <typename List>
List switched(List effects, const std::string& none, const std::string& switches, const std::string& strengths) {
  for (const std::string& text : {none, switches})
    read_fields_from_text(text, "sensing", [&](FieldVisitor& visitor) { effects.visit_switches(visitor); });
  read_fields_from_text(strengths, "simulation", [&](FieldVisitor& visitor) { effects.visit_strengths(visitor); });
  return effects;
}

inline ImageSensing image_sensing(const std::string& switches, const std::string& strengths = "{}") {
  ImageSensing image;
  DeviceDraws draws;
  add_effects(switched(image_effects(), kNoImageEffects, switches, strengths), &draws, &image);
  return image;
}

inline void add_effects(DepthSensing* depth, const std::string& switches, const std::string& strengths = "{}",
                        bool outdoors = false) {
  DeviceDraws draws;
  add_effects(switched(depth_effects(), kNoDepthEffects, switches, strengths), outdoors, &draws, depth);
}

/// What the measurement sees of clean depth.
inline ImageF scene_of(const DepthSensing& depth, const ImageF& clean_m, const Image8& color = Image8()) {
  SensorModel model;
  model.depth = depth;
  return Sensor(model, clean_m.width, clean_m.height).seen_depth(clean_m, color, FrameSeed());
}

/// A run that changes one thing at a time, without a file's name.
inline GenerateConfig plain_config(const std::string& more = "") {
  return parse_generate_config("include: plain.yaml\n" + more, "plain.yaml");
}

/// Changes what a text says, and nothing else.
inline void change(GenerateConfig* config, const std::string& text) {
  read_fields_from_text(text, "change", [config](FieldVisitor& visitor) { config->visit(visitor); });
}

}  // namespace rigproof
