// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/transformer_layers.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::inference {
namespace {

AlignedFloats copied(const Tensor& tensor) {
  AlignedFloats values(static_cast<std::int64_t>(tensor.values.size()));
  std::copy(tensor.values.begin(), tensor.values.end(), values.data());
  return values;
}

float logistic(float x) { return 1.0f / (1.0f + std::exp(-x)); }

void copyRow(const View& from, const View& to, std::int64_t channels) {
  std::copy_n(from.data, channels, to.data);
}

}  // namespace

const Tensor& LayerWeights::named(const std::string& name) const {
  const auto found = tensors.find(name);
  if (found == tensors.end()) throw core::InputError("the network has no tensor '" + name + "'");
  return found->second;
}

void Rows::resize(std::int64_t rows, std::int64_t channels) {
  const std::int64_t stride = ChannelLayout{channels, 1}.padded();
  const bool same = stride == stride_;
  rows_ = rows;
  stride_ = stride;
  if (same && rows * stride <= capacity_) return;
  capacity_ = rows * stride;
  values_ = AlignedFloats(capacity_);
}

Linear::Linear(const LayerWeights& weights, const std::string& name)
    : outputs_(weights.named(name + ".weight").shape[0]),
      convolution_(weights.linear, Filter::ofLinear(weights.named(name + ".weight")), Spacing{},
                   &weights.named(name + ".bias")) {}

LayerNorm::LayerNorm(const LayerWeights& weights, const std::string& name)
    : kernels_(&weights.kernels),
      channels_(weights.named(name + ".weight").shape[0]),
      gain_(copied(weights.named(name + ".weight"))),
      shift_(copied(weights.named(name + ".bias"))) {}

void LayerNorm::apply(const View& input, const View& added, const View& output,
                      std::int64_t rows) const {
  kernels_->normalizeRows({channels_, rows, gain_.data(), shift_.data(), input, added, output});
}

TransformerLayer::TransformerLayer(const LayerWeights& weights, const std::string& name,
                                   const TransformerSizes& sizes)
    : kernels_(&weights.kernels),
      sizes_(sizes),
      query_(weights, name + ".query"),
      key_value_(weights, name + ".key_value"),
      output_(weights, name + ".output"),
      norm1_(weights, name + ".norm1"),
      up_(weights, name + ".up"),
      down_(weights, name + ".down"),
      norm2_(weights, name + ".norm2") {}

void TransformerLayer::attend(const View& query, std::int64_t count, std::int64_t begin,
                              std::int64_t end, std::int64_t output,
                              TransformerMemory& memory) const {
  const std::int64_t head_width = sizes_.width / sizes_.heads;
  const std::int64_t padded = paddedKeys(end - begin);
  memory.weights.resize(static_cast<std::size_t>(sizes_.heads * count * padded));
  if (head_width * padded > memory.keys_capacity) {
    memory.keys_capacity = head_width * padded;
    memory.keys = AlignedFloats(memory.keys_capacity);
  }
  AttentionCall call;
  call.heads = sizes_.heads;
  call.head_width = head_width;
  call.queries = count;
  call.keys = end - begin;
  call.query = query;
  call.key = memory.key_value.view(begin);
  call.value = memory.key_value.view(begin, sizes_.width);
  call.output = memory.mixed.view(output);
  call.weights = memory.weights.data();
  call.scratch = memory.keys.data();
  kernels_->attend(call);
}

/// From the output of attention to the end of the layer, in place on x.
void TransformerLayer::finish(const View& x, std::int64_t rows, TransformerMemory& memory) const {
  memory.change.resize(rows, sizes_.width);
  memory.hidden.resize(rows, sizes_.hidden);
  output_.apply(memory.mixed.view(), memory.change.view(), rows);
  norm1_.apply(x, memory.change.view(), x, rows);
  up_.apply(x, memory.hidden.view(), rows);
  kernels_->gelu(memory.hidden.row(0), rows * memory.hidden.stride());
  down_.apply(memory.hidden.view(), memory.change.view(), rows);
  norm2_.apply(x, memory.change.view(), x, rows);
}

void TransformerLayer::forward(const std::vector<std::int64_t>& begins, const Rows& x,
                               TransformerMemory& memory) const {
  const std::int64_t rows = begins.back();
  memory.query.resize(rows, sizes_.width);
  memory.key_value.resize(rows, 2 * sizes_.width);
  memory.mixed.resize(rows, sizes_.width);
  query_.apply(x.view(), memory.query.view(), rows);
  key_value_.apply(x.view(), memory.key_value.view(), rows);
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    attend(memory.query.view(begins[i]), begins[i + 1] - begins[i], begins[i], begins[i + 1],
           begins[i], memory);
  }
  finish(x.view(), rows, memory);
}

void TransformerLayer::forwardFirst(const std::vector<std::int64_t>& begins, const Rows& x,
                                    TransformerMemory& memory,
                                    std::vector<float>& attention) const {
  const auto sequences = static_cast<std::int64_t>(begins.size()) - 1;
  memory.first.resize(sequences, sizes_.width);
  memory.query.resize(sequences, sizes_.width);
  memory.key_value.resize(begins.back(), 2 * sizes_.width);
  memory.mixed.resize(sequences, sizes_.width);
  attention.clear();
  for (std::int64_t i = 0; i < sequences; ++i)
    copyRow(x.view(begins[static_cast<std::size_t>(i)]), memory.first.view(i), sizes_.width);
  query_.apply(memory.first.view(), memory.query.view(), sequences);
  key_value_.apply(x.view(), memory.key_value.view(), begins.back());
  for (std::int64_t i = 0; i < sequences; ++i) {
    const std::int64_t begin = begins[static_cast<std::size_t>(i)];
    const std::int64_t end = begins[static_cast<std::size_t>(i) + 1];
    attend(memory.query.view(i), 1, begin, end, i, memory);
    for (std::int64_t key = 0; key < end - begin; ++key) {
      float sum = 0.0f;
      for (std::int64_t head = 0; head < sizes_.heads; ++head)
        sum += memory.weights[static_cast<std::size_t>(head * paddedKeys(end - begin) + key)];
      attention.push_back(sum / static_cast<float>(sizes_.heads));
    }
  }
  finish(memory.first.view(), sequences, memory);
}

GruCell::GruCell(const LayerWeights& weights, const std::string& name)
    : input_(weights, name + ".input"),
      state_(weights, name + ".state"),
      states_(state_.outputs() / 3) {}

void GruCell::step(const Rows& input, const Rows& state) {
  of_input_.resize(state.rows(), 3 * states_);
  of_state_.resize(state.rows(), 3 * states_);
  input_.apply(input.view(), of_input_.view(), state.rows());
  state_.apply(state.view(), of_state_.view(), state.rows());
  for (std::int64_t row = 0; row < state.rows(); ++row) {
    const float* x = of_input_.row(row);
    const float* h = of_state_.row(row);
    float* value = state.row(row);
    for (std::int64_t i = 0; i < states_; ++i) {
      const float reset = logistic(x[i] + h[i]);
      const float update = logistic(x[states_ + i] + h[states_ + i]);
      const float proposed = std::tanh(x[2 * states_ + i] + reset * h[2 * states_ + i]);
      value[i] = (1.0f - update) * proposed + update * value[i];
    }
  }
}

}  // namespace cdiff::inference
