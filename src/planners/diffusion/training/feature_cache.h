// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "planners/diffusion/training/diffusion_stages.h"

namespace cdiff::planners {

// Features of all samples by the present encoder, kept in files so that an interrupted run goes
// on.

/// Reads or computes them; kFeatureFile in the output folder. Throws core::Interrupted after
/// saving what there is.
FeatureCache computeFeatures(const TrainingState& state);
inline constexpr const char* kFeatureFile = "features.cache";

}  // namespace cdiff::planners
