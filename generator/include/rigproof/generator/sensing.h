// Which sensor effects a run simulates: block `sensing` of its configuration. How strong an effect is stands in the
// sensor's preset, where it is a property of the device. All of these are sense keys: they can be changed without
// rendering again; but for camera_delay_ms where images are taken while the robot moves.
#pragma once

#include <cstdint>
#include <string>

#include "rigproof/core/distribution.h"
#include "rigproof/generator/effect.h"

namespace rigproof {

struct ImageSensingConfig {
  bool noise = true;
  EffectList<ImageEffect> effects = image_effects();
  std::int64_t jpeg_quality = 90;

  void visit(FieldVisitor& visitor);
};

struct DepthSensingConfig {
  bool noise = true;
  bool disparity_steps = true;
  EffectList<DepthEffect> effects = depth_effects();

  void visit(FieldVisitor& visitor);
};

struct LensSensingConfig {
  Distribution focal_error_percent = 0.0;
  Distribution centre_error_px = 0.0;
  Distribution distortion_error_percent = 0.0;

  void visit(FieldVisitor& visitor);
};

struct TimeSensingConfig {
  Distribution clock_offset_ms = 0.0;
  Distribution camera_delay_ms = 0.0;
  double stamp_jitter_ms = 0.0;
  double dropped_percent = 0.0;
  Distribution odometry_delay_ms = 0.0;
  double odometry_jitter_ms = 0.0;

  void visit(FieldVisitor& visitor);
};

struct SensingConfig {
  std::int64_t seed = -1;      ///< of everything random that is not rendered; -1 = the run's
  std::string told = "drawn";  ///< drawn | exact: what the recording tells of lenses, board and depth scales
  ImageSensingConfig image;
  DepthSensingConfig depth;
  LensSensingConfig lens;
  TimeSensingConfig time;

  void visit(FieldVisitor& visitor);
};

}  // namespace rigproof
