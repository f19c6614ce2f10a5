// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The session's frames as compact JSON for the page's time slider: pixels of the picture from
/// above, whole degrees, 0.1 m/s; commands, gaps and times to collision of ego and CBVs; front
/// views.
#pragma once

#include <string>

#include "page/map_canvas.h"

namespace cdiff::page {

/// Safe inside a script element. Frames are left out evenly when there would be more than 60 000
/// poses.
std::string playbackJson(const record::SessionResult& result, const MapCanvas& canvas);

}  // namespace cdiff::page
