// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/parameters.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::learning {
namespace {

std::int64_t productFrom(const std::vector<std::int64_t>& shape, std::size_t begin) {
  std::int64_t product = 1;
  for (std::size_t i = begin; i < shape.size(); ++i) product *= shape[i];
  return product;
}

}  // namespace

void ParameterSet::declare(const std::string& name, const std::vector<std::int64_t>& shape,
                           const Start& start) {
  std::vector<float> values(static_cast<std::size_t>(productFrom(shape, 0)));
  const core::RandomKey key{core::hashText(name)};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto element = static_cast<std::uint32_t>(i);
    double value = start.value;
    if (start.kind == Start::Kind::kUniform)
      value = start_.uniform(key, element, -start.value, start.value);
    values[i] = static_cast<float>(value);
  }
  places_.emplace(name, names_.size());
  names_.push_back(name);
  tensors_.push_back(toTensor(values, shape, at::kCPU));
}

void ParameterSet::declareLayer(const std::string& name, const std::vector<std::int64_t>& shape,
                                bool transposed) {
  const std::int64_t inputs = transposed ? shape[0] * productFrom(shape, 2) : productFrom(shape, 1);
  const Start start{Start::Kind::kUniform, 1.0 / std::sqrt(static_cast<double>(inputs))};
  declare(name + ".weight", shape, start);
  declare(name + ".bias", {transposed ? shape[1] : shape[0]}, start);
}

void ParameterSet::declareConvolution(const std::string& name,
                                      const std::vector<std::int64_t>& shape) {
  const auto outputs = static_cast<double>(shape[0] * productFrom(shape, 2));
  declare(name + ".weight", shape, {Start::Kind::kUniform, std::sqrt(6.0 / outputs)});
}

void ParameterSet::declareNorm(const std::string& name, std::int64_t channels, double weight) {
  declare(name + ".weight", {channels}, {Start::Kind::kConstant, weight});
  declare(name + ".bias", {channels}, {});
}

void ParameterSet::declareAll(const std::vector<inference::TensorShape>& tensors,
                              const std::function<double(const std::string&)>& bound) {
  constexpr std::string_view kWeight = ".weight";
  for (const inference::TensorShape& tensor : tensors) {
    const std::string& name = tensor.name;
    if (core::endsWith(name, ".bias")) continue;
    if (!core::endsWith(name, kWeight)) {
      declare(name, tensor.shape, {Start::Kind::kUniform, bound(name)});
      continue;
    }
    const std::string layer = name.substr(0, name.size() - kWeight.size());
    if (tensor.shape.size() > 1) {
      declareLayer(layer, tensor.shape);
    } else {
      declareNorm(layer, tensor.shape[0]);
    }
  }
}

const at::Tensor& ParameterSet::operator()(const std::string& name) const {
  const auto found = places_.find(name);
  if (found == places_.end()) throw std::logic_error("no parameter " + name);
  return tensors_[found->second];
}

void ParameterSet::setTrained(bool trained) {
  for (at::Tensor& tensor : tensors_) tensor.set_requires_grad(trained);
}

void ParameterSet::moveTo(const at::Device& device) {
  for (at::Tensor& tensor : tensors_) tensor = tensor.detach().to(device);
}

void ParameterSet::load(const std::map<std::string, inference::Tensor>& values,
                        const std::string& source) {
  const at::NoGradGuard no_gradient;
  for (const auto& [name, value] : values) {
    if (!has(name)) throw core::InputError(source + ": unknown tensor '" + name + "'");
  }
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const auto found = values.find(names_[i]);
    if (found == values.end())
      throw core::InputError(source + ": tensor '" + names_[i] + "' is missing");
    if (tensors_[i].sizes() != at::IntArrayRef(found->second.shape))
      throw core::InputError(source + ": tensor '" + names_[i] + "' has another shape");
    tensors_[i].copy_(toTensor(found->second.values, found->second.shape, at::kCPU));
  }
}

std::map<std::string, inference::Tensor> ParameterSet::values() const {
  std::map<std::string, inference::Tensor> result;
  for (std::size_t i = 0; i < names_.size(); ++i)
    result[names_[i]] = {tensors_[i].sizes().vec(), toVector(tensors_[i])};
  return result;
}

namespace {

template <class Value>
at::Tensor tensorOfValues(const std::vector<Value>& values, at::IntArrayRef shape,
                          at::ScalarType type, const at::Device& device) {
  at::Tensor tensor = at::empty(shape, type);
  if (tensor.numel() != static_cast<std::int64_t>(values.size()))
    throw std::logic_error("a tensor's count of values does not fit its shape");
  if (!values.empty()) std::memcpy(tensor.data_ptr(), values.data(), values.size() * sizeof(Value));
  return tensor.to(device);
}

}  // namespace

at::Tensor toTensor(const std::vector<float>& values, at::IntArrayRef shape,
                    const at::Device& device) {
  return tensorOfValues(values, shape, at::kFloat, device);
}

at::Tensor toIndices(const std::vector<std::int64_t>& values, at::IntArrayRef shape,
                     const at::Device& device) {
  return tensorOfValues(values, shape, at::kLong, device);
}

std::vector<float> toVector(const at::Tensor& tensor) {
  const at::Tensor plain = tensor.detach().to(at::kCPU, at::kFloat).contiguous();
  const float* begin = plain.data_ptr<float>();
  return {begin, begin + plain.numel()};
}

