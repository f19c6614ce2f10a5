// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/rift_measures.h"

#include <cmath>
#include <utility>

#include "metrics/collisions_per_km.h"
#include "metrics/comfort_measures.h"
#include "metrics/shapiro_wilk.h"

namespace cdiff::metrics {
namespace {

constexpr std::size_t kDrawn = 3000;  // values that RIFT draws from a histogram
constexpr const char* kOutsideBins = "no value lies inside RIFT's bins";

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

void RiftMeasures::observeEgo(double speed, const std::optional<double>& time_to_collision,
                              const std::optional<double>& approach_time) {
  constexpr double kLeastSpeed = 3.0;  // cells at or below this edge are not reported
  constexpr double kMostSpeed = 10.0;  // last edge of RIFT's bins of the ego's speed
  if (!(speed > kLeastSpeed) || !(speed < kMostSpeed)) return;
  if (time_to_collision) times_.add(*time_to_collision);
  if (approach_time) approach_times_.add(*approach_time);
}

void RiftMeasures::live(Life& life, const traffic::Vehicle& vehicle) {
  const auto& state = vehicle.state;
  if (life.decisions > 0) distance_ += (state.position - life.last_position).norm();
  life.last_position = state.position;
  ++life.decisions;
  // RIFT's velocity is that of the rear axle, which points along the heading.
  const BodyAcceleration acceleration = bodyAcceleration(vehicle);
  const double magnitude = acceleration.magnitude();
  const double jerk = (magnitude - life.last_acceleration) / decision_period_;
  life.last_acceleration = magnitude;
  uncomfortable_.add(isUncomfortable(acceleration, jerk));
  life.speeds.add(state.speed);
  life.accelerations.add(magnitude);
  life.jerks.add(jerk);
  speeds_.add(life.speeds);
  accelerations_.add(life.accelerations);
  jerks_.add(life.jerks);
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
    return histogramMeasure("", n, std::nullopt, kOutsideBins);
  }
  return histogramMeasure("", n, shapiroWilk(histogram.resample(kDrawn)).w, "");
}

Measure RiftMeasures::wassersteinMeasure() const {
  const std::size_t n = off_road_.ticks();
  std::optional<double> distance;
  if (const auto mean = speeds_.mean())
    distance = riftSpeedWasserstein(*mean, std::sqrt(*speeds_.variance()));
  Measure measure = histogramMeasure("m/s", n, distance, n == 0 ? kNoCbv : kOutsideBins);
  measure.target = "8.5 m/s for all (30 km/h in RIFT's bins)";
  return measure;
}

void RiftMeasures::addTimes(std::map<std::string, Measure>& result) const {
  constexpr const char* kNoTime = "no time below 5 s at an ego speed of 3 to 10 m/s";
  const std::pair<const char*, const RiftHistogram*> times[] = {{"ttc_2d", &times_},
                                                                {"act", &approach_times_}};
  for (const auto& [name, times] : times) {
    const std::uint64_t n = times->total();
    result[std::string(name) + "_s"] = histogramMeasure("s", n, times->mean(), kNoTime);
    result[std::string(name) + "_variance_s2"] =
        histogramMeasure("s^2", n, times->variance(), kNoTime);
  }
}

void RiftMeasures::addMotion(std::map<std::string, Measure>& result) const {
  struct Quantity {
    const char* name;
    const char* suffix;
    const char* unit;
    const RiftHistogram& histogram;
  };
  const Quantity quantities[] = {{"speed", "mps", "m/s", speeds_},
                                 {"acceleration", "mps2", "m/s^2", accelerations_},
                                 {"jerk", "mps3", "m/s^3", jerks_}};
  const std::size_t n = off_road_.ticks();
  const char* reason = n == 0 ? kNoCbv : kOutsideBins;
  for (const Quantity& quantity : quantities) {
    const std::string name = quantity.name;
    std::optional<double> deviation = quantity.histogram.variance();
    if (deviation) deviation = std::sqrt(*deviation);
    result[name + "_mean_" + quantity.suffix] =
        histogramMeasure(quantity.unit, n, quantity.histogram.mean(), reason);
    result[name + "_std_" + quantity.suffix] =
        histogramMeasure(quantity.unit, n, deviation, reason);
  }
}

std::map<std::string, Measure> RiftMeasures::measures() const {
  std::map<std::string, Measure> result;
  addTimes(result);
  addMotion(result);
  result["speed_shapiro_wilk"] = shapiroWilkMeasure(speeds_);
  result["acceleration_shapiro_wilk"] = shapiroWilkMeasure(accelerations_);
  result["speed_wasserstein_mps"] = wassersteinMeasure();
  result["off_road_rate_percent"] = off_road_.measure(kNoCbv);
  result["uncomfortable_rate_percent"] = uncomfortable_.measure(kNoCbv);
  result["collisions_per_km"] = collisionsPerKilometre(collided_.size(), distance_, driven_.size());
  result["reached_progress_m"] =
      histogramMeasure("m", driven_.size(),
                       driven_.empty() ? std::nullopt : std::optional<double>(distance_), kNoCbv);
  return result;
}

}  // namespace cdiff::metrics
