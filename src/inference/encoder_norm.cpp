// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/encoder_norm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cdiff::inference {
namespace {

constexpr double kEpsilon = 1e-5;
constexpr std::int64_t kRun = 64;  ///< pixels that are summed in float before they go into a double

}  // namespace

EncoderNorm::EncoderNorm(const MapShape& shape, dnnl::memory::format_tag layout, const Tensor& gain,
                         const Tensor& shift)
    : pixels_(shape.pixels()),
      channels_(shape.channels),
      blocks_(shape, layout),
      gain_(gain.values),
      shift_(shift.values) {}

void EncoderNorm::run(float* map, const float* residual, Activation activation) const {
  if (blocks_.width == 8) {
    runGroups<8>(map, residual, activation);
  } else {
    runGroups<16>(map, residual, activation);
  }
}

template <int kWidth>
void EncoderNorm::runGroups(float* map, const float* residual, Activation activation) const {
  const double count = static_cast<double>(kGroup * pixels_);
  const float floor =
      activation == Activation::kRelu ? 0.0F : -std::numeric_limits<float>::infinity();
  for (std::int64_t group = 0; group < channels_ / kGroup; ++group) {
    const Lanes sum = sums<kWidth, false>(map, group, 0.0F);
    const double mean = std::accumulate(sum.begin(), sum.end(), 0.0) / count;
    const Lanes squares = sums<kWidth, true>(map, group, static_cast<float>(mean));
    const double variance = std::accumulate(squares.begin(), squares.end(), 0.0) / count;
    const double inverse = 1.0 / std::sqrt(variance + kEpsilon);
    for (std::int64_t part = 0; part < kGroup / kWidth; ++part) {
      const std::int64_t block = group * (kGroup / kWidth) + part;
      float scale[kWidth];
      float offset[kWidth];
      for (int lane = 0; lane < kWidth; ++lane) {
        const std::size_t channel = static_cast<std::size_t>(block * kWidth + lane);
        scale[lane] = static_cast<float>(gain_[channel] * inverse);
        offset[lane] = static_cast<float>(shift_[channel] - mean * inverse * gain_[channel]);
      }
      float* values = map + block * blocks_.block_stride;
      if (residual == nullptr) {
        applyBlock<kWidth, false>(values, nullptr, scale, offset, floor);
      } else {
        applyBlock<kWidth, true>(values, residual + block * blocks_.block_stride, scale, offset,
                                 floor);
      }
    }
  }
}

template <int kWidth, bool kSquared>
EncoderNorm::Lanes EncoderNorm::sums(const float* map, std::int64_t group, float mean) const {
  Lanes total{};
  for (std::int64_t part = 0; part < kGroup / kWidth; ++part) {
    const float* values = map + (group * (kGroup / kWidth) + part) * blocks_.block_stride;
    for (std::int64_t begin = 0; begin < pixels_; begin += kRun) {
      const std::int64_t end = std::min(begin + kRun, pixels_);
      float sum[kWidth] = {};
      for (std::int64_t pixel = begin; pixel < end; ++pixel) {
        const float* row = values + pixel * blocks_.pixel_stride;
        for (int lane = 0; lane < kWidth; ++lane) {
          const float deviation = row[lane] - mean;
          sum[lane] += kSquared ? deviation * deviation : deviation;
        }
      }
      for (int lane = 0; lane < kWidth; ++lane)
        total[static_cast<std::size_t>(part * kWidth + lane)] += static_cast<double>(sum[lane]);
    }
  }
  return total;
}

template <int kWidth, bool kResidual>
void EncoderNorm::applyBlock(float* map, const float* residual, const float* scale,
                             const float* offset, float floor) const {
  for (std::int64_t pixel = 0; pixel < pixels_; ++pixel) {
    float* row = map + pixel * blocks_.pixel_stride;
    float sum[kWidth];
    for (int lane = 0; lane < kWidth; ++lane) sum[lane] = row[lane] * scale[lane] + offset[lane];
    if constexpr (kResidual) {
      const float* other = residual + pixel * blocks_.pixel_stride;
      for (int lane = 0; lane < kWidth; ++lane) sum[lane] += other[lane];
    }
    for (int lane = 0; lane < kWidth; ++lane) row[lane] = sum[lane] > floor ? sum[lane] : floor;
  }
}

}  // namespace cdiff::inference
