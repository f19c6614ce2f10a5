// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "unet_layers.h"

#include <vector>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

AlignedFloats padded(const Tensor& tensor, const ChannelLayout& layout) {
  AlignedFloats result(layout.padded());
  std::copy(tensor.values.begin(), tensor.values.end(), result.data());
  return result;
}

/// to += from.
void addRows(const View& from, const View& to, const RowExtent& extent) {
  for (std::int64_t sample = 0; sample < extent.samples; ++sample) {
    for (std::int64_t row = 0; row < extent.rows; ++row) {
      const float* source = from.data + sample * from.sample + row * from.row;
      float* target = to.data + sample * to.sample + row * to.row;
      for (std::int64_t c = 0; c < extent.channels; ++c) target[c] += source[c];
    }
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
}

void NormalizedConvolution::resize(std::int64_t samples) {
  inverse_deviation_ = AlignedFloats(samples * outputs_.padded());
  normalized_.resize(samples);
  slope_.resize(samples);
  gradient_.resize(samples);
}

NormalizationShape NormalizedConvolution::shape(std::int64_t samples) const {
  return {outputs_.padded(), groups_, outputs_.channels / groups_, rows_, samples, scratch_.data()};
}

void NormalizedConvolution::forward(const View& input, const View& added, const View& output,
                                    std::int64_t samples) {
  convolution_->apply(input, normalized_.view(), rows_, samples);
  kernels_->normalize({shape(samples), scale_.data(), shift_.data(), normalized_.view(),
                       slope_.view(), inverse_deviation_.data(), added, output});
}

void NormalizedConvolution::pullBack(const View& output_gradient, const View& input_gradient,
                                     std::int64_t samples, bool accumulate) {
  kernels_->pullBackNormalize({shape(samples), normalized_.view(), slope_.view(),
                               inverse_deviation_.data(), output_gradient, gradient_.view()});
  reversed_->apply(gradient_.view(), input_gradient, rows_, samples, accumulate);
}

ResidualBlock::ResidualBlock(const LayerSource& source, const std::string& name,
                             const ChannelLayout& inputs, const Connection& connection,
                             std::int64_t injection)
    : connection_(connection),
      injection_(injection),
      rows_(connection.output.signal->value.rows()),
      first_(source, name + ".block1", inputs, rows_),
      second_(source, name + ".block2", first_.outputs(), rows_),
      hidden_(first_.outputs(), rows_, source.halo) {
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
  hidden_.resize(samples);
}

void ResidualBlock::forward(const Pass& pass) {
  const View input = connection_.input.value();
  const View output = connection_.output.value();
  const View injected{pass.injection.data + injection_, 0, pass.injection.sample};
  first_.forward(input, injected, hidden_.value.view(), pass.samples);
  if (skip_) skip_->apply(input, output, rows_, pass.samples);
  second_.forward(hidden_.value.view(), skip_ ? output : input, output, pass.samples);
}

void ResidualBlock::pullBack(const Pass& pass) {
  const View input = connection_.input.gradient();
  const View output = connection_.output.gradient();
  const View hidden = hidden_.gradient.view();
  second_.pullBack(output, hidden, pass.samples, false);
  first_.pullBack(hidden, input, pass.samples, connection_.shared_input);
  if (skip_reversed_) {
    skip_reversed_->apply(output, input, rows_, pass.samples, true);
  } else {
    addRows(output, input, {first_.outputs().padded(), rows_, pass.samples});
  }
}

PlainConvolution::PlainConvolution(const LayerSource& source, const std::string& name,
                                   const Spacing& spacing, const Connection& connection)
    : connection_(connection) {
  const Tensor& weight = tensorNamed(source.tensors, name + ".weight");
  const Filter filter =
      spacing.spread ? Filter::ofTransposedConvolution(weight) : Filter::ofConvolution(weight);
  convolution_.emplace(source.kernels, filter, spacing,
                       &tensorNamed(source.tensors, name + ".bias"));
  reversed_.emplace(source.kernels, filter.transposed(), spacing.reversed());
}

void PlainConvolution::resize(std::int64_t) {}

void PlainConvolution::forward(const Pass& pass) {
  convolution_->apply(connection_.input.value(), connection_.output.value(),
                      connection_.output.signal->value.rows(), pass.samples);
}

void PlainConvolution::pullBack(const Pass& pass) {
  reversed_->apply(connection_.output.gradient(), connection_.input.gradient(),
                   connection_.input.signal->value.rows(), pass.samples, connection_.shared_input);
}

HeadBlock::HeadBlock(const LayerSource& source, const std::string& name,
                     const ChannelLayout& inputs, const Connection& connection)
    : connection_(connection),
      block_(source, name, inputs, connection.output.signal->value.rows()),
      zeros_(block_.outputs().padded()) {}

void HeadBlock::resize(std::int64_t samples) { block_.resize(samples); }

void HeadBlock::forward(const Pass& pass) {
  block_.forward(connection_.input.value(), {zeros_.data(), 0, 0}, connection_.output.value(),
                 pass.samples);
}

void HeadBlock::pullBack(const Pass& pass) {
  block_.pullBack(connection_.output.gradient(), connection_.input.gradient(), pass.samples, false);
}

}  // namespace cdiff::diffusion
