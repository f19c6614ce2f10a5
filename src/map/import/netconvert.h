// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cdiff::map {

// Runs netconvert, which ends with us and within its time limit.

/// Name of the environment variable that replaces the limit below [s].
inline constexpr const char* kNetconvertLimitVariable = "E2E_CDIFF_NETCONVERT_LIMIT";
/// Wall time that netconvert may take [s].
inline constexpr double kNetconvertLimit = 120.0;

/// Runs netconvert with these arguments; SUMO_HOME is core::sumoHome(). `subject` names in errors
/// what is converted ("network 'a.xodr'"). Throws InputError that quotes netconvert, or says that
/// it took longer than the limit or which signal ended it, and Interrupted when a stop is requested
/// meanwhile (core/program.h).
void runNetconvert(const std::vector<std::string>& arguments, const std::string& subject);

// Converts OpenDRIVE and OpenStreetMap files into SUMO network text with SUMO's netconvert and the
// package's type maps. The text holds no date and no paths.

/// Throws InputError and Interrupted as runNetconvert does.
std::string convertOpenDrive(const std::filesystem::path& source);

/// Roads for cars, simplified: points that only shape an edge are no junctions, junctions and
/// lights near each other are one. Throws as above.
std::string convertOpenStreetMap(const std::filesystem::path& source);

}  // namespace cdiff::map
