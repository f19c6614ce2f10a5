// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/session_metrics.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"
#include "metrics/tick_observer.h"

namespace cdiff::metrics {

Measure SessionMeasures::at(const MeasureDefinition& definition) const {
  const auto found = measures_.find(definition.name);
  if (found != measures_.end()) return found->second;
  return {std::nullopt, 0, definition.unit, "not computed"};
}

Measure SessionMeasures::at(const std::string& name) const {
  const MeasureDefinition* definition = findMeasure(name);
  if (definition == nullptr) throw core::InputError("'" + name + "' is no measure of a session");
  return at(*definition);
}

void SessionMeasures::set(const MeasureDefinition& definition, Measure measure) {
  measure.unit = definition.unit;
  measures_[definition.name] = std::move(measure);
}

namespace {

/// Takes the report of one metric into the session's measures.
class Report final : public MetricSink {
 public:
  Report(const MetricDescriptor& metric, SessionMeasures& measures)
      : metric_(metric), measures_(measures) {}

  void set(const MeasureDefinition& definition, Measure measure) override {
    const std::string name = definition.name;
    const bool own = std::any_of(metric_.measures.begin(), metric_.measures.end(),
                                 [&](const MeasureDefinition& each) { return name == each.name; });
    if (!own) {
      throw core::Error("metric '" + metric_.name + "' of " + metric_.source + " reports '" + name +
                        "', which is not among its measures");
    }
    measures_.set(definition, std::move(measure));
  }

  void setList(const std::string& place, std::vector<MetricEntry> entries) override {
    measures_.lists[place] = std::move(entries);
  }

 private:
  const MetricDescriptor& metric_;
  SessionMeasures& measures_;
};

}  // namespace

class SessionMetrics::Metrics {
 public:
  Metrics(const SessionMetricsOptions& options, const map::DrivableArea& drivable_area,
          const map::Route& ego_route)
      : options_(options), context_{drivable_area, ego_route, options_}, ticks_(context_) {
    for (const MetricDescriptor& descriptor : metricDescriptors()) {
      metrics_.emplace_back(&descriptor, descriptor.make(context_));
      if (metrics_.back().second) continue;
      throw core::InputError("metric '" + descriptor.name + "' of " + descriptor.source +
                             ": its constructor gives none; its author must mend it");
    }
  }

  TickMeasures observe(const traffic::TrafficSnapshot& snapshot,
                       const cbv::CbvSelection* selection) {
    const MetricTick tick = ticks_.observe(snapshot, selection);
    for (const auto& [descriptor, metric] : metrics_) metric->observe(tick);
    ego_contacts_.insert(ego_contacts_.end(), tick.ego_contacts.begin(), tick.ego_contacts.end());
    return liveMeasures(tick);
  }

  SessionMeasures measures() const {
    SessionMeasures result;
    result.protocol = options_.protocol;
    result.ego_contacts = ego_contacts_;
    for (const auto& [descriptor, metric] : metrics_) {
      Report report(*descriptor, result);
      metric->report(report);
    }
    return result;
  }

 private:
  static TickMeasures liveMeasures(const MetricTick& tick) {
    TickMeasures live;
    live.ttc_2d = tick.interaction.ttc_2d;
    live.nearest_distance = tick.interaction.nearest_distance;
    live.route_completion_percent = tick.route_completion_percent;
    live.ego_speed = tick.ego != nullptr ? tick.ego->state.speed : 0.0;
    live.ego_off_road = tick.ego_off_road;
    live.cbv_off_road = static_cast<std::size_t>(std::count_if(
        tick.cbvs.begin(), tick.cbvs.end(), [](const CbvSighting& cbv) { return cbv.off_road; }));
    return live;
  }

  SessionMetricsOptions options_;
  MetricContext context_;
  TickObserver ticks_;
  std::vector<std::pair<const MetricDescriptor*, std::unique_ptr<Metric>>> metrics_;
  std::vector<EgoContact> ego_contacts_;
};

SessionMetrics::SessionMetrics(const SessionMetricsOptions& options,
                               const map::DrivableArea& drivable_area, const map::Route& ego_route)
    : metrics_(std::make_unique<Metrics>(options, drivable_area, ego_route)) {}

SessionMetrics::~SessionMetrics() = default;

TickMeasures SessionMetrics::observe(const traffic::TrafficSnapshot& snapshot,
                                     const cbv::CbvSelection* selection) {
  return metrics_->observe(snapshot, selection);
}

SessionMeasures SessionMetrics::measures() const { return metrics_->measures(); }

}  // namespace cdiff::metrics
