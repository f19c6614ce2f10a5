// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <map>
#include <optional>
#include <set>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/known_measures.h"
#include "metrics/measures/body_motion.h"
#include "metrics/measures/collisions_per_km.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

const MeasureDefinition known::kRiftCollisionsPerKm = {
    "rift_compat_collisions_per_km",
    "/metrics/rift_compat/collisions_per_km/value",
    "RIFT: CPK",
    "1/km",
    Direction::kNeither,
    Subject::kCbvs,
    "1000 x CBVs that collided / distance over decision ticks in metres.",
    "",
    3,
    false,
    PoolingRule{Pooling::kMean, SessionWeight::kCbvKilometres},
};
const MeasureDefinition known::kRiftOffRoad = {
    "rift_compat_off_road_rate_percent",
    "/metrics/rift_compat/off_road_rate_percent/value",
    "RIFT: ORR",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "100 x CBV decisions with the centre off the drivable area / CBV decisions.",
    "",
};

namespace {

constexpr MeasureDefinition kReachedProgress = {
    "rift_compat_reached_progress_m",
    "/metrics/rift_compat/reached_progress_m/value",
    "RIFT: RP",
    "m",
    Direction::kHigherIsBetter,
    Subject::kCbvs,
    "Sum over CBVs of the distance between successive decisions; a sum, so it grows with the time "
    "driven as CBV.",
    "",
};
constexpr MeasureDefinition kRiftUncomfortable = {
    "rift_compat_uncomfortable_rate_percent",
    "/metrics/rift_compat/uncomfortable_rate_percent/value",
    "RIFT: UC",
    "%",
    Direction::kLowerIsBetter,
    Subject::kCbvs,
    "As cbv_uncomfortable_percent with a first last acceleration of 0.",
    "",
};

/// Rates and distance of CBVs as RIFT's code has them, from decision ticks; at most one collision
/// per vehicle, at any tick.
class RiftRates final : public Metric {
 public:
  explicit RiftRates(double decision_period) : decision_period_(decision_period) {}

  void observe(const MetricTick& tick) override {
    for (const ContactSighting& contact : tick.contacts)
      collided_.insert(contact.cbvs.begin(), contact.cbvs.end());
    if (!tick.snapshot.decision_tick) return;
    std::map<std::string, Life> present;
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      off_road_.add(cbv.off_road);
      driven_.insert(cbv.vehicle->id);
      present[cbv.vehicle->id] = live(*cbv.vehicle);
    }
    lives_.swap(present);
  }

  void report(MetricSink& sink) const override {
    sink.set(known::kRiftOffRoad, off_road_.measure(kNoCbv));
    sink.set(kRiftUncomfortable, uncomfortable_.measure(kNoCbv));
    sink.set(known::kRiftCollisionsPerKm,
             collisionsPerKilometre(collided_.size(), distance_, driven_.size()));
    const std::optional<double> progress =
        driven_.empty() ? std::nullopt : std::optional<double>(distance_);
    sink.set(kReachedProgress, measureOrReason(progress, driven_.size(), kNoCbv));
  }

 private:
  /// A CBV at the last decision.
  struct Life {
    double acceleration = 0.0;  ///< magnitude [m/s^2]
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
  };

  Life live(const traffic::Vehicle& vehicle) {
    const auto last = lives_.find(vehicle.id);
    const bool known = last != lives_.end();
    const Life now{bodyAcceleration(vehicle).magnitude(), vehicle.state.position};
    if (known) distance_ += (now.position - last->second.position).norm();
    const double before = known ? last->second.acceleration : 0.0;  // RIFT starts a life with 0
    uncomfortable_.add(
        isUncomfortable(bodyAcceleration(vehicle), (now.acceleration - before) / decision_period_));
    return now;
  }

  double decision_period_;
  std::map<std::string, Life> lives_;
  std::set<std::string> driven_;
  std::set<std::string> collided_;
  TickShare off_road_;
  TickShare uncomfortable_;
  double distance_ = 0.0;
};

}  // namespace

MetricDescriptor riftRatesMetric() {
  return {"rift_rates",
          "Rates of CBVs as RIFT's code computes them.",
          {known::kRiftCollisionsPerKm, known::kRiftOffRoad, kReachedProgress, kRiftUncomfortable},
          [](const MetricContext& context) {
            return std::make_unique<RiftRates>(context.options.decision_period);
          }};
}

}  // namespace cdiff::metrics
