// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/post_encroachment.h"
#include "metrics/formulas/sample_statistics.h"

namespace cdiff::metrics {

namespace {

constexpr MeasureDefinition kEncroachmentMean = {
    "post_encroachment_mean_s",
    "/metrics/post_encroachment_s/mean",
    "Post-encroachment time, mean over CBVs",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "Mean over CBVs of the post-encroachment time with the ego: the time between the first one's "
    "box leaving and the second one's box entering a place, the shortest over all places that both "
    "boxes sweep; 0 for a contact, the net time gap for one behind the other, absent above 10 s "
    "(as in FHWA's SSAM, Gettman et al. 2008).",
    "RIFT does not compute it.",
};
constexpr MeasureDefinition kEncroachmentDeviation = {
    "post_encroachment_std_s",
    "/metrics/post_encroachment_s/std",
    "Post-encroachment time, standard deviation over CBVs",
    "s",
    Direction::kNeither,
    Subject::kEgoAndOthers,
    "Standard deviation (n - 1) of the post-encroachment times of the CBVs.",
    "",
};
constexpr MeasureDefinition kEncroachmentMinimum = {
    "post_encroachment_min_s",
    "/metrics/post_encroachment_s/min",
    "Post-encroachment time, minimum",
    "s",
    Direction::kHigherIsBetter,
    Subject::kEgoAndOthers,
    "The smallest post-encroachment time of the CBVs.",
    "",
    3,
    true,
};

using traffic::Vehicle;

bool isUsable(const Vehicle* vehicle) {
  return vehicle != nullptr && vehicle->state.position.allFinite() &&
         std::isfinite(vehicle->state.heading);
}

/// A CBV counts while its role is CBV, the ego always; vehicles on different levels share no place.
class PostEncroachment final : public Metric {
 public:
  /// A longer time counts as never sharing a place [s].
  explicit PostEncroachment(double limit) : limit_(limit) {}

  void observe(const MetricTick& tick) override {
    const SweptBox* ego_sweep = extend(ego_, tick.ego, tick.snapshot.time);
    for (const CbvSighting& cbv : tick.cbvs) cbvs_.try_emplace(cbv.vehicle->id);
    for (auto& [id, cbv] : cbvs_) {
      const Vehicle* vehicle = tick.snapshot.find(id);
      if (vehicle != nullptr && vehicle->role != traffic::VehicleRole::kCbv) vehicle = nullptr;
      const SweptBox* cbv_sweep = extend(cbv, vehicle, tick.snapshot.time);
      if (cbv_sweep != nullptr) {
        for (const SweptBox& sweep : ego_.sweeps) compare(cbv, sweep, *cbv_sweep);
      }
      if (ego_sweep == nullptr) continue;
      for (const SweptBox& sweep : cbv.sweeps) {
        if (&sweep != cbv_sweep) compare(cbv, *ego_sweep, sweep);
      }
    }
    last_time_ = tick.snapshot.time;
  }

  void report(MetricSink& sink) const override {
    const std::string within = std::to_string(std::lround(limit_)) + " s";
    SampleStatistics times;
    std::vector<MetricEntry> entries;
    for (const auto& [id, cbv] : cbvs_) {
      if (cbv.seconds) {
        times.add(*cbv.seconds);
        MetricEntry::value_type::second_type first = nullptr;  // of two that are there at once
        if (*cbv.seconds > 0.0) first = std::string(cbv.ego_first ? "ego" : "cbv");
        entries.push_back({{"vehicle_id", id}, {"seconds", *cbv.seconds}, {"first", first}});
      } else {
        entries.push_back({{"vehicle_id", id},
                           {"seconds", nullptr},
                           {"first", nullptr},
                           {"reason", "ego and CBV were never at one place within " + within}});
      }
    }
    const DistributionMeasure measure =
        times.measure(cbvs_.empty() ? std::string(kNoCbv)
                                    : "no CBV was ever at one place with the ego within " + within);
    sink.set(kEncroachmentMean, measure.mean);
    sink.set(kEncroachmentDeviation, measure.standard_deviation);
    sink.set(kEncroachmentMinimum, measure.minimum);
    sink.setList("/cbv/post_encroachments", std::move(entries));
  }

 private:
  /// What a vehicle's box swept in the last `limit_` seconds.
  struct Track {
    std::deque<SweptBox> sweeps;
    std::optional<Vehicle> last;    ///< at the last tick, where it was there
    std::optional<double> seconds;  ///< shortest so far
    bool ego_first = false;         ///< whether the ego left the place before the CBV entered it
  };

  /// What its box swept since the last tick; nullptr when the vehicle was not there then or is not
  /// finite.
  const SweptBox* extend(Track& track, const Vehicle* vehicle, double time) const {
    while (!track.sweeps.empty() && track.sweeps.front().begin < time - limit_ - 1.0)
      track.sweeps.pop_front();
    const bool moved = track.last && last_time_ && isUsable(vehicle);
    if (moved) {
      SweptBox sweep;
      sweep.box = vehicle->box();
      sweep.box.center = track.last->state.position;
      sweep.offset = vehicle->state.position - track.last->state.position;
      sweep.elevation = vehicle->state.elevation;
      sweep.begin = *last_time_;
      sweep.duration = time - *last_time_;
      track.sweeps.push_back(sweep);
    }
    track.last = isUsable(vehicle) ? std::optional<Vehicle>(*vehicle) : std::nullopt;
    return moved ? &track.sweeps.back() : nullptr;
  }

  void compare(Track& cbv, const SweptBox& ego_sweep, const SweptBox& cbv_sweep) const {
    const double best = cbv.seconds.value_or(limit_);
    const double apart = std::abs(cbv_sweep.begin - ego_sweep.begin) -
                         std::max(ego_sweep.duration, cbv_sweep.duration);
    if (apart > best || farApart(ego_sweep, cbv_sweep) ||
        traffic::onDifferentLevels(ego_sweep.elevation, cbv_sweep.elevation)) {
      return;
    }
    const auto range = timesBetween(ego_sweep, cbv_sweep);
    if (!range) return;
    const bool at_once = range->shortest <= 0.0 && range->longest >= 0.0;
    const double seconds =
        at_once ? 0.0 : std::min(std::abs(range->shortest), std::abs(range->longest));
    if (seconds > limit_ || (cbv.seconds && seconds >= *cbv.seconds)) return;
    cbv.seconds = seconds;
    cbv.ego_first = range->shortest > 0.0;
  }

  double limit_;
  std::optional<double> last_time_;
  Track ego_;
  std::map<std::string, Track> cbvs_;
};

}  // namespace

MetricDescriptor postEncroachmentMetric() {
  return {"post_encroachment",
          "Post-encroachment time of the ego and each CBV.",
          {kEncroachmentMean, kEncroachmentDeviation, kEncroachmentMinimum},
          [](const MetricContext& context) {
            return std::make_unique<PostEncroachment>(context.options.post_encroachment_limit);
          }};
}

}  // namespace cdiff::metrics
