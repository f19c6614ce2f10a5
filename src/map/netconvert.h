// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Runs netconvert, which neither outlives us nor runs for ever.
#pragma once

#include <string>
#include <vector>

namespace cdiff::map {

/// Name of the environment variable that replaces the limit below [s].
inline constexpr const char* kNetconvertLimitVariable = "E2E_CDIFF_NETCONVERT_LIMIT";
/// Wall time that netconvert may take [s].
inline constexpr double kNetconvertLimit = 120.0;

/// Runs netconvert with these arguments; SUMO_HOME is core::sumoHome(). `subject` names in errors
/// what is converted ("network 'a.xodr'"). Throws InputError that quotes netconvert, or says that
/// it took longer than the limit or which signal ended it, and Interrupted when a stop is requested
/// meanwhile (core/program.h).
void runNetconvert(const std::vector<std::string>& arguments, const std::string& subject);

}  // namespace cdiff::map
