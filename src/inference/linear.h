// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Linear layers on matrices, as convolutions of one tap over their rows.
#pragma once

#include <string>

#include "inference/unet_layers.h"

namespace cdiff::inference {

inline Convolution linearNamed(const DenoiserKernels& kernels, const Tensors& tensors,
                               const std::string& name) {
  return Convolution(kernels, Filter::ofLinear(tensorNamed(tensors, name + ".weight")), Spacing{},
                     &tensorNamed(tensors, name + ".bias"));
}

/// The pull-back of a linear layer, or of some of its columns.
inline Convolution reversedLinear(const DenoiserKernels& kernels, const Filter& filter) {
  return Convolution(kernels, filter.transposed(), Spacing{});
}

}  // namespace cdiff::inference
