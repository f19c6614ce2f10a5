// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The table from objective name to constructor.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// Names that exist, in the order in which they are described and summed.
std::vector<std::string> objectiveNames();
/// Meaning of an objective in one sentence.
const char* objectiveText(const std::string& name);
/// Throws InputError naming the nearest known objective for an unknown name.
std::unique_ptr<Objective> makeObjective(const std::string& name);

}  // namespace cdiff::guidance
