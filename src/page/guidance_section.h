// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "core/markup.h"
#include "record/session_result.h"

namespace cdiff::page {

/// What guidance did: a chart of each active objective's value, and a table.
core::Markup guidanceSection(const record::SessionResult& result);

}  // namespace cdiff::page
