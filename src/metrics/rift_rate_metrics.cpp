// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <map>
#include <optional>
#include <set>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/body_motion.h"
#include "metrics/formulas/rift_histogram.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

namespace cdiff::metrics {

const MeasureDefinition known::kRiftTtc = {
    "rift_compat_ttc_2d_s",
    "/metrics/rift_compat/ttc_2d_s/value",
    "RIFT: RTTC, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "Per decision the smallest over vehicles within 60 m of RIFT's ray cast with bow-tie outlines, "
    "rounded to 0.01 s; mean of 0.5 s bins below 5 s at ego speeds of 3 to 10 m/s.",
    "",
};

namespace {

constexpr MeasureDefinition kTtcVariance = {
    "rift_compat_ttc_2d_variance_s2",
    "/metrics/rift_compat/ttc_2d_variance_s2/value",
    "RIFT: RTTC, variance",
    "s^2",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Variance of the RTTC bins' midpoints; RIFT prints it after +-.",
    "",
};
constexpr MeasureDefinition kAct = {
    "rift_compat_act_s",
    "/metrics/rift_compat/act_s/value",
    "RIFT: ACT, mean",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "Per decision the smallest over vehicles within 60 m of shortest corner-to-corner distance / "
    "approach speed of the centers, rounded to 0.01 s; mean of 0.5 s bins below 5 s at ego speeds "
    "of 3 to 10 m/s.",
    "",
};
constexpr MeasureDefinition kActVariance = {
    "rift_compat_act_variance_s2",
    "/metrics/rift_compat/act_variance_s2/value",
    "RIFT: ACT, variance",
    "s^2",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Variance of the same bins' midpoints.",
    "",
};

/// Times to collision as in RIFT's code: in bins below 5 s at ego speeds of 3 to 10 m/s.
class RiftInteraction final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    constexpr double kLeastSpeed = 3.0;  // cells at or below this edge are not reported
    constexpr double kMostSpeed = 10.0;  // last edge of RIFT's bins of the ego's speed
    if (!tick.snapshot.decision_tick || tick.ego == nullptr) return;
    const double speed = tick.ego->state.speed;
    if (!(speed > kLeastSpeed) || !(speed < kMostSpeed)) return;
    if (tick.interaction.rift_ttc) times_.add(*tick.interaction.rift_ttc);
    if (tick.interaction.rift_act) approach_times_.add(*tick.interaction.rift_act);
  }

  void report(MetricSink& sink) const override {
    report(sink, times_, known::kRiftTtc, kTtcVariance);
    report(sink, approach_times_, kAct, kActVariance);
  }

 private:
  static void report(MetricSink& sink, const RiftHistogram& times, const MeasureDefinition& mean,
                     const MeasureDefinition& variance) {
    constexpr const char* kNoTime = "no time below 5 s at an ego speed of 3 to 10 m/s";
    const std::size_t n = times.total();
    sink.set(mean, measureOrReason(times.mean(), n, kNoTime));
    sink.set(variance, measureOrReason(times.variance(), n, kNoTime));
  }

  RiftHistogram times_ = riftTtcHistogram();
  RiftHistogram approach_times_ = riftTtcHistogram();
};

}  // namespace

MetricDescriptor riftInteractionMetric() {
  return {"rift_interaction",
          "Times to collision as RIFT's code computes them.",
          {known::kRiftTtc, kTtcVariance, kAct, kActVariance},
          [](const MetricContext&) { return std::make_unique<RiftInteraction>(); }};
}

const MeasureDefinition known::kRiftCollisionsPerKm = {
    "rift_compat_collisions_per_km",
    "/metrics/rift_compat/collisions_per_km/value",
    "RIFT: CPK",
    "1/km",
    Direction::kNeither,
    Subject::kCbvs,
    "1000 x CBVs that collided / distance over decision ticks in meters.",
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
    "100 x CBV decisions with the center off the drivable area / CBV decisions.",
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

/// Rates and distance of CBVs as in RIFT's code, from decision ticks; at most one collision per
/// vehicle, at any tick.
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
             collisionsPerKilometer(collided_.size(), distance_, driven_.size()));
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
