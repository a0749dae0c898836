// What a simulator needs to know of a sensor beyond its intrinsics and its noise law: block `simulation` of
// models/sensors/NAME.yaml. Whether an effect is simulated is for a run's configuration to say; how strong it is stands
// here, with its source beside it in the file. Formulas: docs/sensors.md.
#pragma once

#include <vector>

#include "rigproof/core/fields.h"

namespace rigproof {

/// The image sensor and its lens (EMVA 1288; 8-bit output, gamma coded).
struct ImageSimulation {
  double full_well_electrons = 6300.0;  ///< light that gives level 255
  double read_noise_electrons = 2.5;
  double gamma = 2.2;
  double dark_offset_electrons = 1.0;  ///< fixed offset of each pixel (DSNU), one sigma
  double pixel_gain_percent = 0.8;     ///< fixed gain error of each pixel (PRNU), one sigma
  double corner_light_percent = 60.0;  ///< light in the image's corner over that in its centre
  double exposure_ms = 10.0;           ///< of a row, indoors
  double readout_ms = 0.0;             ///< rolling shutter: from the first row's start to the last row's; 0 = global

  void visit(FieldVisitor& visitor);
};

/// The depth sensor. The standard deviation of its noise is the law of the preset's block `depth`.
struct DepthSimulation {
  double disparity_step_px = 1.0 / 32.0;    ///< stereo: resolution of the disparity
  double bias_px = 0.05;                    ///< stereo: one sigma of the device's smooth bias field
  double bias_m = 0.003;                    ///< time of flight: the same
  double bias_cell_deg = 15.0;              ///< how far apart the bias differs
  std::vector<double> imagers_x_m;          ///< along the colour camera's x; depth is where all of them see
  double edge_jitter_px = 1.0;              ///< lateral noise of edges, one sigma
  double flying_share = 0.3;                ///< of the pixels at an edge: those between near and far
  double edge_step_per_m = 0.02;            ///< jump of 1/z that makes an edge
  double min_contrast_levels = 6.0;         ///< of 8x8 pixels, needed where no projector helps
  double projector_reach_m = 5.0;           ///< the pattern gives texture up to here, indoors
  double projector_reach_outdoors_m = 1.0;  ///< and in daylight
  double patchy_share = 0.0;                ///< of the noise's variance: varies over patch_px
  double patch_px = 24.0;                   ///< size of a patch
  double ripple_share = 0.0;                ///< of the noise's variance: waves along the image's columns
  double ripple_px = 12.0;                  ///< their length
  double outdoor_valid_share = 1.0;         ///< of the pixels, in daylight
  double outdoor_max_m = 1000.0;            ///< range in daylight
  double readout_ms = 0.0;                  ///< between the measurements of the first and the last row; 0 = all at once

  void visit(FieldVisitor& visitor);
};

struct SensorSimulation {
  ImageSimulation color;
  DepthSimulation depth;

  void visit(FieldVisitor& visitor);
};

}  // namespace rigproof
