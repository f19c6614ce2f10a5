// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/parameters.h"
#include "planners/vad_mini/training/plan_losses.h"

namespace cdiff::planners {
namespace {

/// A plan of 6 waypoints [1, 6, 2] with a gradient.
at::Tensor planOf(const std::vector<float>& places) {
  return learning::toTensor(places, {1, kEgoWaypoints, 2}, at::kCPU).set_requires_grad(true);
}
/// 4 m a step straight on, `y` to the left.
at::Tensor straightPlan(float y = 0.0F) {
  std::vector<float> places;
  for (int i = 1; i <= 6; ++i) places.insert(places.end(), {4.0F * static_cast<float>(i), y});
  return planOf(places);
}

DetectedSurroundings seenOf(const std::vector<float>& begin, const std::vector<float>& end) {
  DetectedSurroundings seen;
  const auto count = static_cast<std::int64_t>(begin.size() / 2);
  seen.edge_begin = seen.lane_begin = learning::toTensor(begin, {1, count, 2}, at::kCPU);
  seen.edge_end = seen.lane_end = learning::toTensor(end, {1, count, 2}, at::kCPU);
  seen.edge_sure = seen.lane_sure = at::ones({1, count});
  return seen;
}

// An edge 0.4 m to the left of all waypoints: 1 - 0.4 each. The gradient pushes to the right.
TEST(PlanLosses, KeepOneMeterFromEdges) {
  const DetectedSurroundings seen = seenOf({-50.0F, 0.4F}, {50.0F, 0.4F});
  const at::Tensor plan = straightPlan();
  const at::Tensor loss = boundaryLoss(plan, seen);
  EXPECT_NEAR(loss.item<double>(), 0.6, 1e-4);
  loss.backward();
  EXPECT_NEAR(plan.grad()[0][3][1].item<double>(), 1.0 / 6.0, 1e-4);
  EXPECT_NEAR(boundaryLoss(straightPlan(), seenOf({-50.0F, 1.2F}, {50.0F, 1.2F})).item<double>(),
              0.0, 1e-9);
}

// An edge across the way at x = 10: the waypoint at 8 is 2 m before it, and behind it nothing
// counts.
TEST(PlanLosses, CountNothingBehindACrossedEdge) {
  const DetectedSurroundings seen =
      seenOf({10.0F, -5.0F, -50.0F, 0.5F}, {10.0F, 5.0F, 50.0F, 0.5F});
  EXPECT_NEAR(boundaryLoss(straightPlan(), seen).item<double>(), 2 * 0.5 / 6.0, 1e-4);
  DetectedSurroundings unsure = seen;
  unsure.edge_sure = at::zeros({1, 2});
  EXPECT_EQ(boundaryLoss(straightPlan(), unsure).item<double>(), 0.0);
}

// An agent always 1 m ahead and 0.5 m beside: (3 - 1) + (1.5 - 0.5) = 3.
TEST(PlanLosses, KeepAwayFromAgents) {
  DetectedSurroundings seen;
  const at::Tensor plan = straightPlan();
  seen.agents = (plan.detach() + learning::toTensor({1.0F, 0.5F}, {2}, at::kCPU)).unsqueeze(1);
  seen.agent_sure = at::ones({1, 1});
  EXPECT_NEAR(collisionLoss(plan, seen).item<double>(), 3.0, 1e-4);
  seen.agents = seen.agents + learning::toTensor({0.0F, 2.6F}, {2}, at::kCPU);
  EXPECT_EQ(collisionLoss(plan, seen).item<double>(), 0.0) << "farther than 3 m";
  seen.agents = plan.detach().unsqueeze(1);
  seen.agent_sure = at::zeros({1, 1});
  EXPECT_EQ(collisionLoss(plan, seen).item<double>(), 0.0) << "not sure";
}

// The lane bears 30 degrees: pi / 6, whichever way it runs.
TEST(PlanLosses, FollowTheDirectionOfLanes) {
  std::vector<float> begin, end;
  for (int i = 1; i <= 6; ++i) {
    const float x = 4.0F * static_cast<float>(i);
    begin.insert(begin.end(), {x - 0.866F, -0.5F});
    end.insert(end.end(), {x + 0.866F, 0.5F});
  }
  EXPECT_NEAR(directionLoss(straightPlan(), seenOf(begin, end)).item<double>(), 0.5236, 2e-3);
  EXPECT_NEAR(directionLoss(straightPlan(), seenOf(end, begin)).item<double>(), 0.5236, 2e-3);
  std::vector<float> standing;
  for (int i = 1; i <= 6; ++i) standing.insert(standing.end(), {4.0F + 0.1F * i, 0.05F * i});
  EXPECT_EQ(directionLoss(planOf(standing), seenOf(begin, end)).item<double>(), 0.0)
      << "less than 1 m from its first to its last waypoint";
}

EgoExample exampleOf(RoadCommand command, std::size_t known) {
  EgoExample example;
  example.command = command;
  example.driven.known = known;
  for (std::size_t i = 0; i < 6; ++i) example.driven.places[i] = {4.0 * (i + 1.0), 0.0};
  return example;
}

// Two known waypoints of three coordinates 1 m off: 2 x 1 m of 4 coordinates.
TEST(PlanLosses, ImitateTheCommandedPlanAsFarAsItIsKnown) {
  const EgoExample example = exampleOf(RoadCommand::kStraight, 2);
  at::Tensor plans = at::full({1, kRoadCommands, kEgoWaypoints, 2}, 100.0);
  plans[0][2] = straightPlan(1.0F).detach()[0];
  const at::Tensor plan = commandedPlans(plans, {&example});
  EXPECT_NEAR(imitationLoss(plan, {&example}).item<double>(), 0.5, 1e-6);
}

/// An agent 10 m ahead that drives on at 8 m/s, with a query whose third way is nearly right.
TEST(PlanLosses, ForecastsLearnFromTheWayThatEndsNearest) {
  EgoExample example;
  AgentLabel label;
  label.box[0] = 10.0F;
  label.future.known = 4;
  for (std::size_t i = 0; i < 6; ++i) label.future.places[i] = {10.0 + 4.0 * (i + 1.0), 0.0};
  example.agents = {label};
  at::Tensor ways = at::zeros({1, 2, 6, 6, 2});
  for (int i = 0; i < 6; ++i) ways[0][1][2][i][0] = 4.0 * (i + 1) - 0.5;
  const at::Tensor logits = at::zeros({1, 2, 6});
  const ForecastLoss loss = forecastLoss(ways, logits, {&example}, {{1}}, {});
  EXPECT_NEAR(loss.places.item<double>(), 0.2 * 0.5, 1e-6) << "0.5 m at each known place";
  // Six logits of 0: 0.25 x log 2 x (0.25 + 5 x 0.75).
  EXPECT_NEAR(loss.kind.item<double>(), 0.2 * 0.25 * 0.693147 * 4.0, 1e-5);
}

TEST(PlanLosses, FocalLossIsTheFormula) {
  // p = 0.5: alpha (1 - p)^2 (-log p) = 0.25 x 0.25 x 0.6931.
  EXPECT_NEAR(focalLoss(at::zeros({1}), at::ones({1})).item<double>(), 0.0433217, 1e-6);
  EXPECT_NEAR(focalLoss(at::zeros({1}), at::zeros({1})).item<double>(), 0.1299651, 1e-6);
  EXPECT_NEAR(focalCost(0.0), 0.0433217 - 0.1299651, 1e-6);
}

TEST(SetLosses, MatchEveryLabelToItsQuery) {
  EgoExample example;
  example.agents.resize(2);
  example.agents[0].box = {10.0F, 0.0F};
  example.agents[1].box = {20.0F, 5.0F};
  at::Tensor boxes = at::zeros({1, 3, 10});
  boxes[0][0][0] = 20.0;
  boxes[0][0][1] = 5.0;
  boxes[0][2][0] = 10.5;
  const at::Tensor logits = at::zeros({1, 3, 1});
  const QueryMatches matches = matchAgents(logits, boxes, {&example}, {});
  EXPECT_EQ(matches, (QueryMatches{{2, 0}}));
  const AgentLoss loss = agentLoss(logits, boxes, {&example}, matches, {});
  EXPECT_NEAR(loss.box.item<double>(), 0.25 * 0.5 / 2.0, 1e-6) << "0.5 m of one, two labels";
  EXPECT_NEAR(loss.kind.item<double>(), 2.0 * (2 * 0.0433217 + 0.1299651) / 2.0, 1e-5);
}

TEST(SetLosses, LinesWithoutDirectionFitFromEitherEnd) {
  const BevGrid bev;
  EgoExample example;
  BevLine edge;
  for (std::size_t i = 0; i < kLinePoints; ++i)
    edge.points[i] = {4.0 * static_cast<double>(i), 3.0};
  example.lines = {edge};
  at::Tensor lines = at::zeros({1, 1, 10, 2});
  for (std::size_t i = 0; i < kLinePoints; ++i) {
    const Eigen::Vector2d share = bev.toShare(edge.points[kLinePoints - 1 - i]);
    lines[0][0][static_cast<std::int64_t>(i)][0] = share.x();
    lines[0][0][static_cast<std::int64_t>(i)][1] = share.y();
  }
  const at::Tensor logits = at::zeros({1, 1, 3});
  const LineLoss same = lineLoss(logits, lines, {&example}, bev, {});
  EXPECT_NEAR(same.points.item<double>(), 0.0, 1e-5);
  EXPECT_NEAR(same.direction.item<double>(), 0.0, 1e-4);
  example.lines[0].kind = MapKind::kCenter;
  const LineLoss turned = lineLoss(logits, lines, {&example}, bev, {});
  EXPECT_GT(turned.points.item<double>(), 1.0) << "a lane has a direction";
  EXPECT_NEAR(turned.direction.item<double>(), 0.005 * 2.0 * 9.0, 1e-3);
}

}  // namespace
}  // namespace cdiff::planners
