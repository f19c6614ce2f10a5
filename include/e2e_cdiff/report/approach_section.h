// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The CBVs that came nearest to the ego: what CBV and ego saw at the closest approach, and a plan
/// from 3 s before against what was driven.
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/report/session_result.h"

namespace cdiff::report {

/// At most this many CBVs are shown with pictures.
inline constexpr std::size_t kMostApproaches = 4;

/// The approaches that are shown, smallest gap first (ties: the vehicle that was driven first).
std::vector<const Approach*> shownApproaches(const ApproachLog& log);

/// As HTML. Renders the front views anew, at 640 x 384 pixels.
std::string approachSection(const SessionResult& result);

}  // namespace cdiff::report
