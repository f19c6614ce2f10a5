// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "session/vehicle_rigs.h"
#include "what_if/recorded_run.h"

namespace cdiff::what_if {

// Who drives in a session that runs again: the recorded actions, and from a take-over on a driver
// of the user's choice.

/// Name of the planner that takes over unless another one is named.
std::string defaultDriver();

/// Who takes the ego over.
struct DriverChoice {
  std::string planner = defaultDriver();  ///< of the table of planners
  std::vector<std::string> set = {};      ///< "key=value" each: options of that planner

  /// For people and file names: the planner's name, and what is set: "NAME delay=1.25".
  std::string label() const;
};

/// A driver that can take the ego over in sessions of one setup.
class Driver {
 public:
  /// `setup` must outlive the object. Throws InputError for an unknown planner, one that does not
  /// drive egos, the external one, and a key that is not one of the planner's own.
  Driver(const session::SessionSetup& setup, const DriverChoice& choice);

  const DriverChoice& choice() const { return choice_; }
  bool sees() const;
  session::VehicleRigs rigs() const { return session::VehicleRigs(options_); }
  /// As it starts into a session. Throws InputError as the planner does.
  std::unique_ptr<planning::Planner> make() const;

 private:
  const session::SessionSetup& setup_;
  DriverChoice choice_;
  session::ScenarioOptions options_;  ///< the session's with this driver's options
};

/// Plays the actions of a recorded run; full braking where it has none.
class RecordedActions : public planning::Planner {
 public:
  explicit RecordedActions(const RecordedRun& run) : run_(run) {}
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  const RecordedRun& run_;
};

/// The recorded ego before a tick, a driver from that tick on. The driver watches from the first
/// decision on, so that what it needs time to perceive it perceives in the recorded course.
class TakenOverEgo : public planning::Planner {
 public:
  TakenOverEgo(const RecordedRun& run, std::unique_ptr<planning::Planner> driver,
               std::uint64_t take_over_tick)
      : recorded_(run), driver_(std::move(driver)), take_over_tick_(take_over_tick) {}
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

 private:
  RecordedActions recorded_;
  std::unique_ptr<planning::Planner> driver_;
  std::uint64_t take_over_tick_;
};

}  // namespace cdiff::what_if
