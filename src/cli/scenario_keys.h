// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "session/scenario_options.h"

namespace cdiff::cli {

/// The keys of a scenario as YAML with a comment above each, which a scenario file can hold. A
/// value that differs from the default is followed by "# default: VALUE". `group`: the keys of this
/// group alone; empty: all. Throws InputError naming the nearest group where there is none of this
/// name.
std::string scenarioKeys(const session::ScenarioOptions& options, const std::string& group);

}  // namespace cdiff::cli
