// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What trains and what drives are two implementations of docs/pluto.md: with the same weights they
// must give the same plans and scores, relative to the largest, up to the rounding of float32.
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/pluto/training/pluto_trainer_network.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

using test::relativeDifference;
using testing::straight;
using testing::vehicleAt;

constexpr double kAgreement = 1e-4;

/// Random numbers in the place of a scene on a network of 40 lanes.
class PlutoNetworkTest : public ::testing::Test {
 protected:
  PlutoNetworkTest()
      : model_{{}, cdiff::testing::randomTensors(plutoTensors({}))},
        world_({}, network()),
        net_({}, 1) {
    net_.parameters().load(model_.weights, "random");
    net_.parameters().setTrained(false);
  }
  static map::RoadNetwork network() {
    std::vector<testing::LaneSpec> lanes;
    for (int i = 0; i < 40; ++i)
      lanes.push_back({"e" + std::to_string(i), straight(0.0, 7.0 * i, 60.0 + i, 7.0 * i + 20.0)});
    return testing::makeNetwork(lanes);
  }
  float draw(double size) { return static_cast<float>(size * random_.normal({}, next_++)); }
  PlutoPose pose() { return {draw(0.5), draw(0.5), draw(0.5)}; }

  PlutoExample example(std::size_t agents, std::size_t polygons, std::size_t lines) {
    PlutoExample made;
    made.world = &world_;
    made.futures.resize(agents);
    for (float& value : made.input.motion) value = draw(0.5);
    for (std::size_t i = 0; i < agents; ++i) {
      PlutoAgent& agent = made.input.agents.emplace_back();
      agent.pose = pose();
      agent.kind = static_cast<std::uint8_t>(i % kAgentKinds);
      for (float& value : agent.history) value = draw(0.5);
    }
    for (std::size_t i = 0; i < polygons; ++i) {
      PlutoPolygon& polygon = made.input.polygons.emplace_back();
      polygon.piece = static_cast<std::uint32_t>(i % world_.builder.pieces().all().size());
      polygon.pose = pose();
      polygon.internal = i % 2;
      polygon.on_route = i / 2 % 2;
      polygon.light = static_cast<std::uint8_t>(i % kLightStates);
      polygon.limit = draw(0.5);
    }
    for (std::size_t i = 0; i < lines; ++i) {
      PlutoLine& line = made.input.lines.emplace_back();
      line.pose = pose();
      line.points.resize((41 - 7 * i) * kLineChannels);  // of different lengths
      for (float& value : line.points) value = draw(0.5);
    }
    return made;
  }
  /// Largest relative difference of all outputs, the examples together in the trainer's network and
  /// each by itself in the other.
  void expectAgreement(const std::vector<const PlutoExample*>& examples,
                       inference::InstructionSet set) {
    PlutoNetwork ours(model_, world_.builder.pieces().all(), set);
    const PlutoNet::Features features = net_.forward(plutoBatch(examples, {}, at::kCPU));
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const auto row = static_cast<std::int64_t>(i);
      const PlutoOutput output = ours.forward(examples[i]->input);
      const auto count = static_cast<std::int64_t>(output.logits.size());
      const at::Tensor queries = features.queries[row].narrow(0, 0, count);
      EXPECT_LT(relativeDifference(output.features, learning::toVector(queries)), kAgreement) << i;
      EXPECT_LT(relativeDifference(output.logits, learning::toVector(net_.scores(queries))),
                kAgreement);
      std::vector<float> plans;
      for (const PlutoTrajectory& candidate : output.candidates)
        plans.insert(plans.end(), candidate.data(), candidate.data() + candidate.size());
      EXPECT_LT(relativeDifference(plans, learning::toVector(net_.trajectories(queries))),
                kAgreement);
      const std::vector<float> free(output.free.data(), output.free.data() + output.free.size());
      const at::Tensor own = features.tokens[row].narrow(0, 0, 1);
      EXPECT_LT(relativeDifference(free, learning::toVector(net_.freePlans(own))), kAgreement);
    }
  }

  core::RandomStream random_{5, "scene"};
  std::uint32_t next_ = 0;
  PlutoModel model_;
  PlutoWorld world_;
  PlutoNet net_;
};

TEST_F(PlutoNetworkTest, AgreesWithTheTrainersNetwork) {
  const PlutoExample full = example(24, 60, 4);
  const PlutoExample small = example(3, 11, 2);
  expectAgreement({&full, &small}, inference::bestInstructionSet());
  expectAgreement({&full, &small}, inference::InstructionSet::kPlain);
}

TEST_F(PlutoNetworkTest, AgreesWithoutNeighborsAndWithoutLanes) {
  const PlutoExample alone = example(0, 30, 1);
  const PlutoExample nowhere = example(5, 0, 1);
  const PlutoExample nothing = example(0, 0, 1);
  expectAgreement({&alone, &nowhere, &nothing}, inference::bestInstructionSet());
  expectAgreement({&nothing}, inference::bestInstructionSet());
}

}  // namespace
}  // namespace cdiff::planners
