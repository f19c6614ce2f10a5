// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/pdm_lite/forecasts.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planners/pdm_lite/route_rules.h"
#include "planning/vehicle_memory.h"

namespace cdiff::planners {

/// PDM-Lite, the rule-based planner, in RIFT's configuration or the original one: action from
/// route, boxes, lights and stop signs; map frame, SI units. target speed = min of the initial one,
/// IDM behind leaders, before lights, stop signs and bicycles whose box is met, and 0 when the
/// forecast box of the vehicle meets that of another; then PID steering and pedals. Neither the
/// scripts for CARLA's scenarios nor the noise on the steer are there (docs/pdm_lite.md).
///
/// Where it differs from the published program:
///  - Cars of SUMO are forecast along their lanes (surrounding_vehicles.h); lights that are
///    switched off do not stop it; the speed limit is anticipated (route_rules.h).
///  - Leaders are followed along the next 80 m of the route, not within the detection radius alone.
///  - In the last 5 m of the route it brakes evenly so as to stand 1 m beyond the end; slower than
///    1 m/s it creeps to the end first.
///  - "Standing for 170 ticks -> full throttle" is kept as 8.5 s, whatever the decision period.
///    "No throttle below 0.5 m/s -> brake" needs no rule: the pedals never coast there.
///  - Order of giving way: two vehicles that brake for each other's boxes would each forecast the
///    other to go on braking, start, see the other start, and brake, again and again until they
///    touch. So a CBV that the box rule made brake keeps braking until its way has been clear for
///    0.5 s + 0.2 s x slot; the ego drives on at once, as published.
///  - A standing vehicle is forecast where it stands and not grown, and the growth of the planned
///    vehicle follows its present speed: two standing cars hold each other up only if the body of
///    one lies in the other's way.
///  - A vehicle with an even style (DrivingStyle) follows by IDM with that style's a and b
///    and gives way by an even deceleration that ends before the boxes meet; its pedals are those
///    that the vehicle dynamics needs, and no rule makes it drive after standing for long; its
///    forecast is that of full throttle, which asks for more room. As published, pedals are full or
///    none and IDM has a = 24 m/s^2.
///  - With cbv_speed_spread or cbv_headway_spread each CBV has a driver of its own, drawn from the
///    stream "driver" by its id: its initial target speed is multiplied by 1 + spread x z (0.5 to
///    1.5), its time headway longer by spread x |z'|, z and z' standard normal. Both are 0 unless
///    asked for, which leaves one driver for all.
class PdmLite : public planning::Planner {
 public:
  PdmLite(const PdmLiteOptions& options, const dynamics::BicycleModelOptions& vehicle,
          const planning::PlanningContext& context);

  /// Controller state is kept per vehicle id and dropped when a vehicle is not among the tasks.
  /// Tasks without vehicle or route throw std::invalid_argument.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  /// What is remembered of a vehicle between decisions.
  struct Memory {
    DriverState driver;
    double standing_time = 0.0;  ///< below 0.1 m/s [s]
    bool gave_way = false;       ///< the box rule made it brake and it has not driven on since
    double clear_time = 0.0;     ///< since no box is met [s]
    double waiting = 0.0;        ///< deceleration of an even style that gives way [m/s^2]
    StopSignRule stop_signs = {};
  };
  /// Forecasts of the snapshot's vehicles, made when first asked for.
  using Forecasts = std::vector<std::optional<std::vector<traffic::VehicleState>>>;
  /// How one CBV's driver differs from the published one.
  struct Driver {
    double speed_factor = 1.0;  ///< on the initial target speed
    double headway = 0.0;       ///< added to the time headway [s]
  };
  Driver driverOf(const planning::PlanningTask& task) const;
  DrivingStyle styleOf(const planning::PlanningTask& task, const Driver& driver) const;
  /// One task with what several rules need.
  struct Situation {
    const planning::PlanningTask& task;
    DrivingStyle style;
    const traffic::TrafficSnapshot& snapshot;
    double arc_length;     ///< on the route [m]
    double initial_speed;  ///< initial target speed [m/s]
    bool near_lane_change;
  };

  planning::PlannedAction planOne(const Situation& situation, Memory& memory,
                                  Forecasts& forecasts) const;
  traffic::ControlAction pedalAction(const Situation& situation, double target,
                                     Memory& memory) const;
  traffic::ControlAction evenAction(const Situation& situation, double remaining,
                                    double target) const;
  double targetSpeed(const Situation& situation, const std::vector<planning::RolloutPoint>& rollout,
                     Memory& memory, Forecasts& forecasts) const;
  /// Speed for the stop lines ahead [m/s]; infinite where there is none to stop at.
  double speedBeforeLines(const Situation& situation, Memory& memory) const;
  /// What the others mean for the vehicle.
  struct Obstruction {
    double target;                   ///< by the free road, leaders and bicycles [m/s]
    std::optional<std::size_t> met;  ///< step that meets a box, the first for an even style
  };
  Obstruction obstructionOf(const Situation& situation,
                            const std::vector<planning::RolloutPoint>& rollout,
                            Forecasts& forecasts) const;
  /// First step at which the boxes meet.
  std::optional<std::size_t> meetsBox(const Situation& situation, const traffic::Vehicle& other,
                                      const std::vector<geometry::OrientedBox>& own,
                                      const std::vector<traffic::VehicleState>& forecast) const;
  bool mustWait(const Situation& situation, bool box_met, Memory& memory) const;
  const std::vector<traffic::VehicleState>& forecastOf(const traffic::TrafficSnapshot& snapshot,
                                                       std::size_t index,
                                                       Forecasts& forecasts) const;
  std::size_t forecastSteps(double horizon) const;
  /// The ego forecast of the options, with a decision wherever one falls.
  EgoHorizon egoHorizon() const;

  PdmLiteOptions options_;
  dynamics::BicycleModel model_;
  const map::RoadNetwork& network_;
  double decision_period_;
  core::RandomStream drivers_;
  planning::VehicleMemory<Memory> memories_;
};

}  // namespace cdiff::planners
