// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "learning/parameters.h"

namespace cdiff::learning {

// Layers of networks with gradients; the tensors of inference/transformer_layers.h.

/// x [B, in] -> [B, out], as a convolution: Debian's libtorch has fast code for those only.
at::Tensor linear(const ParameterSet& parameters, const std::string& name, const at::Tensor& x);

/// The same for many rows, several times as fast: the rows are the pixels of one image, channels
/// last.
at::Tensor linearOfRows(const ParameterSet& parameters, const std::string& name,
                        const at::Tensor& x);

/// `linear` on the last axis of x.
at::Tensor dense(const ParameterSet& parameters, const std::string& name, const at::Tensor& x);

/// Layer normalization of the last axis.
at::Tensor layerNorm(const ParameterSet& parameters, const std::string& name, const at::Tensor& x);

/// inference::Mlp on the last axis.
at::Tensor mlp(const ParameterSet& parameters, const std::string& name, const at::Tensor& x);

/// Output of attention, and its weights.
struct Attended {
  at::Tensor mixed;    ///< [B, Q, width]
  at::Tensor weights;  ///< [B, heads, Q, K]
};
/// inference::attendRows of B sequences: query [B, Q, width], keys and values [B, K, 2 width]; the
/// mask [B, 1, 1, K], undefined where there is none, is added to the scores.
Attended attend(const at::Tensor& query, const at::Tensor& key_value, std::int64_t heads,
                const at::Tensor& mask);

}  // namespace cdiff::learning
