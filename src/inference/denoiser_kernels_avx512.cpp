// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The kernels with AVX-512F; this file alone is compiled for it.
#include "inference/encoder_kernels.h"
#include "inference/transformer_kernels.h"

#ifdef __AVX512F__

#if defined(__GNUC__) && !defined(__clang__)
// GCC 12 takes the undefined operands of its own intrinsics for a mistake (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <immintrin.h>

#include "inference/encoder_templates.h"
#include "inference/transformer_templates.h"

namespace cdiff::inference {
namespace {

struct Vector {
  static constexpr int kWidth = 16;
  static constexpr int kTileRows = 8;
  __m512 lanes;

  static Vector load(const float* from) { return {_mm512_loadu_ps(from)}; }
  static Vector broadcast(float value) { return {_mm512_set1_ps(value)}; }
  static Vector fma(Vector a, Vector b, Vector c) {
    return {_mm512_fmadd_ps(a.lanes, b.lanes, c.lanes)};
  }
  static Vector min(Vector a, Vector b) { return {_mm512_min_ps(a.lanes, b.lanes)}; }
  static Vector max(Vector a, Vector b) { return {_mm512_max_ps(a.lanes, b.lanes)}; }
  static Vector squareRoot(Vector a) { return {_mm512_sqrt_ps(a.lanes)}; }
  /// 2^k of the integer k in the low bits of `shifted` (see exponential).
  static Vector powerOfTwo(Vector shifted) {
    const __m512i bits =
        _mm512_add_epi32(_mm512_castps_si512(shifted.lanes), _mm512_set1_epi32(127));
    return {_mm512_castsi512_ps(_mm512_slli_epi32(bits, 23))};
  }
  void store(float* to) const { _mm512_storeu_ps(to, lanes); }
  /// The lowest byte of each lane's bits.
  void storeLowBytes(std::uint8_t* to) const {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to),
                     _mm512_cvtepi32_epi8(_mm512_castps_si512(lanes)));
  }
  /// See upperHalf().
  void storeUpperHalves(std::uint16_t* to) const {
    const __m512i bits = _mm512_castps_si512(lanes);
    const __m512i odd = _mm512_and_si512(_mm512_srli_epi32(bits, 16), _mm512_set1_epi32(1));
    const __m512i rounded =
        _mm512_add_epi32(bits, _mm512_add_epi32(odd, _mm512_set1_epi32(0x7FFF)));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm512_cvtepi32_epi16(_mm512_srli_epi32(rounded, 16)));
  }
  friend Vector operator+(Vector a, Vector b) { return {_mm512_add_ps(a.lanes, b.lanes)}; }
  friend Vector operator-(Vector a, Vector b) { return {_mm512_sub_ps(a.lanes, b.lanes)}; }
  friend Vector operator*(Vector a, Vector b) { return {_mm512_mul_ps(a.lanes, b.lanes)}; }
  friend Vector operator/(Vector a, Vector b) { return {_mm512_div_ps(a.lanes, b.lanes)}; }
};

constexpr DenoiserKernels kKernels = kernelsOf<Vector>();
constexpr TransformerKernels kTransformerKernels = transformerKernelsOf<Vector>();
constexpr EncoderKernels kEncoderKernels = encoderKernelsOf<Vector>();

}  // namespace

const DenoiserKernels* avx512Kernels() { return &kKernels; }
const TransformerKernels* avx512TransformerKernels() { return &kTransformerKernels; }
const EncoderKernels* avx512EncoderKernels() { return &kEncoderKernels; }

}  // namespace cdiff::inference

#else

namespace cdiff::inference {
const DenoiserKernels* avx512Kernels() { return nullptr; }
const TransformerKernels* avx512TransformerKernels() { return nullptr; }
const EncoderKernels* avx512EncoderKernels() { return nullptr; }
}  // namespace cdiff::inference

#endif
