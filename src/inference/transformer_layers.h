// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "inference/convolution.h"
#include "inference/instruction_set.h"

namespace cdiff::inference {

// Layers of transformers and recurrent heads at run time, float32, on the kernels of one
// instruction set. Rows of several sequences lie one after the other; what comes out of a row is
// the same to the last bit whatever lies in the other sequences.

/// What layers are built from; all must outlive them but the tensors.
struct LayerWeights {
  const DenoiserKernels& linear;
  const TransformerKernels& kernels;
  const std::map<std::string, Tensor>& tensors;

  LayerWeights(InstructionSet set, const std::map<std::string, Tensor>& weights)
      : linear(denoiserKernels(set)), kernels(transformerKernels(set)), tensors(weights) {}
  /// Throws InputError naming the tensor when there is none.
  const Tensor& named(const std::string& name) const;
};

/// Rows x channels of float32 in memory of its own, channels padded to kChannelMultiple with zeros.
class Rows {
 public:
  Rows() = default;
  /// Makes room; what was there is lost unless only the count of rows falls.
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

 private:
  const TransformerKernels* kernels_;
  std::int64_t channels_;
  AlignedFloats gain_;
  AlignedFloats shift_;
};

/// Sizes of a transformer's encoder: width and hidden are multiples of 16, width / heads is, too.
struct TransformerSizes {
  std::int64_t width = 256;
  std::int64_t heads = 8;
  std::int64_t hidden = 1024;  ///< of the feed-forward network
};

/// Memory that the layers of a network share.
struct TransformerMemory {
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

/// A layer of a transformer's encoder, normalization last (Vaswani et al. 2017, as BERT has it):
/// x = LN(x + W_o attention(x)), x = LN(x + W_2 gelu(W_1 x)). Tensors: NAME.query, NAME.key_value
/// (keys, then values), NAME.output, NAME.norm1, NAME.up, NAME.down, NAME.norm2.
class TransformerLayer {
 public:
  TransformerLayer(const LayerWeights& weights, const std::string& name,
                   const TransformerSizes& sizes);

  /// In place; `begins`: the first row of each sequence, then the count of all rows.
  void forward(const std::vector<std::int64_t>& begins, const Rows& x,
               TransformerMemory& memory) const;
  /// The first row of each sequence alone, to memory.first; the mean over heads of the weights by
  /// which it attends to its sequence's rows comes to `attention`, sequence after sequence.
  void forwardFirst(const std::vector<std::int64_t>& begins, const Rows& x,
                    TransformerMemory& memory, std::vector<float>& attention) const;

 private:
  /// Attention of `count` queries that start at `query` to a sequence.
  void attend(const View& query, std::int64_t count, std::int64_t begin, std::int64_t end,
              std::int64_t output, TransformerMemory& memory) const;
  void finish(const View& x, std::int64_t rows, TransformerMemory& memory) const;

  const TransformerKernels* kernels_;
  TransformerSizes sizes_;
  Linear query_;
  Linear key_value_;
  Linear output_;
  LayerNorm norm1_;
  Linear up_;
  Linear down_;
  LayerNorm norm2_;
};

/// A gated recurrent unit (Cho et al. 2014, with the reset gate behind the matrix as libtorch has
/// it): r, z = sigmoid(W_i x + b_i + W_h h + b_h), n = tanh(W_i x + b_i + r (W_h h + b_h)),
/// h' = (1 - z) n + z h. Tensors NAME.input and NAME.state with the rows of r, z, n.
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
