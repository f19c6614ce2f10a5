// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/optimizer.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <cmath>

namespace cdiff::learning {
namespace {

constexpr double kBeta1 = 0.9;
constexpr double kBeta2 = 0.999;
constexpr double kEpsilon = 1e-8;

/// Factors of one step; float as the tensors are.
struct StepFactors {
  float rate;          ///< learning rate over the correction of m
  float correction;    ///< 1 / sqrt(correction of v)
  float decay;         ///< 1 - learning rate x weight decay
  float average_gain;  ///< 1 - d
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
  at::parallel_for(0, tensors.weight.numel(), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const float g = gradient[i];
      first[i] = static_cast<float>(kBeta1) * first[i] + static_cast<float>(1.0 - kBeta1) * g;
      second[i] = static_cast<float>(kBeta2) * second[i] + static_cast<float>(1.0 - kBeta2) * g * g;
      const float root = std::sqrt(second[i]) * factors.correction + static_cast<float>(kEpsilon);
      weight[i] = factors.decay * weight[i] - factors.rate * first[i] / root;
      average[i] += factors.average_gain * (weight[i] - average[i]);
    }
  });
}

void stepOnDevice(const StepTensors& tensors, const StepFactors& factors) {
  tensors.first.mul_(kBeta1).add_(tensors.gradient, 1.0 - kBeta1);
  tensors.second.mul_(kBeta2).addcmul_(tensors.gradient, tensors.gradient, 1.0 - kBeta2);
  const at::Tensor root = tensors.second.sqrt().mul_(factors.correction).add_(kEpsilon);
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
  const at::NoGradGuard no_gradient;
  std::vector<at::Tensor> norms;
  for (const at::Tensor& parameter : parameters_) {
    if (parameter.grad().defined()) norms.push_back(parameter.grad().norm());
  }
  const double norm = at::stack(norms).norm().item<double>();
  if (norm <= limit || !std::isfinite(norm)) return norm;
  for (const at::Tensor& parameter : parameters_) {
    if (parameter.grad().defined()) parameter.grad().mul_(limit / norm);
  }
  return norm;
}

void Optimizer::step(std::int64_t n, double rate) {
  const at::NoGradGuard no_gradient;
  const auto count = static_cast<double>(n);
  const double average_decay = std::min(options_.average_decay, (1.0 + count) / (10.0 + count));
  StepFactors factors{};
  factors.rate = static_cast<float>(rate / (1.0 - std::pow(kBeta1, count + 1.0)));
  factors.correction = static_cast<float>(1.0 / std::sqrt(1.0 - std::pow(kBeta2, count + 1.0)));
  factors.average_gain = static_cast<float>(1.0 - average_decay);
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
