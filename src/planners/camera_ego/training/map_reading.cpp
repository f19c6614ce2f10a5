// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/map_reading.h"

#include <torch/csrc/autograd/custom_function.h>

#include "learning/parameters.h"

namespace cdiff::planners {
namespace {

using inference::CellCorners;
using inference::DeformableSizes;
using inference::MapReading;
using inference::SamplingPlan;

/// The part of one sample in the rows of a batch.
struct SampleRows {
  const BatchReading& reading;

  inference::View of(const at::Tensor& rows, std::int64_t sample, std::int64_t count) const {
    const std::int64_t columns = rows.size(1);
    return {rows.data_ptr<float>() + sample * count * columns, columns};
  }
  MapReading sample(std::int64_t index, const at::Tensor& values, const at::Tensor& offsets,
                    const at::Tensor& weights, const at::Tensor& output) const {
    const std::int64_t queries = reading.plans.front()->queries;
    return {reading.sizes,
            reading.grid,
            of(values, index, reading.maps * reading.grid.cells()),
            of(offsets, index, queries),
            of(weights, index, queries),
            of(output, index, queries)};
  }
};

float dot(const float* first, const float* second, std::int64_t count) {
  float lanes[4] = {};
  std::int64_t i = 0;
  for (; i + 4 <= count; i += 4) {
    for (int lane = 0; lane < 4; ++lane) lanes[lane] += first[i + lane] * second[i + lane];
  }
  for (; i < count; ++i) lanes[0] += first[i] * second[i];
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

/// Adds to the gradients of values, offsets and weights what comes from one visit. `forward` holds
/// the gradient of the output in place of the output.
void backwardVisit(const MapReading& forward, const MapReading& gradient, const SamplingPlan& plan,
                   std::size_t number) {
  const DeformableSizes& sizes = forward.sizes;
  const inference::MapVisit& visit = plan.visits[number];
  const std::int64_t head_width = sizes.headWidth();
  const std::int64_t first = visit.block * sizes.heads * sizes.points;
  const std::int64_t at = visit.query * forward.weights.row + first;
  const std::int64_t place = visit.query * forward.offsets.row + 2 * first;
  const float* references =
      plan.references.data() + number * static_cast<std::size_t>(2 * plan.points);
  const float share = plan.shares[static_cast<std::size_t>(visit.query)];
  const float* output = forward.output.data + visit.query * forward.output.row;
  for (std::int64_t i = 0; i < sizes.heads * sizes.points; ++i) {
    const std::int64_t head = i / sizes.points, point = i % sizes.points;
    const float* offset = forward.offsets.data + place + 2 * i;
    const CellCorners corners(forward.grid, visit.map, references[2 * point] + offset[0],
                              references[2 * point + 1] + offset[1]);
    const float weight = share * forward.weights.data[at + i];
    float along[4] = {};  // the gradient along each corner's values
    for (int c = 0; c < 4; ++c) {
      if (corners.row[c] < 0) continue;
      const std::int64_t value = corners.row[c] * forward.values.row + head * head_width;
      const float* from = output + head * head_width;
      along[c] = dot(from, forward.values.data + value, head_width);
      float* to = gradient.values.data + value;
      const float scale = weight * corners.share[c];
      for (std::int64_t k = 0; k < head_width; ++k) to[k] += scale * from[k];
      gradient.weights.data[at + i] += share * corners.share[c] * along[c];
    }
    gradient.offsets.data[place + 2 * i] +=
        weight *
        ((1.0F - corners.down) * (along[1] - along[0]) + corners.down * (along[3] - along[2]));
    gradient.offsets.data[place + 2 * i + 1] +=
        weight *
        ((1.0F - corners.across) * (along[2] - along[0]) + corners.across * (along[3] - along[1]));
  }
}

/// Keeps how a batch is read until its gradient is asked for.
struct ReadingHolder : torch::CustomClassHolder {
  explicit ReadingHolder(BatchReading kept) : reading(std::move(kept)) {}
  BatchReading reading;
};

/// readMaps as libtorch differentiates it.
class MapReader : public torch::autograd::Function<MapReader> {
 public:
  static at::Tensor forward(torch::autograd::AutogradContext* context, const at::Tensor& values,
                            const at::Tensor& offsets, const at::Tensor& weights,
                            const c10::intrusive_ptr<ReadingHolder>& holder) {
    const BatchReading& reading = holder->reading;
    const auto samples = static_cast<std::int64_t>(reading.plans.size());
    at::Tensor output = at::empty({offsets.size(0), reading.sizes.width}, values.options());
    for (std::int64_t i = 0; i < samples; ++i)
      inference::readMaps(SampleRows{reading}.sample(i, values, offsets, weights, output),
                          *reading.plans[static_cast<std::size_t>(i)]);
    context->save_for_backward({values, offsets, weights});
    context->saved_data["reading"] =
        c10::IValue::make_capsule(c10::intrusive_ptr<torch::CustomClassHolder>(holder));
    return output;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list outputs) {
    const auto capsule = context->saved_data["reading"].toCapsule();
    const BatchReading& reading = static_cast<ReadingHolder&>(*capsule).reading;
    const torch::autograd::variable_list saved = context->get_saved_variables();
    const at::Tensor output = outputs[0].contiguous();
    const at::Tensor values = at::zeros_like(saved[0]), offsets = at::zeros_like(saved[1]),
                     weights = at::zeros_like(saved[2]);
    for (std::size_t i = 0; i < reading.plans.size(); ++i) {
      const auto index = static_cast<std::int64_t>(i);
      const SampleRows rows{reading};
      const MapReading forward = rows.sample(index, saved[0], saved[1], saved[2], output);
      const MapReading gradient = rows.sample(index, values, offsets, weights, output);
      for (std::size_t visit = 0; visit < reading.plans[i]->visits.size(); ++visit)
        backwardVisit(forward, gradient, *reading.plans[i], visit);
    }
    return {values, offsets, weights, at::Tensor()};
  }
};

/// The visits of one map as rows of tensors.
struct MapVisits {
  at::Tensor queries;     ///< int64 [V]
  at::Tensor blocks;      ///< int64 [V]
  at::Tensor references;  ///< [V, 1, points, 2]
  at::Tensor shares;      ///< [V, 1]
};

MapVisits visitsOf(const SamplingPlan& plan, std::int64_t map, const at::Device& device) {
  std::vector<std::int64_t> queries, blocks;
  std::vector<float> references, shares;
  const auto size = static_cast<std::ptrdiff_t>(2 * plan.points);
  for (std::size_t i = 0; i < plan.visits.size(); ++i) {
    const inference::MapVisit& visit = plan.visits[i];
    if (visit.map != map) continue;
    queries.push_back(visit.query);
    blocks.push_back(visit.block);
    const auto begin = plan.references.begin() + static_cast<std::ptrdiff_t>(i) * size;
    references.insert(references.end(), begin, begin + size);
    shares.push_back(plan.shares[static_cast<std::size_t>(visit.query)]);
  }
  const auto count = static_cast<std::int64_t>(queries.size());
  return {learning::toIndices(queries, {count}, device),
          learning::toIndices(blocks, {count}, device),
          learning::toTensor(references, {count, 1, plan.points, 2}, device),
          learning::toTensor(shares, {count, 1}, device)};
}

}  // namespace

at::Tensor readMapsOf(const BatchReading& reading, const at::Tensor& values,
                      const at::Tensor& offsets, const at::Tensor& weights) {
  if (!values.device().is_cpu()) return readMapsByGridSample(reading, values, offsets, weights);
  return MapReader::apply(values.contiguous(), offsets.contiguous(), weights.contiguous(),
                          c10::make_intrusive<ReadingHolder>(reading));
}

at::Tensor readMapsByGridSample(const BatchReading& reading, const at::Tensor& values,
                                const at::Tensor& offsets, const at::Tensor& weights) {
  const DeformableSizes& s = reading.sizes;
  const inference::MapGrid& grid = reading.grid;
  const auto samples = static_cast<std::int64_t>(reading.plans.size());
  const std::int64_t queries = reading.plans.front()->queries;
  const at::Tensor maps =
      values.reshape({samples, reading.maps, grid.height, grid.width, s.heads, s.headWidth()})
          .permute({0, 1, 4, 5, 2, 3});
  const at::Tensor moves = offsets.reshape({samples, queries, s.blocks, s.heads, s.points, 2});
  const at::Tensor shares = weights.reshape({samples, queries, s.blocks, s.heads, s.points});
  std::vector<at::Tensor> results;
  for (std::int64_t b = 0; b < samples; ++b) {
    at::Tensor output = at::zeros({queries, s.width}, values.options());
    for (std::int64_t m = 0; m < reading.maps; ++m) {
      const MapVisits v = visitsOf(*reading.plans[static_cast<std::size_t>(b)], m, values.device());
      if (v.queries.numel() == 0) continue;
      const at::Tensor places =
          (v.references + moves[b].index({v.queries, v.blocks})).transpose(0, 1);
      const at::Tensor size = learning::toTensor(
          {static_cast<float>(grid.width), static_cast<float>(grid.height)}, {2}, values.device());
      const at::Tensor read =  // [heads, head width, V, points]
          at::grid_sampler_2d(maps[b][m].contiguous(), (2.0 * places + 1.0) / size - 1.0, 0, 0,
                              false);
      const at::Tensor weight = shares[b].index({v.queries, v.blocks}).transpose(0, 1).unsqueeze(1);
      const at::Tensor mixed = (read * weight).sum(3).permute({2, 0, 1}).reshape({-1, s.width});
      output = output.index_add(0, v.queries, v.shares * mixed);
    }
    results.push_back(output);
  }
  return at::cat(results, 0);
}

}  // namespace cdiff::planners
