// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <string>

#include "inference/convolution.h"

namespace cdiff::inference {

// Layers of the denoiser's U-Net (docs/neural_network.md), each with its forward pass and its
// backward pass (the product of its transposed Jacobian with a gradient). Layers are joined by
// variables.

using Tensors = std::map<std::string, Tensor>;

/// Throws InputError naming the tensor when there is none.
const Tensor& tensorNamed(const Tensors& tensors, const std::string& name);

/// What goes from layer to layer, with the gradient that comes back.
struct Variable {
  Activation value;
  Activation gradient;

  Variable() = default;
  Variable(const ChannelLayout& layout, std::int64_t rows, std::int64_t halo)
      : value(layout, rows, halo), gradient(layout, rows, halo) {}
  void resize(std::int64_t samples) {
    value.resize(samples);
    gradient.resize(samples);
  }
};

/// A variable from a channel on.
struct Slice {
  const Variable* variable = nullptr;
  std::int64_t channel = 0;

  View value(std::int64_t sample) const { return variable->value.view(sample, channel); }
  View gradient(std::int64_t sample) const { return variable->gradient.view(sample, channel); }
};

/// What all layers are built from.
struct LayerSource {
  const DenoiserKernels& kernels;
  const Tensors& tensors;
  std::int64_t groups;
  std::int64_t halo;
};

/// The variables that a layer reads and writes.
struct Edge {
  Slice input;
  Slice output;
  /// A later layer reads the input, too: gradients are added to the input's.
  bool shared_input = false;
};

/// A layer of the U-Net that works on one sample of a batch at a time and keeps what its backward
/// pass needs.
class Layer {
 public:
  explicit Layer(const Edge& edge) : edge_(edge) {}
  virtual ~Layer() = default;
  /// Makes room for a batch, where a layer keeps anything.
  virtual void resize(std::int64_t /*samples*/) {}
  /// `injection`: the sample's row of injections.
  virtual void forward(std::int64_t sample, const float* injection) = 0;
  /// From the gradient at the output to that at the input, at the last forward.
  virtual void backward(std::int64_t sample) = 0;

 protected:
  Edge edge_;
};

/// Mish(GN(convolution(input))) + added.
class NormalizedConvolution {
 public:
  NormalizedConvolution(const LayerSource& source, const std::string& name,
                        const ChannelLayout& inputs, std::int64_t rows);

  void resize(std::int64_t samples);
  void forward(std::int64_t sample, const View& input, const View& added, const View& output);
  void backward(std::int64_t sample, const View& output_gradient, const View& input_gradient,
                bool accumulate);
  const ChannelLayout& outputs() const { return outputs_; }

 private:
  NormalizationShape shape() const;

  const DenoiserKernels* kernels_;
  ChannelLayout outputs_;
  std::int64_t groups_;
  std::int64_t rows_;
  std::optional<Convolution> convolution_;
  std::optional<Convolution> reversed_;
  AlignedFloats scale_;
  AlignedFloats shift_;
  AlignedFloats scratch_;
  Activation inverse_deviation_;  ///< [B, channels]
  Activation normalized_;
  Activation slope_;
  Activation gradient_;  ///< at the convolution's output, of one sample
};

/// Two normalized convolutions, the injection after the first, plus the input.
class ResidualBlock : public Layer {
 public:
  /// `injection`: its first channel in a row of injections.
  ResidualBlock(const LayerSource& source, const std::string& name, const ChannelLayout& inputs,
                const Edge& edge, std::int64_t injection);

  void resize(std::int64_t samples) override;
  void forward(std::int64_t sample, const float* injection) override;
  void backward(std::int64_t sample) override;

 private:
  void buildSkip(const LayerSource& source, const std::string& name, const ChannelLayout& inputs);

  std::int64_t injection_;
  std::int64_t rows_;
  NormalizedConvolution first_;
  NormalizedConvolution second_;
  std::optional<Convolution> skip_;
  std::optional<Convolution> skip_reversed_;
  Variable hidden_;  ///< of one sample
};

/// A convolution alone: changes of resolution and the head's output.
class PlainConvolution : public Layer {
 public:
  PlainConvolution(const LayerSource& source, const std::string& name, const Spacing& spacing,
                   const Edge& edge);

  void forward(std::int64_t sample, const float* injection) override;
  void backward(std::int64_t sample) override;

 private:
  std::optional<Convolution> convolution_;
  std::optional<Convolution> reversed_;
};

/// The head's normalized convolution, with nothing added.
class HeadBlock : public Layer {
 public:
  HeadBlock(const LayerSource& source, const std::string& name, const ChannelLayout& inputs,
            const Edge& edge);

  void resize(std::int64_t samples) override;
  void forward(std::int64_t sample, const float* injection) override;
  void backward(std::int64_t sample) override;

 private:
  NormalizedConvolution block_;
  AlignedFloats zeros_;
};

// Linear layers on matrices, as convolutions of one tap over their rows.

inline Convolution linearNamed(const DenoiserKernels& kernels, const Tensors& tensors,
                               const std::string& name) {
  return Convolution(kernels, Filter::ofLinear(tensorNamed(tensors, name + ".weight")), Spacing{},
                     &tensorNamed(tensors, name + ".bias"));
}

/// The backward pass of a linear layer, or of some of its columns.
inline Convolution reversedLinear(const DenoiserKernels& kernels, const Filter& filter) {
  return Convolution(kernels, filter.transposed(), Spacing{});
}

}  // namespace cdiff::inference
