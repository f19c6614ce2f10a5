// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/bev_transfer.h"

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {
namespace {

void requireSameButGrid(const CameraEgoSizes& sizes, const TrainedBevEncoder& trained) {
  CameraEgoSizes known = trained.sizes, wanted = sizes;
  known.bev = wanted.bev;
  known.past_bev = wanted.past_bev;
  const std::string found = core::dumpOptions(known), expected = core::dumpOptions(wanted);
  if (found == expected) return;
  throw core::InputError(trained.source + ": the sizes of its BEV encoder are\n" + found +
                         "\nbut all except the grid were expected to be\n" + expected);
}

/// Rows of the cells of a grid, by the rows of those of another.
inference::Tensor rowsOnGrid(const inference::Tensor& rows, const BevGrid& from,
                             const BevGrid& to) {
  const std::int64_t width = rows.shape[1];
  inference::Tensor result{{to.cells(), width}, {}};
  result.values.assign(static_cast<std::size_t>(to.cells() * width), 0.0F);
  for (std::int64_t cell = 0; cell < to.cells(); ++cell) {
    const Eigen::Vector2d place = from.toCell(to.center(cell));
    const double column = std::clamp(place.x(), 0.0, static_cast<double>(from.columns - 1));
    const double row = std::clamp(place.y(), 0.0, static_cast<double>(from.rows - 1));
    const inference::CellCorners corners(from.grid(), 0, static_cast<float>(column),
                                         static_cast<float>(row));
    for (int i = 0; i < 4; ++i) {
      if (corners.row[i] < 0) continue;
      for (std::int64_t channel = 0; channel < width; ++channel)
        result.values[static_cast<std::size_t>(cell * width + channel)] +=
            corners.share[i] *
            rows.values[static_cast<std::size_t>(corners.row[i] * width + channel)];
    }
  }
  return result;
}

inference::Tensor scaled(inference::Tensor tensor, double factor) {
  for (float& value : tensor.values) value *= static_cast<float>(factor);
  return tensor;
}

inference::Tensor onGrid(const std::string& name, const inference::Tensor& tensor,
                         const BevGrid& from, const BevGrid& to) {
  if (name == "table.bev.query" || name == "table.bev.position")
    return rowsOnGrid(tensor, from, to);
  const bool between_bevs = name.find(".temporal.offset.") != std::string::npos;
  return between_bevs ? scaled(tensor, from.cell / to.cell) : tensor;
}

}  // namespace

WeightTensors bevEncoderFor(const CameraEgoSizes& sizes, const TrainedBevEncoder& trained) {
  requireSameButGrid(sizes, trained);
  inference::TensorList list;
  addBevEncoder(sizes, list);
  WeightTensors tensors;
  for (const inference::TensorShape& tensor : list.take()) {
    const auto found = trained.weights.find(tensor.name);
    if (found == trained.weights.end())
      throw core::InputError(trained.source + ": there is no tensor '" + tensor.name + "'");
    tensors[tensor.name] = onGrid(tensor.name, found->second, trained.sizes.bev, sizes.bev);
  }
  return tensors;
}

}  // namespace cdiff::planners
