// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <memory_resource>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

/// The measures of a session by name, each with its unit, count and, where it cannot be given, the
/// reason; and the lists and contacts that belong to them.
class SessionMeasures {
 public:
  /// The measure with that definition; one without value, "not computed", where no metric reported
  /// it.
  Measure at(const MeasureDefinition& definition) const;
  /// Likewise by name. Throws core::InputError for a name that no metric has.
  Measure at(const std::string& name) const;
  /// The value of a measure that has one in every session; else 0.
  double number(const MeasureDefinition& definition) const {
    return at(definition).value.value_or(0.0);
  }
  std::size_t count(const MeasureDefinition& definition) const {
    return static_cast<std::size_t>(number(definition));
  }
  /// Sets a measure; its unit is the definition's.
  void set(const MeasureDefinition& definition, Measure measure);

  std::string protocol;  ///< preset whose rules the score and the infractions follow
  std::vector<EgoContact> ego_contacts;                   ///< in order of time
  std::map<std::string, std::vector<MetricEntry>> lists;  ///< by JSON pointer in summary.json
  std::vector<traffic::Fault> faults;  ///< of metrics that threw; their measures have no value

 private:
  std::map<std::string, Measure> measures_;  ///< by the measure's name
};

/// Measures of one tick, for the live topic.
struct TickMeasures {
  std::optional<double> ttc_2d;            ///< minimum over vehicles near the ego [s]
  std::optional<double> nearest_distance;  ///< ego's box to the nearest other box [m]
  double route_completion_percent = 0.0;
  double ego_speed = 0.0;
  bool ego_off_road = false;
  std::size_t cbv_off_road = 0;  ///< CBVs now off the drivable area
};

/// From now on the sessions of this process leave a metric out: its measures have this reason.
void leaveOutMetric(const std::string& name, const std::string& reason);

/// All registered metrics of one session. They measure from its snapshots and selections alone:
/// the same online, from a bag, and in one process.
class SessionMetrics {
 public:
  /// References must outlive the object, and `memory`, in which lies what grows with the session.
  SessionMetrics(const SessionMetricsOptions& options, const map::DrivableArea& drivable_area,
                 const map::Route& ego_route,
                 std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  ~SessionMetrics();

  /// One tick in order; `selection` at decision ticks, else nullptr. A metric that throws is left
  /// out from then on; `measures` says so.
  TickMeasures observe(const traffic::TrafficSnapshot& snapshot,
                       const cbv::CbvSelection* selection);
  /// The measures so far.
  SessionMeasures measures() const;

 private:
  class Metrics;
  std::unique_ptr<Metrics> metrics_;
};

}  // namespace cdiff::metrics
