// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/camera_ego/training/two_looks.h"
#include "planners/uniad_mini/training/uniad_mini_trainer_network.h"
#include "planners/uniad_mini/uniad_mini_network.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

using testing::TwoLooks;

/// All that the network with gradients answers for one moment.
struct NetAnswer {
  TrackAnswer tracks;
  MapAnswer map;
  MotionAnswer motion;
  at::Tensor occupancy;
  at::Tensor plan;
};

UniadMiniModel drawnUniad() {
  UniadMiniArchitecture architecture;
  UniadMiniModel model{architecture, cdiff::testing::randomTensors(uniadMiniTensors(architecture))};
  model.weights[kAnchorTable] = toTensor(clusterAnchors({}));
  return model;
}

/// The agents that are there by the scores of the network at run time.
at::Tensor sureOf(const UniadMiniOutput& output) {
  std::vector<float> sure;
  for (const DetectedAgent& agent : output.agents)
    sure.push_back(logistic(agent.score) >= kKeepScore ? 1.0F : 0.0F);
  return learning::toTensor(sure, {1, static_cast<std::int64_t>(sure.size())}, at::kCPU);
}

/// Where the second look starts, from what the network at run time keeps of the first.
TrackStart startFrom(const TrackSet& kept, const at::Tensor& content, const EgoPoses& poses) {
  const BevGrid& bev = UniadMiniArchitecture{}.ego.bev;
  std::vector<float> held, reference;
  for (std::size_t slot = 0; slot < kept.live.size(); ++slot) {
    const auto moved = movedCenter(kept, slot, poses, bev);
    const auto at = moved ? referenceAt(bev, *moved) : std::array<float, 2>{};
    held.push_back(moved ? 1.0F : 0.0F);
    reference.insert(reference.end(), at.begin(), at.end());
  }
  held.push_back(1.0F);
  const auto slots = static_cast<std::int64_t>(kept.live.size());
  return {learning::toTensor(held, {1, slots + 1, 1}, at::kCPU), content,
          learning::toTensor(reference, {1, slots, 2}, at::kCPU)};
}

NetAnswer answerOf(const UniadMiniNet& net, const at::Tensor& bev, const TrackStart& start,
                   const UniadMiniOutput& output, RoadCommand command) {
  NetAnswer answer;
  answer.tracks = net.seeTracks(bev, 1, start);
  answer.map = net.seeMap(bev, 1);
  answer.motion = net.forecast(bev, answer.tracks, answer.map);
  answer.occupancy = net.occupancy(bev, answer.tracks, answer.motion, sureOf(output));
  answer.plan = net.plan(bev, answer.tracks, answer.motion,
                         learning::toIndices({static_cast<std::int64_t>(command)}, {1}, at::kCPU));
  return answer;
}

void expectNear(double found, const at::Tensor& expected, const char* what) {
  EXPECT_NEAR(found, expected.item<double>(),
              1e-4 * std::max(1.0, std::abs(expected.item<double>())))
      << what;
}

void expectSameAgents(const UniadMiniOutput& found, const NetAnswer& expected) {
  const at::Tensor shares = at::softmax(expected.motion.logits.back(), 2);
  for (std::size_t a = 0; a < found.agents.size(); ++a) {
    const auto i = static_cast<std::int64_t>(a);
    const DetectedAgent& agent = found.agents[a];
    expectNear(agent.score, expected.tracks.logits.back()[0][i][0], "score");
    for (std::int64_t n = 0; n < kBoxNumbers; ++n)
      expectNear(agent.box[static_cast<std::size_t>(n)], expected.tracks.boxes.back()[0][i][n],
                 "box");
    for (std::int64_t m = 0; m < kMotionModes; ++m) {
      const auto mode = static_cast<std::size_t>(m);
      for (std::int64_t k = 0; k < kEgoWaypoints; ++k) {
        const Eigen::Vector2d place = agent.ways[mode][static_cast<std::size_t>(k)];
        for (std::int64_t axis = 0; axis < 2; ++axis)
          expectNear(place[axis] - static_cast<double>(agent.box[axis == 0 ? 0 : 1]),
                     expected.motion.ways.back()[0][i][m][k][axis], "way");
      }
      expectNear(logistic(agent.way_scores[mode]), shares[0][i][m], "share of a mode");
    }
  }
}

