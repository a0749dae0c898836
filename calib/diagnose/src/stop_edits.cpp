#include "stop_edits.h"

#include <algorithm>
#include <utility>

namespace rigproof::ml {
namespace {

// Of all that cameras saw.
template <typename Edit>
void edit_seen(Observations* observations, const Edit& edit) {
  edit(&observations->board_views);
  edit(&observations->ground_planes);
  edit(&observations->board_planes);
}

template <typename T>
void keep_stops(int first, int end, std::vector<T>* values) {
  values->erase(std::remove_if(values->begin(), values->end(),
                               [=](const T& value) { return value.stop < first || value.stop >= end; }),
                values->end());
}

template <typename T>
void sort_by_stop(std::vector<T>* values) {
  std::stable_sort(values->begin(), values->end(),
                   [](const T& a, const T& b) { return a.stop != b.stop ? a.stop < b.stop : a.camera < b.camera; });
}

// The way to the stop after this one, past it.
void join_ways(int stop, std::vector<Stop>* stops) {
  const std::size_t i = static_cast<std::size_t>(stop);
  if (i + 1 >= stops->size()) return;
  const Stop& passed = (*stops)[i];
  std::vector<Eigen::Vector3d> way = passed.way, rest = std::move((*stops)[i + 1].way);
  way.emplace_back(passed.x_m, passed.y_m, passed.yaw_rad);
  way.insert(way.end(), rest.begin(), rest.end());
  (*stops)[i + 1].way = std::move(way);
}

}  // namespace

Observations stops_between(const Observations& observations, int first, int end) {
  Observations part = observations;
  part.stops.assign(observations.stops.begin() + first, observations.stops.begin() + end);
  const auto cut = [&](auto* values) {
    keep_stops(first, end, values);
    for (auto& value : *values) value.stop -= first;
  };
  edit_seen(&part, cut);
  cut(&part.exclusions);
  return part;
}

Observations first_stops(const Observations& observations, int stops) {
  if (static_cast<int>(observations.stops.size()) <= stops) return observations;
  return stops_between(observations, 0, stops);
}

void leave_out_stop(int stop, Observations* observations) {
  join_ways(stop, &observations->stops);
  observations->stops.erase(observations->stops.begin() + stop);
  edit_seen(observations, [stop](auto* values) {
    values->erase(
        std::remove_if(values->begin(), values->end(), [stop](const auto& value) { return value.stop == stop; }),
        values->end());
    for (auto& value : *values)
      if (value.stop > stop) --value.stop;
  });
}

void swap_frames(int stop, int first, int second, Observations* observations) {
  edit_seen(observations, [=](auto* values) {
    for (auto& value : *values) {
      if (value.stop != stop || (value.camera != first && value.camera != second)) continue;
      value.camera = value.camera == first ? second : first;
    }
    sort_by_stop(values);
  });
}

void shift_cameras(const std::vector<int>& cameras, int by, int from, Observations* observations) {
  const int stops = static_cast<int>(observations->stops.size());
  edit_seen(observations, [&](auto* values) {
    const auto is_one_of_them = [&](const auto& value) {
      return std::find(cameras.begin(), cameras.end(), value.camera) != cameras.end();
    };
    values->erase(std::remove_if(values->begin(), values->end(),
                                 [&](const auto& value) {
                                   return is_one_of_them(value) && value.stop < from && value.stop >= from + by;
                                 }),
                  values->end());
    for (auto& value : *values)
      if (is_one_of_them(value) && value.stop >= from) value.stop += by;
    keep_stops(0, stops, values);
    sort_by_stop(values);
  });
}

void move_frames(const std::vector<int>& cameras, const std::vector<int>& to, Observations* observations) {
  edit_seen(observations, [&](auto* values) {
    for (auto& value : *values)
      if (std::find(cameras.begin(), cameras.end(), value.camera) != cameras.end())
        value.stop = to[static_cast<std::size_t>(value.stop)];
    sort_by_stop(values);
  });
}

}  // namespace rigproof::ml
