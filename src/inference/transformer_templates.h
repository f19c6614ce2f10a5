// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cmath>
#include <limits>

#include "inference/kernel_templates.h"
#include "inference/transformer_kernels.h"

namespace cdiff::inference {

// Layer normalization, attention and GELU for one vector type V (linkage as in kernel_templates.h).

namespace {

/// The sum of a vector's lanes, first to last.
template <class V>
float sumLanes(V vector) {
  float lanes[V::kWidth];
  vector.store(lanes);
  float sum = 0.0f;
  for (const float lane : lanes) sum += lane;
  return sum;
}

template <class V>
void normalizeRow(const LayerNormCall& call, std::int64_t row) {
  const float* input = call.input.data + row * call.input.row;
  const float* added = call.added.data + row * call.added.row;
  float* output = call.output.data + row * call.output.row;
  const auto count = static_cast<float>(call.channels);
  V total = V::broadcast(0.0f);
  for (std::int64_t c = 0; c < call.channels; c += V::kWidth) {
    const V sum = V::load(input + c) + V::load(added + c);
    sum.store(output + c);
    total = total + sum;
  }
  const V mean = V::broadcast(sumLanes(total) / count);
  V squares = V::broadcast(0.0f);
  for (std::int64_t c = 0; c < call.channels; c += V::kWidth) {
    const V distance = V::load(output + c) - mean;
    squares = V::fma(distance, distance, squares);
  }
  const float variance = sumLanes(squares) / count;
  const V inverse = V::broadcast(1.0f / __builtin_sqrtf(variance + kNormalizationEpsilon));
  for (std::int64_t c = 0; c < call.channels; c += V::kWidth) {
    const V normalized = (V::load(output + c) - mean) * inverse;
    V::fma(normalized, V::load(call.gain + c), V::load(call.shift + c)).store(output + c);
  }
}

template <class V>
void normalizeRows(const LayerNormCall& call) {
  for (std::int64_t row = 0; row < call.rows; ++row) normalizeRow<V>(call, row);
}

/// erf by Abramowitz and Stegun 7.1.26, absolute error below 2e-7, for x >= 0.
template <class V>
V errorFunction(V x) {
  const V one = V::broadcast(1.0f);
  const V t = one / V::fma(V::broadcast(0.3275911f), x, one);
  V sum = V::broadcast(1.061405429f);
  sum = V::fma(sum, t, V::broadcast(-1.453152027f));
  sum = V::fma(sum, t, V::broadcast(1.421413741f));
  sum = V::fma(sum, t, V::broadcast(-0.284496736f));
  sum = V::fma(sum, t, V::broadcast(0.254829592f));
  const V square = V::max(V::broadcast(0.0f) - x * x, V::broadcast(-87.0f));
  return one - sum * t * exponential(square);
}

template <class V>
void gelu(float* values, std::int64_t count) {
  const V zero = V::broadcast(0.0f);
  const V half = V::broadcast(0.5f);
  for (std::int64_t i = 0; i < count; i += V::kWidth) {
    const V x = V::load(values + i);
    const V positive = V::max(x, zero - x);  // |x|
    const V error = errorFunction(positive * V::broadcast(0.70710678f));
    // x / 2 + |x| erf(|x| / sqrt 2) / 2, since erf is odd
    (half * V::fma(positive, error, x)).store(values + i);
  }
}

/// The keys of a head with tokens along the rows: [head_width, padded keys].
inline void transposeKeys(const AttentionCall& call, const float* key, std::int64_t padded) {
  for (std::int64_t d = 0; d < call.head_width; ++d) {
    float* to = call.scratch + d * padded;
    for (std::int64_t j = 0; j < call.keys; ++j) to[j] = key[j * call.key.row + d];
    for (std::int64_t j = call.keys; j < padded; ++j) to[j] = 0.0f;
  }
}

/// weights = softmax of the first `keys` scores, 0 after them; the sum runs first to last.
template <class V>
void softmaxRow(float* scores, std::int64_t keys, std::int64_t padded) {
  float largest = scores[0];
  for (std::int64_t j = 1; j < keys; ++j) largest = scores[j] > largest ? scores[j] : largest;
  const V offset = V::broadcast(largest);
  for (std::int64_t j = 0; j < padded; j += V::kWidth) {
    const V below = V::min(V::load(scores + j) - offset, V::broadcast(0.0f));
    exponential(V::max(below, V::broadcast(-87.0f))).store(scores + j);
  }
  for (std::int64_t j = keys; j < padded; ++j) scores[j] = 0.0f;
  float sum = 0.0f;
  for (std::int64_t j = 0; j < keys; ++j) sum += scores[j];
  const V inverse = V::broadcast(1.0f / sum);
  for (std::int64_t j = 0; j < padded; j += V::kWidth)
    (V::load(scores + j) * inverse).store(scores + j);
}

template <class V>
void attendHead(const AttentionCall& call, std::int64_t head, std::int64_t padded) {
  const std::int64_t first = head * call.head_width;
  const float scale = 1.0f / __builtin_sqrtf(static_cast<float>(call.head_width));
  transposeKeys(call, call.key.data + first, padded);
  for (std::int64_t i = 0; i < call.queries; ++i) {
    const float* query = call.query.data + i * call.query.row + first;
    float* weights = call.weights + (head * call.queries + i) * padded;
    for (std::int64_t j = 0; j < padded; j += V::kWidth) {
      V sum = V::broadcast(0.0f);
      for (std::int64_t d = 0; d < call.head_width; ++d)
        sum = V::fma(V::broadcast(query[d]), V::load(call.scratch + d * padded + j), sum);
      (sum * V::broadcast(scale)).store(weights + j);
    }
    softmaxRow<V>(weights, call.keys, padded);
    float* output = call.output.data + i * call.output.row + first;
    for (std::int64_t d = 0; d < call.head_width; d += V::kWidth) {
      V sum = V::broadcast(0.0f);
      for (std::int64_t j = 0; j < call.keys; ++j) {
        const float* value = call.value.data + j * call.value.row + first + d;
        sum = V::fma(V::broadcast(weights[j]), V::load(value), sum);
      }
      sum.store(output + d);
    }
  }
}

template <class V>
void attend(const AttentionCall& call) {
  const std::int64_t padded = paddedKeys(call.keys);
  for (std::int64_t head = 0; head < call.heads; ++head) attendHead<V>(call, head, padded);
}

template <class V>
constexpr TransformerKernels transformerKernelsOf() {
  return {normalizeRows<V>, attend<V>, gelu<V>};
}

}  // namespace

}  // namespace cdiff::inference
