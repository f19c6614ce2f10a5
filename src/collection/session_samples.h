// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Training samples from a driven session: for every image of a driven vehicle what it then did, in
/// its own frame (SI units; rows as in traffic/rollout.h), and its route tokens.
#pragma once

#include <vector>

#include "collection/dataset_options.h"
#include "collection/dataset_statistics.h"
#include "collection/driven_session.h"

namespace cdiff::collection {

/// By tick and slot. An image gives one if its vehicle was driven, without noise, contact or jump,
/// from the tick before it to the end of the horizon. Throws InputError for images of another size.
std::vector<learning::DrivingSample> samplesOf(const DrivenSession& session,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics);

}  // namespace cdiff::collection
