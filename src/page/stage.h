// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The part of the page that a slider over time moves: the picture from above, the front view of
/// each slot's CBV, speeds and commands at that time, and the controls.
#pragma once

#include <string>

#include "page/map_canvas.h"

namespace cdiff::page {

/// As HTML. What needs the script is hidden without it.
std::string stageHtml(const record::SessionResult& result, const MapCanvas& canvas);

}  // namespace cdiff::page
