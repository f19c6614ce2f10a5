// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The normaliser of a data set.
#pragma once

#include "diffusion/normalizer.h"
#include "learning/driving_sample.h"

namespace cdiff::planners {

/// Actions: throttle and brake [0, 1] -> [-1, 1], steer by twice its standard deviation over all
/// rows. States: mean and standard deviation of each cell, at least 0.05 m, 0.01 rad and 0.1 m/s.
/// The training samples and, if asked, their mirror images count.
diffusion::Normalizer fitNormalizer(const learning::DrivingDataset& dataset, bool mirrored);

}  // namespace cdiff::planners
