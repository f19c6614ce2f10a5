// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "core/markup.h"
#include "page/pictures/map_canvas.h"
#include "record/session_result.h"

namespace cdiff::page {

// The part of the page that a slider over time moves: the picture from above, the front view of
// each slot's CBV, speeds and commands at that time, and the controls.

/// What needs the script is hidden without it.
core::Markup stageHtml(const record::SessionResult& result, const MapCanvas& canvas);

// The session's frames as compact JSON for the page's time slider: pixels of the picture from
// above, whole degrees, 0.1 m/s; commands, gaps and times to collision of ego and CBVs; front
// views.

/// Frames are left out evenly when there would be more than 60 000 poses.
std::string playbackJson(const record::SessionResult& result, const MapCanvas& canvas);

}  // namespace cdiff::page
