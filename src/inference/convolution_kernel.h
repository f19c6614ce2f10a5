// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "inference/denoiser_kernels.h"

namespace cdiff::inference {

// Convolution over time for one vector type V, vectorized over output channels. Included once by
// each instruction set's source file; everything has internal linkage, so that no code of one
// instruction set can be linked into another's.

namespace {

/// Where a tile stands.
struct ConvolutionTile {
  const float* weights;
  const float* bias;
  const float* input;
  float* output;
};

/// kRows rows x kVectors vectors of outputs, held in registers.
template <class V, int kRows, int kVectors>
void convolveTile(const ConvolutionCall& call, const ConvolutionTile& tile) {
  V sums[kRows][kVectors];
  const float* inputs[kRows];
  for (int r = 0; r < kRows; ++r) {
    inputs[r] = tile.input + r * call.input.row;
    for (int v = 0; v < kVectors; ++v) {
      sums[r][v] = V::load((call.accumulate ? tile.output + r * call.output.row : tile.bias) +
                           v * V::kWidth);
    }
  }
  const float* weights = tile.weights;
  for (std::int64_t j = 0; j < call.taps; ++j) {
    for (std::int64_t i = 0; i < call.inputs; ++i, weights += kVectors * V::kWidth) {
      V weight[kVectors];
      for (int v = 0; v < kVectors; ++v) weight[v] = V::load(weights + v * V::kWidth);
      for (int r = 0; r < kRows; ++r) {
        const V input = V::broadcast(inputs[r][i]);
        for (int v = 0; v < kVectors; ++v) sums[r][v] = V::fma(weight[v], input, sums[r][v]);
      }
    }
    for (int r = 0; r < kRows; ++r) inputs[r] += call.tap;
  }
  for (int r = 0; r < kRows; ++r) {
    for (int v = 0; v < kVectors; ++v) {
      sums[r][v].store(tile.output + r * call.output.row + v * V::kWidth);
    }
  }
}

/// The last, fewer rows.
template <class V, int kRows, int kVectors>
void convolveRest(const ConvolutionCall& call, const ConvolutionTile& tile, std::int64_t rows) {
  if constexpr (kRows > 0) {
    if (rows == kRows) return convolveTile<V, kRows, kVectors>(call, tile);
    convolveRest<V, kRows - 1, kVectors>(call, tile, rows);
  }
}

/// One block of outputs for all rows.
template <class V, int kVectors>
void convolveBlock(const ConvolutionCall& call, std::int64_t first_output) {
  ConvolutionTile tile;
  tile.weights = call.weights + first_output * call.taps * call.inputs;
  tile.bias = call.bias + first_output;
  tile.input = call.input.data;
  tile.output = call.output.data + first_output;
  std::int64_t row = 0;
  for (; row + V::kTileRows <= call.rows; row += V::kTileRows) {
    convolveTile<V, V::kTileRows, kVectors>(call, tile);
    tile.input += V::kTileRows * call.input.row;
    tile.output += V::kTileRows * call.output.row;
  }
  convolveRest<V, V::kTileRows - 1, kVectors>(call, tile, call.rows - row);
}

template <class V>
void convolve(const ConvolutionCall& call) {
  std::int64_t output = 0;
  for (; output + 2 * V::kWidth <= call.outputs; output += 2 * V::kWidth) {
    convolveBlock<V, 2>(call, output);
  }
  if (output < call.outputs) convolveBlock<V, 1>(call, output);
}

}  // namespace
}  // namespace cdiff::inference
