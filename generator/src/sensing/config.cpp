#include "rigproof/generator/sensing.h"

namespace rigproof {

void ImageSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("noise", noise, "shot and read noise, in linear light");
  visitor.field("pixel_pattern", pixel_pattern, "fixed gain and offset of every pixel of the device (PRNU, DSNU)");
  visitor.field("vignetting", vignetting, "the lens passes less light towards the corners");
  visitor.field("exposure", exposure, {0.05, 20.0}, "light over that of the render, drawn for each camera");
  visitor.field("exposure_jitter_percent", exposure_jitter_percent, {0.0, 50.0},
                "exposure differs from frame to frame, one sigma");
  visitor.field("defocus_sigma_px", defocus_sigma_px, {0.0, 10.0},
                "blur beside the lens's own, drawn for each camera; render.psf_sigma_px is the lens's");
  visitor.field("jpeg_quality", jpeg_quality, {0.0, 100.0},
                "images are stored as JPEG of this quality, 1 to 100; 0 = as PNG, without loss");
}

void DepthSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("noise", noise, "random noise by the sensor's law, correlated between neighbours");
  visitor.field("disparity_steps", disparity_steps, "stereo: disparity is rounded to the preset's steps");
  visitor.field("coarse_noise", coarse_noise, "part of the noise is patchy and rippled, as the preset says");
  visitor.field("bias_field", bias_field, "smooth, fixed error of the device over its field of view");
  visitor.field("occlusion", occlusion, "no depth where one of the sensor's imagers does not see the point");
  visitor.field("edges", edges, "edges are frayed, and some pixels float between near and far");
  visitor.field("texture_holes", texture_holes,
                "stereo: no depth without texture, beyond the projector's reach, and where pixels are saturated");
  visitor.field("daylight", daylight, "outdoors time of flight loses most of its pixels and of its range");
  visitor.field("misregistration_px", misregistration_px, {-50.0, 50.0},
                "shift of the depth image against the colour image, drawn for each camera and axis, in whole pixels");
}

void LensSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("focal_error_percent", focal_error_percent, {-10.0, 10.0},
                "the focal length that the user is told is too large by this, drawn for each camera");
  visitor.field("centre_error_px", centre_error_px, {-50.0, 50.0},
                "the same for the principal point, drawn for each camera and axis");
  visitor.field("distortion_error_percent", distortion_error_percent, {-100.0, 100.0},
                "the same for each coefficient of the lens");
}

void TimeSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("clock_offset_ms", clock_offset_ms, {-1000.0, 1000.0},
                "a camera's stamps are later than the truth by this, drawn for each camera");
  visitor.field("camera_delay_ms", camera_delay_ms, {-1000.0, 1000.0},
                "a camera takes its images later than the stop's time by this and says so, drawn for each camera: "
                "cameras without a common trigger. With drive.capture moving a render key, >= 0: images show where the "
                "robot is then, and the run's seed draws");
  visitor.field("stamp_jitter_ms", stamp_jitter_ms, {0.0, 1000.0}, "error of every single stamp, one sigma");
  visitor.field("dropped_percent", dropped_percent, {0.0, 90.0}, "share of the frames that were never recorded");
  visitor.field("odometry_delay_ms", odometry_delay_ms, {-1000.0, 1000.0},
                "stamps of the odometry are later than the truth by this, drawn once a run");
  visitor.field("odometry_jitter_ms", odometry_jitter_ms, {0.0, 1000.0}, "error of every single stamp, one sigma");
}

void SensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("seed", seed, {-1.0, 9007199254740992.0},
                "of noise, devices and odometry; -1 = the run's seed, which also draws the world and the drive");
  visitor.nested("image", image, "colour images");
  visitor.nested("depth", depth, "depth images");
  visitor.nested("lens", lens, "what the user is told of the lens against what is true");
  visitor.nested("time", time, "stamps");
}

}  // namespace rigproof
