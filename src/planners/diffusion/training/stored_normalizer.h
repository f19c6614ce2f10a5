// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Which normalizer a run uses: weights mean something only with the one they were trained with, so
/// it travels with every checkpoint as the fact "normalizer" (Normalizer::toJson).
#pragma once

#include "diffusion/model.h"
#include "learning/driving_sample.h"
#include "learning/training_options.h"

namespace cdiff::planners {

/// That of the checkpoint that the run goes on with or starts from, else that of the model `init`
/// (nullptr: none), else one fitted to the data and, if asked, its mirror images; [T, 7] each, of
/// m, rad, m/s and pedals. Throws InputError naming the file for one that does not fit.
diffusion::Normalizer chooseNormalizer(const learning::TrainingOptions& options, bool mirror,
                                       const learning::DrivingDataset& dataset,
                                       const diffusion::Model* init);

}  // namespace cdiff::planners
