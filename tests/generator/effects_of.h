// Sensors with the effects that two texts switch on and size, as a run's `sensing` and a preset's `simulation` do.
#pragma once

#include <string>

#include "rigproof/core/fields.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {

template <typename List>
List switched(List effects, const std::string& switches, const std::string& strengths) {
  read_fields_from_text(switches, "sensing", [&](FieldVisitor& visitor) { effects.visit_switches(visitor); });
  read_fields_from_text(strengths, "simulation", [&](FieldVisitor& visitor) { effects.visit_strengths(visitor); });
  return effects;
}

inline ImageSensing image_sensing(const std::string& switches, const std::string& strengths = "{}") {
  ImageSensing image;
  DeviceDraws draws;
  add_effects(switched(image_effects(), switches, strengths), &draws, &image);
  return image;
}

inline void add_effects(DepthSensing* depth, const std::string& switches, const std::string& strengths = "{}",
                        bool outdoors = false) {
  DeviceDraws draws;
  add_effects(switched(depth_effects(), switches, strengths), outdoors, &draws, depth);
}

/// What the measurement sees of clean depth.
inline ImageF scene_of(const DepthSensing& depth, const ImageF& clean_m, const Image8& color = Image8()) {
  SensorModel model;
  model.depth = depth;
  return Sensor(model, clean_m.width, clean_m.height).seen_depth(clean_m, color, FrameSeed());
}

/// Changes what a text says, and nothing else.
inline void change(GenerateConfig* config, const std::string& text) {
  read_fields_from_text(text, "change", [config](FieldVisitor& visitor) { config->visit(visitor); });
}

}  // namespace rigproof
