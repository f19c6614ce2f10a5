// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Tensors of given shapes whose values come from a rule or a fixed stream.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "inference/safetensors.h"

namespace cdiff::test {

/// Element i is value(i).
template <class Value>
inference::Tensor tensorOf(const std::vector<std::int64_t>& shape, const Value& value) {
  std::uint32_t count = 1;
  for (const std::int64_t size : shape) count *= static_cast<std::uint32_t>(size);
  inference::Tensor tensor{shape, {}};
  for (std::uint32_t i = 0; i < count; ++i) tensor.values.push_back(static_cast<float>(value(i)));
  return tensor;
}

/// Uniform in [-bound, bound].
inline inference::Tensor uniformTensor(const std::string& name,
                                       const std::vector<std::int64_t>& shape, double bound) {
  const core::RandomStream random(5, name);
  return tensorOf(shape, [&](std::uint32_t i) { return random.uniform({0}, i, -bound, bound); });
}

inline std::map<std::string, inference::Tensor> uniformTensors(
    const std::vector<inference::TensorShape>& shapes, double bound) {
  std::map<std::string, inference::Tensor> tensors;
  for (const inference::TensorShape& shape : shapes)
    tensors[shape.name] = uniformTensor(shape.name, shape.shape, bound);
  return tensors;
}

}  // namespace cdiff::test
