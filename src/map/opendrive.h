// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Converts an OpenDRIVE file into SUMO network text with SUMO's netconvert, run as a child
/// process.
#pragma once

#include <filesystem>
#include <string>

namespace cdiff::map {

/// The text holds no date and no paths. Throws as runNetconvert does (map/process.h).
std::string convertOpenDrive(const std::filesystem::path& source);

}  // namespace cdiff::map
