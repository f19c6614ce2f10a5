// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// One metric by itself: made by its name, shown ticks, and asked for its report.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "metrics/metric_registry.h"
#include "metrics/straight_road.h"

namespace cdiff::test {

class MetricUnderTest final : private metrics::MetricSink {
 public:
  /// On a straight road, unless `route` says otherwise; it must outlive the object.
  explicit MetricUnderTest(const std::string& name,
                           const metrics::SessionMetricsOptions& options = {},
                           const map::Route* route = nullptr)
      : options_(std::make_unique<metrics::SessionMetricsOptions>(options)),
        road_(std::make_unique<StraightRoad>()) {
    const auto& all = metrics::metricDescriptors();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const auto& metric) { return metric.name == name; });
    metric_ =
        found->make({road_->drivable_area, route != nullptr ? *route : road_->route, *options_});
  }

  void observe(const metrics::MetricTick& tick) { metric_->observe(tick); }

  /// A decision tick with the CBVs alone.
  void observeCbvs(const std::vector<metrics::CbvSighting>& cbvs) {
    const traffic::TrafficSnapshot at = snapshot(0, {});
    metrics::MetricTick tick{at};
    tick.cbvs = cbvs;
    metric_->observe(tick);
  }

  bool has(const std::string& name) {
    report();
    return measures_.count(name) == 1;
  }
  /// What it reports for one of its measures.
  metrics::Measure at(const std::string& name) {
    report();
    return measures_.at(name);
  }
  std::vector<metrics::MetricEntry> list(const std::string& place) {
    report();
    return lists_.at(place);
  }

 private:
  void report() { metric_->report(*this); }
  void set(const metrics::MeasureDefinition& definition, metrics::Measure measure) override {
    measures_[definition.name] = std::move(measure);
  }
  void setList(const std::string& place, std::vector<metrics::MetricEntry> entries) override {
    lists_[place] = std::move(entries);
  }

  std::unique_ptr<metrics::SessionMetricsOptions> options_;
  std::unique_ptr<StraightRoad> road_;
  std::unique_ptr<metrics::Metric> metric_;
  std::map<std::string, metrics::Measure> measures_;
  std::map<std::string, std::vector<metrics::MetricEntry>> lists_;
};

}  // namespace cdiff::test
