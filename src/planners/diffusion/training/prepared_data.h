// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "diffusion/model.h"
#include "diffusion/normalizer.h"
#include "learning/samples/driving_sample.h"
#include "learning/training_options.h"
#include "planners/diffusion/training/diffusion_stages.h"

namespace cdiff::planners {

// Features of all samples by the current encoder, kept in files so that an interrupted run goes on.

/// Reads or computes them; kFeatureFile in the output folder. Throws core::Interrupted after saving
/// what there is.
FeatureCache computeFeatures(const TrainingState& state);
inline constexpr const char* kFeatureFile = "features.cache";

// The normalizer of a data set.

/// Actions: throttle and brake [0, 1] -> [-1, 1], steer by twice its standard deviation over all
/// rows. States: mean and standard deviation of each cell, at least 0.05 m, 0.01 rad and 0.1 m/s.
/// The training samples and, if asked, their mirror images count.
diffusion::Normalizer fitNormalizer(const learning::DrivingDataset& dataset, bool mirrored);

// Which normalizer a run uses: weights mean something only with the one they were trained with, so
// it travels with every checkpoint as the fact "normalizer" (Normalizer::toJson).

/// That of the checkpoint that the run goes on with or starts from, else that of the model `init`
/// (nullptr: none), else one fitted to the data and, if asked, its mirror images; [T, 7] each, of
/// m, rad, m/s and pedals. Throws InputError naming the file for one that does not fit.
diffusion::Normalizer chooseNormalizer(const learning::TrainingOptions& options, bool mirror,
                                       const learning::DrivingDataset& dataset,
                                       const diffusion::Model* init);

}  // namespace cdiff::planners
