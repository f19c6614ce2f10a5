// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Linear layers on matrices, as convolutions of one tap over their rows.
#pragma once

#include <string>

#include "unet_layers.h"

namespace cdiff::diffusion {

inline float* rowOf(const Activation& matrix, std::int64_t row) {
  return matrix.view().data + row * matrix.channels();
}

inline Convolution linearNamed(const DenoiserKernels& kernels, const Tensors& tensors,
                               const std::string& name) {
  return Convolution(kernels, Filter::ofLinear(tensorNamed(tensors, name + ".weight")), Spacing{},
                     &tensorNamed(tensors, name + ".bias"));
}

/// The pull-back of the columns first .. first + inputs - 1 of a linear layer.
inline Convolution reversedLinear(const DenoiserKernels& kernels, const Filter& filter) {
  return Convolution(kernels, filter.transposed(), Spacing{});
}

}  // namespace cdiff::diffusion
