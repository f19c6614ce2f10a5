// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// How training samples are made of what was recorded.
#pragma once

#include "collection/collection_options.h"
#include "diffusion/architecture.h"
#include "learning/driving_sample.h"

namespace cdiff::collection {

struct DatasetOptions {
  diffusion::Architecture architecture;  ///< horizon, image size, route tokens
  double standing_share = 0.25;          ///< part kept of samples that stand all the time
  double offset_share = 0.2;             ///< of samples that move, the part displaced once more
  double offset_lateral = 0.75;          ///< largest displacement to the side [m]
  double offset_heading = 12.0;          ///< largest turn of a displaced vehicle [deg]
};

/// Those that a collection's own options give.
DatasetOptions datasetOptions(const CollectionOptions& options);

/// The schema that such samples fit.
learning::DrivingSchema schemaOf(const diffusion::Architecture& architecture);

}  // namespace cdiff::collection