namespace {

constexpr double kBeta1 = 0.9;

/// Factors of one step; float as the tensors are.
struct StepFactors {
  float rate;          ///< learning rate over the correction of m
  float correction;    ///< 1 / sqrt(correction of v)
  float decay;         ///< 1 - learning rate x weight decay
  float average_gain;  ///< 1 - d
  double second;       ///< b2
  float epsilon;       ///< added to the root of v
};

struct StepTensors {
  at::Tensor weight;
  at::Tensor gradient;
  at::Tensor first;
  at::Tensor second;
  at::Tensor average;
};

/// One pass over the memory instead of ten.
void stepOnCpu(const StepTensors& tensors, const StepFactors& factors) {
  float* weight = tensors.weight.data_ptr<float>();
  const float* gradient = tensors.gradient.data_ptr<float>();
  float* first = tensors.first.data_ptr<float>();
  float* second = tensors.second.data_ptr<float>();
  float* average = tensors.average.data_ptr<float>();
  const auto second_decay = static_cast<float>(factors.second);
  const auto second_gain = static_cast<float>(1.0 - factors.second);
  at::parallel_for(0, tensors.weight.numel(), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const float g = gradient[i];
      first[i] = static_cast<float>(kBeta1) * first[i] + static_cast<float>(1.0 - kBeta1) * g;
      second[i] = second_decay * second[i] + second_gain * g * g;
      const float root = std::sqrt(second[i]) * factors.correction + factors.epsilon;
      weight[i] = factors.decay * weight[i] - factors.rate * first[i] / root;
      average[i] += factors.average_gain * (weight[i] - average[i]);
    }
  });
}

void stepOnDevice(const StepTensors& tensors, const StepFactors& factors) {
  tensors.first.mul_(kBeta1).add_(tensors.gradient, 1.0 - kBeta1);
  tensors.second.mul_(factors.second)
      .addcmul_(tensors.gradient, tensors.gradient, 1.0 - factors.second);
  const at::Tensor root = tensors.second.sqrt().mul_(factors.correction).add_(factors.epsilon);
  tensors.weight.mul_(factors.decay).addcdiv_(tensors.first, root, -factors.rate);
  tensors.average.add_(tensors.weight - tensors.average, factors.average_gain);
}

}  // namespace

Optimizer::Optimizer(std::vector<at::Tensor> parameters, const OptimizerOptions& options)
    : options_(options), parameters_(std::move(parameters)) {
  const at::NoGradGuard no_gradient;
  for (at::Tensor& parameter : parameters_) {
    first_.push_back(at::zeros_like(parameter));
    second_.push_back(at::zeros_like(parameter));
    average_.push_back(parameter.detach().clone());
  }
}

void Optimizer::clearGradients() {
  for (at::Tensor& parameter : parameters_) parameter.mutable_grad().reset();
}

double Optimizer::clipGradients(double limit) {
  return clipGradients(limit, 0, parameters_.size());
}

double Optimizer::clipGradients(double limit, std::size_t first, std::size_t count) {
  const at::NoGradGuard no_gradient;
  std::vector<at::Tensor> gradients;
  std::vector<at::Tensor> norms;
  for (std::size_t i = first; i < first + count; ++i) {
    const at::Tensor& gradient = parameters_.at(i).grad();
    if (!gradient.defined()) continue;
    gradients.push_back(gradient);
    norms.push_back(gradient.norm());
  }
  const double norm = at::stack(norms).norm().item<double>();
  if (norm <= limit || !std::isfinite(norm)) return norm;
  for (at::Tensor& gradient : gradients) gradient.mul_(limit / norm);
  return norm;
}

void Optimizer::step(std::int64_t n, double rate) {
  const at::NoGradGuard no_gradient;
  const auto count = static_cast<double>(n);
  const double average_decay = std::min(options_.average_decay, (1.0 + count) / (10.0 + count));
  StepFactors factors{};
  factors.rate = static_cast<float>(rate / (1.0 - std::pow(kBeta1, count + 1.0)));
  factors.correction =
      static_cast<float>(1.0 / std::sqrt(1.0 - std::pow(options_.second_decay, count + 1.0)));
  factors.average_gain = static_cast<float>(1.0 - average_decay);
  factors.second = options_.second_decay;
  factors.epsilon = static_cast<float>(options_.epsilon);
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    at::Tensor& weight = parameters_[i];
    const double decay = weight.dim() > 1 ? rate * options_.weight_decay : 0.0;
    factors.decay = static_cast<float>(1.0 - decay);
    const at::Tensor gradient =
        weight.grad().defined() ? weight.grad().contiguous() : at::zeros_like(weight);
    const StepTensors tensors{weight.detach(), gradient, first_[i], second_[i], average_[i]};
    if (weight.is_cpu()) {
      stepOnCpu(tensors, factors);
    } else {
      stepOnDevice(tensors, factors);
    }
  }
}

void Optimizer::swapAverage() {
  const at::NoGradGuard no_gradient;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const at::Tensor weight = parameters_[i].detach().clone();
    parameters_[i].copy_(average_[i]);
    average_[i].copy_(weight);
  }
}

bool Optimizer::parametersFinite() const {
  const at::NoGradGuard no_gradient;
  return std::all_of(parameters_.begin(), parameters_.end(), [](const at::Tensor& parameter) {
    return std::isfinite(parameter.detach().sum().item<double>());
  });
}

}  // namespace cdiff::learning
