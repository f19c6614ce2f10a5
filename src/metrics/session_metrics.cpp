// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/session_metrics.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/forked_work.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"
#include "metrics/tick_observer.h"
#include "traffic/shown_fault.h"

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
    requirePlace(place);
    measures_.lists[place] = std::move(entries);
  }

 private:
  /// Throws core::Error unless a list fits beside the measures of a part of summary.json.
  void requirePlace(const std::string& place) const {
    const std::vector<std::string> keys = core::splitText(place, '/');
    bool free = keys.size() == 2 && measures_.lists.count(place) == 0 &&
                place == "/" + keys[0] + "/" + keys[1];
    bool known = false;
    for (const MeasureDefinition& definition : measureDefinitions()) {
      const std::vector<std::string> taken = core::splitText(definition.place, '/');
      if (!free || taken.front() != keys[0]) continue;
      known = true;
      free = taken[1] != keys[1];
    }
    if (free && known) return;
    throw core::Error("a list at '" + core::shortened(place) +
                      "'; expected /PART/NAME with a part of summary.json and a new name");
  }

  const MetricDescriptor& metric_;
  SessionMeasures& measures_;
};

/// What a metric threw in one of its functions, or nothing.
template <class Call>
std::optional<traffic::Fault> faultOf(
    const MetricDescriptor& metric, const char* function, std::uint64_t tick, const Call& call,
    core::NamedCall::Limit limit = core::NamedCall::Limit::kOfTheWork) {
  const auto fault = [&](const std::string& text) {
    return traffic::Fault{tick, "metric:" + metric.name,
                          std::string(function) + "() of metric '" + metric.name + "' of " +
                              metric.source + " threw: " + text + "; its measures are left out"};
  };
  const core::NamedCall named("metric", metric.name, limit);
  try {
    call();
    return std::nullopt;
  } catch (const std::exception& error) {
    return fault(traffic::thrownFaultText(error));
  } catch (...) {
    return fault("an exception of an unknown type");
  }
}

/// The measures of a metric that threw have its fault as their reason.
void leaveOut(const MetricDescriptor& metric, const traffic::Fault& fault,
              SessionMeasures& measures) {
  for (const MeasureDefinition& definition : metric.measures)
    measures.set(definition, {std::nullopt, 0, "", fault.text});
  measures.faults.push_back(fault);
}

/// Why metrics of these names are left out of the sessions of this process.
std::map<std::string, std::string>& reasonsToLeaveOut() {
  static std::map<std::string, std::string> reasons;
  return reasons;
}

}  // namespace

void leaveOutMetric(const std::string& name, const std::string& reason) {
  reasonsToLeaveOut()[name] = reason;
}

class SessionMetrics::Metrics {
 public:
  Metrics(const SessionMetricsOptions& options, const map::DrivableArea& drivable_area,
          const map::Route& ego_route, std::pmr::memory_resource* memory)
      : options_(options), context_{drivable_area, ego_route, options_, memory}, ticks_(context_) {
    for (const MetricDescriptor& descriptor : metricDescriptors()) {
      const auto reason = reasonsToLeaveOut().find(descriptor.name);
      if (reason != reasonsToLeaveOut().end()) {
        const traffic::Fault fault{0, "metric:" + descriptor.name, reason->second};
        metrics_.push_back({&descriptor, nullptr, fault});
        continue;
      }
      Running made{&descriptor, nullptr, std::nullopt};
      made.fault = faultOf(
          descriptor, "make", 0, [&] { made.metric = descriptor.make(context_); },
          core::NamedCall::Limit::kWhenStopped);
      metrics_.push_back(std::move(made));
      if (metrics_.back().metric || metrics_.back().fault) continue;
      throw core::InputError("metric '" + descriptor.name + "' of " + descriptor.source +
                             ": its constructor gives none; its author must mend it");
    }
  }

  TickMeasures observe(const traffic::TrafficSnapshot& snapshot,
                       const cbv::CbvSelection* selection) {
    const MetricTick tick = ticks_.observe(snapshot, selection);
    for (Running& running : metrics_) {
      if (running.fault) continue;
      running.fault = faultOf(*running.descriptor, "observe", snapshot.tick,
                              [&] { running.metric->observe(tick); });
    }
    last_tick_ = snapshot.tick;
    ego_contacts_.insert(ego_contacts_.end(), tick.ego_contacts.begin(), tick.ego_contacts.end());
    return liveMeasures(tick);
  }

  SessionMeasures measures() const {
    SessionMeasures result;
    result.protocol = options_.protocol;
    result.ego_contacts = ego_contacts_;
    for (const Running& running : metrics_) {
      const MetricDescriptor& descriptor = *running.descriptor;
      std::optional<traffic::Fault> fault = running.fault;
      if (!fault) {
        fault = faultOf(descriptor, "report", last_tick_, [&] {
          Report report(descriptor, result);
          running.metric->report(report);
        });
      }
      if (fault) leaveOut(descriptor, *fault, result);
    }
    return result;
  }

 private:
  struct Running {
    const MetricDescriptor* descriptor;
    std::unique_ptr<Metric> metric;
    std::optional<traffic::Fault> fault;  ///< why it is left out
  };

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
  std::vector<Running> metrics_;
  std::vector<EgoContact> ego_contacts_;
  std::uint64_t last_tick_ = 0;
};

SessionMetrics::SessionMetrics(const SessionMetricsOptions& options,
                               const map::DrivableArea& drivable_area, const map::Route& ego_route,
                               std::pmr::memory_resource* memory)
    : metrics_(std::make_unique<Metrics>(options, drivable_area, ego_route, memory)) {}

SessionMetrics::~SessionMetrics() = default;

TickMeasures SessionMetrics::observe(const traffic::TrafficSnapshot& snapshot,
                                     const cbv::CbvSelection* selection) {
  return metrics_->observe(snapshot, selection);
}

SessionMeasures SessionMetrics::measures() const { return metrics_->measures(); }

}  // namespace cdiff::metrics
