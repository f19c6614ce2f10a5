// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <algorithm>
#include <cstring>

#include "inference/encoder_kernels.h"

namespace cdiff::inference {

// Group normalization and narrowing of feature maps for one vector type V (linkage as in
// kernel_templates.h).

namespace {

inline constexpr std::int64_t kSummedInFloat = 64;  ///< pixels

template <class V, bool kSquared>
void sumLanes(const ChannelRun& run, std::int64_t lane, float mean, double* lanes) {
  const V middle = V::broadcast(mean);
  for (std::int64_t begin = 0; begin < run.pixels; begin += kSummedInFloat) {
    const std::int64_t end = std::min(begin + kSummedInFloat, run.pixels);
    const float* row = run.data + begin * run.pixel_stride + lane;
    V sum = V::broadcast(0.0F);
    for (std::int64_t pixel = begin; pixel < end; ++pixel, row += run.pixel_stride) {
      const V deviation = V::load(row) - middle;
      sum = sum + (kSquared ? deviation * deviation : deviation);
    }
    float parts[V::kWidth];
    sum.store(parts);
    for (int i = 0; i < V::kWidth; ++i) lanes[lane + i] += static_cast<double>(parts[i]);
  }
}

template <class V>
void sumRun(const ChannelRun& run, float mean, bool squared, double* lanes) {
  std::fill(lanes, lanes + run.width, 0.0);
  for (std::int64_t lane = 0; lane < run.width; lane += V::kWidth) {
    if (squared) {
      sumLanes<V, true>(run, lane, mean, lanes);
    } else {
      sumLanes<V, false>(run, lane, mean, lanes);
    }
  }
}

template <class V, bool kResidual>
V applyLanes(const ChannelRun& run, const NormLine& line, std::int64_t lane, V largest) {
  const V scale = V::load(line.scale + lane);
  const V offset = V::load(line.offset + lane);
  const V floor = V::broadcast(line.floor);
  for (std::int64_t pixel = 0; pixel < run.pixels; ++pixel) {
    float* row = run.data + pixel * run.pixel_stride + lane;
    V value = V::load(row) * scale + offset;
    if constexpr (kResidual)
      value = value + V::load(line.residual + pixel * run.pixel_stride + lane);
    value = V::max(value, floor);
    value.store(row);
    largest = V::max(largest, value);
  }
  return largest;
}

template <class V>
float applyRun(const ChannelRun& run, const NormLine& line) {
  V largest = V::broadcast(line.floor);
  for (std::int64_t lane = 0; lane < run.width; lane += V::kWidth) {
    largest = line.residual == nullptr ? applyLanes<V, false>(run, line, lane, largest)
                                       : applyLanes<V, true>(run, line, lane, largest);
  }
  float parts[V::kWidth];
  largest.store(parts);
  return *std::max_element(parts, parts + V::kWidth);
}

template <class V>
void narrowToBytes(const float* values, std::int64_t count, float factor, std::uint8_t* bytes) {
  const V scale = V::broadcast(factor);
  const V zero = V::broadcast(0.0F);
  const V most = V::broadcast(255.0F);
  const V magic = V::broadcast(8388608.0F);  // 2^23: adding it rounds to an integer
  for (std::int64_t i = 0; i < count; i += V::kWidth) {
    const V value = V::min(V::max(V::load(values + i) * scale, zero), most) + magic;
    value.storeLowBytes(bytes + i);
  }
}

/// Bits of a finite float rounded to their upper half.
inline std::uint16_t upperHalf(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return static_cast<std::uint16_t>((bits + 0x7FFFU + ((bits >> 16) & 1U)) >> 16);
}

template <class V>
void narrowToBfloat16(const float* values, std::int64_t count, std::uint16_t* halves) {
  for (std::int64_t i = 0; i < count; i += V::kWidth)
    V::load(values + i).storeUpperHalves(halves + i);
}

template <class V>
constexpr EncoderKernels encoderKernelsOf() {
  return {sumRun<V>, applyRun<V>, narrowToBytes<V>, narrowToBfloat16<V>};
}

}  // namespace

}  // namespace cdiff::inference
