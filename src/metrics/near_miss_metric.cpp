// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cstddef>
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sample_statistics.h"

namespace cdiff::metrics {
namespace {

constexpr MeasureDefinition kNearMisses = {
    "ego_near_misses",
    "/ego/near_misses",
    "Near misses of the ego",
    "count",
    Direction::kLowerIsBetter,
    Subject::kEgoAndOthers,
    "Episodes in which the ego's 2D-TTC is below 1.5 s, or the vehicle that it is of comes so fast "
    "that relative speed / (2 x 2D-TTC) is above 3.4 m/s^2 (DRAC). Episodes less than 1 s apart "
    "are one; one with a contact of the ego, or a contact within 1 s after it, is none.",
    "",
    0,
    false,
    {Pooling::kCount, SessionWeight::kEgoKilometres},
};
constexpr MeasureDefinition kNearMissesPerKm = {
    "ego_near_misses_per_km",
    "/ego/near_misses_per_km",
    "Near misses of the ego per km",
    "1/km",
    Direction::kLowerIsBetter,
    Subject::kEgoAndOthers,
    "1000 x ego_near_misses / distance driven by the ego in meters.",
    "",
    3,
    false,
    {Pooling::kRate, SessionWeight::kEgoKilometres},
};

constexpr double kShortTime = 1.5;    // 2D-TTC [s]
constexpr double kHardBraking = 3.4;  // DRAC [m/s^2]
constexpr double kEpisodeGap = 1.0;   // between episodes [s]

class NearMiss final : public Metric {
 public:
  void observe(const MetricTick& tick) override {
    if (tick.ego == nullptr || !tick.ego->state.position.allFinite()) return;
    travel(*tick.ego);
    const double now = tick.snapshot.time;
    if (episode_ && now - episode_->last > kEpisodeGap) close();
    if (isNear(tick)) {
      if (!episode_) episode_ = Episode();
      episode_->last = now;
    }
    const bool touched =
        std::any_of(tick.contacts.begin(), tick.contacts.end(),
                    [](const ContactSighting& contact) { return !contact.ego_partner.empty(); });
    if (touched && episode_) episode_->touched = true;
  }

  void report(MetricSink& sink) const override {
    const std::size_t count = count_ + (episode_ && !episode_->touched ? 1 : 0);
    sink.set(kNearMisses, countMeasure(count));
    sink.set(kNearMissesPerKm, countPerKilometer(count, distance_, ticks_,
                                                 ticks_ == 0 ? kNoEgo : "the ego did not move"));
  }

 private:
  /// A time in which something is near.
  struct Episode {
    double last = 0.0;  ///< when it was near last [s]
    bool touched = false;
  };

  void travel(const traffic::Vehicle& ego) {
    ++ticks_;
    if (before_) distance_ += (ego.state.position - *before_).norm();
    before_ = ego.state.position;
  }

  static bool isNear(const MetricTick& tick) {
    const auto& time = tick.interaction.ttc_2d;
    const traffic::Vehicle* other = tick.interaction.ttc_2d_partner;
    if (!time || other == nullptr || *time <= 0.0) return false;
    if (*time < kShortTime) return true;
    const double speed = (tick.ego->state.velocity() - other->state.velocity()).norm();
    return speed / (2.0 * *time) > kHardBraking;
  }

  void close() {
    if (!episode_->touched) ++count_;
    episode_.reset();
  }

  std::optional<Eigen::Vector2d> before_;
  double distance_ = 0.0;
  std::size_t ticks_ = 0;
  std::size_t count_ = 0;  ///< of episodes that are over
  std::optional<Episode> episode_;
};

}  // namespace

MetricDescriptor nearMissMetric() {
  return {"near_miss",
          "How often another vehicle came so near that only luck or hard braking helped.",
          {kNearMisses, kNearMissesPerKm},
          [](const MetricContext&) { return std::make_unique<NearMiss>(); }};
}

}  // namespace cdiff::metrics
