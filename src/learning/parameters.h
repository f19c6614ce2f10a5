// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "inference/safetensors.h"

namespace cdiff::learning {

// Named tensors of a network in the order of their declaration, and the steps that train them.

/// How a tensor starts.
struct Start {
  enum class Kind { kConstant, kUniform };
  Kind kind = Kind::kConstant;
  double value = 0.0;  ///< the constant, or the bound of the absolute value
};

/// The weights of a network with gradients, by name: declared once, drawn from a seeded stream,
/// loaded and saved as safetensors.
class ParameterSet {
 public:
  explicit ParameterSet(const core::RandomStream& start) : start_(start) {}

  void declare(const std::string& name, const std::vector<std::int64_t>& shape, const Start& start);
  /// NAME.weight [out, in, kernel...] and, if asked, NAME.bias [out], uniform within 1/sqrt(fan
  /// in).
  void declareLayer(const std::string& name, const std::vector<std::int64_t>& shape,
                    bool transposed = false);
  /// NAME.weight [out, in, kernel, kernel], uniform with variance 2 / fan out, no bias.
  void declareConvolution(const std::string& name, const std::vector<std::int64_t>& shape);
  /// NAME.weight = `weight` and NAME.bias = 0.
  void declareNorm(const std::string& name, std::int64_t channels, double weight = 1.0);

  /// Of names and shapes as weight files list them: NAME.weight as by declareLayer, or with one
  /// dimension by declareNorm, each with its bias; others uniform within bound(name).
  void declareAll(const std::vector<inference::TensorShape>& tensors,
                  const std::function<double(const std::string&)>& bound);

  bool has(const std::string& name) const { return places_.count(name) != 0; }
  const at::Tensor& operator()(const std::string& name) const;
  const std::vector<std::string>& names() const { return names_; }
  std::vector<at::Tensor>& tensors() { return tensors_; }
  const std::vector<at::Tensor>& tensors() const { return tensors_; }

  void setTrained(bool trained);
  void moveTo(const at::Device& device);
  /// Values in and out, as the weight files hold them. Throws InputError naming the tensor that is
  /// missing, unknown or of another shape.
  void load(const std::map<std::string, inference::Tensor>& values, const std::string& source);
  std::map<std::string, inference::Tensor> values() const;

 private:
  core::RandomStream start_;
  std::vector<std::string> names_;
  std::vector<at::Tensor> tensors_;
  std::map<std::string, std::size_t> places_;
};

at::Tensor toTensor(const std::vector<float>& values, at::IntArrayRef shape,
                    const at::Device& device);
/// Whole numbers, as rows are chosen by.
at::Tensor toIndices(const std::vector<std::int64_t>& values, at::IntArrayRef shape,
                     const at::Device& device);
std::vector<float> toVector(const at::Tensor& tensor);

/// Weight decay, the decay per step of the moving average of the weights, b2 of AdamW, and what is
/// added to the root of the second moment.
struct OptimizerOptions {
  double weight_decay = 1e-4;
  double average_decay = 0.999;
  double second_decay = 0.999;
  double epsilon = 1e-8;
};

/// AdamW with a moving average of the weights: m = b1 m + (1-b1) g, v = b2 v + (1-b2) g^2,
/// w -= r (m' / (sqrt(v') + epsilon) + decay w), m', v' corrected for their start; average += (1-d)
/// (w - average), d = min(average_decay, (1+n)/(10+n)). Decay acts on tensors of two dimensions and
/// more.
class Optimizer {
 public:
  Optimizer(std::vector<at::Tensor> parameters, const OptimizerOptions& options);

  void clearGradients();
  /// Scales the gradients down to the norm `limit`; returns their norm before.
  double clipGradients(double limit);
  /// The same for `count` parameters from the one of number `first`.
  double clipGradients(double limit, std::size_t first, std::size_t count);
  /// Step `n` = 0, 1, ...
  void step(std::int64_t n, double rate);
  /// Exchanges weights and their average.
  void swapAverage();
  bool parametersFinite() const;

  std::vector<at::Tensor>& firstMoments() { return first_; }
  std::vector<at::Tensor>& secondMoments() { return second_; }
  std::vector<at::Tensor>& averages() { return average_; }
  std::vector<at::Tensor>& parameters() { return parameters_; }

 private:
  OptimizerOptions options_;
  std::vector<at::Tensor> parameters_;
  std::vector<at::Tensor> first_;
  std::vector<at::Tensor> second_;
  std::vector<at::Tensor> average_;
};

}  // namespace cdiff::learning
