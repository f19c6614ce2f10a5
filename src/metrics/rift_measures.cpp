// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/rift_measures.h"

#include <cmath>
#include <utility>

#include "e2e_cdiff/metrics/collisions_per_km.h"
#include "e2e_cdiff/metrics/shapiro_wilk.h"

namespace cdiff::metrics {
namespace {

constexpr std::size_t kDrawn = 3000;  // values that RIFT draws from a histogram

Measure histogramMeasure(const char* unit, std::uint64_t n, const std::optional<double>& value,
                         const char* reason) {
  Measure measure;
  measure.unit = unit;
  measure.n = static_cast<std::size_t>(n);
  measure.value = value;
  if (!value) measure.reason = reason;
  return measure;
}

}  // namespace

void RiftMeasures::observeEgo(double speed, const std::optional<double>& time_to_collision) {
  constexpr double kLeastSpeed = 3.0;  // cells at or below this edge are not reported
  constexpr double kMostSpeed = 10.0;  // last edge of RIFT's bins of the ego's speed
  if (!time_to_collision || !(speed > kLeastSpeed) || !(speed < kMostSpeed)) return;
  times_.add(*time_to_collision);
}

void RiftMeasures::live(Life& life, const traffic::Vehicle& vehicle) {
  const auto& state = vehicle.state;
  if (life.decisions > 0) distance_ += (state.position - life.last_position).norm();
  life.last_position = state.position;
  ++life.decisions;
  life.speeds.add(state.speed);
  // At the rear axle the velocity points along the heading: lateral acceleration = speed x yaw
  // rate.
  life.accelerations.add(std::hypot(vehicle.acceleration, state.speed * vehicle.yaw_rate));
  speeds_.add(life.speeds);
  accelerations_.add(life.accelerations);
}

void RiftMeasures::observeCbvs(const std::vector<CbvSighting>& cbvs) {
  std::map<std::string, Life> present;
  for (const CbvSighting& cbv : cbvs) {
    const traffic::Vehicle& vehicle = *cbv.vehicle;
    if (!vehicle.state.position.allFinite()) continue;
    off_road_.add(cbv.off_road);
    driven_.insert(vehicle.id);
    auto known = lives_.extract(vehicle.id);
    const auto place = known ? present.insert(std::move(known)).position
                             : present.emplace(vehicle.id, Life{}).first;
    live(place->second, vehicle);
  }
  lives_.swap(present);
}

Measure RiftMeasures::shapiroWilkMeasure(const RiftHistogram& histogram) const {
  const std::size_t n = off_road_.ticks();
  if (n == 0) return histogramMeasure("", 0, std::nullopt, kNoCbv);
  if (histogram.total() == 0) {
    return histogramMeasure("", n, std::nullopt, "no value lies inside RIFT's bins");
  }
  return histogramMeasure("", n, shapiroWilk(histogram.resample(kDrawn)).w, "");
}

Measure RiftMeasures::wassersteinMeasure() const {
  const std::size_t n = off_road_.ticks();
  if (n == 0) return histogramMeasure("m/s", 0, std::nullopt, kNoCbv);
  const auto mean = speeds_.mean();
  if (!mean) return histogramMeasure("m/s", n, std::nullopt, "no value lies inside RIFT's bins");
  return histogramMeasure("m/s", n, riftSpeedWasserstein(*mean, std::sqrt(*speeds_.variance())),
                          "");
}

std::map<std::string, Measure> RiftMeasures::measures() const {
  constexpr const char* kNoTime = "no time below 5 s at an ego speed of 3 to 10 m/s";
  std::map<std::string, Measure> result;
  result["ttc_2d_s"] = histogramMeasure("s", times_.total(), times_.mean(), kNoTime);
  result["ttc_2d_variance_s2"] =
      histogramMeasure("s^2", times_.total(), times_.variance(), kNoTime);
  result["speed_shapiro_wilk"] = shapiroWilkMeasure(speeds_);
  result["acceleration_shapiro_wilk"] = shapiroWilkMeasure(accelerations_);
  result["speed_wasserstein_mps"] = wassersteinMeasure();
  result["off_road_rate_percent"] = off_road_.measure(kNoCbv);
  result["collisions_per_km"] = collisionsPerKilometre(collided_.size(), distance_, driven_.size());
  return result;
}

}  // namespace cdiff::metrics
