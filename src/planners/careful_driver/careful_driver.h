// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/pdm_lite/forecasts.h"
#include "planners/pdm_lite/route_rules.h"
#include "planning/vehicle_memory.h"
#include "reference_driver/careful_driver.h"

namespace cdiff::planners {

/// Options of the planner `careful_driver`: those of the driver, and how it drives undisturbed.
struct CarefulDriverPlannerOptions : reference_driver::CarefulDriverOptions {
  std::string driver = "careful";       ///< who reacts: careful (C) | rss (R) | fuzzy (FSM)
  double top_speed = 20.0;              ///< it drives no faster [m/s]
  double acceleration = 2.0;            ///< [m/s^2]
  double following_deceleration = 4.0;  ///< at most, behind a lead and before a line [m/s^2]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError also where it cannot stop from its top speed within its horizon.
  void validate() const { CarefulDriverOptions::validate(top_speed, "careful_driver."); }
};

/// An ego of known quality: a reference driver that follows its route (map frame, SI units).
///  - It keeps the lanes' limits and v*, the time gap of UN R157 to its lead by IDM, and stops at
///    lights that are not green, at stop signs and at the end of its route, as PDM-Lite does. Its
///    lead is the nearest vehicle in the strip that its box sweeps; one that came in from beside
///    counts after evaluation time and delay, or before it starts.
///  - Where that is not enough the driver brakes: C, R or FSM (src/reference_driver).
///  - PDM-Lite's PID steers; it never evades.
class CarefulDriverPlanner : public planning::Planner {
 public:
  CarefulDriverPlanner(const CarefulDriverPlannerOptions& options,
                       const dynamics::BicycleModelOptions& vehicle, double decision_period);

  /// What it saw is remembered by vehicle: who is to take over must be asked before, too. Fault and
  /// fail-safe action: no route, a state that is not finite, a speed from which it cannot stop
  /// within its horizon.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  struct Memory {
    DriverState driver;
    StopSignRule stop_signs;
    std::unique_ptr<reference_driver::ReferenceDriver> reference;
    std::map<std::string, double> in_way_since;  ///< [s], by vehicle; infinite where it is not
  };
  /// The nearest vehicle in the way that counts as lead.
  struct Lead {
    double gap = 0.0;    ///< from bumper to bumper [m]
    double speed = 0.0;  ///< along the path, at least 0 [m/s]
  };
  /// What is seen at a decision.
  struct View {
    reference_driver::OwnMotion own;
    std::vector<reference_driver::SeenVehicle> seen;
    std::optional<Lead> lead;
  };

  Memory makeMemory() const;
  std::string faultOf(const traffic::TrafficSnapshot& snapshot,
                      const planning::PlanningTask& task) const;
  traffic::ControlAction actionOf(const traffic::TrafficSnapshot& snapshot,
                                  const planning::PlanningTask& task, Memory& memory) const;
  View look(const traffic::TrafficSnapshot& snapshot, const planning::PlanningTask& task,
            Memory& memory) const;
  void noteLead(const traffic::Vehicle& vehicle, const reference_driver::SeenVehicle& seen,
                View& view, Memory& memory) const;
  /// Without the driver's braking [m/s^2].
  double undisturbed(const traffic::TrafficSnapshot& snapshot, const planning::PlanningTask& task,
                     const View& view, Memory& memory) const;

  CarefulDriverPlannerOptions options_;
  dynamics::BicycleModel model_;
  double decision_period_;
  planning::VehicleMemory<Memory> memories_;
};

}  // namespace cdiff::planners
