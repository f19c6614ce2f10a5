// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What happened in a session, in a few plain sentences: how far the ego came, which CBV came how
/// near and when, who touched the ego.
#pragma once

#include <string>
#include <vector>

#include "record/session_result.h"

namespace cdiff::record {

/// Plain text, not escaped.
std::vector<std::string> sessionStory(const SessionResult& result);

}  // namespace cdiff::record
