// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/core/random.h"

#include <array>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::core {
namespace {

using Counter = std::array<std::uint32_t, 4>;

constexpr std::uint32_t kMultiplier0 = 0xD2511F53;
constexpr std::uint32_t kMultiplier1 = 0xCD9E8D57;
constexpr std::uint32_t kWeyl0 = 0x9E3779B9;
constexpr std::uint32_t kWeyl1 = 0xBB67AE85;

Counter philox(Counter counter, std::uint32_t key0, std::uint32_t key1) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = std::uint64_t{kMultiplier0} * counter[0];
    const std::uint64_t product1 = std::uint64_t{kMultiplier1} * counter[2];
    counter = {static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key0,
               static_cast<std::uint32_t>(product1),
               static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key1,
               static_cast<std::uint32_t>(product0)};
    key0 += kWeyl0;
    key1 += kWeyl1;
  }
  return counter;
}

double toUniform(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; }

Counter draw(std::uint64_t stream_key, const RandomKey& key, std::uint32_t element) {
  const std::uint64_t mixed_key = stream_key ^ (key.vehicle * 0x9E3779B97F4A7C15ULL) ^
                                  (std::uint64_t{key.diffusion_step} << 48);
  const Counter counter = {element, key.decision, static_cast<std::uint32_t>(key.vehicle),
                           static_cast<std::uint32_t>(key.vehicle >> 32) ^ key.diffusion_step};
  return philox(counter, static_cast<std::uint32_t>(mixed_key),
                static_cast<std::uint32_t>(mixed_key >> 32));
}

std::uint64_t join(std::uint32_t high, std::uint32_t low) {
  return (std::uint64_t{high} << 32) | low;
}

}  // namespace

std::uint64_t hashText(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const char character : text) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001B3ULL;
  }
  return hash;
}

RandomStream::RandomStream(std::uint64_t root_seed, std::string_view name) {
  const std::uint64_t name_hash = hashText(name);
  const Counter mixed = philox(
      {static_cast<std::uint32_t>(root_seed), static_cast<std::uint32_t>(root_seed >> 32), 0, 0},
      static_cast<std::uint32_t>(name_hash), static_cast<std::uint32_t>(name_hash >> 32));
  key_ = join(mixed[0], mixed[1]);
}

std::uint64_t RandomStream::bits(const RandomKey& key, std::uint32_t element) const {
  const Counter drawn = draw(key_, key, element);
  return join(drawn[0], drawn[1]);
}

double RandomStream::uniform(const RandomKey& key, std::uint32_t element) const {
  return toUniform(bits(key, element));
}

double RandomStream::uniform(const RandomKey& key, std::uint32_t element, double low,
                             double high) const {
  return low + (high - low) * uniform(key, element);
}

double RandomStream::normal(const RandomKey& key, std::uint32_t element) const {
  const Counter drawn = draw(key_, key, element);
  const double radius = std::sqrt(-2.0 * std::log(1.0 - toUniform(join(drawn[0], drawn[1]))));
  return radius * std::cos(2.0 * kPi * toUniform(join(drawn[2], drawn[3])));
}

std::size_t RandomStream::index(const RandomKey& key, std::uint32_t element,
                                std::size_t count) const {
  return static_cast<std::size_t>(uniform(key, element) * static_cast<double>(count));
}

}  // namespace cdiff::core