/// Occupancy has a threshold in it, at which single cells may fall to either side.
void expectSameOccupancy(const UniadMiniOutput& found, const at::Tensor& expected) {
  double apart = 0.0, size = 0.0;
  for (std::size_t step = 0; step < found.occupancy.logits.size(); ++step) {
    const std::vector<float> wanted =
        learning::toVector(expected[0][static_cast<std::int64_t>(step)].contiguous());
    ASSERT_EQ(found.occupancy.logits[step].size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      apart += std::abs(static_cast<double>(found.occupancy.logits[step][i] - wanted[i]));
      size += std::abs(static_cast<double>(wanted[i]));
    }
  }
  EXPECT_LT(apart, 1e-4 * size);
  EXPECT_GT(size, 0.0);
}

void expectSame(const UniadMiniOutput& found, const NetAnswer& expected) {
  expectSameAgents(found, expected);
  const at::Tensor lines =
      metersOfShares(UniadMiniArchitecture{}.ego.bev, expected.map.lines.back());
  for (std::size_t l = 0; l < found.lines.size(); ++l) {
    const auto i = static_cast<std::int64_t>(l);
    for (std::int64_t k = 0; k < kMapKinds; ++k)
      expectNear(found.lines[l].scores[static_cast<std::size_t>(k)],
                 expected.map.logits.back()[0][i][k], "line score");
    for (std::int64_t p = 0; p < kMapPoints; ++p) {
      const Eigen::Vector2d place = found.lines[l].points[static_cast<std::size_t>(p)];
      expectNear(place.x(), lines[0][i][p][0], "line");
      expectNear(place.y(), lines[0][i][p][1], "line");
    }
  }
  expectSameOccupancy(found, expected.occupancy);
  for (std::int64_t k = 0; k < kEgoWaypoints; ++k) {
    const Eigen::Vector2d place = found.plan[static_cast<std::size_t>(k)];
    expectNear(place.x(), expected.plan[0][k][0], "plan");
    expectNear(place.y(), expected.plan[0][k][1], "plan");
  }
}

inference::Rows copyOf(const inference::Rows& rows, std::int64_t channels) {
  inference::Rows copy;
  copy.resize(rows.rows(), channels);
  for (std::int64_t row = 0; row < rows.rows(); ++row)
    std::copy_n(rows.row(row), channels, copy.row(row));
  return copy;
}

class UniadMiniNetworks : public ::testing::TestWithParam<inference::InstructionSet> {};

TEST_P(UniadMiniNetworks, IsTheFunctionThatThePlannerComputes) {
  if (GetParam() > inference::bestInstructionSet()) GTEST_SKIP() << "not on this processor";
  const UniadMiniModel model = drawnUniad();
  UniadMiniNet net(model.architecture, 1);
  net.load(model.weights, "test");
  UniadMiniNetwork network(model, GetParam());
  const TwoLooks looks;
  const at::NoGradGuard no_gradient;
  const BevGrid& bev = model.architecture.ego.bev;
  UniadMiniInput first = looks.input<UniadMiniInput>(false);
  first.command = RoadCommand::kLeft;
  const UniadMiniOutput one = network.forward(first);
  const at::Tensor past = net.bev().encode(looks.batch(bev, false), {});
  const NetAnswer answer = answerOf(net, past, {}, one, first.command);
  expectSame(one, answer);

  const inference::Rows kept = copyOf(network.bev(), model.architecture.ego.width);
  UniadMiniInput second = looks.input<UniadMiniInput>(true);
  second.past = &kept;
  second.past_tracks = &one.tracks;
  second.command = RoadCommand::kStraight;
  const TrackStart start = startFrom(one.tracks, answer.tracks.content, second.poses);
  const double held = start.held.sum().item<double>();
  EXPECT_GT(held, 1.0) << "some tracks go on";
  EXPECT_LT(held, 25.0) << "and some do not";
  const UniadMiniOutput two = network.forward(second);
  expectSame(two, answerOf(net, net.bev().encode(looks.batch(bev, true), past), start, two,
                           second.command));
}

