// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/random.h"
#include "learning/parameters.h"
#include "planners/camera_ego/training/map_reading.h"

namespace cdiff::planners {
namespace {

at::Tensor drawn(const std::string& name, at::IntArrayRef shape, double bound) {
  const core::RandomStream random(3, name);
  std::int64_t count = 1;
  for (const std::int64_t size : shape) count *= size;
  std::vector<float> values;
  for (std::int64_t i = 0; i < count; ++i)
    values.push_back(
        static_cast<float>(random.uniform({}, static_cast<std::uint32_t>(i), -bound, bound)));
  return learning::toTensor(values, shape, at::kCPU);
}

/// Two samples with two maps of 4 x 5 cells and three queries: one reads both maps with different
/// blocks, one reads one of them, one none.
class MapReadingTest : public ::testing::Test {
 protected:
  MapReadingTest() {
    for (int sample = 0; sample < 2; ++sample) {
      auto plan = std::make_shared<inference::SamplingPlan>();
      plan->queries = 3;
      plan->points = reading_.sizes.points;
      plan->visit(0, 0, 0);
      plan->visit(0, 1, 1);
      plan->visit(2, 1, 0);
      const float places[] = {0.3F, 1.2F, 2.4F,  0.9F, 4.4F, 3.1F,
                              1.5F, 1.6F, -0.4F, 0.7F, 2.2F, 3.4F};
      for (const float place : places)
        plan->references.push_back(place + 0.3F * static_cast<float>(sample));
      plan->finish();
      reading_.plans.push_back(plan);
    }
  }

  BatchReading reading_{{8, 2, 2, 2}, {4, 5}, 2, {}};
  at::Tensor values_ = drawn("values", {2 * 2 * 20, 8}, 1.0);
  at::Tensor offsets_ = drawn("offsets", {6, 16}, 0.8);
  at::Tensor weights_ = drawn("weights", {6, 8}, 1.0);
};

TEST_F(MapReadingTest, EqualsTheGridSampleOfLibtorch) {
  const at::Tensor ours = readMapsOf(reading_, values_, offsets_, weights_);
  const at::Tensor theirs = readMapsByGridSample(reading_, values_, offsets_, weights_);
  EXPECT_GT(theirs.abs().max().item<double>(), 0.1);
  EXPECT_LT((ours - theirs).abs().max().item<double>(), 1e-5);
  EXPECT_EQ(ours[1].abs().max().item<double>(), 0.0) << "a query without a visit reads nothing";
}

TEST_F(MapReadingTest, ItsGradientsEqualThoseOfLibtorch) {
  const at::Tensor pull = drawn("pull", {6, 8}, 1.0);
  std::vector<std::vector<at::Tensor>> gradients;
  for (const auto& read : {readMapsOf, readMapsByGridSample}) {
    std::vector<at::Tensor> inputs;
    for (const at::Tensor& input : {values_, offsets_, weights_})
      inputs.push_back(input.clone().set_requires_grad(true));
    (read(reading_, inputs[0], inputs[1], inputs[2]) * pull).sum().backward();
    gradients.emplace_back();
    for (const at::Tensor& input : inputs) gradients.back().push_back(input.grad());
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(gradients[1][i].abs().max().item<double>(), 0.1) << i;
    EXPECT_LT((gradients[0][i] - gradients[1][i]).abs().max().item<double>(), 1e-5) << i;
  }
}

// One query, one head, one point at column 0.25 of a row of two cells worth 4 and 8: 0.75 x 4 +
// 0.25 x 8 = 5, of which a weight of 0.5 leaves 2.5.
TEST(MapReading, IsBilinear) {
  auto plan = std::make_shared<inference::SamplingPlan>();
  plan->queries = 1;
  plan->points = 1;
  plan->visit(0, 0);
  plan->references = {0.0F, 0.0F};
  plan->finish();
  const BatchReading reading{{1, 1, 1, 1}, {1, 2}, 1, {plan}};
  const at::Tensor read = readMapsOf(reading, learning::toTensor({4.0F, 8.0F}, {2, 1}, at::kCPU),
                                     learning::toTensor({0.25F, 0.0F}, {1, 2}, at::kCPU),
                                     learning::toTensor({0.5F}, {1, 1}, at::kCPU));
  EXPECT_FLOAT_EQ(read.item<float>(), 2.5F);
}

}  // namespace
}  // namespace cdiff::planners
