// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "core/markup.h"
#include "record/session_result.h"

namespace cdiff::page {

// Who was CBV when: a row per slot over the session's time [s], a bar per stay, a ring where the
// CBV touched another vehicle.

/// As one HTML figure, for a session with CBVs.
core::Markup slotChart(const record::SessionResult& result);

// Charts of a session: speeds, distance between ego and CBVs, commands.

/// All charts with their common legend, as HTML.
core::Markup sessionCharts(const record::SessionResult& result);

}  // namespace cdiff::page
