// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/unet_layers.h"

#include <vector>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::inference {
namespace {

AlignedFloats padded(const Tensor& tensor, const ChannelLayout& layout) {
  AlignedFloats result(layout.padded());
  std::copy(tensor.values.begin(), tensor.values.end(), result.data());
  return result;
}

/// to += from.
void addRows(const View& from, const View& to, std::int64_t rows, std::int64_t channels) {
  for (std::int64_t row = 0; row < rows; ++row) {
    const float* source = from.data + row * from.row;
    float* target = to.data + row * to.row;
    for (std::int64_t c = 0; c < channels; ++c) target[c] += source[c];
  }
}

}  // namespace

const Tensor& tensorNamed(const Tensors& tensors, const std::string& name) {
  const auto found = tensors.find(name);
  if (found == tensors.end()) throw core::InputError("the denoiser has no tensor '" + name + "'");
  return found->second;
}

NormalizedConvolution::NormalizedConvolution(const LayerSource& source, const std::string& name,
                                             const ChannelLayout& inputs, std::int64_t rows)
    : kernels_(&source.kernels), groups_(source.groups), rows_(rows) {
  const Tensor& weight = tensorNamed(source.tensors, name + ".conv.weight");
  Filter filter = Filter::ofConvolution(weight);
  filter.inputs = inputs;
  outputs_ = filter.outputs;
  const Spacing same{1, filter.taps / 2, false};
  convolution_.emplace(source.kernels, filter, same,
                       &tensorNamed(source.tensors, name + ".conv.bias"));
  reversed_.emplace(source.kernels, filter.transposed(), same.reversed());
  scale_ = padded(tensorNamed(source.tensors, name + ".norm.weight"), outputs_);
  shift_ = padded(tensorNamed(source.tensors, name + ".norm.bias"), outputs_);
  scratch_ = AlignedFloats(3 * outputs_.padded());
  normalized_ = Activation(outputs_, rows, 0);
  slope_ = Activation(outputs_, rows, 0);
  gradient_ = Activation(outputs_, rows, source.halo);
  gradient_.resize(1);
}

void NormalizedConvolution::resize(std::int64_t samples) {
  inverse_deviation_ = matrix(outputs_.padded(), samples);
  normalized_.resize(samples);
  slope_.resize(samples);
}

NormalizationShape NormalizedConvolution::shape() const {
  return {outputs_.padded(), groups_, outputs_.channels / groups_, rows_, scratch_.data()};
}

void NormalizedConvolution::forward(std::int64_t sample, const View& input, const View& added,
                                    const View& output) {
  const View normalized = normalized_.view(sample);
  convolution_->apply(input, normalized, rows_);
  kernels_->normalize({shape(), scale_.data(), shift_.data(), normalized, slope_.view(sample),
                       inverse_deviation_.row(sample), added, output});
}

void NormalizedConvolution::backward(std::int64_t sample, const View& output_gradient,
                                     const View& input_gradient, bool accumulate) {
  kernels_->backwardNormalize({shape(), normalized_.view(sample), slope_.view(sample),
                               inverse_deviation_.row(sample), output_gradient, gradient_.view()});
  reversed_->apply(gradient_.view(), input_gradient, rows_, accumulate);
}

ResidualBlock::ResidualBlock(const LayerSource& source, const std::string& name,
                             const ChannelLayout& inputs, const Edge& edge, std::int64_t injection)
    : Layer(edge),
      injection_(injection),
      rows_(edge.output.variable->value.rows()),
      first_(source, name + ".block1", inputs, rows_),
      second_(source, name + ".block2", first_.outputs(), rows_),
      hidden_(first_.outputs(), rows_, source.halo) {
  hidden_.resize(1);
  buildSkip(source, name, inputs);
}

