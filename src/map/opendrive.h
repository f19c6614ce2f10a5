// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Converts an OpenDRIVE file into SUMO network text with SUMO's netconvert, run as a child
/// process.
#pragma once

#include <filesystem>
#include <string>

namespace cdiff::map {

/// `scratch` is a path in a writable folder; files that begin with it are made and removed again.
/// The text holds no date and no paths. Throws InputError that quotes netconvert.
std::string convertOpenDrive(const std::filesystem::path& source,
                             const std::filesystem::path& scratch);

}  // namespace cdiff::map
