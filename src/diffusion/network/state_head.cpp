// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/state_head.h"

#include "e2e_cdiff/traffic/vehicle.h"
#include "inference/unet_layers.h"

namespace cdiff::diffusion {
namespace {

/// gradient *= slope.
void multiply(const inference::Activation& gradient, const inference::Activation& slope) {
  float* values = gradient.view().data;
  const float* factors = slope.view().data;
  const std::int64_t count = gradient.rows() * gradient.channels();
  for (std::int64_t i = 0; i < count; ++i) values[i] *= factors[i];
}

inference::Filter columns(const inference::Tensors& tensors, std::int64_t first,
                          std::int64_t count) {
  return inference::Filter::ofLinear(inference::tensorNamed(tensors, "state.0.weight"), first,
                                     count);
}

}  // namespace

StateHead::Hidden::Hidden(std::int64_t width, std::int64_t rows)
    : input(inference::matrix(width, rows)),
      value(inference::matrix(width, rows)),
      slope(inference::matrix(width, rows)),
      gradient(inference::matrix(width, rows)) {}

StateHead::StateHead(const inference::DenoiserKernels& kernels, const Architecture& architecture,
                     const inference::Tensors& tensors,
                     const inference::Activation& time_embeddings)
    : kernels_(&kernels),
      action_values_(architecture.horizon * traffic::kActionColumns),
      state_values_(architecture.horizon * traffic::kStateColumns),
      width_(architecture.state_hidden),
      actions_(kernels, columns(tensors, 0, action_values_), inference::Spacing{}),
      actions_reversed_(inference::reversedLinear(kernels, columns(tensors, 0, action_values_))),
      middle_(inference::linearNamed(kernels, tensors, "state.2")),
      middle_reversed_(inference::reversedLinear(
          kernels, inference::Filter::ofLinear(inference::tensorNamed(tensors, "state.2.weight")))),
      out_(inference::linearNamed(kernels, tensors, "state.4")),
      out_reversed_(inference::reversedLinear(
          kernels, inference::Filter::ofLinear(inference::tensorNamed(tensors, "state.4.weight")))),
      time_part_(inference::matrix(width_, time_embeddings.rows())) {
  const std::int64_t speed = architecture.startsFromSpeed() ? 1 : 0;
  if (speed > 0)
    speed_.emplace(kernels, columns(tensors, action_values_, speed), inference::Spacing{});
  inference::Convolution(kernels, columns(tensors, action_values_ + speed, architecture.time_width),
                         inference::Spacing{}, &inference::tensorNamed(tensors, "state.0.bias"))
      .applyToRows(time_embeddings, time_part_);
}

void StateHead::setContexts(const std::vector<Context>& contexts) {
  const auto rows = static_cast<std::int64_t>(contexts.size());
  inference::Activation speeds = inference::matrix(1, rows);
  for (std::int64_t b = 0; b < rows; ++b) {
    *speeds.row(b) = static_cast<float>(contexts[static_cast<std::size_t>(b)].speed / kSpeedScale);
  }
  speed_part_ = inference::matrix(width_, rows);
  if (speed_) speed_->applyToRows(speeds, speed_part_);
  action_rows_ = inference::matrix(action_values_, rows);
  state_rows_ = inference::matrix(state_values_, rows);
  for (Hidden& hidden : hidden_) hidden = Hidden(width_, rows);
}

void StateHead::mish(Hidden& hidden) const {
  kernels_->mish(hidden.input.view().data, hidden.input.rows() * hidden.input.channels(),
                 hidden.value.view().data, hidden.slope.view().data);
}

void StateHead::forward(const float* actions, int k, float* states) {
  const std::int64_t rows = action_rows_.rows();
  const float* time = time_part_.row(k);
  for (std::int64_t b = 0; b < rows; ++b) {
    const float* speed = speed_part_.row(b);
    float* to = hidden_[0].input.row(b);
    for (std::int64_t c = 0; c < width_; ++c) to[c] = time[c] + speed[c];
  }
  inference::copyIn(actions, rows, action_values_, action_rows_.view());
  actions_.applyToRows(action_rows_, hidden_[0].input, true);
  mish(hidden_[0]);
  middle_.applyToRows(hidden_[0].value, hidden_[1].input);
  mish(hidden_[1]);
  out_.applyToRows(hidden_[1].value, state_rows_);
  inference::copyOut(state_rows_.view(), rows, state_values_, states);
}

void StateHead::backward(const float* state_gradient, float* action_gradient) {
  const std::int64_t rows = action_rows_.rows();
  inference::copyIn(state_gradient, rows, state_values_, state_rows_.view());
  out_reversed_.applyToRows(state_rows_, hidden_[1].gradient);
  multiply(hidden_[1].gradient, hidden_[1].slope);
  middle_reversed_.applyToRows(hidden_[1].gradient, hidden_[0].gradient);
  multiply(hidden_[0].gradient, hidden_[0].slope);
  actions_reversed_.applyToRows(hidden_[0].gradient, action_rows_);
  inference::copyOut(action_rows_.view(), rows, action_values_, action_gradient);
}

}  // namespace cdiff::diffusion
