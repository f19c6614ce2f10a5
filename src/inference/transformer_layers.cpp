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

RowSpan sequenceOf(const std::vector<std::int64_t>& begins, std::size_t index) {
  return {begins[index], 1, begins[index + 1] - begins[index]};
}

View spanView(const Rows& rows, const RowSpan& span, std::int64_t channel = 0) {
  return {rows.row(span.first) + channel, span.step * rows.stride()};
}

void normalizeInto(const LayerNorm& norm, const Rows& x, TransformerMemory& memory) {
  memory.normed.resize(x.rows(), x.stride());
  norm.apply(x.view(), memory.normed.view(), x.rows());
}

void addRows(const Rows& change, const Rows& x) {
  for (std::int64_t row = 0; row < x.rows(); ++row) addRow(change.row(row), x.stride(), x.row(row));
}

void requireMultiple(const char* key, std::int64_t value, std::int64_t divisor,
                     const std::string& reason) {
  if (value % divisor == 0) return;
  throw core::InputError(std::string(key) + " is " + std::to_string(value) + "; a multiple of " +
                         reason + " was expected");
}

}  // namespace

const Tensor& LayerWeights::named(const std::string& name) const {
  const auto found = tensors.find(name);
  if (found == tensors.end()) throw core::InputError("the network has no tensor '" + name + "'");
  return found->second;
}

void TensorList::layer(const std::string& name, const std::vector<std::int64_t>& shape) {
  add(name + ".weight", shape);
  add(name + ".bias", {shape[0]});
}

void TensorList::mlp(const std::string& name, std::int64_t in, std::int64_t hidden,
                     std::int64_t out) {
  layer(name + ".in", {hidden, in});
  norm(name + ".norm", hidden);
  layer(name + ".out", {out, hidden});
}

void TensorList::attention(const std::string& name, std::int64_t width) {
  layer(name + ".query", {width, width});
  layer(name + ".key_value", {2 * width, width});
  layer(name + ".output", {width, width});
}

void TensorList::feedForward(const std::string& name, std::int64_t width, std::int64_t hidden) {
  layer(name + ".up", {hidden, width});
  layer(name + ".down", {width, hidden});
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
      shift_(copied(weights.named(name + ".bias"))),
      zeros_(channels_) {}

void LayerNorm::apply(const View& input, const View& added, const View& output,
                      std::int64_t rows) const {
  kernels_->normalizeRows({channels_, rows, gain_.data(), shift_.data(), input, added, output});
}

void TransformerSizes::validate() const {
  requireMultiple("width", width, kChannelMultiple * heads, "16 x heads");
  requireMultiple("hidden", hidden, kChannelMultiple, "16");
}

Mlp::Mlp(const LayerWeights& weights, const std::string& name)
    : in_(weights, name + ".in"), norm_(weights, name + ".norm"), out_(weights, name + ".out") {}

void Mlp::apply(const View& input, const View& output, std::int64_t rows, Rows& hidden) const {
  hidden.resize(rows, in_.outputs());
  in_.apply(input, hidden.view(), rows);
  norm_.apply(hidden.view(), hidden.view(), rows);
  float* values = hidden.row(0);
  for (std::int64_t i = 0; i < rows * hidden.stride(); ++i) values[i] = std::max(0.0F, values[i]);
  out_.apply(hidden.view(), output, rows);
}

void attendRows(const TransformerKernels& kernels, const TransformerSizes& sizes,
                const RowSpan& queries, const RowSpan& keys, TransformerMemory& memory) {
  const std::int64_t head_width = sizes.width / sizes.heads;
  const std::int64_t padded = paddedKeys(keys.count);
  memory.weights.resize(static_cast<std::size_t>(sizes.heads * queries.count * padded));
  if (head_width * padded > memory.keys_capacity) {
    memory.keys_capacity = head_width * padded;
    memory.keys = AlignedFloats(memory.keys_capacity);
  }
  AttentionCall call;
  call.heads = sizes.heads;
  call.head_width = head_width;
  call.queries = queries.count;
  call.keys = keys.count;
  call.query = spanView(memory.query, queries);
  call.key = spanView(memory.key_value, keys);
  call.value = spanView(memory.key_value, keys, sizes.width);
  call.output = spanView(memory.mixed, queries);
  call.weights = memory.weights.data();
  call.scratch = memory.keys.data();
  kernels.attend(call);
}

MultiHeadAttention::MultiHeadAttention(const LayerWeights& weights, const std::string& name,
                                       const TransformerSizes& sizes)
    : kernels_(&weights.kernels),
      sizes_(sizes),
      query_(weights, name + ".query"),
      key_value_(weights, name + ".key_value"),
      output_(weights, name + ".output") {}

void MultiHeadAttention::project(const Rows& x, const Rows& context,
                                 TransformerMemory& memory) const {
  memory.query.resize(x.rows(), sizes_.width);
  memory.key_value.resize(context.rows(), 2 * sizes_.width);
  memory.mixed.resize(x.rows(), sizes_.width);
  query_.apply(x.view(), memory.query.view(), x.rows());
  key_value_.apply(context.view(), memory.key_value.view(), context.rows());
}

void MultiHeadAttention::finish(TransformerMemory& memory) const {
  memory.change.resize(memory.mixed.rows(), sizes_.width);
  output_.apply(memory.mixed.view(), memory.change.view(), memory.mixed.rows());
}

FeedForward::FeedForward(const LayerWeights& weights, const std::string& name)
    : kernels_(&weights.kernels), up_(weights, name + ".up"), down_(weights, name + ".down") {}

void FeedForward::apply(const Rows& x, TransformerMemory& memory) const {
  memory.hidden.resize(x.rows(), up_.outputs());
  memory.change.resize(x.rows(), down_.outputs());
  up_.apply(x.view(), memory.hidden.view(), x.rows());
  kernels_->gelu(memory.hidden.row(0), x.rows() * memory.hidden.stride());
  down_.apply(memory.hidden.view(), memory.change.view(), x.rows());
}

TransformerLayer::TransformerLayer(const LayerWeights& weights, const std::string& name,
                                   const TransformerSizes& sizes)
    : sizes_(sizes),
      attention_(weights, name, sizes),
      norm1_(weights, name + ".norm1"),
      mix_(weights, name),
      norm2_(weights, name + ".norm2") {}

/// From the output of attention to the end of the layer, in place on x.
void TransformerLayer::finish(const Rows& x, TransformerMemory& memory) const {
  attention_.finish(memory);
  norm1_.apply(x.view(), memory.change.view(), x.view(), x.rows());
  mix_.apply(x, memory);
  norm2_.apply(x.view(), memory.change.view(), x.view(), x.rows());
}

void TransformerLayer::forward(const std::vector<std::int64_t>& begins, const Rows& x,
                               TransformerMemory& memory) const {
  attention_.project(x, x, memory);
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    const RowSpan sequence = sequenceOf(begins, i);
    attention_.attend(sequence, sequence, memory);
  }
  finish(x, memory);
}

