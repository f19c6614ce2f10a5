// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Who was CBV when: a row per slot over the session's time [s], a bar per stay, a ring where the
/// CBV touched somebody.
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

/// As one HTML figure, for a session with CBVs.
std::string slotChart(const record::SessionResult& result);

}  // namespace cdiff::page
