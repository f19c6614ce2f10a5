// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>

#include "e2e_cdiff/guidance/guidance_options.h"
#include "session/scenario_options.h"
#include "session/steering.h"

namespace cdiff::session {

/// What steering has made of the CBVs so far: their mode, guidance profile, guidance and target
/// speed. Every part that needs one of them follows the changes of the snapshots in its own copy.
class SteeredCbvs {
 public:
  /// As the scenario begins. `options` must outlive the object.
  explicit SteeredCbvs(const ScenarioOptions& options);

  /// Whether the subject is one of these four; others concern single vehicles.
  static bool concerns(const std::string& what);
  /// The change that a request of such a subject makes. Throws InputError for an unknown profile,
  /// mode or objective, a value out of range, and guidance of CBVs whose planner is not guided.
  traffic::SteeringChange changeBy(const SteeringRequest& request) const;
  /// Returns whether guidance is another one now. Throws as `changeBy`.
  bool follow(const traffic::SteeringChange& change);

  /// The present value of such a subject as text; "drawn" for target speeds that are.
  std::string value(const std::string& what) const { return valueOf(what, now_); }
  const guidance::GuidanceOptions& guidance() const { return now_.guidance; }
  /// v* of all CBVs [m/s]; nullopt where it is still the scenario's.
  std::optional<double> targetSpeed() const { return now_.target_speed; }

 private:
  struct State {
    std::string mode;
    std::string profile;
    guidance::GuidanceOptions guidance;
    std::optional<double> target_speed;
  };
  void apply(const std::string& what, const std::string& value, State& state) const;
  std::string valueOf(const std::string& what, const State& state) const;

  const ScenarioOptions& options_;
  State now_;
};

/// Throws InputError naming the entry of `options.steering` that asks for what cannot be.
void validateSteering(const ScenarioOptions& options);

}  // namespace cdiff::session
