// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "core/markup.h"
#include "record/session_result.h"

namespace cdiff::page {

// One plan of a CBV against what it drove over the plan's horizon: from above (map frame), and
// speed over the time since the decision.

/// Pictures and legend, for a plan whose whole horizon was driven.
core::Markup planPictures(const record::SessionResult& result, const record::VehiclePlans& vehicle,
                          const record::LoggedPlan& plan);

// The CBVs that came nearest to the ego: what CBV and ego saw at the closest approach, and a plan
// from 3 s before against what was driven.

/// Renders the front views again, at 640 x 384 pixels.
core::Markup approachSection(const record::SessionResult& result);

}  // namespace cdiff::page
