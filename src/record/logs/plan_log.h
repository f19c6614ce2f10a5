// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory_resource>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "record/logs/planner_logs.h"
#include "session/session_observer.h"

namespace cdiff::record {

/// A planned or driven state of a vehicle (map frame).
struct Waypoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< center of the box [m]
  double heading = 0.0;                                ///< [rad]
  double speed = 0.0;                                  ///< [m/s]
};

/// A plan that a planner weighed against others (map frame).
struct LoggedCandidate {
  std::pmr::vector<Eigen::Vector2d> places;  ///< as in planning::PlannedCandidate [m]
  double score = 0.0;                        ///< in the planner's own measure
};

/// The plan that a vehicle was given at one decision: states 0.1 s apart, the first of them 0.1 s
/// after the decision.
struct LoggedPlan {
  std::uint64_t tick = 0;
  double time = 0.0;  ///< [s]
  Waypoint start;     ///< state of the vehicle at the decision
  std::pmr::vector<Waypoint> points;
  double state_mismatch = 0.0;                   ///< see planning::PlannedAction [m]
  std::pmr::vector<LoggedCandidate> candidates;  ///< that it was weighed against

  double horizon() const;  ///< duration of the plan [s]
};

/// Plans and driven states of one vehicle over the session.
struct VehiclePlans {
  std::string vehicle_id;
  traffic::VehicleDimensions dimensions;
  std::pmr::vector<LoggedPlan> plans;
  std::pmr::vector<std::pair<std::uint64_t, Waypoint>>
      driven;  ///< (tick, state) while driven as CBV
};

/// Records what each CBV planned at its decisions and what it then drove (map frame, SI units).
/// Displacement of a plan h seconds after its decision at t0: |planned(t0 + h) - driven(t0 + h)| of
/// the positions in the plane [m]. Filled by the result writer; read by summary, report, plans.csv
/// and the figure of execution.
class PlanLog {
 public:
  /// What grows with the session lies in `memory`, which must outlive the log.
  explicit PlanLog(double simulation_step,
                   std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : simulation_step_(simulation_step), memory_(memory) {}
  /// Call at every tick, in order.
  void observe(const session::TickRecord& record);

  /// In the order in which they were first planned for or driven.
  const std::vector<VehiclePlans>& vehicles() const { return vehicles_; }
  /// The plans of a vehicle, or nullptr.
  const VehiclePlans* find(const std::string& vehicle_id) const;
  /// Whether any plan was logged.
  bool empty() const;

  /// Driven state `seconds` after the decision, interpolated between ticks; nullopt unless the
  /// vehicle was driven as CBV from the decision until then.
  std::optional<Waypoint> drivenAfter(const VehiclePlans& vehicle, const LoggedPlan& plan,
                                      double seconds) const;
  /// Displacement [m] `seconds` after each decision; decisions whose plan or drive is shorter are
  /// left out.
  std::vector<double> displacements(const VehiclePlans& vehicle, double seconds) const;
  /// The plan whose whole horizon was driven and whose decision is nearest to `time` (the earlier
  /// of equals), or nullptr.
  const LoggedPlan* drivenPlanNear(const VehiclePlans& vehicle, double time) const;

 private:
  VehiclePlans& plansOf(const traffic::Vehicle& vehicle);
  double simulation_step_;
  std::pmr::memory_resource* memory_;
  std::vector<VehiclePlans> vehicles_;
  std::unordered_map<std::string, std::size_t> index_by_id_;
};

/// Planned state `seconds` after the decision (a multiple of 0.1 s); nullptr beyond the plan.
const Waypoint* plannedAfter(const LoggedPlan& plan, double seconds);

/// Displacements of all vehicles together [m].
SampleSummary displacementSummary(const PlanLog& log, double seconds);
/// State mismatches of all plans together [m].
SampleSummary mismatchSummary(const PlanLog& log);
SampleSummary mismatchSummary(const VehiclePlans& vehicle);

// plans.csv: planned against driven states of CBVs (map frame, SI units), a row per decision and
// 0.4 s of the plan.

/// Content of the file. Driven cells stay empty where the vehicle was not driven until then; at 0 s
/// both states are that of the decision.
std::string plansCsv(const PlanLog& plans);

/// One row of plans.csv.
struct PlanRow {
  std::string vehicle_id;
  std::uint64_t tick = 0;  ///< of the decision
  double seconds = 0.0;    ///< since the decision
  Waypoint planned;
  std::optional<Waypoint> driven;
};

/// Rows in the file's order. Throws InputError naming file and line for anything else.
std::vector<PlanRow> readPlans(const std::filesystem::path& file);

}  // namespace cdiff::record
