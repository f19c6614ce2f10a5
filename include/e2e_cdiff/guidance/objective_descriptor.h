// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// What is known of a guidance objective before one is made.
struct ObjectiveDescriptor {
  std::string name;  ///< in guidance profiles, snake_case
  std::string help;  ///< one sentence: what a plan does to lower it
  std::function<std::unique_ptr<Objective>()> make;
};

}  // namespace cdiff::guidance