INSTANTIATE_TEST_SUITE_P(Sets, UniadMiniNetworks,
                         ::testing::Values(inference::InstructionSet::kPlain,
                                           inference::InstructionSet::kAvx2,
                                           inference::InstructionSet::kAvx512));

TEST(UniadMiniNetwork, AnswersTheSameBytesEveryTime) {
  const UniadMiniModel model = drawnUniad();
  UniadMiniNetwork first(model), second(model);
  const TwoLooks looks;
  second.forward(looks.input<UniadMiniInput>(true));  // whatever came before
  const UniadMiniOutput one = first.forward(looks.input<UniadMiniInput>(false));
  const UniadMiniOutput other = second.forward(looks.input<UniadMiniInput>(false));
  EXPECT_EQ(one.plan, other.plan);
  EXPECT_EQ(one.occupancy.logits, other.occupancy.logits);
  for (std::size_t i = 0; i < one.agents.size(); ++i)
    EXPECT_EQ(one.agents[i].box, other.agents[i].box) << i;
}

TEST(UniadMiniNetwork, PlansForTheCommand) {
  UniadMiniNetwork network(drawnUniad());
  const TwoLooks looks;
  UniadMiniInput input = looks.input<UniadMiniInput>(false);
  input.command = RoadCommand::kLeft;
  const EgoWaypoints left = network.forward(input).plan;
  input.command = RoadCommand::kRight;
  EXPECT_NE(network.forward(input).plan, left);
}

TEST(UniadMiniNet, DeclaresTheTensorsOfTheWeightFile) {
  const UniadMiniNet net(UniadMiniArchitecture(), 1);
  const WeightTensors values = net.values();
  const auto expected = uniadMiniTensors(UniadMiniArchitecture());
  ASSERT_EQ(values.size(), expected.size());
  std::size_t count = 0;
  for (const inference::TensorShape& tensor : expected) {
    EXPECT_EQ(values.at(tensor.name).shape, tensor.shape) << tensor.name;
    count += values.at(tensor.name).values.size();
  }
  EXPECT_LT(count, 8000000U) << "a compact network";
  std::cout << count << " weights\n";
}

// Taps and channels of a convolution: libtorch's own 3 x 3 convolution of the same weights.
TEST(UniadMiniNet, NeighborsAndALinearLayerAreAConvolution) {
  at::manual_seed(3);
  const at::Tensor x = at::randn({2, 4 * 6, 16});
  const at::Tensor weight = at::randn({5, 9, 16});
  const at::Tensor found =
      at::matmul(neighborsOf({4, 6}, x), weight.reshape({5, 9 * 16}).t());  // [2, 24, 5]
  const at::Tensor image = x.permute({0, 2, 1}).reshape({2, 16, 4, 6});
  const at::Tensor expected =
      at::conv2d(image, weight.reshape({5, 3, 3, 16}).permute({0, 3, 1, 2}).contiguous(), {}, 1, 1);
  EXPECT_LT(
      (found.permute({0, 2, 1}).reshape(expected.sizes()) - expected).abs().max().item<double>(),
      1e-4);
}

TEST(UniadMiniNet, RefusesWeightsWithoutAnchors) {
  UniadMiniModel model = drawnUniad();
  model.weights.erase(kAnchorTable);
  UniadMiniNet net(model.architecture, 1);
  EXPECT_THROW(net.load(model.weights, "test"), std::runtime_error);
}

}  // namespace
}  // namespace cdiff::planners
