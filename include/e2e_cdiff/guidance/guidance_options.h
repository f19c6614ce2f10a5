// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// An objective with the values that a profile gives it: its weight w_i in the sum, the diffusion
/// steps k (counting down from K to 1) at which it acts, and the cap of its gradient.
struct WeightedObjective {
  std::string name;             ///< of the objective
  double weight = 0.0;          ///< w_i; 0 switches it off
  std::int64_t first_step = 0;  ///< acts at k <= first_step; 0: from K on
  std::int64_t last_step = 1;   ///< acts at k >= last_step
  double gradient_cap = 0.0;    ///< largest |w_i dJ_i/d tau| of a sample, normalized units; 0: none
  std::unique_ptr<Objective> objective;  ///< with its own options

  /// Whether it has a weight and the step lies in its window.
  bool actsAt(int diffusion_step) const {
    return weight > 0.0 && diffusion_step >= last_step &&
           (first_step == 0 || diffusion_step <= first_step);
  }
  void describe(core::OptionsVisitor& visitor);  ///< visits every option
};

/// Guidance of a session: every objective with weight, window and cap; J_total = sum_i w_i J_i
/// (paper III-D2). A profile, in config/guidance, is a YAML file of these options. Holds one entry
/// per known objective, all switched off by default; copies are deep.
struct GuidanceOptions {
  GuidanceOptions();
  GuidanceOptions(const GuidanceOptions& other);                     ///< deep copy
  GuidanceOptions(GuidanceOptions&&) noexcept = default;             ///< move
  GuidanceOptions& operator=(const GuidanceOptions& other);          ///< deep copy
  GuidanceOptions& operator=(GuidanceOptions&&) noexcept = default;  ///< move

  std::vector<WeightedObjective> objectives;  ///< in the order of the table of objectives
  /// Farthest that a proximal step (sampler mode real_time) moves an action, in units of the spread
  /// r_k (diffusion/sampler.h).
  double trust_region = 2.0;
  /// No objective acts at k below it, whatever its own window: the steps after it are the model's
  /// alone, so that what guidance did last is denoised once more.
  std::int64_t last_step = 1;
  /// rho: correlation of the noise that a vehicle's plans are drawn from between any two of its
  /// decisions; 0: drawn anew each time (the paper), 1: one noise for all its decisions.
  double noise_correlation = 0.0;
  /// Samples drawn of each vehicle and decision; the one with the lowest J_total is driven.
  std::int64_t candidates = 1;
  /// Of these, the ones come first that keep every corner of the box on the drivable area for so
  /// long [s] when they are driven; 0: J_total alone ranks them.
  double road_horizon = 0.0;
  /// Which of these is driven by a CBV: off, or by the careful driver in the ego's place that must
  /// be able to answer it (e2e_cdiff/planning/challenge.h): easy | medium | hard.
  std::string challenge = "off";

  /// The entry of an objective. Throws InputError naming the nearest one for an unknown name.
  WeightedObjective& find(const std::string& name);
  /// Whether an objective of this name has a weight; false for an unknown name.
  bool isActive(const std::string& name) const;
  /// Whether an objective of these options acts at a diffusion step: by its window and last_step.
  bool acts(const WeightedObjective& entry, int diffusion_step) const {
    return diffusion_step >= last_step && entry.actsAt(diffusion_step);
  }
  void describe(core::OptionsVisitor& visitor);  ///< visits every option
  /// Throws InputError; `group` is put before the keys that it names ("guidance.").
  void validate(const std::string& group = "") const;
  /// Throws InputError naming the key, with `group` before it, of an active objective whose window
  /// reaches beyond `diffusion_steps`, the model's K, or holds none of the steps that the sampler
  /// visits.
  void validateWindows(int diffusion_steps, const std::vector<int>& visited,
                       const std::string& group = "") const;
};

/// Reads a profile by file name, or by the name of one in config/guidance. Throws InputError naming
/// file, line and key, or the nearest shipped profile.
GuidanceOptions loadProfile(const std::string& name_or_file);

/// Names of the shipped profiles, sorted.
std::vector<std::string> shippedProfiles();

/// One objective over the denoising steps of the sample that was chosen.
struct ObjectiveReport {
  std::string name;            ///< of the objective
  double weight = 0.0;         ///< w_i
  double value = 0.0;          ///< J of the rollout that was chosen (unweighted)
  double gradient_norm = 0.0;  ///< mean over active steps of |w dJ/d tau| at the start of the
                               ///< step, before the cap, normalized units
  double capped_share = 0.0;   ///< share of active steps in which the gradient cap acted, [0, 1]
  std::int64_t dropped = 0;    ///< steps in which it was not finite and left out
};

/// What the choice of mode challenging was in one decision of one CBV (map frame).
struct ChallengeReport {
  std::string state;        ///< "drives", "attacks" or "withdrawn"; empty: not this mode
  std::string reason;       ///< why it withdrew, or empty
  std::int64_t chosen = 0;  ///< index of the plan, those of the last plan and of braking included
  double delta = 0.0;       ///< extra delay with which C still answers the plan [s]
  /// Last moment to brake, from now on [s]; absent where C need not brake.
  std::optional<double> last_brake_time;
  std::optional<traffic::VehicleState> ghost;  ///< of the promise that is kept
  std::vector<std::string> refusals;           ///< by plan: why it may not be driven, or empty
};

/// What guidance did in one decision of one vehicle, for people and records.
struct GuidanceReport {
  std::vector<ObjectiveReport> objectives;  ///< active ones, in the table's order
  std::int64_t candidates = 0;              ///< samples drawn
  std::int64_t chosen = 0;                  ///< index of the one that drives
  double trust_region_share = 0.0;  ///< share of guided steps in which the trust region acted
  ChallengeReport challenge;        ///< in mode challenging
};

}  // namespace cdiff::guidance
