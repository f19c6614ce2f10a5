// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// One plan of a CBV against what it drove over the plan's horizon: from above (map frame), and
/// speed over the time since the decision.
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

/// Pictures and legend as HTML, for a plan whose whole horizon was driven.
std::string planPictures(const record::SessionResult& result, const record::VehiclePlans& vehicle,
                         const record::LoggedPlan& plan);

}  // namespace cdiff::page
