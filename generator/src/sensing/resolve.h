// From configuration and presets to what each camera's sensor does, and what the recording says of lens and time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/sensors.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// Of everything random that is not rendered.
std::uint64_t sensing_seed(const GenerateConfig& config);

/// One model a camera of the rig. Throws Error if a camera's preset cannot be read.
/// @param outdoors the scene lies in daylight
std::vector<SensorModel> resolve_sensors(const GenerateConfig& config, const Rig& rig, bool outdoors);

/// Whether lenses, board and depth scales are told with the errors that calibrations and rulers leave.
bool told_is_drawn(const GenerateConfig& config);
/// What the depth of a camera of the rig is multiplied by: asked for, or drawn with a part that cameras of its make
/// share, or 1.
double depth_scale_of(const GenerateConfig& config, const Rig& rig, int index, DeviceDraws* draws);
/// In place of what is true: the intrinsics and how well they are known, which is exactly unless an error may be drawn.
/// What `sensing.lens` asks for replaces what would be drawn of the same quantity.
void tell_lens(const GenerateConfig& config, std::int32_t index, RigCamera* camera);
/// The same for the side of the squares of a board of the run.
void tell_board(const GenerateConfig& config, std::size_t index, Board* board);
/// Where a board of the run beside the first one stands against that, as its owner measured it; nothing, if nobody did.
std::optional<BoardPlace> told_place(const GenerateConfig& config, std::size_t index, const Rigid3& T_first_board);
/// The true readout, of images taken at speed; nothing, where errors may be drawn: people do not know it.
void tell_readout(const GenerateConfig& config, double readout_s, RigCamera* camera);
/// How well the scale of depth that cameras of a make share is known; neither an offset nor a tilt is simulated.
void tell_depth(const GenerateConfig& config, RigCamera* camera);

/// Says in the camera's noise law how large the device's fixed depth error is that the model simulates: none, if none.
void tell_depth_bias(const SensorModel& model, RigCamera* camera);

/// By how much each camera takes its images later than the stops where the robot moves meanwhile: pictures and poses
/// are those of that time. Drawn by the run's seed, as all that is rendered; zeros where images are taken standing.
std::vector<double> rendered_delays_s(const GenerateConfig& config, std::size_t cameras);
/// What is left to disturb_time(): without the delays of cameras that rendered_delays_s() has.
TimeSensingConfig sensed_time(const GenerateConfig& config);

/// What is wrong with the clocks: moves the stamps of frames and odometry, forgets dropped frames, and labels it in the
/// truth. Stamps stay in order. At least one frame of every camera is kept.
void disturb_time(const TimeSensingConfig& config, std::uint64_t seed, Recording* recording, Truth* truth);
/// The part of it that concerns the odometry.
void disturb_odometry_time(const TimeSensingConfig& config, std::uint64_t seed, Recording* recording, Truth* truth);

}  // namespace rigproof
