// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace cdiff::core {

/// 64-bit FNV-1a hash of a text; names streams and vehicles.
std::uint64_t hashText(std::string_view text);

/// Coordinates of a family of draws; the element index is given at the draw.
struct RandomKey {
  std::uint64_t vehicle = 0;         ///< `hashText` of the vehicle's id, or 0
  std::uint32_t decision = 0;        ///< decision cycle, or any other counter
  std::uint16_t diffusion_step = 0;  ///< diffusion step k, or 0
};

/// A named stream of random numbers of one root seed. Counter-based (Philox4x32-10, Salmon et al.
/// 2011): a draw is a pure function of (root seed, named stream, vehicle, decision, diffusion step,
/// element), so no draw depends on the order of others. Copyable, without state.
class RandomStream {
 public:
  /// The stream of this name: streams of one seed with different names are independent.
  RandomStream(std::uint64_t root_seed, std::string_view name);

  /// 64 random bits for one element.
  std::uint64_t bits(const RandomKey& key, std::uint32_t element) const;
  /// Uniform in [0, 1) with 53 bits.
  double uniform(const RandomKey& key, std::uint32_t element) const;
  /// Uniform in [low, high).
  double uniform(const RandomKey& key, std::uint32_t element, double low, double high) const;
  /// Standard normal (Box-Muller on two independent 53-bit uniforms of this element).
  double normal(const RandomKey& key, std::uint32_t element) const;
  /// Uniform integer in [0, count); `count` must be positive.
  std::size_t index(const RandomKey& key, std::uint32_t element, std::size_t count) const;

 private:
  std::uint64_t key_;
};

}  // namespace cdiff::core
