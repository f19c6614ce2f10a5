// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "record/session_result.h"

namespace cdiff::record {

// The fixed words of CBV identification (cbv/candidate_gates.h, cbv/held_cbv.h) as sentences for
// people.

/// Why a candidate was not taken; the word itself when it is not known.
std::string rejectionText(const std::string& reason);
/// Why a CBV left its slot; the word itself when it is not known.
std::string releaseText(const std::string& reason);

// What happened in a session, in a few plain sentences: how far the ego came, which CBV came how
// near and when, who touched the ego.

/// Plain text, not escaped.
std::vector<std::string> sessionStory(const SessionResult& result);

}  // namespace cdiff::record
