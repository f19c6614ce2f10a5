// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/measure.h"
#include "e2e_cdiff/metrics/metric_tick.h"
#include "e2e_cdiff/metrics/session_metrics_options.h"

namespace cdiff::metrics {

/// What a metric may keep for the session; all references outlive the metric.
struct MetricContext {
  const map::DrivableArea& drivable_area;
  const map::Route& ego_route;
  const SessionMetricsOptions& options;
};

/// Keys and values of one entry of a list in summary.json, in order.
using MetricEntry =
    std::vector<std::pair<std::string, std::variant<std::nullptr_t, bool, double, std::string>>>;

/// Takes what a metric reports.
class MetricSink {
 public:
  virtual ~MetricSink() = default;
  /// `measure` is one of the metric's; the unit of the measure is set to the measure's. Throws
  /// core::Error for a measure that its descriptor does not have.
  virtual void set(const MeasureDefinition& definition, Measure measure) = 0;
  /// A list beside the measures of a part of summary.json, by JSON pointer ("/cbv/NAME").
  virtual void setList(const std::string& place, std::vector<MetricEntry> entries) = 0;
};

/// The interface of everything that is measured in a session, and its registration. A metric
/// observes each tick, reports its measures, and appears in summary.json, the report, the messages,
/// the batch columns and the list of definitions by its descriptor alone.
class Metric {
 public:
  virtual ~Metric() = default;
  /// Every tick of the session, in order.
  virtual void observe(const MetricTick& tick) = 0;
  /// The measures so far; each has a value or a reason.
  virtual void report(MetricSink& sink) const = 0;
};

/// What is known of a metric before a session: name, the measures it defines, and its constructor.
struct MetricDescriptor {
  std::string name;                         ///< snake_case, unique
  std::string help;                         ///< a sentence
  std::vector<MeasureDefinition> measures;  ///< in the order of the table; names and places unique
  std::function<std::unique_ptr<Metric>(const MetricContext&)> make;
  std::string source = "e2e_cdiff";  ///< who registers it; a plug-in gives its file
};

/// Sessions that begin from now on measure it, too. Call at start or when a plug-in is loaded, from
/// one thread. Throws core::InputError for a descriptor without name, measures or `make`, and for a
/// metric, measure or place that is registered already, naming both sources.
void registerMetric(MetricDescriptor descriptor);

}  // namespace cdiff::metrics
