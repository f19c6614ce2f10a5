// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The session's main figures as a table for a terminal.
#pragma once

#include <filesystem>
#include <string>

#include "record/session_result.h"

namespace cdiff::record {

/// `folder` is where the files lie.
std::string sessionTable(const SessionResult& result, const std::filesystem::path& folder);

/// A further row of it that names a file; empty where that file is not.
std::string fileRow(const std::string& name, const std::filesystem::path& file);

/// A figure with its unit and count, or why it is absent: "3.21 s (n = 40)", "not defined: no CBV
/// was driven".
std::string measureText(const metrics::Measure& measure, int decimals);

}  // namespace cdiff::record
