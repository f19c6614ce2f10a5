// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/conditioning.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "inference/unet_layers.h"

namespace cdiff::diffusion {
namespace {

constexpr double kLongestPeriod = 10000.0;

/// e_i = sin(k w_i), e_{h+i} = cos(k w_i), w_i = exp(-ln(10000) i / (h - 1)), h half the width.
inference::Activation sinusoids(std::int64_t steps, std::int64_t width) {
  inference::Activation result = inference::matrix(width, steps + 1);
  const std::int64_t half = width / 2;
  for (std::int64_t k = 0; k <= steps; ++k) {
    float* row = result.row(k);
    for (std::int64_t i = 0; i < half; ++i) {
      const double frequency = std::exp(-std::log(kLongestPeriod) * static_cast<double>(i) /
                                        static_cast<double>(half - 1));
      row[i] = static_cast<float>(std::sin(static_cast<double>(k) * frequency));
      row[half + i] = static_cast<float>(std::cos(static_cast<double>(k) * frequency));
    }
  }
  return result;
}

void requireSize(const char* what, std::size_t size, std::int64_t expected, std::size_t sample) {
  if (size == static_cast<std::size_t>(expected)) return;
  throw std::invalid_argument("context " + std::to_string(sample) + " has " + std::to_string(size) +
                              " " + what + "; " + std::to_string(expected) + " were expected");
}

}  // namespace

Conditioning::Conditioning(const inference::DenoiserKernels& kernels,
                           const Architecture& architecture, const inference::Tensors& tensors,
                           const std::vector<Injection>& injections)
    : kernels_(&kernels), architecture_(architecture) {
  if (architecture.takesRoute()) {
    route0_ = inference::linearNamed(kernels, tensors, "route.0");
    route2_ = inference::linearNamed(kernels, tensors, "route.2");
    no_route_ = inference::tensorNamed(tensors, "no_route").values;
  }
  if (architecture.takesSpeed()) speed0_ = inference::linearNamed(kernels, tensors, "speed.0");
  if (architecture.takesPrevious())
    no_previous_ = inference::tensorNamed(tensors, "no_previous").values;
  if (architecture.takesTarget()) {
    target0_ = inference::linearNamed(kernels, tensors, "target.0");
    no_target_ = inference::tensorNamed(tensors, "no_target").values;
  }
  if (architecture.context_width > 0)
    context0_ = inference::linearNamed(kernels, tensors, "context.0");
  buildTimeEmbeddings(tensors);
  buildInjections(tensors, injections);
}

void Conditioning::buildTimeEmbeddings(const inference::Tensors& tensors) {
  const std::int64_t rows = architecture_.diffusion_steps + 1;
  inference::Activation hidden =
      inference::matrix(inference::tensorNamed(tensors, "time.0.bias").shape[0], rows);
  inference::linearNamed(*kernels_, tensors, "time.0")
      .applyToRows(sinusoids(architecture_.diffusion_steps, architecture_.time_width), hidden);
  time_ = inference::matrix(architecture_.time_width, rows);
  inference::linearNamed(*kernels_, tensors, "time.2").applyToRows(mished(hidden), time_);
}

void Conditioning::buildInjections(const inference::Tensors& tensors,
                                   const std::vector<Injection>& injections) {
  const std::int64_t width = injections.back().first + injections.back().layout.padded();
  const inference::Activation time = mished(time_);
  time_part_ = inference::matrix(width, time_.rows());
  for (const Injection& injection : injections) {
    const inference::Tensor& weight = inference::tensorNamed(tensors, injection.name + ".weight");
    const inference::Filter time_columns =
        inference::Filter::ofLinear(weight, 0, architecture_.time_width);
    const inference::Filter context_columns = inference::Filter::ofLinear(
        weight, architecture_.time_width, architecture_.contextValues());
    inference::Convolution(*kernels_, time_columns, inference::Spacing{},
                           &inference::tensorNamed(tensors, injection.name + ".bias"))
        .apply(time.view(), time_part_.view(0, injection.first), time.rows());
    context_injections_.push_back(
        {injection.first,
         inference::Convolution(*kernels_, context_columns, inference::Spacing{})});
  }
}

inference::Activation Conditioning::mished(const inference::Activation& input) const {
  inference::Activation result = inference::matrix(input.channels(), input.rows());
  inference::AlignedFloats slope(input.channels() * input.rows());
  kernels_->mish(input.view().data, input.channels() * input.rows(), result.view().data,
                 slope.data());
  return result;
}

inference::Activation Conditioning::routeFeatures(const std::vector<Context>& contexts) const {
  const auto rows = static_cast<std::int64_t>(contexts.size());
  inference::Activation tokens = inference::matrix(2 * architecture_.route_points, rows);
  for (std::int64_t b = 0; b < rows; ++b) {
    const std::vector<float>& route = contexts[static_cast<std::size_t>(b)].route;
    std::copy(route.begin(), route.end(), tokens.row(b));
  }
  inference::Activation hidden = inference::matrix(route0_->outputs(), rows);
  route0_->applyToRows(tokens, hidden);
  inference::Activation result = inference::matrix(architecture_.route_features, rows);
  route2_->applyToRows(mished(hidden), result);
  for (std::int64_t b = 0; b < rows; ++b) {
    if (!contexts[static_cast<std::size_t>(b)].route.empty()) continue;
    std::copy(no_route_.begin(), no_route_.end(), result.row(b));
  }
  return result;
}

inference::Activation Conditioning::speedFeatures(const std::vector<Context>& contexts) const {
  inference::Activation speed = inference::matrix(1, static_cast<std::int64_t>(contexts.size()));
  for (std::size_t b = 0; b < contexts.size(); ++b) {
    *speed.row(static_cast<std::int64_t>(b)) = static_cast<float>(contexts[b].speed / kSpeedScale);
  }
  inference::Activation result = inference::matrix(architecture_.speed_features, speed.rows());
  speed0_->applyToRows(speed, result);
  return mished(result);
}

inference::Activation Conditioning::previousFeatures(const std::vector<Context>& contexts) const {
  inference::Activation result =
      inference::matrix(architecture_.image_features, static_cast<std::int64_t>(contexts.size()));
  for (std::size_t b = 0; b < contexts.size(); ++b) {
    const std::vector<float>& known = contexts[b].previous;
    const std::vector<float>& values = known.empty() ? no_previous_ : known;
    std::copy(values.begin(), values.end(), result.row(static_cast<std::int64_t>(b)));
  }
  return result;
}

inference::Activation Conditioning::targetFeatures(const std::vector<Context>& contexts) const {
  inference::Activation target = inference::matrix(1, static_cast<std::int64_t>(contexts.size()));
  for (std::size_t b = 0; b < contexts.size(); ++b) {
    *target.row(static_cast<std::int64_t>(b)) =
        static_cast<float>(contexts[b].target_speed.value_or(0.0) / kSpeedScale);
  }
  inference::Activation hidden = inference::matrix(architecture_.target_features, target.rows());
  target0_->applyToRows(target, hidden);
  inference::Activation result = mished(hidden);
  for (std::size_t b = 0; b < contexts.size(); ++b) {
    if (contexts[b].target_speed) continue;
    std::copy(no_target_.begin(), no_target_.end(), result.row(static_cast<std::int64_t>(b)));
  }
  return result;
}

void Conditioning::requireSizes(const Context& context, std::size_t sample) const {
  requireSize("image features", context.image_features.size(), architecture_.image_features,
              sample);
  if (!context.route.empty()) {
    requireSize("route values", context.route.size(),
                architecture_.takesRoute() ? 2 * architecture_.route_points : 0, sample);
  }
  if (!context.previous.empty()) {
    requireSize("features of the image before", context.previous.size(),
                architecture_.takesPrevious() ? architecture_.image_features : 0, sample);
  }
  if (context.target_speed && !architecture_.takesTarget())
    requireSize("target speeds", 1, 0, sample);
}

inference::Activation Conditioning::joinedFeatures(const std::vector<Context>& contexts) const {
  const auto rows = static_cast<std::int64_t>(contexts.size());
  inference::Activation joined = inference::matrix(architecture_.joinedFeatures(), rows);
  std::int64_t first = architecture_.image_features;
  for (std::int64_t b = 0; b < rows; ++b) {
    const std::vector<float>& image = contexts[static_cast<std::size_t>(b)].image_features;
    std::copy(image.begin(), image.end(), joined.row(b));
  }
  const auto append = [&](const inference::Activation& part, std::int64_t count) {
    for (std::int64_t b = 0; b < rows; ++b) std::copy_n(part.row(b), count, joined.row(b) + first);
    first += count;
  };
  if (architecture_.takesRoute()) append(routeFeatures(contexts), architecture_.route_features);
  if (architecture_.takesSpeed()) append(speedFeatures(contexts), architecture_.speed_features);
  if (architecture_.takesPrevious())
    append(previousFeatures(contexts), architecture_.image_features);
  if (architecture_.takesTarget()) append(targetFeatures(contexts), architecture_.target_features);
  return joined;
}

void Conditioning::setContexts(const std::vector<Context>& contexts) {
  for (std::size_t b = 0; b < contexts.size(); ++b) requireSizes(contexts[b], b);
  const auto rows = static_cast<std::int64_t>(contexts.size());
  inference::Activation context = joinedFeatures(contexts);
  if (context0_) {
    inference::Activation squeezed = inference::matrix(architecture_.context_width, rows);
    context0_->applyToRows(context, squeezed);
    context = mished(squeezed);
  }
  const inference::Activation injected = mished(context);  // the blocks' own Mish of c
  context_part_ = inference::matrix(time_part_.channels(), rows);
  injection_ = inference::matrix(time_part_.channels(), rows);
  for (const ContextInjection& part : context_injections_) {
    part.layer.apply(injected.view(), context_part_.view(0, part.first), rows);
  }
}

const inference::Activation& Conditioning::injection(int k) {
  const float* time = time_part_.row(k);
  for (std::int64_t b = 0; b < injection_.rows(); ++b) {
    const float* context = context_part_.row(b);
    float* to = injection_.row(b);
    for (std::int64_t c = 0; c < injection_.channels(); ++c) to[c] = time[c] + context[c];
  }
  return injection_;
}

}  // namespace cdiff::diffusion
