// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Group normalisation with Mish, and its pull-back, for one vector type V; see
/// convolution_kernel.h about linkage.
#pragma once

#include "inference/mish_kernel.h"

namespace cdiff::inference {
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
void pullBackNormalize(const NormalizationGradientCall& call) {
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
      const V centred = pulled(row, c) - mean - normalized(row, c) * product;
      (centred * inverse).store(to + row * call.input_gradient.row + c);
    }
  }
}

template <class V>
constexpr DenoiserKernels kernelsOf() {
  return {2 * V::kWidth, convolve<V>, normalize<V>, pullBackNormalize<V>, mish<V>};
}

}  // namespace
}  // namespace cdiff::inference
