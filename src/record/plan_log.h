// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What each CBV planned at its decisions and what it drove (map frame, SI units), and how far
/// apart the two are: |planned(t0 + h) - driven(t0 + h)| in the plane, h seconds after the decision
/// at t0.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "record/sample_figures.h"
#include "session/session_observer.h"

namespace cdiff::record {

/// A state of a plan or a drive.
struct WayPoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double heading = 0.0;                                ///< [rad]
  double speed = 0.0;                                  ///< [m/s]
};

/// A decision with a rollout: points 0.1 s apart, the first 0.1 s after the decision.
struct LoggedPlan {
  std::uint64_t tick = 0;
  double time = 0.0;  ///< [s]
  WayPoint start;     ///< where the vehicle was
  std::vector<WayPoint> points;
  double state_mismatch = 0.0;  ///< see planning::PlannedAction [m]

  double horizon() const;  ///< [s]
};

/// One vehicle over the session.
struct VehiclePlans {
  std::string vehicle_id;
  traffic::VehicleDimensions dimensions;
  std::vector<LoggedPlan> plans;
  std::vector<std::pair<std::uint64_t, WayPoint>> driven;  ///< (tick, state) while driven as CBV
};

class PlanLog {
 public:
  explicit PlanLog(double simulation_step) : simulation_step_(simulation_step) {}
  /// Every tick in order.
  void observe(const session::TickRecord& record);

  /// In order of the first plan or the first drive.
  const std::vector<VehiclePlans>& vehicles() const { return vehicles_; }
  /// The plans of a vehicle, or nullptr.
  const VehiclePlans* find(const std::string& vehicle_id) const;
  /// Whether any plan was logged.
  bool empty() const;

  /// Where the vehicle was `seconds` after the decision, between ticks by interpolation; nullopt
  /// unless it was driven from the decision until then.
  std::optional<WayPoint> drivenAfter(const VehiclePlans& vehicle, const LoggedPlan& plan,
                                      double seconds) const;
  /// Over the decisions whose plan and drive reach that far [m].
  std::vector<double> displacements(const VehiclePlans& vehicle, double seconds) const;
  /// The plan whose whole horizon was driven and whose decision is nearest to `time` (the earlier
  /// of equals), or nullptr.
  const LoggedPlan* drivenPlanNear(const VehiclePlans& vehicle, double time) const;

 private:
  VehiclePlans& plansOf(const traffic::Vehicle& vehicle);
  double simulation_step_;
  std::vector<VehiclePlans> vehicles_;
  std::unordered_map<std::string, std::size_t> index_by_id_;
};

/// Planned state `seconds` after the decision (a multiple of 0.1 s); nullptr beyond the plan.
const WayPoint* plannedAfter(const LoggedPlan& plan, double seconds);

/// Displacements of all vehicles together [m].
SampleFigures displacementFigures(const PlanLog& log, double seconds);
/// State mismatches of all plans together [m].
SampleFigures mismatchFigures(const PlanLog& log);
SampleFigures mismatchFigures(const VehiclePlans& vehicle);

}  // namespace cdiff::record
