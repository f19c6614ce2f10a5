// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <iostream>

#include "planners/camera_ego/training/two_looks.h"
#include "planners/vad_mini/training/vad_mini_trainer_network.h"
#include "planners/vad_mini/vad_mini_network.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

using testing::TwoLooks;

VadMiniModel drawnModel() {
  VadMiniArchitecture architecture;
  return {architecture, cdiff::testing::randomTensors(vadMiniTensors(architecture))};
}

void expectNear(double found, const at::Tensor& expected, const char* what) {
  EXPECT_NEAR(found, expected.item<double>(),
              1e-4 * std::max(1.0, std::abs(expected.item<double>())))
      << what;
}

void expectSame(const VadMiniOutput& found, const VadMiniAnswer& expected) {
  for (std::size_t a = 0; a < found.agents.size(); ++a) {
    const auto i = static_cast<std::int64_t>(a);
    expectNear(found.agents[a].score, expected.agent_logits.back()[0][i][0], "score");
    for (std::int64_t n = 0; n < kBoxNumbers; ++n)
      expectNear(found.agents[a].box[static_cast<std::size_t>(n)], expected.boxes.back()[0][i][n],
                 "box");
    for (std::int64_t m = 0; m < kMotionModes; ++m) {
      for (std::int64_t k = 0; k < kEgoWaypoints; ++k) {
        const Eigen::Vector2d place =
            found.agents[a].ways[static_cast<std::size_t>(m)][static_cast<std::size_t>(k)];
        for (std::int64_t axis = 0; axis < 2; ++axis)
          expectNear(place[axis] - static_cast<double>(found.agents[a].box[axis == 0 ? 0 : 1]),
                     expected.ways[0][i][m][k][axis], "way");
      }
      expectNear(found.agents[a].way_scores[static_cast<std::size_t>(m)],
                 expected.way_logits[0][i][m], "way score");
    }
  }
  const at::Tensor lines = metersOfShares(BevGrid{}, expected.lines.back());
  for (std::size_t l = 0; l < found.lines.size(); ++l) {
    const auto i = static_cast<std::int64_t>(l);
    for (std::int64_t k = 0; k < kMapKinds; ++k)
      expectNear(found.lines[l].scores[static_cast<std::size_t>(k)],
                 expected.line_logits.back()[0][i][k], "line score");
    for (std::int64_t p = 0; p < kMapPoints; ++p) {
      const Eigen::Vector2d place = found.lines[l].points[static_cast<std::size_t>(p)];
      expectNear(place.x(), lines[0][i][p][0], "line");
      expectNear(place.y(), lines[0][i][p][1], "line");
    }
  }
  for (std::int64_t c = 0; c < kRoadCommands; ++c) {
    for (std::int64_t k = 0; k < kEgoWaypoints; ++k) {
      const Eigen::Vector2d place =
          found.plans[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)];
      expectNear(place.x(), expected.plans[0][c][k][0], "plan");
      expectNear(place.y(), expected.plans[0][c][k][1], "plan");
    }
  }
}

class VadMiniNetworks : public ::testing::TestWithParam<inference::InstructionSet> {};

TEST_P(VadMiniNetworks, IsTheFunctionThatThePlannerComputes) {
  if (GetParam() > inference::bestInstructionSet()) GTEST_SKIP() << "not on this processor";
  const VadMiniModel model = drawnModel();
  VadMiniNet net(model.architecture, 1);
  net.parameters().load(model.weights, "test");
  VadMiniNetwork network(model, GetParam());
  const TwoLooks looks;
  const at::NoGradGuard no_gradient;
  const BevGrid& bev = model.architecture.ego.bev;
  const at::Tensor past = net.bev().encode(looks.batch(bev, false), {});
  expectSame(network.forward(looks.input<VadMiniInput>(false)), net.answer(past, 1));
  inference::Rows kept;
  kept.resize(network.bev().rows(), model.architecture.ego.width);
  for (std::int64_t row = 0; row < kept.rows(); ++row)
    std::copy_n(network.bev().row(row), model.architecture.ego.width, kept.row(row));
  VadMiniInput second = looks.input<VadMiniInput>(true);
  second.past = &kept;
  expectSame(network.forward(second),
             net.answer(net.bev().encode(looks.batch(bev, true), past), 1));
}

TEST(VadMiniNetwork, KeepsTheBevOfItsImagesAlone) {
  const VadMiniModel model = drawnModel();
  const std::int64_t width = model.architecture.ego.width;
  VadMiniNetwork alone(model), with_past(model);
  const TwoLooks looks;
  alone.forward(looks.input<VadMiniInput>(false));
  VadMiniInput later = looks.input<VadMiniInput>(false);
  later.motion[2] = 0.5F;
  later.poses.past = geometry::Pose2d{{-3.0, 0.0}, 0.0};
  later.past = &alone.bev();
  with_past.forward(later);
  const auto valueOf = [&](const inference::Rows& bev) {
    return bev.row(bev.rows() / 2)[width / 2];
  };
  EXPECT_NE(valueOf(with_past.bev()), valueOf(alone.bev()));
  const inference::Rows& kept = with_past.bevAlone(later.motion);
  for (std::int64_t row = 0; row < kept.rows(); ++row)
    EXPECT_TRUE(std::equal(kept.row(row), kept.row(row) + width, alone.bev().row(row))) << row;
}

INSTANTIATE_TEST_SUITE_P(Sets, VadMiniNetworks,
                         ::testing::Values(inference::InstructionSet::kPlain,
                                           inference::InstructionSet::kAvx2,
                                           inference::InstructionSet::kAvx512));

TEST(VadMiniNetwork, AnswersTheSameBytesEveryTime) {
  const VadMiniModel model = drawnModel();
  VadMiniNetwork first(model), second(model);
  const TwoLooks looks;
  second.forward(looks.input<VadMiniInput>(true));  // whatever came before
  const auto one = first.forward(looks.input<VadMiniInput>(false)),
             other = second.forward(looks.input<VadMiniInput>(false));
  for (std::size_t c = 0; c < one.plans.size(); ++c) EXPECT_EQ(one.plans[c], other.plans[c]);
}

TEST(VadMiniNet, DeclaresTheTensorsOfTheWeightFile) {
  VadMiniNet net(VadMiniArchitecture(), 1);
  const auto values = net.parameters().values();
  const auto expected = vadMiniTensors(VadMiniArchitecture());
  ASSERT_EQ(values.size(), expected.size());
  std::size_t count = 0;
  for (const inference::TensorShape& tensor : expected) {
    EXPECT_EQ(values.at(tensor.name).shape, tensor.shape) << tensor.name;
    count += values.at(tensor.name).values.size();
  }
  EXPECT_LT(count, 4000000U) << "a compact network";
  std::cout << count << " weights\n";
}

}  // namespace
}  // namespace cdiff::planners
