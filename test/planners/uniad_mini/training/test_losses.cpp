// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <numeric>

#include "planners/uniad_mini/training/uniad_losses.h"

namespace cdiff::planners {
namespace {

/// A car 10 m ahead that keeps 4 m every 0.5 s, along x.
AgentLabel carAhead(std::size_t known = 6) {
  AgentLabel label;
  label.vehicle = 7;
  label.box[0] = 10.0F;
  label.size.length = 4.0;
  label.size.width = 2.0;
  label.future.known = known;
  for (std::size_t i = 0; i < 6; ++i) label.future.places[i] = {10.0 + 4.0 * (i + 1.0), 0.0};
  return label;
}

/// An ego that was driven straight on, 4 m every 0.5 s, behind that car.
EgoExample behindTheCar(std::size_t known = 6) {
  EgoExample example;
  example.agents = example.others = {carAhead()};
  example.driven.known = known;
  for (std::size_t i = 0; i < 6; ++i) example.driven.places[i] = {4.0 * (i + 1.0), 0.0};
  return example;
}

at::Tensor planAlong(double step, double y) {
  at::Tensor plan = at::zeros({1, kEgoWaypoints, 2});
  for (int i = 0; i < 6; ++i) {
    plan[0][i][0] = step * (i + 1);
    plan[0][i][1] = y;
  }
  return plan;
}

// Every known waypoint is 3 m ahead and 4 m beside: 5 m.
TEST(UniadLosses, DisplacementIsTheMeanDistance) {
  EgoExample example = behindTheCar(2);
  at::Tensor plan = planAlong(4.0, 4.0);
  plan.select(2, 0) += 3.0;
  EXPECT_NEAR(averageDisplacement(plan, {&example}).item<double>(), 5.0, 1e-5);
  example.driven.known = 0;
  EXPECT_EQ(averageDisplacement(plan, {&example}).item<double>(), 0.0);
}

// The plan is 8 m ahead of where it was driven: 2 m behind the car's center at each of the six
// times. Along x the car reaches 2 m to its rear, the ego 2.042 m to its front: 2.042 m of overlap;
// across the smaller width of the ego, 1.85 m. 0.5 m more make 2.292 m x 2 m, the car's width.
TEST(UniadLosses, OverlapIsTheAreaOfHulls) {
  const EgoExample example = behindTheCar();
  at::Tensor plan = planAlong(4.0, 0.0);
  plan.select(2, 0) += 8.0;
  plan.set_requires_grad(true);
  const at::Tensor loss = overlapLoss(plan, {&example}, 0.0);
  EXPECT_NEAR(loss.item<double>(), 2.042 * 1.85, 1e-4);
  EXPECT_NEAR(overlapLoss(plan, {&example}, 0.5).item<double>(), 2.292 * 2.0, 1e-4);
  loss.backward();
  EXPECT_NEAR(plan.grad()[0][0][0].item<double>(), 1.85 / 6.0, 1e-5) << "it pushes back";
  EXPECT_EQ(overlapLoss(planAlong(4.0, 0.0), {&example}, 1.0).item<double>(), 0.0)
      << "10 m between centers";
}

// Of two of the six times the car's place is known.
TEST(UniadLosses, OverlapCountsKnownPlacesOnly) {
  EgoExample example = behindTheCar();
  example.others[0].future.known = 2;
  at::Tensor plan = planAlong(4.0, 0.0);
  plan.select(2, 0) += 8.0;
  EXPECT_NEAR(overlapLoss(plan, {&example}, 0.0).item<double>(), 2.042 * 1.85 / 3.0, 1e-4);
  example.others.clear();
  EXPECT_EQ(overlapLoss(plan, {&example}, 0.0).item<double>(), 0.0);
}

// Along y its hull is as long as it is; where it stands it keeps its heading.
TEST(UniadLosses, HeadingsAreThoseItWasDrivenWith) {
  FuturePlaces driven;
  driven.known = 4;
  driven.places = {{{0.0, 2.0}, {0.0, 4.0}, {0.0, 4.01}, {1.0, 4.01}}};
  const auto headings = drivenHeadings(driven);
  EXPECT_NEAR(headings[0], M_PI / 2.0, 1e-9);
  EXPECT_NEAR(headings[2], M_PI / 2.0, 1e-9) << "1 cm is no direction";
  EXPECT_NEAR(headings[3], 0.0, 1e-9);
}

// A standard normal at (1, 0): log(2 pi) + 1/2 = 2.33788. Twice the deviation along x: log 2 more,
// and 1/8 in place of 1/2.
TEST(UniadLosses, NegativeLogLikelihoodIsTheFormula) {
  const at::Tensor offset = learning::toTensor({1.0F, 0.0F}, {1, 2}, at::kCPU);
  const auto nll = [&](float log_x, float rho) {
    return gaussianNll(offset, learning::toTensor({log_x, 0.0F, rho}, {1, 3}, at::kCPU))
        .item<double>();
  };
  EXPECT_NEAR(nll(0.0F, 0.0F), 2.33788, 1e-4);
  EXPECT_NEAR(nll(std::log(2.0F), 0.0F), 2.33788 + 0.693147 - 0.375, 1e-4);
  // rho = 0.95 tanh(1) = 0.723514: log(2 pi) + log(1 - rho^2) / 2 + 1 / (2 (1 - rho^2)).
  EXPECT_NEAR(nll(0.0F, 1.0F), 1.837877 + 0.5 * std::log(0.476528) + 0.5 / 0.476528, 1e-4);
  EXPECT_NEAR(nll(-100.0F, 0.0F), 1.837877 - 3.0 + 0.5 * std::exp(6.0), 1e-2) << "bounded";
}

// Of two egos at 4 and 6 m/s, both answered with (5, 0.5) m/s by each of two layers: 1.5 m/s apart,
// times a quarter, twice.
TEST(UniadLosses, TheEgoIsToKnowItsVelocity) {
  EgoExample slow, fast;
  slow.speed = 4.0;
  fast.speed = 6.0;
  TrackAnswer answer;
  answer.features = at::zeros({2, 3, 4});
  const at::Tensor velocity = learning::toTensor({5.0F, 0.5F, 5.0F, 0.5F}, {2, 2}, at::kCPU);
  answer.ego_velocities = {velocity, velocity};
  EXPECT_NEAR(egoVelocityLoss(answer, {&slow, &fast}).item<double>(), 2.0 * 0.25 * 1.5, 1e-6);
}

/// One layer with two slots and the ego; all modes stay where they are but mode 2 of the first
/// slot, which is 0.5 m behind the car along x.
MotionAnswer nearlyRight() {
  MotionAnswer answer;
  at::Tensor ways = at::zeros({1, 3, kMotionModes, kEgoWaypoints, 2});
  for (int i = 0; i < 6; ++i) ways[0][0][2][i][0] = 4.0 * (i + 1) - 0.5;
  answer.ways = {ways};
  answer.spreads = {at::zeros({1, 3, kMotionModes, kEgoWaypoints, 3})};
  answer.logits = {at::zeros({1, 3, kMotionModes})};
  return answer;
}

// Half the cross entropy of six equal modes, log 6; half of log(2 pi) + 0.5^2 / 2; a quarter of
// 0.5 m.
TEST(UniadLosses, MotionLearnsFromTheModeThatEndsNearest) {
  EgoExample example = behindTheCar(0);
  const auto targets = motionTargets({&example}, {{0}}, 3);
  ASSERT_EQ(targets.size(), 1U) << "where the ego was driven is not known";
  EXPECT_EQ(targets[0].places[0], Eigen::Vector2d(4.0, 0.0)) << "from its center on";
  EXPECT_NEAR(motionLoss(nearlyRight(), targets).item<double>(),
              0.5 * 1.791759 + 0.5 * (1.837877 + 0.125) + 0.25 * 0.5, 1e-4);
  EXPECT_EQ(motionLoss(nearlyRight(), {}).item<double>(), 0.0);
}

TEST(UniadLosses, MotionTargetsHoldTheEgoLast) {
  EgoExample one = behindTheCar(), two = behindTheCar();
  two.agents[0].future.known = 0;
  const auto targets = motionTargets({&one, &two}, {{1}, {1}}, 3);
  ASSERT_EQ(targets.size(), 3U);
  EXPECT_EQ(targets[0].row, 1);
  EXPECT_EQ(targets[1].row, 2);
  EXPECT_EQ(targets[2].row, 5) << "of the second sample the ego alone";
  EXPECT_EQ(targets[2].places[5], Eigen::Vector2d(24.0, 0.0));
}

// 4 m x 2 m around (10, 0), cells of 2 m with borders at even places: x from 8 to 12 m, y from -1
// to 1 m. Touching counts: columns of x 6-8, 8-10, 10-12, 12-14, rows of y -2-0 and 0-2.
TEST(UniadLosses, MasksAreTheCellsThatABoxTouches) {
  const BevGrid bev{32, 32, 2.0, 16.0};
  const std::vector<float> mask = maskOf(bev, {{10.0, 0.0}, 0.0, 4.0, 2.0});
  double sum = 0.0;
  for (std::size_t cell = 0; cell < mask.size(); ++cell) {
    sum += static_cast<double>(mask[cell]);
    const Eigen::Vector2d center = bev.center(static_cast<std::int64_t>(cell));
    if (mask[cell] > 0.5F) {
      EXPECT_LE(std::abs(center.x() - 10.0), 3.0);
      EXPECT_LE(std::abs(center.y()), 1.0);
    }
  }
  EXPECT_EQ(sum, 8.0);
  const std::vector<float> inside = maskOf(bev, {{9.0, 1.0}, 0.0, 1.0, 1.0});
  EXPECT_EQ(std::accumulate(inside.begin(), inside.end(), 0.0F), 1.0F);
}

// One slot whose mask is right and sure at every step, another one that nobody matched.
TEST(UniadLosses, OccupancyOfRightMasksCostsNothing) {
  const BevGrid bev{32, 32, 2.0, 16.0};
  EgoExample example = behindTheCar();
  at::Tensor logits = at::full({1, 5, 2, 1024}, 30.0);
  logits.select(2, 1).fill_(-30.0);
  for (int step = 0; step < 5; ++step) {
    const std::vector<float> mask = maskOf(bev, {{10.0 + 4.0 * step, 0.0}, 0.0, 4.0, 2.0});
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (mask[i] > 0.5F) logits[0][step][1][static_cast<std::int64_t>(i)] = 30.0;
    }
  }
  EXPECT_NEAR(occupancyLoss(logits, bev, {&example}, {{1}}).item<double>(), 0.0, 1e-5);
  EXPECT_GT(occupancyLoss(logits, bev, {&example}, {{0}}).item<double>(), 100.0);
  EXPECT_EQ(occupancyLoss(logits, bev, {&example}, {{-1}}).item<double>(), 0.0);
}

// Logits of 0: entropy log 2 in every cell, so 5 x 0.6931; dice with p = 1/2 in 1024 cells, of
// which 8 are the car's: 1 - (8 + 1) / (512 + 8 + 1).
TEST(UniadLosses, OccupancyIsEntropyAndDice) {
  const BevGrid bev{32, 32, 2.0, 16.0};
  EgoExample example = behindTheCar();
  example.agents[0].future.known = 0;  // of the steps "now" alone
  const at::Tensor logits = at::zeros({1, 5, 1, 1024});
  EXPECT_NEAR(occupancyLoss(logits, bev, {&example}, {{0}}).item<double>(),
              5.0 * 0.693147 + 1.0 - 9.0 / 521.0, 1e-4);
}

}  // namespace
}  // namespace cdiff::planners
