// Sensor effects. An effect is one file in generator/src/effects, with its switch in a run's `sensing`, its strength in
// a sensor preset's `simulation`, its labels in the truth and its mathematics, and one line in effects/registry.cpp.
// Formulas and sources: docs/theory/sensors.md.
//
// An object of an effect goes through four stages: switches are read from the run, strengths from the preset; resolve()
// draws what a device has; prepare() makes its tables; then the hooks are called for every frame.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rigproof/core/fields.h"
#include "rigproof/core/image.h"
#include "rigproof/core/random.h"
#include "rigproof/core/rig.h"

namespace rigproof {

struct DepthSensing;

/// Where the random numbers of one frame come from.
struct FrameSeed {
  std::uint64_t seed = 0;
  std::int64_t frame = -1;
  std::int32_t camera = -1;

  RandomStream stream(std::string_view purpose) const { return {seed, purpose, frame, camera}; }
};

/// Random numbers of a device that several effects draw from: who asks later goes on where the earlier one stopped.
class DeviceDraws {
 public:
  explicit DeviceDraws(const FrameSeed& device = {}) : device_{device.seed, -1, device.camera} {}
  RandomStream& of(const std::string& purpose) {
    return streams_.try_emplace(purpose, device_.stream(purpose)).first->second;
  }

 private:
  FrameSeed device_;
  std::map<std::string, RandomStream> streams_;
};

/// What an effect of the depth image is resolved for.
struct DepthDevice {
  DepthSensing& sensing;  ///< an effect may narrow the range
  bool outdoors = false;
};

/// Names with units and values, for the truth.
using Labels = std::map<std::string, double>;

class Effect {
 public:
  virtual ~Effect() = default;
  virtual void visit_switch(FieldVisitor& visitor) = 0;
  virtual void visit_strength(FieldVisitor& /*visitor*/) {}
  /// Of an effect that is on.
  virtual void label(Labels* labels) const = 0;
  /// Makes what is fixed for a device. @param width, height of the images that the hooks get
  virtual void prepare(int /*width*/, int /*height*/, const FrameSeed& /*device*/) {}
};

/// Changes light between the lens and the pixels' noise, and levels after it. Hooks are called in the order in which
/// they stand here, those of several effects in the order of the registry.
class ImageEffect : public Effect {
 public:
  virtual std::unique_ptr<ImageEffect> clone() const = 0;
  /// Returns whether the effect is on for this device.
  virtual bool resolve(DeviceDraws* draws) = 0;

  /// True if change_image() is wanted: it takes a whole image in memory.
  virtual bool changes_image() const { return false; }
  /// Light in electrons, three interleaved channels.
  virtual void change_image(ImageF* /*electrons*/) const {}
  /// Light of the whole frame over that of the render.
  virtual double light_of_frame(const FrameSeed& /*frame*/) const { return 1.0; }
  /// Light of each pixel of row y over that of the render.
  virtual void change_light(int /*y*/, std::size_t /*pixels*/, float* /*light*/) const {}
  /// Electrons of the three interleaved channels of row y.
  virtual void change_electrons(int /*y*/, std::size_t /*samples*/, float* /*electrons*/) const {}
  /// The levels of the whole picture, after noise: what the camera's processor makes of it.
  virtual void change_levels(Image8* /*image*/) const {}
  /// How far below nothing change_electrons() may bring a sample [electrons], but for a few in a hundred thousand.
  virtual double pedestal_electrons() const { return 0.0; }
};

/// Calls of one frame, with rows from the top.
using ChangeRow = std::function<void(int y, float* row)>;

/// Changes the depth before, while and after it is measured.
class DepthEffect : public Effect {
 public:
  /// Order of the hook change_scene(); effects with the same place follow the registry.
  enum class Place {
    kShape,  ///< where surfaces are seen
    kSight,  ///< what is seen of them at all
    kFrame   ///< where the picture lies
  };
  struct Scene {
    const ImageF& clean_m;  ///< z along the optical axis, 0 = nothing there
    const Image8& color;    ///< clean, what the imagers see; may be empty
    FrameSeed frame;
  };

  virtual std::unique_ptr<DepthEffect> clone() const = 0;
  /// Returns whether the effect is on for this device.
  virtual bool resolve(const DepthDevice& device, DeviceDraws* draws) = 0;
  /// Says in the noise law what the recording's reader is told of the effect.
  virtual void tell(DepthNoise* /*told*/) const {}

  virtual Place place() const { return Place::kSight; }
  /// True if change_scene() is wanted: it takes a copy of the depth image.
  virtual bool changes_scene() const { return false; }
  virtual void change_scene(const Scene& /*scene*/, ImageF* /*depth_m*/) const {}
  /// Changes rows of standard normal numbers, the noise, and keeps their variance. Empty: it does not.
  virtual ChangeRow noise_of(const FrameSeed& /*frame*/) const { return {}; }
  /// Adds to the errors of row y: pixels of disparity in stereo, else metres.
  virtual void add_error(int /*y*/, float* /*error*/) const {}
  virtual void change_counts(const FrameSeed& /*frame*/, Image16* /*counts*/) const {}
};

/// clone() of an effect that can be copied.
template <typename Base, typename Derived>
class ClonedEffect : public Base {
 public:
  std::unique_ptr<Base> clone() const override { return std::make_unique<Derived>(static_cast<const Derived&>(*this)); }
};

/// A list of effects that is copied as a value.
template <typename Kind>
class EffectList {
 public:
  EffectList() = default;
  explicit EffectList(std::vector<std::unique_ptr<Kind>> effects) : effects_(std::move(effects)) {}
  EffectList(const EffectList& other) {
    for (const auto& effect : other.effects_) effects_.push_back(effect->clone());
  }
  EffectList(EffectList&&) noexcept = default;
  EffectList& operator=(EffectList other) noexcept {
    effects_.swap(other.effects_);
    return *this;
  }
  ~EffectList() = default;

  auto begin() const { return effects_.begin(); }
  auto end() const { return effects_.end(); }
  bool empty() const { return effects_.empty(); }

  void visit_switches(FieldVisitor& visitor) {
    for (const auto& effect : effects_) effect->visit_switch(visitor);
  }
  void visit_strengths(FieldVisitor& visitor) {
    for (const auto& effect : effects_) effect->visit_strength(visitor);
  }
  /// The effects that are on for a device; arguments as Kind::resolve().
  template <typename... Arguments>
  EffectList resolved(Arguments&&... arguments) const {
    EffectList on = *this;
    // One after the other, as they draw: std::remove_if promises no order.
    std::vector<std::unique_ptr<Kind>> kept;
    for (auto& effect : on.effects_)
      if (effect->resolve(arguments...)) kept.push_back(std::move(effect));
    return EffectList(std::move(kept));
  }
  void prepare(int width, int height, const FrameSeed& device) {
    for (const auto& effect : effects_) effect->prepare(width, height, device);
  }
  template <typename Less>
  void sort(const Less& less) {
    std::stable_sort(effects_.begin(), effects_.end(), [&](const auto& a, const auto& b) { return less(*a, *b); });
  }
  void label(Labels* labels) const {
    for (const auto& effect : effects_) effect->label(labels);
  }

 private:
  std::vector<std::unique_ptr<Kind>> effects_;
};

/// All effects that there are, switched as by default, with the strengths of a general device.
EffectList<ImageEffect> image_effects();
EffectList<DepthEffect> depth_effects();

}  // namespace rigproof
