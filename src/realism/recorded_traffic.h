// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <vector>

#include "realism/recording.h"

namespace cdiff::realism {

/// Columns that a file of recorded traffic must have, in any order: recording, vehicle, t [s], x, y
/// [m], heading [rad], length, width [m]. Others are passed over: speeds and accelerations are
/// differentiated anew from x and y.
const std::vector<std::string>& recordedColumns();

/// Recorded traffic from a CSV file: rows of a vehicle lie together in order of time, 0.1 s apart.
/// A longer gap starts another track. The site is the recording's name up to the first '-'. Throws
/// InputError naming file, missing and expected columns, or the line that cannot be read.
std::vector<Recording> readRecordedTraffic(const std::filesystem::path& file);

/// The same of several files, or of all *.csv files that have these columns in a folder, sorted by
/// name.
std::vector<Recording> readRecordedTraffic(const std::vector<std::filesystem::path>& files);

/// The course of a session from its result folder (trace.csv, session.yaml), every 0.1 s. The trace
/// holds neither elevations nor sizes: all vehicles lie on one level and are 4.5 m x 1.8 m, as
/// generated demand and every vehicle of ours is. Throws InputError for a folder without them and
/// for a simulation step of which 0.1 s is no multiple.
Recording readResult(const std::filesystem::path& folder);

}  // namespace cdiff::realism
