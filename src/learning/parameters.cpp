// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/parameters.h"

#include <cmath>
#include <cstring>
#include <numeric>

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

at::Tensor linear(const ParameterSet& parameters, const std::string& name, const at::Tensor& x) {
  const at::Tensor weight = parameters(name + ".weight").unsqueeze(2).unsqueeze(3);
  return at::conv2d(x.unsqueeze(2).unsqueeze(3), weight, parameters(name + ".bias")).flatten(1);
}

at::Tensor toTensor(const std::vector<float>& values, at::IntArrayRef shape,
                    const at::Device& device) {
  at::Tensor tensor = at::empty(shape, at::kFloat);
  if (tensor.numel() != static_cast<std::int64_t>(values.size()))
    throw std::logic_error("a tensor's count of values does not fit its shape");
  if (!values.empty()) std::memcpy(tensor.data_ptr(), values.data(), values.size() * sizeof(float));
  return tensor.to(device);
}

std::vector<float> toVector(const at::Tensor& tensor) {
  const at::Tensor plain = tensor.detach().to(at::kCPU, at::kFloat).contiguous();
  const float* begin = plain.data_ptr<float>();
  return {begin, begin + plain.numel()};
}

}  // namespace cdiff::learning
