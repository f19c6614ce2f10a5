// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>

#include "realism/recording.h"

namespace cdiff::realism {

/// The course of a session from its result folder (trace.csv, session.yaml), every 0.1 s, with the
/// contacts of every tick: a CBV leaves the simulation at the tick after one, which need not be a
/// step. The trace holds neither elevations nor sizes: all vehicles lie on one level and are 4.5 m
/// x 1.8 m (generated demand: 4.2 x 1.75 to 5.2 x 1.95), so that contacts of ego and CBVs are taken
/// from summary.json, too, where it is there. Throws InputError for a folder without trace.csv or
/// session.yaml, a damaged file, and for a simulation step that does not divide 0.1 s.
Recording readResult(const std::filesystem::path& folder);

}  // namespace cdiff::realism
