// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/challenge.h"
#include "reference_driver/careful_driver.h"
#include "reference_driver/drive_ahead.h"

namespace cdiff::planning {

// The plans of CBVs in mode challenging, tried one by one in the ego's place. `Challenge` asks; C
// is the careful driver of UN R157 (reference_driver/careful_driver.h).

/// An ego that is no faster stands (nuPlan) [m/s].
inline constexpr double kStandingEgo = 0.05;

/// A plan of a CBV under examination (times from now on [s]).
struct ChallengeTrial {
  /// The plan, and after its end: along the lane, braking with 8 m/s^2, straight on.
  std::array<reference_driver::ForeseenVehicle, 3> motions;
  std::string refusal;  ///< empty: it may be driven
  /// Time until C in the ego's place is touched [s].
  double margin = std::numeric_limits<double>::infinity();
  std::optional<double> hit_time;  ///< when an ego that keeps its speed is touched [s]
  /// When it is touched after the plan, with the CBV on its lane [s].
  std::optional<double> approach_time;
  double delta = 0.0;                ///< largest extra delay with which C answers it [s]
  std::optional<double> brake_time;  ///< when C begins to brake [s]
  std::size_t off_road = 0;          ///< states of the plan with a corner off the road
};

/// The ego at a decision, in whose place plans are tried (map frame, SI units).
class ChallengeCourse {
 public:
  /// `own`: the ego on its path; `driver`: C as it has watched from there. References must outlive
  /// it.
  ChallengeCourse(const PlanningContext& context, const reference_driver::OwnMotion& own,
                  const reference_driver::DrivenPath& path,
                  const reference_driver::CarefulDriver& driver)
      : context_(context), own_(own), path_(path), driver_(driver) {}

  /// Refused are plans that touch the ego while it stands or from behind: an ego that keeps its
  /// speed, or one that goes on braking as it does.
  ChallengeTrial examine(const traffic::Vehicle& cbv, const ChallengePlan& plan) const;
  /// Fills `off_road`.
  void findRoad(ChallengeTrial& trial, std::size_t states) const;
  /// Whether C answers the plan from the ego's place, whatever comes after the plan's end; fills
  /// `margin` and `brake_time`.
  bool egoAnswers(ChallengeTrial& trial) const { return answers(driver_, own_, trial, 0.0); }
  /// The same from another place.
  bool answers(const reference_driver::CarefulDriver& driver,
               const reference_driver::OwnMotion& start, ChallengeTrial& trial,
               double extra_delay) const;
  /// Fills `delta` of a plan that is answered.
  void findDelta(ChallengeTrial& trial) const;
  /// From now on plans of others are tried together with this one.
  void choose(const ChallengeTrial& trial) { chosen_.push_back(trial.motions.front()); }

 private:
  double duration() const;
  void addTails(const traffic::Vehicle& cbv, ChallengeTrial& trial) const;
  std::string strikeOf(reference_driver::ReferenceDriver& driver, ChallengeTrial& trial,
                       double duration) const;
  void findApproach(const traffic::Vehicle& cbv, ChallengeTrial& trial) const;

  const PlanningContext& context_;
  const reference_driver::OwnMotion& own_;
  const reference_driver::DrivenPath& path_;
  const reference_driver::CarefulDriver& driver_;
  std::vector<reference_driver::ForeseenVehicle> chosen_;  ///< of this decision
};

}  // namespace cdiff::planning
