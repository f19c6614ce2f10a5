// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "inference/transformer_layers.h"

namespace cdiff::inference {

// Deformable attention (Zhu et al. 2021): a query reads a few places of feature maps instead of all
// of them. Maps are rows of features: map m, row r, column c is row (m x height + r) x width + c.

/// Size of the maps that are read, in cells.
struct MapGrid {
  std::int64_t height = 0;
  std::int64_t width = 0;

  std::int64_t cells() const { return height * width; }
};

/// One query reading one map; `block`: which of the query's blocks of offsets and weights it uses.
struct MapVisit {
  std::int32_t query = 0;
  std::int32_t map = 0;
  std::int32_t block = 0;
};

/// Which queries read which maps around which places. A place is (column, row) in cells, the center
/// of the first cell being (0, 0); beyond the map there are zeros.
struct SamplingPlan {
  std::int64_t queries = 0;
  std::int64_t points = 0;        ///< places a visit and head
  std::vector<MapVisit> visits;   ///< those of a query one after the other
  std::vector<float> references;  ///< [visits, points, 2]
  std::vector<float> shares;      ///< [queries] 1 / number of its visits, 0 where it has none

  /// Adds a visit; its references, one for all points or one each, are appended by the caller.
  void visit(std::int64_t query, std::int64_t map, std::int64_t block = 0);
  /// Sets `shares`; the end of making a plan.
  void finish();
};

/// Every query reads map 0 around one place: `places` [queries, 2].
SamplingPlan planAround(const float* places, std::int64_t queries, std::int64_t points);

/// Sizes of a deformable attention: width / heads numbers a head.
struct DeformableSizes {
  std::int64_t width = 96;
  std::int64_t heads = 6;
  std::int64_t points = 4;  ///< places a visit and head
  std::int64_t blocks = 1;  ///< of offsets and weights a query

  std::int64_t headWidth() const { return width / heads; }
  std::int64_t offsets() const { return blocks * heads * points * 2; }
  std::int64_t weights() const { return blocks * heads * points; }
};

/// The rows that readMaps works on: of queries their offsets [blocks, heads, points, 2] in cells
/// and weights [blocks, heads, points]; of maps their values [heads x head width].
struct MapReading {
  DeformableSizes sizes;
  MapGrid grid;
  View values;
  View offsets;
  View weights;
  View output;  ///< a row for each query
};

/// output[q, h] = share of q x sum over its visits v and points p of weights[q, block of v, h, p]
/// values(map of v, h) at references[v, p] + offsets[q, block of v, h, p], bilinear.
void readMaps(const MapReading& reading, const SamplingPlan& plan);

/// The four cells around a place with their shares; `row` is -1 for a cell beyond the map.
struct CellCorners {
  std::int64_t row[4];
  float share[4];
  float across;  ///< of the place between the columns, in [0, 1]
  float down;    ///< between the rows

  CellCorners(const MapGrid& grid, std::int64_t map, float column, float line);
};

/// Memory that deformable attentions share.
struct DeformableMemory {
  Rows values;
  Rows offsets;
  Rows weights;
  Rows mixed;
};

/// change = W_o read(W_v maps) with offsets W_d x and weights softmax over a block's points of
/// W_a x. Tensors: NAME.value, NAME.offset, NAME.score, NAME.output.
class DeformableAttention {
 public:
  DeformableAttention(const LayerWeights& weights, const std::string& name,
                      const DeformableSizes& sizes);
  /// `x`: rows of queries; `maps`: rows of the maps' features. Writes `change`, a row for each
  /// query.
  void apply(const Rows& x, const Rows& maps, const MapGrid& grid, const SamplingPlan& plan,
             DeformableMemory& memory, Rows& change) const;
  const DeformableSizes& sizes() const { return sizes_; }

 private:
  DeformableSizes sizes_;
  Linear value_;
  Linear offset_;
  Linear score_;
  Linear output_;
};

/// Names and shapes of its tensors; `inputs`: width of a row of x.
void addDeformable(const std::string& name, const DeformableSizes& sizes, std::int64_t inputs,
                   TensorList& list);

}  // namespace cdiff::inference
