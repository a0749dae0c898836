// What a simulator needs to know of a sensor beyond its intrinsics and its noise law: block `simulation` of
// models/sensors/NAME.yaml. Whether an effect is simulated is for a run's configuration to say; how strong it is stands
// there, with its source beside it in the file. Formulas: docs/theory/sensors.md.
#pragma once

#include <string>

#include "rigproof/core/rig_yaml.h"
#include "rigproof/generator/sensing.h"

namespace rigproof {

/// The image sensor (EMVA 1288; 8-bit output, gamma coded).
struct ImageDevice {
  double full_well_electrons = 6300.0;  ///< light that gives level 255
  double read_noise_electrons = 2.5;
  double gamma = 2.2;
  double exposure_ms = 10.0;          ///< of a row, indoors
  double readout_ms = 0.0;            ///< rolling shutter: from the first row's start to the last row's; 0 = global
  double lens_residual_px = 0.15;     ///< of a coordinate, over the image: see LensResidual
  double lens_residual_cells = 16.0;  ///< across the image
  EffectList<ImageEffect> effects = image_effects();

  void visit(FieldVisitor& visitor);
};

/// The depth sensor. The standard deviation of its noise is the law of the preset's block `depth`.
struct DepthSensorDevice {
  double disparity_step_px = 1.0 / 32.0;  ///< stereo: resolution of the disparity
  double patch_px = 24.0;                 ///< size of a patch, of noise and of what daylight leaves
  double readout_ms = 0.0;                ///< between the measurements of the first and the last row; 0 = all at once
  EffectList<DepthEffect> effects = depth_effects();

  void visit(FieldVisitor& visitor);
};

struct SensorDevice {
  SensorPreset preset;
  ImageDevice color;
  DepthSensorDevice depth;

  void visit(FieldVisitor& visitor);
};

/// A preset with its block `simulation`; a general device for an empty name. The effects have their strengths from the
/// preset and their switches from the configuration. Throws Error with every problem of the preset.
SensorDevice load_sensor_device(const std::string& name, const SensingConfig& config = {});

}  // namespace rigproof
