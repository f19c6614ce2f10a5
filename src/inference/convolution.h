// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

#include "inference/denoiser_kernels.h"
#include "inference/safetensors.h"

namespace cdiff::inference {

// Convolutions over time at run time, and the padded float32 memory that layers work on.

/// Floats aligned to a cache line, initially zero.
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

/// Activations of the denoiser [sample][time][channel], with channels padded to a multiple of 16
/// and rows of zeros ("halo") before and after each sample's rows, which take the place of a
/// convolution's padding.
class Activation {
 public:
  Activation() = default;
  Activation(const ChannelLayout& layout, std::int64_t rows, std::int64_t halo)
      : channels_(layout.padded()), rows_(rows), halo_(halo) {}

  /// Sets everything to zero.
  void resize(std::int64_t samples) { values_ = AlignedFloats(samples * sampleSize()); }
  View view(std::int64_t sample = 0, std::int64_t channel = 0, std::int64_t row = 0) const {
    return {values_.data() + sample * sampleSize() + (halo_ + row) * channels_ + channel,
            channels_};
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

/// Weights as they lie in a tensor: W_k[o, i] = values[o output_stride + i input_stride + k].
struct Filter {
  const float* values = nullptr;
  ChannelLayout outputs;
  ChannelLayout inputs;
  std::int64_t output_stride = 0;
  std::int64_t input_stride = 0;
  std::int64_t taps = 1;

  /// Of a convolution [out, in, kernel], a transposed one [in, out, kernel], and of the columns
  /// first .. first + inputs - 1 of a linear layer [out, in].
  static Filter ofConvolution(const Tensor& weight);
  static Filter ofTransposedConvolution(const Tensor& weight);
  static Filter ofLinear(const Tensor& weight, std::int64_t first, std::int64_t inputs);
  static Filter ofLinear(const Tensor& weight);
  Filter transposed() const;
};

/// Stride and padding of a one-dimensional convolution [rows]; `spread` makes it a transposed one.
struct Spacing {
  std::int64_t stride = 1;
  std::int64_t padding = 0;
  bool spread = false;

  Spacing reversed() const { return {stride, padding, !spread}; }
};

/// A convolution over time with its weights packed for the kernels: gathering, output[s] = bias +
/// sum over k of W_k input[stride s + k - padding], or spreading (a transposed convolution),
/// output[stride s + k - padding] += W_k input[s]. One is the backward pass of the other.
class Convolution {
 public:
  /// Without `bias` it is zero.
  Convolution(const DenoiserKernels& kernels, const Filter& filter, const Spacing& spacing,
              const Tensor* bias = nullptr);

  /// The input has rows / stride (spreading) or rows x stride rows.
  void apply(const View& input, const View& output, std::int64_t rows,
             bool accumulate = false) const;
  /// For matrices: each row separately.
  void applyToRows(const Activation& input, const Activation& output,
                   bool accumulate = false) const;
  /// With padding.
  std::int64_t outputs() const { return outputs_; }

 private:
  /// The output rows phase, phase + output_stride, ... and the taps that reach them.
  struct Phase {
    std::int64_t first = 0;  ///< input row of the first tap for the first output row
    std::int64_t taps = 0;
    AlignedFloats weights;
  };
  /// Packs the taps k = ks[0], ks[1], ...
  AlignedFloats pack(const Filter& filter, const std::vector<std::int64_t>& ks) const;

  const DenoiserKernels* kernels_;
  Spacing spacing_;
  std::int64_t inputs_;
  std::int64_t outputs_;
  AlignedFloats bias_;
  std::vector<Phase> phases_;
};

}  // namespace cdiff::inference
