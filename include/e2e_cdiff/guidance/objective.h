// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/guidance_scene.h"

namespace cdiff::guidance {

/// A guidance objective J(tau^0): what sampling minimizes (paper III-D), with its analytic gradient
/// with respect to states and actions in metric units.
/// Stateless besides its options; one row per objective in the table of objectives.
class Objective {
 public:
  virtual ~Objective() = default;
  /// Its own options (weight, window and cap are described by WeightedObjective).
  virtual void describe(core::OptionsVisitor& visitor) = 0;
  /// Throws InputError naming the option.
  virtual void validate() const {}
  /// J of a metric rollout (body frame of `scene`), summed over its rows; adds dJ/d(rollout) to
  /// `gradient` (same shape). The states are independent variables here: the state branch joins
  /// them to the actions.
  virtual double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                          traffic::Rollout& gradient) const = 0;
  virtual std::unique_ptr<Objective> clone() const = 0;
};

}  // namespace cdiff::guidance
