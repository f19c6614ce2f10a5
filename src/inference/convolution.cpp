// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/convolution.h"

#include <algorithm>

namespace cdiff::inference {

Filter Filter::ofConvolution(const Tensor& weight) {
  const std::int64_t inputs = weight.shape[1];
  const std::int64_t taps = weight.shape[2];
  return {weight.values.data(), {weight.shape[0]}, {inputs}, inputs * taps, taps, taps};
}

Filter Filter::ofTransposedConvolution(const Tensor& weight) {
  return ofConvolution(weight).transposed();
}

Filter Filter::ofLinear(const Tensor& weight, std::int64_t first, std::int64_t inputs) {
  return {weight.values.data() + first, {weight.shape[0]}, {inputs}, weight.shape[1], 1, 1};
}

Filter Filter::ofLinear(const Tensor& weight) { return ofLinear(weight, 0, weight.shape[1]); }

Filter Filter::transposed() const {
  return {values, inputs, outputs, input_stride, output_stride, taps};
}

Convolution::Convolution(const DenoiserKernels& kernels, const Filter& filter,
                         const Spacing& spacing, const Tensor* bias)
    : kernels_(&kernels),
      spacing_(spacing),
      inputs_(filter.inputs.padded()),
      outputs_(filter.outputs.padded()),
      bias_(outputs_) {
  for (std::int64_t o = 0; bias && o < filter.outputs.channels; ++o) {
    bias_.data()[filter.outputs.place(o)] = bias->values[static_cast<std::size_t>(o)];
  }
  const std::int64_t phases = spacing.spread ? spacing.stride : 1;
  for (std::int64_t p = 0; p < phases; ++p) {
    std::vector<std::int64_t> ks;
    for (std::int64_t k = 0; k < filter.taps; ++k) {
      if (k % phases == (p + spacing.padding) % phases) ks.push_back(k);
    }
    // Output row p + stride m takes tap k from input row m + (p + padding - k) / stride.
    if (spacing.spread) std::reverse(ks.begin(), ks.end());
    const std::int64_t reach = ks.empty() ? 0 : (p + spacing.padding - ks.front()) / spacing.stride;
    phases_.push_back({spacing.spread ? reach : -spacing.padding,
                       static_cast<std::int64_t>(ks.size()), pack(filter, ks)});
  }
}

AlignedFloats Convolution::pack(const Filter& filter, const std::vector<std::int64_t>& ks) const {
  const auto taps = static_cast<std::int64_t>(ks.size());
  AlignedFloats packed(taps * inputs_ * outputs_);
  for (std::int64_t o = 0; o < filter.outputs.channels; ++o) {
    const std::int64_t output = filter.outputs.place(o);
    const std::int64_t first = output / kernels_->block * kernels_->block;
    const std::int64_t width = std::min(kernels_->block, outputs_ - first);
    for (std::int64_t j = 0; j < taps; ++j) {
      const float* from =
          filter.values + o * filter.output_stride + ks[static_cast<std::size_t>(j)];
      for (std::int64_t i = 0; i < filter.inputs.channels; ++i) {
        const std::int64_t input = filter.inputs.place(i);
        packed.data()[first * taps * inputs_ + (j * inputs_ + input) * width + output - first] =
            from[i * filter.input_stride];
      }
    }
  }
  return packed;
}

void Convolution::apply(const View& input, const View& output, std::int64_t rows,
                        bool accumulate) const {
  ConvolutionCall call;
  call.bias = bias_.data();
  call.inputs = inputs_;
  call.outputs = outputs_;
  call.tap = input.row;
  call.accumulate = accumulate;
  const auto phases = static_cast<std::int64_t>(phases_.size());
  for (std::int64_t p = 0; p < phases; ++p) {
    const Phase& phase = phases_[static_cast<std::size_t>(p)];
    call.weights = phase.weights.data();
    call.taps = phase.taps;
    call.input = {input.data + phase.first * input.row,
                  spacing_.spread ? input.row : spacing_.stride * input.row};
    call.output = {output.data + p * output.row, phases * output.row};
    call.rows = rows / phases;
    kernels_->convolve(call);
  }
}

void Convolution::applyToRows(const Activation& input, const Activation& output,
                              bool accumulate) const {
  apply(input.view(), output.view(), output.rows(), accumulate);
}

}  // namespace cdiff::inference
