// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/sample_statistics.h"

namespace cdiff::metrics {

namespace {

/// Definition of a share of the decisions at which the ego has a 2D-TTC [%].
constexpr MeasureDefinition shareMeasure(const char* name, const char* label,
                                         const char* definition) {
  return {name,
          "",
          label,
          "%",
          Direction::kNeither,
          Subject::kEgoAndOthers,
          definition,
          "RIFT takes all vehicles.",
          1,
          false,
          {Pooling::kShare, SessionWeight::kTtcSeconds}};
}
/// Definition of a mean 2D-TTC over such decisions [s].
constexpr MeasureDefinition meanMeasure(const char* name, const char* label,
                                        const char* definition) {
  return {name,
          "",
          label,
          "s",
          Direction::kHigherIsBetter,
          Subject::kEgoAndOthers,
          definition,
          "RIFT takes all vehicles."};
}

constexpr MeasureDefinition kFollowingShare = shareMeasure(
    "ttc_following_percent", "2D-TTC of the ego's own following, share",
    "100 x decisions at which the vehicle that sets ttc_mean_s is ahead in the ego's lane / "
    "decisions at which it is defined: its center within half a lane's width of the ego's route "
    "ahead of the ego, its heading within 45 deg of the route's; whoever drives it.");
constexpr MeasureDefinition kFollowingCbvShare =
    shareMeasure("ttc_following_cbv_percent", "2D-TTC of following a CBV, share",
                 "The part of ttc_following_percent in which the vehicle ahead is a CBV.");
constexpr MeasureDefinition kTtcCbvShare =
    shareMeasure("ttc_cbv_share_percent", "2D-TTC of CBVs not ahead in the lane, share",
                 "100 x decisions at which a CBV that is not ahead in the ego's lane sets "
                 "ttc_mean_s / decisions at which it is defined.");
constexpr MeasureDefinition kTtcBackgroundShare = shareMeasure(
    "ttc_background_share_percent", "2D-TTC of background vehicles not ahead in the lane, share",
    "100 x decisions at which a background vehicle that is not ahead in the ego's lane sets "
    "ttc_mean_s / decisions at which it is defined; the three shares sum to 100.");
constexpr MeasureDefinition kFollowingMean = meanMeasure(
    "ttc_following_mean_s", "2D-TTC of the ego's own following, mean",
    "Mean 2D-TTC over the decisions of ttc_following_percent; ttc_mean_s is the mean of the three "
    "means, weighted with their shares.");
constexpr MeasureDefinition kTtcCbvSetMean =
    meanMeasure("ttc_cbv_set_mean_s", "2D-TTC of CBVs not ahead in the lane, mean",
                "Mean 2D-TTC over the decisions of ttc_cbv_share_percent.");
constexpr MeasureDefinition kTtcBackgroundMean = meanMeasure(
    "ttc_background_set_mean_s", "2D-TTC of background vehicles not ahead in the lane, mean",
    "Mean 2D-TTC over the decisions of ttc_background_share_percent.");

/// Which vehicle sets the ego's 2D-TTC at decisions: one ahead in the ego's lane, another CBV, or
/// another background vehicle.
class Ttc2dPartner final : public Metric {
 public:
  explicit Ttc2dPartner(const MetricContext& context)
      : route_(context.ego_route),
        network_(context.options.network),
        radius_(context.options.ttc_radius) {}

  void observe(const MetricTick& tick) override {
    const traffic::Vehicle* partner = tick.interaction.ttc_2d_partner;
    if (!tick.snapshot.decision_tick || tick.ego == nullptr || partner == nullptr) return;
    const bool cbv = partner->role == traffic::VehicleRole::kCbv;
    const bool ahead = isAhead(*tick.ego, *partner, tick.ego_arc_length);
    (ahead ? following_ : cbv ? cbvs_ : background_).add(*tick.interaction.ttc_2d);
    following_cbv_.add(ahead && cbv);
  }

  void report(MetricSink& sink) const override {
    constexpr const char* kNever = "no vehicle was on a collision course with the ego";
    sink.set(kFollowingShare, shareOf(following_, kNever));
    sink.set(kFollowingCbvShare, following_cbv_.measure(kNever));
    sink.set(kTtcCbvShare, shareOf(cbvs_, kNever));
    sink.set(kTtcBackgroundShare, shareOf(background_, kNever));
    constexpr const char* kNone = "no such vehicle set the time to collision";
    for (const auto& [definition, times] :
         {std::pair(&kFollowingMean, &following_), std::pair(&kTtcCbvSetMean, &cbvs_),
          std::pair(&kTtcBackgroundMean, &background_)})
      sink.set(*definition, measureOrReason(times->mean(), times->count(), kNone));
  }

 private:
  /// Whether the center of `other` lies on the ego's lane ahead of the ego, headed like its route.
  bool isAhead(const traffic::Vehicle& ego, const traffic::Vehicle& other,
               double ego_arc_length) const {
    constexpr double kDetour = 1.5;  // largest distance along the route / straight distance
    constexpr double kAngle = core::degreesToRadians(45.0);
    constexpr double kUsualHalfWidth = 1.6;  // [m] of a lane, without a network
    if (route_.empty()) return false;
    const geometry::Polyline& path = route_.path();
    const double here =
        path.projectNear(ego.state.position, ego_arc_length, map::kRouteWindow).arc_length;
    const double end = std::min(here + kDetour * radius_, path.length());
    const geometry::Projection there = path.project(other.state.position, here, end);
    const double half = network_ == nullptr
                            ? kUsualHalfWidth
                            : 0.5 * network_->lane(route_.laneAt(there.arc_length)).width;
    return there.arc_length > here && there.distance <= half &&
           std::abs(core::angleDifference(other.state.heading, there.heading)) <= kAngle;
  }

  Measure shareOf(const SampleStatistics& times, const char* reason) const {
    const std::size_t all = following_cbv_.ticks();
    if (all == 0) return absentMeasure(reason);
    return {100.0 * static_cast<double>(times.count()) / static_cast<double>(all), all, {}, {}};
  }

  const map::Route& route_;
  const map::RoadNetwork* network_;
  double radius_;
  SampleStatistics following_;
  SampleStatistics cbvs_;
  SampleStatistics background_;
  TickShare following_cbv_;  ///< of all decisions with a 2D-TTC
};

}  // namespace

MetricDescriptor ttc2dPartnerMetric() {
  return {"ttc_2d_partner",
          "Who sets the ego's 2D time to collision.",
          {kFollowingShare, kFollowingCbvShare, kTtcCbvShare, kTtcBackgroundShare, kFollowingMean,
           kTtcCbvSetMean, kTtcBackgroundMean},
          [](const MetricContext& context) { return std::make_unique<Ttc2dPartner>(context); }};
}

}  // namespace cdiff::metrics
