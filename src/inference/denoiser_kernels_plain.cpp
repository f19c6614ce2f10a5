// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The kernels for any CPU, on the compiler's generic vector types. Without a fused multiply-add, a
/// product is rounded before the sum.
#include "inference/encoder_templates.h"
#include "inference/transformer_templates.h"

namespace cdiff::inference {
namespace {

typedef float Lanes __attribute__((vector_size(16), aligned(4), may_alias));
typedef std::uint32_t Bits __attribute__((vector_size(16)));

struct Vector {
  static constexpr int kWidth = 4;
  static constexpr int kTileRows = 4;
  Lanes lanes;

  static Vector load(const float* from) { return {*reinterpret_cast<const Lanes*>(from)}; }
  static Vector broadcast(float value) { return {Lanes{value, value, value, value}}; }
  static Vector fma(Vector a, Vector b, Vector c) { return {a.lanes * b.lanes + c.lanes}; }
  static Vector min(Vector a, Vector b) { return {a.lanes < b.lanes ? a.lanes : b.lanes}; }
  static Vector max(Vector a, Vector b) { return {a.lanes > b.lanes ? a.lanes : b.lanes}; }
  static Vector squareRoot(Vector a) {
    for (int i = 0; i < kWidth; ++i) a.lanes[i] = __builtin_sqrtf(a.lanes[i]);
    return a;
  }
  /// 2^k of the integer k in the low bits of `shifted` (see exponential).
  static Vector powerOfTwo(Vector shifted) {
    const Bits bits = (reinterpret_cast<Bits>(shifted.lanes) + 127u) << 23;
    return {reinterpret_cast<Lanes>(bits)};
  }
  void store(float* to) const { *reinterpret_cast<Lanes*>(to) = lanes; }
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
  friend Vector operator+(Vector a, Vector b) { return {a.lanes + b.lanes}; }
  friend Vector operator-(Vector a, Vector b) { return {a.lanes - b.lanes}; }
  friend Vector operator*(Vector a, Vector b) { return {a.lanes * b.lanes}; }
  friend Vector operator/(Vector a, Vector b) { return {a.lanes / b.lanes}; }
};

constexpr DenoiserKernels kKernels = kernelsOf<Vector>();
constexpr TransformerKernels kTransformerKernels = transformerKernelsOf<Vector>();
constexpr EncoderKernels kEncoderKernels = encoderKernelsOf<Vector>();

}  // namespace

const DenoiserKernels* plainKernels() { return &kKernels; }
const TransformerKernels* plainTransformerKernels() { return &kTransformerKernels; }
const EncoderKernels* plainEncoderKernels() { return &kEncoderKernels; }

}  // namespace cdiff::inference
