// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "inference/convolution.h"
#include "inference/instruction_set.h"

namespace cdiff::inference {

// Layers of transformers and recurrent heads at run time, float32, on the kernels of one
// instruction set. Rows of several sequences are stored one after the other; the result for a row
// is the same to the last bit whatever the other sequences hold.

/// What layers are built from. The kernels must outlive the layers; the tensors need not, they are
/// copied.
struct LayerWeights {
  const DenoiserKernels& linear;
  const TransformerKernels& kernels;
  const std::map<std::string, Tensor>& tensors;

  LayerWeights(InstructionSet set, const std::map<std::string, Tensor>& weights)
      : linear(denoiserKernels(set)), kernels(transformerKernels(set)), tensors(weights) {}
  /// Throws InputError naming the tensor when there is none.
  const Tensor& named(const std::string& name) const;
};

/// Collects names and shapes of the tensors that layers are built from.
class TensorList {
 public:
  void add(const std::string& name, const std::vector<std::int64_t>& shape) {
    tensors_.push_back({name, shape});
  }
  /// NAME.weight and NAME.bias [out]: [out, in] of a Linear, or [out, in, taps].
  void layer(const std::string& name, const std::vector<std::int64_t>& shape);
  void norm(const std::string& name, std::int64_t channels) { layer(name, {channels}); }
  void mlp(const std::string& name, std::int64_t in, std::int64_t hidden, std::int64_t out);
  /// The tensors of a MultiHeadAttention.
  void attention(const std::string& name, std::int64_t width);
  void feedForward(const std::string& name, std::int64_t width, std::int64_t hidden);
  std::vector<TensorShape> take() { return std::move(tensors_); }

 private:
  std::vector<TensorShape> tensors_;
};

/// A float32 matrix [rows, channels] that owns its memory; channels are padded with zeros to a
/// multiple of kChannelMultiple.
class Rows {
 public:
  Rows() = default;
  /// Makes room; the content is lost unless only the number of rows decreases.
  void resize(std::int64_t rows, std::int64_t channels);
  View view(std::int64_t row = 0, std::int64_t channel = 0) const {
    return {values_.data() + row * stride_ + channel, stride_};
  }
  float* row(std::int64_t index) const { return values_.data() + index * stride_; }
  std::int64_t rows() const { return rows_; }
  std::int64_t stride() const { return stride_; }

 private:
  AlignedFloats values_;
  std::int64_t capacity_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t stride_ = 0;
};

/// Adds `count` values element by element: to += from.
inline void addRow(const float* from, std::int64_t count, float* to) {
  for (std::int64_t i = 0; i < count; ++i) to[i] += from[i];
}

/// y = W x + b on each row, of the tensors NAME.weight [out, in] and NAME.bias [out].
class Linear {
 public:
  Linear(const LayerWeights& weights, const std::string& name);
  void apply(const View& input, const View& output, std::int64_t rows) const {
    convolution_.apply(input, output, rows);
  }
  std::int64_t outputs() const { return outputs_; }

 private:
  std::int64_t outputs_;
  Convolution convolution_;
};

/// output = LayerNorm(input + added) (Ba et al. 2016, epsilon 1e-5), of the tensors NAME.weight and
/// NAME.bias [channels], a multiple of kChannelMultiple.
class LayerNorm {
 public:
  LayerNorm(const LayerWeights& weights, const std::string& name);
  void apply(const View& input, const View& added, const View& output, std::int64_t rows) const;
  /// output = LayerNorm(input).
  void apply(const View& input, const View& output, std::int64_t rows) const {
    apply(input, {zeros_.data(), 0}, output, rows);
  }

 private:
  const TransformerKernels* kernels_;
  std::int64_t channels_;
  AlignedFloats gain_;
  AlignedFloats shift_;
  AlignedFloats zeros_;
};

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
};

/// Sizes of a transformer's layers: width and hidden are multiples of 16, width / heads is, too.
struct TransformerSizes {
  std::int64_t width = 256;
  std::int64_t heads = 8;
  std::int64_t hidden = 1024;  ///< of the feed-forward network

  /// Throws InputError naming the key that is not such a multiple.
  void validate() const;
};

/// Scratch buffers that the layers of a network share.
struct TransformerMemory {
  Rows normed;
  Rows query;
  Rows key_value;
  Rows mixed;   ///< output of attention
  Rows change;  ///< what is added to the tokens
  Rows hidden;
  Rows first;  ///< the first row of each sequence
  std::vector<float> weights;
  AlignedFloats keys;
  std::int64_t keys_capacity = 0;
};

/// The rows of one sequence among others: first, first + step, ...
struct RowSpan {
  std::int64_t first = 0;
  std::int64_t step = 1;
  std::int64_t count = 0;
};

