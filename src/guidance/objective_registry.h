// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

// The table of guidance objectives: those of this package, and those that plug-ins add.

/// Adds an objective at the end of the table; `source` says who does ("library /x/libmine.so").
/// Throws InputError naming `source` for a name that is taken or not snake_case, and for a
/// descriptor without help or constructor.
void registerObjective(ObjectiveDescriptor descriptor, const std::string& source);

/// Names in the table's order.
std::vector<std::string> objectiveNames();
/// One sentence about an objective, kept as long as the program runs. Throws InputError for an
/// unknown name, naming the nearest one; so does `makeObjective`.
const char* objectiveText(const std::string& name);
std::unique_ptr<Objective> makeObjective(const std::string& name);
/// Who registered an objective; "" for an unknown name.
std::string objectiveSource(const std::string& name);

}  // namespace cdiff::guidance
