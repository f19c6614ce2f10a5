// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The kernels with AVX2 and FMA; this file alone is compiled for it.
#include "inference/encoder_kernels.h"
#include "inference/transformer_kernels.h"

#if defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>

#include "inference/encoder_templates.h"
#include "inference/transformer_templates.h"

namespace cdiff::inference {
namespace {

struct Vector {
  static constexpr int kWidth = 8;
  static constexpr int kTileRows = 4;
  __m256 lanes;

  static Vector load(const float* from) { return {_mm256_loadu_ps(from)}; }
  static Vector broadcast(float value) { return {_mm256_set1_ps(value)}; }
  static Vector fma(Vector a, Vector b, Vector c) {
    return {_mm256_fmadd_ps(a.lanes, b.lanes, c.lanes)};
  }
  static Vector min(Vector a, Vector b) { return {_mm256_min_ps(a.lanes, b.lanes)}; }
  static Vector max(Vector a, Vector b) { return {_mm256_max_ps(a.lanes, b.lanes)}; }
  static Vector squareRoot(Vector a) { return {_mm256_sqrt_ps(a.lanes)}; }
  /// 2^k of the integer k in the low bits of `shifted` (see exponential).
  static Vector powerOfTwo(Vector shifted) {
    const __m256i bits =
        _mm256_add_epi32(_mm256_castps_si256(shifted.lanes), _mm256_set1_epi32(127));
    return {_mm256_castsi256_ps(_mm256_slli_epi32(bits, 23))};
  }
  void store(float* to) const { _mm256_storeu_ps(to, lanes); }
  /// The lowest byte of each lane's bits.
  void storeLowBytes(std::uint8_t* to) const {
    float parts[kWidth];
    store(parts);
    for (int i = 0; i < kWidth; ++i) std::memcpy(to + i, parts + i, 1);
  }
  void storeUpperHalves(std::uint16_t* to) const {
    float parts[kWidth];
    store(parts);
    for (int i = 0; i < kWidth; ++i) to[i] = upperHalf(parts[i]);
  }
  friend Vector operator+(Vector a, Vector b) { return {_mm256_add_ps(a.lanes, b.lanes)}; }
  friend Vector operator-(Vector a, Vector b) { return {_mm256_sub_ps(a.lanes, b.lanes)}; }
  friend Vector operator*(Vector a, Vector b) { return {_mm256_mul_ps(a.lanes, b.lanes)}; }
  friend Vector operator/(Vector a, Vector b) { return {_mm256_div_ps(a.lanes, b.lanes)}; }
};

constexpr DenoiserKernels kKernels = kernelsOf<Vector>();
constexpr TransformerKernels kTransformerKernels = transformerKernelsOf<Vector>();
constexpr EncoderKernels kEncoderKernels = encoderKernelsOf<Vector>();

}  // namespace

const DenoiserKernels* avx2Kernels() { return &kKernels; }
const TransformerKernels* avx2TransformerKernels() { return &kTransformerKernels; }
const EncoderKernels* avx2EncoderKernels() { return &kEncoderKernels; }

}  // namespace cdiff::inference

#else

namespace cdiff::inference {
const DenoiserKernels* avx2Kernels() { return nullptr; }
const TransformerKernels* avx2TransformerKernels() { return nullptr; }
const EncoderKernels* avx2EncoderKernels() { return nullptr; }
}  // namespace cdiff::inference

#endif
