// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/attention_layers.h"

#include <algorithm>

namespace cdiff::inference {
namespace {

/// Nothing to add to any row.
View none(const AlignedFloats& zeros) { return {zeros.data(), 0}; }

void addRows(const Rows& change, const Rows& x) {
  for (std::int64_t row = 0; row < x.rows(); ++row) {
    const float* from = change.row(row);
    float* to = x.row(row);
    for (std::int64_t i = 0; i < x.stride(); ++i) to[i] += from[i];
  }
}

View spanView(const Rows& rows, const RowSpan& span, std::int64_t channel = 0) {
  return {rows.row(span.first) + channel, span.step * rows.stride()};
}

}  // namespace

void attendRows(const TransformerKernels& kernels, const TransformerSizes& sizes,
                const AttentionRows& rows, AttentionMemory& memory) {
  const std::int64_t head_width = sizes.width / sizes.heads;
  const std::int64_t padded = paddedKeys(rows.keys);
  memory.weights.resize(static_cast<std::size_t>(sizes.heads * rows.queries * padded));
  if (head_width * padded > memory.keys_capacity) {
    memory.keys_capacity = head_width * padded;
    memory.keys = AlignedFloats(memory.keys_capacity);
  }
  AttentionCall call;
  call.heads = sizes.heads;
  call.head_width = head_width;
  call.queries = rows.queries;
  call.keys = rows.keys;
  call.query = rows.query;
  call.key = rows.key;
  call.value = rows.value;
  call.output = rows.output;
  call.weights = memory.weights.data();
  call.scratch = memory.keys.data();
  kernels.attend(call);
}

Mlp::Mlp(const LayerWeights& weights, const std::string& name)
    : in_(weights, name + ".in"),
      norm_(weights, name + ".norm"),
      out_(weights, name + ".out"),
      zeros_(in_.outputs()) {}

void Mlp::apply(const View& input, const View& output, std::int64_t rows, Rows& hidden) const {
  hidden.resize(rows, in_.outputs());
  in_.apply(input, hidden.view(), rows);
  norm_.apply(hidden.view(), none(zeros_), hidden.view(), rows);
  float* values = hidden.row(0);
  for (std::int64_t i = 0; i < rows * hidden.stride(); ++i) values[i] = std::max(0.0F, values[i]);
  out_.apply(hidden.view(), output, rows);
}

PreNormAttention::PreNormAttention(const LayerWeights& weights, const std::string& name,
                                   const TransformerSizes& sizes)
    : kernels_(&weights.kernels),
      sizes_(sizes),
      norm_(weights, name + ".norm"),
      query_(weights, name + ".query"),
      key_value_(weights, name + ".key_value"),
      output_(weights, name + ".output"),
      zeros_(sizes.width) {}

void PreNormAttention::attendSelf(const std::vector<RowSpan>& spans, const Rows& x,
                                  const Rows& position, AttentionMemory& memory) const {
  const std::int64_t rows = x.rows();
  memory.normed.resize(rows, sizes_.width);
  memory.query.resize(rows, sizes_.width);
  memory.key_value.resize(rows, 2 * sizes_.width);
  memory.mixed.resize(rows, sizes_.width);
  norm_.apply(x.view(), none(zeros_), memory.normed.view(), rows);
  for (std::int64_t row = 0; position.rows() > 0 && row < rows; ++row) {
    const float* added = position.row(row % position.rows());
    float* to = memory.normed.row(row);
    for (std::int64_t i = 0; i < sizes_.width; ++i) to[i] += added[i];
  }
  query_.apply(memory.normed.view(), memory.query.view(), rows);
  key_value_.apply(memory.normed.view(), memory.key_value.view(), rows);
  for (const RowSpan& span : spans) {
    attendRows(
        *kernels_, sizes_,
        {spanView(memory.query, span), span.count, spanView(memory.key_value, span),
         spanView(memory.key_value, span, sizes_.width), span.count, spanView(memory.mixed, span)},
        memory);
  }
  addOutput(x, memory);
}

void PreNormAttention::attendTo(const Rows& context, const Rows& x, AttentionMemory& memory) const {
  const std::int64_t rows = x.rows();
  memory.normed.resize(rows, sizes_.width);
  memory.query.resize(rows, sizes_.width);
  memory.key_value.resize(context.rows(), 2 * sizes_.width);
  memory.mixed.resize(rows, sizes_.width);
  norm_.apply(x.view(), none(zeros_), memory.normed.view(), rows);
  query_.apply(memory.normed.view(), memory.query.view(), rows);
  key_value_.apply(context.view(), memory.key_value.view(), context.rows());
  attendRows(*kernels_, sizes_,
             {memory.query.view(), rows, memory.key_value.view(),
              memory.key_value.view(0, sizes_.width), context.rows(), memory.mixed.view()},
             memory);
  addOutput(x, memory);
}

void PreNormAttention::addOutput(const Rows& x, AttentionMemory& memory) const {
  memory.change.resize(x.rows(), sizes_.width);
  output_.apply(memory.mixed.view(), memory.change.view(), x.rows());
  addRows(memory.change, x);
}

PreNormFeedForward::PreNormFeedForward(const LayerWeights& weights, const std::string& name,
                                       const TransformerSizes& sizes)
    : kernels_(&weights.kernels),
      sizes_(sizes),
      norm_(weights, name + ".norm"),
      up_(weights, name + ".up"),
      down_(weights, name + ".down"),
      zeros_(sizes.width) {}

void PreNormFeedForward::apply(const Rows& x, AttentionMemory& memory) const {
  const std::int64_t rows = x.rows();
  memory.normed.resize(rows, sizes_.width);
  memory.hidden.resize(rows, sizes_.hidden);
  memory.change.resize(rows, sizes_.width);
  norm_.apply(x.view(), none(zeros_), memory.normed.view(), rows);
  up_.apply(memory.normed.view(), memory.hidden.view(), rows);
  kernels_->gelu(memory.hidden.row(0), rows * memory.hidden.stride());
  down_.apply(memory.hidden.view(), memory.change.view(), rows);
  addRows(memory.change, x);
}

}  // namespace cdiff::inference
