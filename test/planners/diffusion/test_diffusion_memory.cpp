// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/diffusion/diffusion_memory.h"

namespace cdiff::planners {
namespace {

/// A memory whose watch has seen an image with this first byte.
void see(std::uint64_t tick, std::uint8_t first, DiffusionMemory& memory) {
  const traffic::CameraImage image{2, 2, tick, {first, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};
  EXPECT_EQ(memory.watch.fault({2, 2, 1.0, 0.05}, &image, {}, tick), std::nullopt);
}

TEST(DiffusionMemory, TakesAnImageOnceAndEachOtherOne) {
  DiffusionMemory memory;
  see(0, 10, memory);
  EXPECT_TRUE(memory.takeImage());
  memory.features = {1.0F};
  see(2, 10, memory);
  EXPECT_FALSE(memory.takeImage()) << "the same picture";
  see(4, 20, memory);
  EXPECT_TRUE(memory.takeImage());
  see(6, 10, memory);
  EXPECT_TRUE(memory.takeImage()) << "no picture but the last is known";
}

TEST(DiffusionMemory, KeepsFeaturesAsFarBackAsTheModelLooks) {
  DiffusionMemory memory;
  for (std::uint64_t tick = 0; tick <= 12; tick += 2) {
    memory.features = {static_cast<float>(tick)};
    memory.keepFeatures(tick, 8);
  }
  ASSERT_NE(memory.featuresBefore(12, 8), nullptr);
  EXPECT_EQ(*memory.featuresBefore(12, 8), std::vector<float>{4.0F});
  EXPECT_EQ(memory.featuresBefore(12, 10), nullptr) << "forgotten";
  EXPECT_EQ(memory.featuresBefore(12, 5), nullptr) << "no decision";
  EXPECT_EQ(memory.featuresBefore(6, 8), nullptr) << "before the first tick";
}

TEST(DiffusionMemory, KeepsNoneForAModelOfOneImage) {
  DiffusionMemory memory;
  memory.features = {1.0F};
  memory.keepFeatures(2, 0);
  EXPECT_EQ(memory.featuresBefore(2, 0), nullptr);
  EXPECT_EQ(memory.featuresBefore(4, 2), nullptr);
}

}  // namespace
}  // namespace cdiff::planners
