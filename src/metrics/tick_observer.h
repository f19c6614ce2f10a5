// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <string>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/braking_avoidance.h"
#include "metrics/formulas/contact_fault.h"

namespace cdiff::metrics {

/// Makes of each snapshot the tick that metrics see: who is off the road, how far the ego is, which
/// vehicles are CBVs, and who touched whom (map frame, SI units).
class TickObserver {
 public:
  /// References must outlive the object; an empty route completes nothing.
  explicit TickObserver(const MetricContext& context);

  /// Ticks in order; `selection` may be nullptr. The answer refers to the snapshot.
  MetricTick observe(const traffic::TrafficSnapshot& snapshot, const cbv::CbvSelection* selection);

 private:
  bool offRoad(const traffic::Vehicle& vehicle) const;
  std::optional<double> edgeDistance(const traffic::Vehicle& vehicle) const;
  double wantedSpeed(const traffic::Vehicle& vehicle) const;
  bool isCbv(const traffic::TrafficSnapshot& snapshot, const std::string& id) const;
  void addEgo(const traffic::Vehicle& ego, MetricTick& tick);
  void addContacts(MetricTick& tick);
  ContactSighting sightingOf(const traffic::Contact& contact, const MetricTick& tick) const;
  void addCbvs(MetricTick& tick);

  const SessionMetricsOptions& options_;
  const map::DrivableArea& drivable_area_;
  std::optional<map::RouteProgress> progress_;
  EgoContacts ego_contacts_;
  BrakingAvoidance avoidance_;
  std::string ego_id_;                                     ///< empty before the first tick
  std::map<std::string, Eigen::Vector2d> last_positions_;  ///< of the CBVs of the last tick
};

}  // namespace cdiff::metrics
