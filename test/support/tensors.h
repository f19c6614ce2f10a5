// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Tensors of given shapes whose values come from a rule or a fixed stream, and how far two are
/// apart.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

/// Largest difference relative to the largest value.
inline double relativeDifference(const std::vector<float>& ours,
                                 const std::vector<float>& reference) {
  EXPECT_EQ(ours.size(), reference.size());
  double largest = 0.0;
  double apart = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(reference[i])));
    apart = std::max(apart, std::abs(static_cast<double>(ours[i]) - reference[i]));
  }
  return apart / largest;
}

}  // namespace cdiff::test
