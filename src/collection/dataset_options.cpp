// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/dataset_options.h"

namespace cdiff::collection {

DatasetOptions datasetOptions(const CollectionOptions& options) {
  DatasetOptions dataset;
  dataset.standing_share = options.standing_share;
  dataset.offset_share = options.offset_share;
  dataset.offset_lateral = options.offset_lateral;
  dataset.offset_heading = options.offset_heading;
  return dataset;
}

learning::DrivingSchema schemaOf(const diffusion::Architecture& architecture) {
  learning::DrivingSchema schema;
  schema.horizon = architecture.horizon;
  schema.image_width = architecture.image_width;
  schema.image_height = architecture.image_height;
  schema.route_points = architecture.route_points;
  schema.route_spacing = architecture.route_spacing;
  return schema;
}

}  // namespace cdiff::collection
