// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "storyboard/scenario.h"

namespace cdiff::storyboard {

/// Reads an OpenSCENARIO XML file of version 1.0 to 1.3 with its catalogs. Throws InputError naming
/// file, line and element for what is wrong, and for what is not supported, unless that is to be
/// ignored; the scenario then lists it.
Scenario readScenario(const std::string& file, bool ignore_unsupported);

/// The table of elements that docs/openscenario.md shows, as Markdown.
std::string supportTable();

}  // namespace cdiff::storyboard
