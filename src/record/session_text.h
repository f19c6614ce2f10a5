// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "record/session_result.h"

namespace cdiff::record {

// The fixed words of CBV identification (cbv/candidate_gates.h, cbv/cbv_selector.h) as sentences
// for people.

/// Why a candidate was not taken; the word itself when it is not known.
std::string rejectionText(const std::string& reason);
/// Why a CBV left its slot; the word itself when it is not known.
std::string releaseText(const std::string& reason);

// What happened in a session, in a few plain sentences: how far the ego came, which CBV came how
// near and when, who touched the ego.

/// Plain text, not escaped.
std::vector<std::string> sessionStory(const SessionResult& result);

/// Of a session that was to have CBVs, drove to its end and had none: "0 CBVs: nothing was tested:
/// ...". Empty for every other.
std::string untestedText(const SessionResult& result);

// The session's main measures as a table for a terminal.

/// `folder` is where the files lie.
std::string sessionTable(const SessionResult& result, const std::filesystem::path& folder);

/// A further row of it that names a file; empty where that file is not.
std::string fileRow(const std::string& name, const std::filesystem::path& file);

/// A measure with its unit and count, or why it is absent: "3.21 s (n = 40)", "not defined: no CBV
/// was driven".
std::string measureText(const metrics::Measure& measure, int decimals);

}  // namespace cdiff::record
