// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Features of all samples by the present encoder, kept in files so that an interrupted run goes
/// on.
#pragma once

#include <atomic>
#include <ostream>

#include "training/stage.h"

namespace cdiff::training {

/// Reads or computes them; `features.cache` in the output folder. Throws core::Interrupted after
/// saving what there is.
FeatureCache computeFeatures(const TrainingState& state, const std::atomic<bool>& stop,
                             std::ostream& log);

}  // namespace cdiff::training
