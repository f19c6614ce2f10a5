// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/deformable_attention.h"

#include <algorithm>
#include <cmath>

namespace cdiff::inference {
namespace {

/// Softmax of each run of `count` numbers in a row.
void softmaxRuns(float* values, std::int64_t runs, std::int64_t count) {
  for (std::int64_t run = 0; run < runs; ++run, values += count) {
    const float largest = *std::max_element(values, values + count);
    float sum = 0.0F;
    for (std::int64_t i = 0; i < count; ++i) {
      values[i] = std::exp(values[i] - largest);
      sum += values[i];
    }
    for (std::int64_t i = 0; i < count; ++i) values[i] /= sum;
  }
}

void addScaled(const float* from, float scale, std::int64_t count, float* to) {
  for (std::int64_t i = 0; i < count; ++i) to[i] += scale * from[i];
}

void readVisit(const MapReading& reading, const SamplingPlan& plan, std::size_t number) {
  const DeformableSizes& sizes = reading.sizes;
  const MapVisit& visit = plan.visits[number];
  const std::int64_t head_width = sizes.headWidth();
  const std::int64_t first = visit.block * sizes.heads * sizes.points;
  const float* offsets = reading.offsets.data + visit.query * reading.offsets.row + 2 * first;
  const float* weights = reading.weights.data + visit.query * reading.weights.row + first;
  const float* references =
      plan.references.data() + number * static_cast<std::size_t>(2 * plan.points);
  const float share = plan.shares[static_cast<std::size_t>(visit.query)];
  float* output = reading.output.data + visit.query * reading.output.row;
  for (std::int64_t head = 0; head < sizes.heads; ++head, output += head_width) {
    for (std::int64_t point = 0; point < sizes.points; ++point, offsets += 2, ++weights) {
      const CellCorners corners(reading.grid, visit.map, references[2 * point] + offsets[0],
                                references[2 * point + 1] + offsets[1]);
      for (int i = 0; i < 4; ++i) {
        if (corners.row[i] < 0) continue;
        const float* value =
            reading.values.data + corners.row[i] * reading.values.row + head * head_width;
        addScaled(value, share * *weights * corners.share[i], head_width, output);
      }
    }
  }
}

}  // namespace

void SamplingPlan::visit(std::int64_t query, std::int64_t map, std::int64_t block) {
  visits.push_back({static_cast<std::int32_t>(query), static_cast<std::int32_t>(map),
                    static_cast<std::int32_t>(block)});
}

void SamplingPlan::finish() {
  shares.assign(static_cast<std::size_t>(queries), 0.0F);
  for (const MapVisit& one : visits) shares[static_cast<std::size_t>(one.query)] += 1.0F;
  for (float& share : shares) share = share > 0.0F ? 1.0F / share : 0.0F;
}

SamplingPlan planAround(const float* places, std::int64_t queries, std::int64_t points) {
  SamplingPlan plan;
  plan.queries = queries;
  plan.points = points;
  for (std::int64_t query = 0; query < queries; ++query) {
    plan.visit(query, 0);
    for (std::int64_t point = 0; point < points; ++point)
      plan.references.insert(plan.references.end(), places + 2 * query, places + 2 * query + 2);
  }
  plan.finish();
  return plan;
}

CellCorners::CellCorners(const MapGrid& grid, std::int64_t map, float column, float line) {
  // Places far outside, and those that are not finite, read nothing.
  const bool near = column > -1.0F && column < static_cast<float>(grid.width) && line > -1.0F &&
                    line < static_cast<float>(grid.height);
  const float left = near ? std::floor(column) : -2.0F;
  const float top = near ? std::floor(line) : -2.0F;
  across = near ? column - left : 0.0F;
  down = near ? line - top : 0.0F;
  for (int i = 0; i < 4; ++i) {
    const std::int64_t c = static_cast<std::int64_t>(left) + i % 2;
    const std::int64_t r = static_cast<std::int64_t>(top) + i / 2;
    const bool inside = c >= 0 && c < grid.width && r >= 0 && r < grid.height;
    row[i] = inside ? (map * grid.height + r) * grid.width + c : -1;
    share[i] = (i % 2 == 0 ? 1.0F - across : across) * (i / 2 == 0 ? 1.0F - down : down);
  }
}

void readMaps(const MapReading& reading, const SamplingPlan& plan) {
  for (std::int64_t query = 0; query < plan.queries; ++query)
    std::fill_n(reading.output.data + query * reading.output.row, reading.sizes.width, 0.0F);
  for (std::size_t visit = 0; visit < plan.visits.size(); ++visit) readVisit(reading, plan, visit);
}

DeformableAttention::DeformableAttention(const LayerWeights& weights, const std::string& name,
                                         const DeformableSizes& sizes)
    : sizes_(sizes),
      value_(weights, name + ".value"),
      offset_(weights, name + ".offset"),
      score_(weights, name + ".score"),
      output_(weights, name + ".output") {}

void DeformableAttention::apply(const Rows& x, const Rows& maps, const MapGrid& grid,
                                const SamplingPlan& plan, DeformableMemory& memory,
                                Rows& change) const {
  memory.values.resize(maps.rows(), sizes_.width);
  memory.offsets.resize(x.rows(), sizes_.offsets());
  memory.weights.resize(x.rows(), sizes_.weights());
  memory.mixed.resize(x.rows(), sizes_.width);
  change.resize(x.rows(), sizes_.width);
  value_.apply(maps.view(), memory.values.view(), maps.rows());
  offset_.apply(x.view(), memory.offsets.view(), x.rows());
  score_.apply(x.view(), memory.weights.view(), x.rows());
  for (std::int64_t row = 0; row < x.rows(); ++row)
    softmaxRuns(memory.weights.row(row), sizes_.blocks * sizes_.heads, sizes_.points);
  readMaps({sizes_, grid, memory.values.view(), memory.offsets.view(), memory.weights.view(),
            memory.mixed.view()},
           plan);
  output_.apply(memory.mixed.view(), change.view(), x.rows());
}

void addDeformable(const std::string& name, const DeformableSizes& sizes, std::int64_t inputs,
                   TensorList& list) {
  list.layer(name + ".value", {sizes.width, sizes.width});
  list.layer(name + ".offset", {sizes.offsets(), inputs});
  list.layer(name + ".score", {sizes.weights(), inputs});
  list.layer(name + ".output", {sizes.width, sizes.width});
}

}  // namespace cdiff::inference
