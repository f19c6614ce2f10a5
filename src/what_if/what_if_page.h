// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "core/markup.h"
#include "what_if/what_if.h"

namespace cdiff::what_if {

/// A self-contained page: the recorded course, the driver's with everyone answering to it, and the
/// driver's with everyone as recorded, side by side from above under one slider; the ego's speed in
/// each.
std::string whatIfPage(const session::SessionSetup& setup, const Answer& answer);

// Style sheet and script of that page: the files in what_if/assets.

extern const core::Asset kWhatIfStyle;
extern const core::Asset kWhatIfScript;

}  // namespace cdiff::what_if
