// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "realism/recording.h"

namespace cdiff::realism {

/// Columns that a file of recorded traffic must have, in any order: recording, vehicle, t [s], x, y
/// [m], heading [rad], length, width [m]. Others are skipped: speeds and accelerations are
/// differentiated again from x and y.
const std::vector<std::string>& recordedColumns();

/// Recorded traffic from a CSV file: rows of a vehicle lie together in order of time, 0.1 s apart.
/// A longer gap starts another track. The site is the recording's name up to the first '-'. Throws
/// InputError naming file, missing and expected columns, or the line that cannot be read.
std::vector<Recording> readRecordedTraffic(const std::filesystem::path& file);

/// The same of several files, or of all *.csv files that have these columns in a folder, sorted by
/// name.
std::vector<Recording> readRecordedTraffic(const std::vector<std::filesystem::path>& files);

}  // namespace cdiff::realism
