// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Mish(x) = x tanh(ln(1 + e^x)) and its derivative for one vector type V; see
/// convolution_kernel.h about linkage. With e = e^x and n = e (e + 2), tanh(ln(1 + e)) = n / (n +
/// 2).
#pragma once

#include "inference/denoiser_kernels.h"

namespace cdiff::inference {
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
}  // namespace cdiff::inference