void ResidualBlock::buildSkip(const LayerSource& source, const std::string& name,
                              const ChannelLayout& inputs) {
  const std::int64_t outputs = first_.outputs().channels;
  if (inputs.channels != outputs) {
    Filter filter = Filter::ofConvolution(tensorNamed(source.tensors, name + ".skip.weight"));
    filter.inputs = inputs;
    skip_.emplace(source.kernels, filter, Spacing{},
                  &tensorNamed(source.tensors, name + ".skip.bias"));
    skip_reversed_.emplace(source.kernels, filter.transposed(), Spacing{}.reversed());
  } else if (inputs.parts > 1) {
    // The same channels in another layout: an identity moves them.
    Tensor identity{{outputs, outputs, 1}, std::vector<float>(outputs * outputs, 0.0f)};
    for (std::int64_t i = 0; i < outputs; ++i) identity.values[i * (outputs + 1)] = 1.0f;
    Filter filter = Filter::ofConvolution(identity);
    filter.inputs = inputs;
    skip_.emplace(source.kernels, filter, Spacing{});
    skip_reversed_.emplace(source.kernels, filter.transposed(), Spacing{}.reversed());
  }
}

void ResidualBlock::resize(std::int64_t samples) {
  first_.resize(samples);
  second_.resize(samples);
}

void ResidualBlock::forward(std::int64_t sample, const float* injection) {
  const View input = edge_.input.value(sample);
  const View output = edge_.output.value(sample);
  const View hidden = hidden_.value.view();
  // Rows of stride 0: the same injection at every time step.
  first_.forward(sample, input, {const_cast<float*>(injection) + injection_, 0}, hidden);
  if (skip_) skip_->apply(input, output, rows_);
  second_.forward(sample, hidden, skip_ ? output : input, output);
}

void ResidualBlock::backward(std::int64_t sample) {
  const View input = edge_.input.gradient(sample);
  const View output = edge_.output.gradient(sample);
  const View hidden = hidden_.gradient.view();
  second_.backward(sample, output, hidden, false);
  first_.backward(sample, hidden, input, edge_.shared_input);
  if (skip_reversed_) {
    skip_reversed_->apply(output, input, rows_, true);
  } else {
    addRows(output, input, rows_, first_.outputs().padded());
  }
}

PlainConvolution::PlainConvolution(const LayerSource& source, const std::string& name,
                                   const Spacing& spacing, const Edge& edge)
    : Layer(edge) {
  const Tensor& weight = tensorNamed(source.tensors, name + ".weight");
  const Filter filter =
      spacing.spread ? Filter::ofTransposedConvolution(weight) : Filter::ofConvolution(weight);
  convolution_.emplace(source.kernels, filter, spacing,
                       &tensorNamed(source.tensors, name + ".bias"));
  reversed_.emplace(source.kernels, filter.transposed(), spacing.reversed());
}

void PlainConvolution::forward(std::int64_t sample, const float*) {
  convolution_->apply(edge_.input.value(sample), edge_.output.value(sample),
                      edge_.output.variable->value.rows());
}

void PlainConvolution::backward(std::int64_t sample) {
  reversed_->apply(edge_.output.gradient(sample), edge_.input.gradient(sample),
                   edge_.input.variable->value.rows(), edge_.shared_input);
}

HeadBlock::HeadBlock(const LayerSource& source, const std::string& name,
                     const ChannelLayout& inputs, const Edge& edge)
    : Layer(edge),
      block_(source, name, inputs, edge.output.variable->value.rows()),
      zeros_(block_.outputs().padded()) {}

void HeadBlock::resize(std::int64_t samples) { block_.resize(samples); }

void HeadBlock::forward(std::int64_t sample, const float*) {
  block_.forward(sample, edge_.input.value(sample), {zeros_.data(), 0}, edge_.output.value(sample));
}

void HeadBlock::backward(std::int64_t sample) {
  block_.backward(sample, edge_.output.gradient(sample), edge_.input.gradient(sample), false);
}

}  // namespace cdiff::inference
