// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Activations of the denoiser [sample][time][channel], with channels padded to a multiple of 16
/// and rows of zeros ("halo") before and after each sample's rows, which take the place of a
/// convolution's padding.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>

#include "inference/denoiser_kernels.h"

namespace cdiff::inference {

/// Floats that begin at a cache line, zero at first.
class AlignedFloats {
 public:
  AlignedFloats() = default;
  explicit AlignedFloats(std::int64_t size)
      : values_(static_cast<float*>(
            ::operator new(sizeof(float) * static_cast<std::size_t>(size), kAlignment))) {
    std::fill_n(values_.get(), size, 0.0f);
  }

  float* data() const { return values_.get(); }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(float* values) const { ::operator delete(values, kAlignment); }
  };
  std::unique_ptr<float[], Free> values_;
};

/// Where the channels of a layer's input or output lie: `parts` equal parts, each padded.
struct ChannelLayout {
  std::int64_t channels = 0;
  std::int64_t parts = 1;

  std::int64_t partSize() const {
    return (channels / parts + kChannelMultiple - 1) / kChannelMultiple * kChannelMultiple;
  }
  std::int64_t padded() const { return parts * partSize(); }
  /// Padded index of a channel.
  std::int64_t place(std::int64_t channel) const {
    const std::int64_t length = channels / parts;
    return channel / length * partSize() + channel % length;
  }
};

class Activation {
 public:
  Activation() = default;
  Activation(const ChannelLayout& layout, std::int64_t rows, std::int64_t halo)
      : channels_(layout.padded()), rows_(rows), halo_(halo) {}

  /// Sets everything to zero.
  void resize(std::int64_t samples) { values_ = AlignedFloats(samples * sampleSize()); }
  View view(std::int64_t sample = 0, std::int64_t channel = 0) const {
    return {values_.data() + sample * sampleSize() + halo_ * channels_ + channel, channels_};
  }
  /// Of a matrix.
  float* row(std::int64_t index) const { return view().data + index * channels_; }
  std::int64_t rows() const { return rows_; }
  std::int64_t channels() const { return channels_; }

 private:
  std::int64_t sampleSize() const { return (rows_ + 2 * halo_) * channels_; }

  std::int64_t channels_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t halo_ = 0;
  AlignedFloats values_;
};

/// A matrix of zeros.
inline Activation matrix(std::int64_t columns, std::int64_t rows) {
  Activation result({columns, 1}, rows, 0);
  result.resize(1);
  return result;
}

/// Dense [rows, channels] into a view, and back.
inline void copyIn(const float* from, std::int64_t rows, std::int64_t channels, const View& to) {
  for (std::int64_t r = 0; r < rows; ++r) {
    std::copy_n(from + r * channels, channels, to.data + r * to.row);
  }
}
inline void copyOut(const View& from, std::int64_t rows, std::int64_t channels, float* to) {
  for (std::int64_t r = 0; r < rows; ++r) {
    std::copy_n(from.data + r * from.row, channels, to + r * channels);
  }
}

}  // namespace cdiff::inference
