// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "fma_peak.h"

#include <immintrin.h>

#include <algorithm>

#include "benchmark.h"

namespace cdiff::benchmark {
namespace {

constexpr int kChains = 12;  ///< independent sums, to cover the latency of a multiply-add
constexpr int kSteps = 1000000;

/// Each returns a sum of what it computed, so that nothing can be left out.
__attribute__((target("avx512f"))) float multiplyAdd512() {
  __m512 sums[kChains];
  for (int i = 0; i < kChains; ++i) sums[i] = _mm512_set1_ps(static_cast<float>(i));
  const __m512 factor = _mm512_set1_ps(0.999F);
  const __m512 term = _mm512_set1_ps(0.001F);
  for (int step = 0; step < kSteps; ++step) {
    for (int i = 0; i < kChains; ++i) sums[i] = _mm512_fmadd_ps(sums[i], factor, term);
  }
  for (int i = 1; i < kChains; ++i) sums[0] = _mm512_add_ps(sums[0], sums[i]);
  return _mm512_cvtss_f32(sums[0]);
}

__attribute__((target("avx2,fma"))) float multiplyAdd256() {
  __m256 sums[kChains];
  for (int i = 0; i < kChains; ++i) sums[i] = _mm256_set1_ps(static_cast<float>(i));
  const __m256 factor = _mm256_set1_ps(0.999F);
  const __m256 term = _mm256_set1_ps(0.001F);
  for (int step = 0; step < kSteps; ++step) {
    for (int i = 0; i < kChains; ++i) sums[i] = _mm256_fmadd_ps(sums[i], factor, term);
  }
  for (int i = 1; i < kChains; ++i) sums[0] = _mm256_add_ps(sums[0], sums[i]);
  return _mm256_cvtss_f32(sums[0]);
}

float multiplyAdd128() {
  __m128 sums[kChains];
  for (int i = 0; i < kChains; ++i) sums[i] = _mm_set1_ps(static_cast<float>(i));
  const __m128 factor = _mm_set1_ps(0.999F);
  const __m128 term = _mm_set1_ps(0.001F);
  for (int step = 0; step < kSteps; ++step) {
    for (int i = 0; i < kChains; ++i) sums[i] = _mm_add_ps(_mm_mul_ps(sums[i], factor), term);
  }
  for (int i = 1; i < kChains; ++i) sums[0] = _mm_add_ps(sums[0], sums[i]);
  return _mm_cvtss_f32(sums[0]);
}

}  // namespace

double measureFmaPeak() {
  const bool wide = __builtin_cpu_supports("avx512f") != 0;
  const bool middle = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  float (*const compute)() = wide ? multiplyAdd512 : middle ? multiplyAdd256 : multiplyAdd128;
  const double lanes = wide ? 16.0 : middle ? 8.0 : 4.0;
  double shortest = 1e9;
  volatile float kept = 0.0F;
  for (int round = 0; round < 20; ++round)
    shortest = std::min(shortest, secondsOf([&] { kept = compute(); }));
  return 2.0 * lanes * kChains * kSteps / shortest;
}

}  // namespace cdiff::benchmark
