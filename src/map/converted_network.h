// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Converts OpenDRIVE and OpenStreetMap files into SUMO network text with SUMO's netconvert and the
/// package's type maps. The text holds no date and no paths.
#pragma once

#include <filesystem>
#include <string>

namespace cdiff::map {

/// Throws InputError and Interrupted as runNetconvert does.
std::string convertOpenDrive(const std::filesystem::path& source);

/// Roads for cars, simplified: points that only shape an edge are no junctions, junctions and
/// lights near each other are one. Throws as above.
std::string convertOpenStreetMap(const std::filesystem::path& source);

}  // namespace cdiff::map