/// Scaled dot-product attention of several heads (Vaswani et al. 2017) between rows that are
/// already projected: the rows `queries` of memory.query attend to the rows `keys` of
/// memory.key_value (keys, then values). Writes memory.weights, and memory.mixed at `queries`; both
/// must have been resized.
void attendRows(const TransformerKernels& kernels, const TransformerSizes& sizes,
                const RowSpan& queries, const RowSpan& keys, TransformerMemory& memory);

/// W_o attention(W_q x, W_kv context), of the tensors NAME.query, NAME.key_value (keys, then
/// values) and NAME.output: `project`, `attend` for each sequence, `finish`.
class MultiHeadAttention {
 public:
  MultiHeadAttention(const LayerWeights& weights, const std::string& name,
                     const TransformerSizes& sizes);
  /// memory.query of the rows of x, and memory.key_value of those of `context`.
  void project(const Rows& x, const Rows& context, TransformerMemory& memory) const;
  void attend(const RowSpan& queries, const RowSpan& keys, TransformerMemory& memory) const {
    attendRows(*kernels_, sizes_, queries, keys, memory);
  }
  /// memory.change of memory.mixed.
  void finish(TransformerMemory& memory) const;

 private:
  const TransformerKernels* kernels_;
  TransformerSizes sizes_;
  Linear query_;
  Linear key_value_;
  Linear output_;
};

/// memory.change = W_2 gelu(W_1 x), of the tensors NAME.up and NAME.down.
class FeedForward {
 public:
  FeedForward(const LayerWeights& weights, const std::string& name);
  void apply(const Rows& x, TransformerMemory& memory) const;

 private:
  const TransformerKernels* kernels_;
  Linear up_;
  Linear down_;
};

/// A layer of a transformer's encoder, normalization last (Vaswani et al. 2017, as in BERT):
/// x = LN(x + W_o attention(x)), x = LN(x + W_2 gelu(W_1 x)). Tensors: NAME.query, NAME.key_value
/// (keys, then values), NAME.output, NAME.norm1, NAME.up, NAME.down, NAME.norm2.
class TransformerLayer {
 public:
  TransformerLayer(const LayerWeights& weights, const std::string& name,
                   const TransformerSizes& sizes);

  /// In place; `begins`: the first row of each sequence, then the number of all rows.
  void forward(const std::vector<std::int64_t>& begins, const Rows& x,
               TransformerMemory& memory) const;
  /// Only the first row of each sequence, written to memory.first; `attention` receives the weights
  /// with which it attends to the rows of its sequence, averaged over heads, sequence after
  /// sequence.
  void forwardFirst(const std::vector<std::int64_t>& begins, const Rows& x,
                    TransformerMemory& memory, std::vector<float>& attention) const;

 private:
  void finish(const Rows& x, TransformerMemory& memory) const;

  TransformerSizes sizes_;
  MultiHeadAttention attention_;
  LayerNorm norm1_;
  FeedForward mix_;
  LayerNorm norm2_;
};

/// Normalization first: x += W_o attention(LN(x) + position), of the tensors NAME.norm,
/// NAME.query, NAME.key_value and NAME.output.
class PreNormAttention {
 public:
  PreNormAttention(const LayerWeights& weights, const std::string& name,
                   const TransformerSizes& sizes);

  /// Each span attends to itself. `position` is empty or has a row for each of the first
  /// position.rows() rows of x, repeated from there on.
  void attendSelf(const std::vector<RowSpan>& spans, const Rows& x, const Rows& position,
                  TransformerMemory& memory) const;
  /// All rows of x attend to those of `context`, which are already normalized.
  void attendTo(const Rows& context, const Rows& x, TransformerMemory& memory) const;

 private:
  LayerNorm norm_;
  MultiHeadAttention attention_;
};

/// Normalization first: x += W_2 gelu(W_1 LN(x)), of the tensors NAME.norm, NAME.up and NAME.down.
class PreNormFeedForward {
 public:
  PreNormFeedForward(const LayerWeights& weights, const std::string& name);
  void apply(const Rows& x, TransformerMemory& memory) const;

 private:
  LayerNorm norm_;
  FeedForward mix_;
};

/// A gated recurrent unit (Cho et al. 2014, with the reset gate applied after the matrix product,
/// as in libtorch): r, z = sigmoid(W_i x + b_i + W_h h + b_h), n = tanh(W_i x + b_i + r (W_h h +
/// b_h)), h' = (1 - z) n + z h. Tensors NAME.input and NAME.state with the rows of r, z, n.
class GruCell {
 public:
  GruCell(const LayerWeights& weights, const std::string& name);
  /// Replaces the states [rows, states] by their successors.
  void step(const Rows& input, const Rows& state);
  std::int64_t states() const { return states_; }

 private:
  Linear input_;
  Linear state_;
  std::int64_t states_;
  Rows of_input_;
  Rows of_state_;
};

}  // namespace cdiff::inference
