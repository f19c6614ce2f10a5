// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "inference/transformer_layers.h"

namespace cdiff::inference {

// Layers of transformers with normalization first, on rows of several sequences: each adds to the
// rows what it computes of their layer normalization.

/// The rows of one sequence among others: first, first + step, ...
struct RowSpan {
  std::int64_t first = 0;
  std::int64_t step = 1;
  std::int64_t count = 0;
};

/// Memory that the layers share.
struct AttentionMemory {
  Rows normed;
  Rows query;
  Rows key_value;
  Rows mixed;  ///< output of attention
  Rows change;
  Rows hidden;
  std::vector<float> weights;
  AlignedFloats keys;
  std::int64_t keys_capacity = 0;
};

/// Where attention reads and writes: heads side by side in each row.
struct AttentionRows {
  View query;
  std::int64_t queries = 0;
  View key;
  View value;
  std::int64_t keys = 0;
  View output;
};

/// One call of the kernel with its scratch memory.
void attendRows(const TransformerKernels& kernels, const TransformerSizes& sizes,
                const AttentionRows& rows, AttentionMemory& memory);

/// y = W_2 max(0, LN(W_1 x + b_1)) + b_2 on each row, of the tensors NAME.in, NAME.norm and
/// NAME.out; the hidden width is a multiple of 16.
class Mlp {
 public:
  Mlp(const LayerWeights& weights, const std::string& name);
  void apply(const View& input, const View& output, std::int64_t rows, Rows& hidden) const;
  std::int64_t outputs() const { return out_.outputs(); }

 private:
  Linear in_;
  LayerNorm norm_;
  Linear out_;
  AlignedFloats zeros_;
};

/// x += W_o attention(LN(x) + position) (Vaswani et al. 2017, normalization first), of the tensors
/// NAME.norm, NAME.query, NAME.key_value (keys, then values) and NAME.output.
class PreNormAttention {
 public:
  PreNormAttention(const LayerWeights& weights, const std::string& name,
                   const TransformerSizes& sizes);

  /// Each span attends to itself. `position` is empty or has a row for each of the first
  /// position.rows() rows of x, repeated from there on.
  void attendSelf(const std::vector<RowSpan>& spans, const Rows& x, const Rows& position,
                  AttentionMemory& memory) const;
  /// All rows of x attend to those of `context`, which come normalized.
  void attendTo(const Rows& context, const Rows& x, AttentionMemory& memory) const;

 private:
  void addOutput(const Rows& x, AttentionMemory& memory) const;

  const TransformerKernels* kernels_;
  TransformerSizes sizes_;
  LayerNorm norm_;
  Linear query_;
  Linear key_value_;
  Linear output_;
  AlignedFloats zeros_;
};

/// x += W_2 gelu(W_1 LN(x)), of the tensors NAME.norm, NAME.up and NAME.down.
class PreNormFeedForward {
 public:
  PreNormFeedForward(const LayerWeights& weights, const std::string& name,
                     const TransformerSizes& sizes);
  void apply(const Rows& x, AttentionMemory& memory) const;

 private:
  const TransformerKernels* kernels_;
  TransformerSizes sizes_;
  LayerNorm norm_;
  Linear up_;
  Linear down_;
  AlignedFloats zeros_;
};

}  // namespace cdiff::inference
