// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "inference/denoiser_kernels.h"

namespace cdiff::inference {

// Convolution over time for one vector type V, vectorized over output channels. Included once by
// each instruction set's source file; everything has internal linkage, so that no code of one
// instruction set can be linked into another's.

namespace {

/// Where a tile of outputs, and the weights and inputs that it needs, lie in memory.
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

// Mish(x) = x tanh(ln(1 + e^x)) and its derivative for one vector type V (linkage as
// above). With e = e^x and n = e (e + 2), tanh(ln(1 + e)) = n / (n + 2).

namespace {

/// e^x for x in [-87, 20], relative error below 2e-7: 2^k times a polynomial of x - k ln 2.
template <class V>
V exponential(V x) {
  const V magic = V::broadcast(12582912.0f);  // 1.5 x 2^23: adding it rounds to an integer
  const V shifted = V::fma(x, V::broadcast(1.44269504f), magic);
  const V k = shifted - magic;
  // ln 2 in two parts; the first has few bits, so that its product with k is exact.
  V rest = V::fma(k, V::broadcast(-0.693359375f), x);
  rest = V::fma(k, V::broadcast(2.12194440e-4f), rest);
  V sum = V::broadcast(1.0f / 720.0f);
  sum = V::fma(sum, rest, V::broadcast(1.0f / 120.0f));
  sum = V::fma(sum, rest, V::broadcast(1.0f / 24.0f));
  sum = V::fma(sum, rest, V::broadcast(1.0f / 6.0f));
  sum = V::fma(sum, rest, V::broadcast(0.5f));
  sum = V::fma(sum, rest, V::broadcast(1.0f));
  sum = V::fma(sum, rest, V::broadcast(1.0f));
  return sum * V::powerOfTwo(shifted);
}

/// Mish of a vector of values, and its derivative there.
template <class V>
struct MishValue {
  V value;
  V slope;
};

/// Mish'(x) = n / (n + 2) + 4 x e (1 + e) / (n + 2)^2. Beyond 20 the first term is 1 and the second
/// 0 in float32; below -87 both are.
template <class V>
MishValue<V> mishOf(V x) {
  const V bounded = V::min(V::max(x, V::broadcast(-87.0f)), V::broadcast(20.0f));
  const V e = exponential(bounded);
  const V n = V::fma(e, e, e + e);
  const V inverse = V::broadcast(1.0f) / (n + V::broadcast(2.0f));
  const V tangent = n * inverse;
  const V bell = V::fma(e, e, e) * V::broadcast(4.0f) * inverse * inverse;
  return {x * tangent, V::fma(bounded, bell, tangent)};
}

template <class V>
void mish(const float* input, std::int64_t count, float* output, float* slope) {
  for (std::int64_t i = 0; i < count; i += V::kWidth) {
    const MishValue<V> result = mishOf(V::load(input + i));
    result.value.store(output + i);
    result.slope.store(slope + i);
  }
}

}  // namespace

// Group normalization with Mish, and its backward pass, for one vector type V (linkage as
// above).

namespace {

inline constexpr float kNormalizationEpsilon = 1e-5f;

/// The mean of each group of `sums` over its rows, at every channel of the group.
inline void spreadGroupMeans(const NormalizationShape& shape, const float* sums, float* means) {
  const float count = static_cast<float>(shape.group_channels * shape.rows);
  for (std::int64_t group = 0; group < shape.groups; ++group) {
    const std::int64_t first = group * shape.group_channels;
    float sum = 0.0f;
    for (std::int64_t c = 0; c < shape.group_channels; ++c) sum += sums[first + c];
    for (std::int64_t c = 0; c < shape.group_channels; ++c) means[first + c] = sum / count;
  }
  for (std::int64_t c = shape.groups * shape.group_channels; c < shape.channels; ++c) {
    means[c] = 0.0f;
  }
}

/// sums[c] = sum over rows of term(row, c): even and odd rows apart, to hide latency.
template <class V, class Term>
void sumRows(const NormalizationShape& shape, float* sums, const Term& term) {
  for (std::int64_t c = 0; c < shape.channels; c += V::kWidth) {
    V even = V::broadcast(0.0f);
    V odd = even;
    std::int64_t row = 0;
    for (; row + 2 <= shape.rows; row += 2) {
      even = even + term(row, c);
      odd = odd + term(row + 1, c);
    }
    if (row < shape.rows) even = even + term(row, c);
    (even + odd).store(sums + c);
  }
}

/// Mean and inverse deviation at every channel.
template <class V>
void groupMoments(const NormalizationShape& shape, const float* x, std::int64_t stride,
                  float* means, float* inverse_deviation) {
  float* sums = shape.scratch;
  sumRows<V>(shape, sums,
             [&](std::int64_t row, std::int64_t c) { return V::load(x + row * stride + c); });
  spreadGroupMeans(shape, sums, means);
  sumRows<V>(shape, sums, [&](std::int64_t row, std::int64_t c) {
    const V distance = V::load(x + row * stride + c) - V::load(means + c);
    return distance * distance;
  });
  spreadGroupMeans(shape, sums, inverse_deviation);
  const V epsilon = V::broadcast(kNormalizationEpsilon);
  for (std::int64_t c = 0; c < shape.channels; c += V::kWidth) {
    const V variance = V::load(inverse_deviation + c);
    (V::broadcast(1.0f) / V::squareRoot(variance + epsilon)).store(inverse_deviation + c);
  }
}

template <class V>
void normalize(const NormalizationCall& call) {
  const NormalizationShape& shape = call.shape;
  float* x = call.normalized.data;
  float* slope = call.slope.data;
  const float* added = call.added.data;
  float* output = call.output.data;
  float* means = shape.scratch + shape.channels;
  float* inverse_deviation = call.inverse_deviation;
  groupMoments<V>(shape, x, call.normalized.row, means, inverse_deviation);
  for (std::int64_t c = 0; c < shape.channels; c += V::kWidth) {
    const V mean = V::load(means + c);
    const V inverse = V::load(inverse_deviation + c);
    const V scale = V::load(call.scale + c);
    const V shift = V::load(call.shift + c);
    for (std::int64_t row = 0; row < shape.rows; ++row) {
      const V normalized = (V::load(x + row * call.normalized.row + c) - mean) * inverse;
      const MishValue<V> mish = mishOf(V::fma(normalized, scale, shift));
      normalized.store(x + row * call.normalized.row + c);
      (mish.slope * scale).store(slope + row * call.slope.row + c);
      (mish.value + V::load(added + row * call.added.row + c))
          .store(output + row * call.output.row + c);
    }
  }
}

/// With h = output_gradient x slope: input_gradient = (h - mean(h) - n mean(h n)) / deviation.
template <class V>
void backwardNormalize(const NormalizationGradientCall& call) {
  const NormalizationShape& shape = call.shape;
  const float* n = call.normalized.data;
  const float* slope = call.slope.data;
  const float* from = call.output_gradient.data;
  float* to = call.input_gradient.data;
  const auto normalized = [&](std::int64_t row, std::int64_t c) {
    return V::load(n + row * call.normalized.row + c);
  };
  const auto pulled = [&](std::int64_t row, std::int64_t c) {
    return V::load(from + row * call.output_gradient.row + c) *
           V::load(slope + row * call.slope.row + c);
  };
  float* means = shape.scratch + shape.channels;
  float* products = means + shape.channels;
  sumRows<V>(shape, shape.scratch, pulled);
  spreadGroupMeans(shape, shape.scratch, means);
  sumRows<V>(shape, shape.scratch,
             [&](std::int64_t row, std::int64_t c) { return pulled(row, c) * normalized(row, c); });
  spreadGroupMeans(shape, shape.scratch, products);
  for (std::int64_t c = 0; c < shape.channels; c += V::kWidth) {
    const V mean = V::load(means + c);
    const V product = V::load(products + c);
    const V inverse = V::load(call.inverse_deviation + c);
    for (std::int64_t row = 0; row < shape.rows; ++row) {
      const V centered = pulled(row, c) - mean - normalized(row, c) * product;
      (centered * inverse).store(to + row * call.input_gradient.row + c);
    }
  }
}

template <class V>
constexpr DenoiserKernels kernelsOf() {
  return {2 * V::kWidth, convolve<V>, normalize<V>, backwardNormalize<V>, mish<V>};
}

}  // namespace

}  // namespace cdiff::inference