void TransformerLayer::forwardFirst(const std::vector<std::int64_t>& begins, const Rows& x,
                                    TransformerMemory& memory,
                                    std::vector<float>& attention) const {
  memory.first.resize(static_cast<std::int64_t>(begins.size()) - 1, sizes_.width);
  attention.clear();
  for (std::int64_t i = 0; i < memory.first.rows(); ++i)
    std::copy_n(x.row(begins[static_cast<std::size_t>(i)]), sizes_.width, memory.first.row(i));
  attention_.project(memory.first, x, memory);
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    const RowSpan keys = sequenceOf(begins, i);
    attention_.attend({static_cast<std::int64_t>(i), 1, 1}, keys, memory);
    for (std::int64_t key = 0; key < keys.count; ++key) {
      float sum = 0.0f;
      for (std::int64_t head = 0; head < sizes_.heads; ++head)
        sum += memory.weights[static_cast<std::size_t>(head * paddedKeys(keys.count) + key)];
      attention.push_back(sum / static_cast<float>(sizes_.heads));
    }
  }
  finish(memory.first, memory);
}

PreNormAttention::PreNormAttention(const LayerWeights& weights, const std::string& name,
                                   const TransformerSizes& sizes)
    : norm_(weights, name + ".norm"), attention_(weights, name, sizes) {}

void PreNormAttention::attendSelf(const std::vector<RowSpan>& spans, const Rows& x,
                                  const Rows& position, TransformerMemory& memory) const {
  normalizeInto(norm_, x, memory);
  for (std::int64_t row = 0; position.rows() > 0 && row < x.rows(); ++row)
    addRow(position.row(row % position.rows()), position.stride(), memory.normed.row(row));
  attention_.project(memory.normed, memory.normed, memory);
  for (const RowSpan& span : spans) attention_.attend(span, span, memory);
  attention_.finish(memory);
  addRows(memory.change, x);
}

void PreNormAttention::attendTo(const Rows& context, const Rows& x,
                                TransformerMemory& memory) const {
  normalizeInto(norm_, x, memory);
  attention_.project(memory.normed, context, memory);
  attention_.attend({0, 1, x.rows()}, {0, 1, context.rows()}, memory);
  attention_.finish(memory);
  addRows(memory.change, x);
}

PreNormFeedForward::PreNormFeedForward(const LayerWeights& weights, const std::string& name)
    : norm_(weights, name + ".norm"), mix_(weights, name) {}

void PreNormFeedForward::apply(const Rows& x, TransformerMemory& memory) const {
  normalizeInto(norm_, x, memory);
  mix_.apply(memory.normed, memory);
  addRows(memory.change, x);
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
