// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/random.h"
#include "planners/plant/training/plant_trainer_network.h"

namespace cdiff::planners {
namespace {

/// Vehicles and segments drawn from a stream; `vehicles` and `segments` of each.
PlantExample drawnExample(std::uint64_t number, std::size_t vehicles, std::size_t segments) {
  const core::RandomStream random(9, "plant example");
  std::uint32_t element = 0;
  const auto token = [&] {
    PlantToken values;
    for (float& value : values)
      value = static_cast<float>(random.uniform({number}, element++, -1.0, 1.0));
    return values;
  };
  PlantExample example;
  for (std::size_t i = 0; i < vehicles; ++i) {
    example.input.vehicles.push_back(token());
    example.next.push_back({1, 2, 3, 4, 5, 6});
  }
  for (std::size_t i = 0; i < segments; ++i) example.input.route.push_back(token());
  example.input.red_light = number % 2 == 0;
  example.input.target = {0.4F, 0.1F * static_cast<float>(number)};
  for (std::size_t i = 0; i < 4; ++i) example.driven[i] = {4.0 * static_cast<double>(i + 1), 0.0};
  return example;
}

/// Larger weights than those at the start, so that attention differs and errors would show.
PlantNet drawnNet(const PlantArchitecture& architecture) {
  PlantNet net(architecture, 7);
  for (at::Tensor& tensor : net.parameters().tensors()) tensor.mul_(1.5);
  return net;
}

void expectSameOutputs(inference::InstructionSet set) {
  const PlantArchitecture architecture;  // the real sizes
  const PlantNet net = drawnNet(architecture);
  PlantNetwork network({architecture, net.parameters().values()}, set);
  std::vector<PlantExample> examples = {drawnExample(0, 24, 2), drawnExample(1, 0, 0),
                                        drawnExample(2, 3, 1), drawnExample(3, 17, 2)};
  std::vector<const PlantExample*> views;
  std::vector<PlantInput> inputs;
  for (const PlantExample& example : examples) {
    views.push_back(&example);
    inputs.push_back(example.input);
  }
  const at::NoGradGuard no_gradient;
  const PlantNet::Result expected = net.forward(plantBatch(views, at::kCPU));
  const std::vector<PlantOutput> found = network.forward(inputs);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto moment = static_cast<std::int64_t>(i);
    for (std::int64_t n = 0; n < kPlantWaypoints; ++n) {
      for (std::int64_t axis = 0; axis < 2; ++axis)
        EXPECT_NEAR(found[i].waypoints[static_cast<std::size_t>(n)][axis],
                    expected.waypoints[moment][n][axis].item<double>(), 1e-4);
    }
    ASSERT_EQ(found[i].attention.size(), inputs[i].vehicles.size());
    for (std::size_t v = 0; v < found[i].attention.size(); ++v)
      EXPECT_NEAR(static_cast<double>(found[i].attention[v]),
                  expected.attention[moment][static_cast<std::int64_t>(v) + 1].item<double>(),
                  1e-5);
  }
}

TEST(PlantNet, IsTheFunctionThatThePlannerComputes) {
  for (const auto set : {inference::InstructionSet::kPlain, inference::InstructionSet::kAvx2,
                         inference::InstructionSet::kAvx512}) {
    if (set > inference::bestInstructionSet()) continue;
    SCOPED_TRACE(inference::toText(set));
    expectSameOutputs(set);
  }
}

TEST(PlantNet, DeclaresTheTensorsOfTheWeightFile) {
  const PlantArchitecture architecture;
  const PlantNet net(architecture, 1);
  const auto values = net.parameters().values();
  const auto expected = plantTensors(architecture);
  ASSERT_EQ(values.size(), expected.size());
  for (const inference::TensorShape& tensor : expected)
    EXPECT_EQ(values.at(tensor.name).shape, tensor.shape) << tensor.name;
}

// A moment's waypoints do not depend on how much padding a longer one beside it causes.
TEST(PlantNet, PaddingDoesNotCount) {
  PlantArchitecture architecture;
  architecture.layers = 2;
  const PlantNet net = drawnNet(architecture);
  const PlantExample few = drawnExample(1, 2, 1), many = drawnExample(2, 20, 2);
  const at::NoGradGuard no_gradient;
  const at::Tensor alone = net.forward(plantBatch({&few}, at::kCPU)).waypoints[0];
  const at::Tensor beside = net.forward(plantBatch({&few, &many}, at::kCPU)).waypoints[0];
  // As near as float32 brings places of some 10 m.
  EXPECT_LT((alone - beside).abs().max().item<double>(), 1e-4);
}

TEST(PlantNet, VehiclesAreASet) {
  PlantArchitecture architecture;
  architecture.layers = 2;
  const PlantNet net = drawnNet(architecture);
  const PlantExample example = drawnExample(1, 5, 2);
  PlantExample turned = example;
  std::reverse(turned.input.vehicles.begin(), turned.input.vehicles.end());
  const at::NoGradGuard no_gradient;
  const at::Tensor difference = net.forward(plantBatch({&example}, at::kCPU)).waypoints -
                                net.forward(plantBatch({&turned}, at::kCPU)).waypoints;
  EXPECT_LT(difference.abs().max().item<double>(), 1e-4);
}

TEST(PlantNet, VehiclesThatAreGonePredictNothing) {
  PlantArchitecture architecture;
  architecture.layers = 1;
  const PlantNet net(architecture, 1);
  PlantExample example = drawnExample(1, 3, 2);
  example.next[1].fill(kNoBin);
  const PlantBatch batch = plantBatch({&example}, at::kCPU);
  EXPECT_EQ(batch.places.numel(), 2);
  EXPECT_EQ(batch.places[1].item<std::int64_t>(), 3) << "CLS, then vehicles 0, 1 and 2";
  const PlantNet::Result result = net.forward(batch);
  for (std::size_t i = 0; i < kPlantBins.size(); ++i) {
    EXPECT_EQ(result.next[i].size(0), 2);
    EXPECT_EQ(result.next[i].size(1), kPlantBins[i]);
  }
}

}  // namespace
}  // namespace cdiff::planners
