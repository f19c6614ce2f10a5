// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "planners/registry.h"

namespace cdiff::session {

/// How planners that sample and are guided work unless a scenario says otherwise: a preset below
/// all single keys. Methods are YAML files of it in config/methods: `paper` is the published
/// method, `default` what the package recommends.
struct MethodOptions {
  std::string naturalistic_profile;     ///< guidance profile of CBVs in mode naturalistic
  std::string safety_critical_profile;  ///< and in mode safety_critical
  std::string ego_profile;              ///< of an ego whose planner can be guided
  planning::PlannerOptionsTable planner_options = planners::defaultOptions();

  void describe(core::OptionsVisitor& visitor);
  const std::string& profileOf(const std::string& mode) const;
};

/// Throws InputError naming the nearest shipped method for an unknown name.
MethodOptions loadMethod(const std::string& name);

/// Names of the shipped methods, sorted.
std::vector<std::string> shippedMethods();

}  // namespace cdiff::session
