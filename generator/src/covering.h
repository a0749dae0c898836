// The planner `covering`: every camera gets its share of stops, pairs of cameras see a board together, and boards come
// to lie all over each image, as far as the world lets them.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "places.h"
#include "rigproof/core/random.h"
#include "rigproof/generator/coverage.h"
#include "rigproof/generator/viewpoints.h"

namespace rigproof {

/// How often some stops have shown what.
class SeenSoFar {
 public:
  explicit SeenSoFar(const ViewpointSubject& subject);

  /// What a stop adds, in cells of an image: each thing counts less the more often it was shown.
  /// @param seeing the cameras that see a board from there
  double worth(const Viewpoint& stop, const std::vector<Sight>& seeing) const;
  void add(const Viewpoint& stop, const std::vector<Sight>& seeing);

 private:
  struct OfCamera {
    int views = 0;
    std::array<int, kImageCells> cells{};
  };

  std::vector<std::size_t> cells_of(const Viewpoint& stop, const Sight& sight) const;

  const ViewpointSubject& subject_;
  std::vector<OfCamera> cameras_;
  std::vector<int> pairs_;  ///< [a * cameras + b], a < b: stops from which both see the same board
};

/// Chooses stop after stop, each by what those before have not shown.
class CoveringPlanner {
 public:
  CoveringPlanner(const ViewpointConfig& config, const ViewpointSubject& subject, const Places& places)
      : config_(config), subject_(subject), places_(places), seen_(subject) {}

  /// A stop that is there already.
  void add(const Viewpoint& stop) { seen_.add(stop, places_.seeing(stop)); }

  /// Of places drawn from the stream, the one that shows most; nothing if none is possible. It is not added.
  std::optional<Viewpoint> next(RandomStream random, Tally* tally) const;

 private:
  struct Candidate {
    Viewpoint stop;
    double worth = 0.0;
  };

  std::vector<Viewpoint> turned_to_boards(const Viewpoint& place, RandomStream* random) const;
  std::optional<double> worth_without_obstacles(const Viewpoint& stop, Tally* tally) const;
  std::optional<Viewpoint> best_possible(std::vector<Candidate> candidates, Tally* tally) const;
  int needed() const { return std::max(1, static_cast<int>(config_.min_cameras)); }

  const ViewpointConfig& config_;
  const ViewpointSubject& subject_;
  const Places& places_;
  SeenSoFar seen_;
};

}  // namespace rigproof
