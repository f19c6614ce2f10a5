// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "core/markup.h"
#include "session/session_observer.h"

namespace cdiff::page {

/// The images of a rig's cameras side by side, each under its name, as the planner of `who` got
/// them; nothing where there is none.
core::Markup cameraStrip(const std::vector<session::SlotImage>& views, const std::string& who);

}  // namespace cdiff::page
