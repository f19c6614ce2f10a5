// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What guidance did, as HTML: a chart of each active objective's value, and a table.
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

std::string guidanceSection(const record::SessionResult& result);

}  // namespace cdiff::page
