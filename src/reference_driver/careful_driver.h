// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "reference_driver/conflict.h"
#include "reference_driver/reference_driver.h"

namespace cdiff::reference_driver {

/// Constants of the careful and competent human driver (UN R157, Annex 3, Appendix 3, Table 1), and
/// ours where the regulation covers cut-in, cut-out and deceleration only.
struct CarefulDriverOptions {
  double evaluation_time = 0.4;      ///< from first evidence to a perceived risk [s]
  double delay = 0.75;               ///< from there until the brake acts [s]
  double ramp_time = 0.6;            ///< until it acts fully [s]
  double deceleration = 7.593;       ///< full: 0.774 g [m/s^2]
  double lateral_deviation = 0.375;  ///< beyond it a vehicle that comes nearer cuts in [m]
  double lead_time = 2.5;  ///< TTC to a lead that is a risk [s]; at 2 s it fails from 8.5 m/s on
  double lead_deceleration = 5.0;  ///< of a lead that is a risk [m/s^2]
  double look_ahead = 4.0;         ///< ours: cut-ins, crossings, merges, oncoming [s]
  double arrival_gap = 1.0;        ///< ours: missing by less than this is a risk [s]
  /// Ours: who can still stop before the corridor with this is expected to yield [m/s^2].
  double yielding_deceleration = 1.5;
  double horizon = 15.0;  ///< within which it must be able to stop [s]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for a negative delay or other times and decelerations that are not positive,
  /// and for a horizon that is shorter than it takes to stop from `top_speed` [m/s]; `group` is put
  /// before the keys that it names.
  void validate(double top_speed = 1.0, const std::string& group = "") const;
  /// From first evidence to standstill [s].
  double stoppingTime(double speed) const;
  /// The same [m]: D(v) = (t_e + t_d) v + v T / 2 + v^2 / 2a - a T^2 / 24.
  double stoppingDistance(double speed) const;
  /// Whether it can stop within the horizon from `speed` [m/s].
  bool stopsFrom(double speed) const { return stoppingTime(speed) <= horizon; }
};

/// Careful and competent driver C. Evidence of a risk, vehicle by vehicle:
///  - cut-in: it has come nearer by more than 0.375 m since it last kept its offset, and the two
///    meet within `look_ahead` (conflict.h);
///  - lead, the nearest vehicle in the corridor (a vehicle behind another is hidden, so that a
///    cut-out reveals it): TTC at most `lead_time`, unless the own braking will do, or it brakes
///    harder than `lead_deceleration`;
///  - merge, crossing: they meet within `look_ahead` or miss each other by less than `arrival_gap`,
///    and the other can no longer stop before the corridor with `yielding_deceleration`, or is no
///    car but a pedestrian or a bicycle;
///  - oncoming: the same, with its box less than 0.7 m from the corridor.
/// Evidence that holds for `evaluation_time` is a perceived risk; `delay` later the brake goes down
/// within `ramp_time`. It is held until the vehicle is clear: to standstill, or until they would
/// not meet within twice the look-ahead. JRC's coasting by 0.4 m/s^2 in the delay is left out.
class CarefulDriver final : public ReferenceDriver {
 public:
  explicit CarefulDriver(const CarefulDriverOptions& options = {});

  double brake(const OwnMotion& own, const std::vector<SeenVehicle>& seen,
               double duration) override;
  std::unique_ptr<ReferenceDriver> clone() const override;
  /// Waits so much longer before it brakes [s].
  void delayBy(double extra) { extra_delay_ = extra; }
  /// Whether a risk is perceived.
  bool perceives() const;

 private:
  /// What is known of one vehicle.
  struct Clock {
    std::uint64_t id = 0;
    double seen_time = 0.0;        ///< last [s]
    double steady_offset = 0.0;    ///< distance from the corridor when it last kept it [m]
    double evidence_since = -1.0;  ///< [s]; negative: there is none
    bool kept = false;             ///< seen at this step
  };

  Clock& clockOf(const SeenVehicle& vehicle, const Conflict& conflict, double time);
  static bool isSmall(const SeenVehicle& vehicle);
  bool isRisk(const OwnMotion& own, const Conflict& conflict, const SeenVehicle& vehicle,
              const Clock& clock, bool nearest) const;
  bool isDue(const Clock& clock, double time) const;

  CarefulDriverOptions options_;
  double extra_delay_ = 0.0;
  std::vector<Clock> clocks_;
  BrakeRamp ramp_;
};

/// Distance to the vehicle ahead that UN R157 (5.2.3.3) asks for, from bumper to bumper [m]: the
/// time gap grows from 1.0 s at 2 m/s to 1.6 s at 16.7 m/s; at least 2 m.
double followingGap(double speed);

}  // namespace cdiff::reference_driver
