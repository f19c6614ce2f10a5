// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/training/plan_losses.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "learning/parameters.h"

namespace cdiff::planners {
namespace {

constexpr double kFar = 1e6;

at::Tensor crossOf(const at::Tensor& a, const at::Tensor& b) {
  return a.select(-1, 0) * b.select(-1, 1) - a.select(-1, 1) * b.select(-1, 0);
}

/// Distances [B, 6, S] of waypoints to segments; far where those are not sure.
at::Tensor distances(const at::Tensor& plans, const at::Tensor& begin, const at::Tensor& end,
                     const at::Tensor& sure) {
  const at::Tensor from = plans.unsqueeze(2) - begin.unsqueeze(1);
  const at::Tensor way = (end - begin).unsqueeze(1);
  const at::Tensor share =
      at::clamp((from * way).sum(-1) / (way.square().sum(-1) + 1e-6), 0.0, 1.0).detach();
  const at::Tensor apart = from - share.unsqueeze(-1) * way;
  return at::sqrt(apart.square().sum(-1) + 1e-6) + kFar * (1.0 - sure.unsqueeze(1));
}

/// Plans with the ego's place before them [B, 7, 2].
at::Tensor withStart(const at::Tensor& plans) {
  return at::cat({at::zeros_like(plans.narrow(1, 0, 1)), plans}, 1);
}

/// 1 up to and without the first segment of the plan that crosses a sure one [B, 6].
at::Tensor beforeCrossing(const at::Tensor& plans, const DetectedSurroundings& seen) {
  const at::Tensor path = withStart(plans.detach());
  const at::Tensor a = path.narrow(1, 0, kEgoWaypoints).unsqueeze(2);
  const at::Tensor b = path.narrow(1, 1, kEgoWaypoints).unsqueeze(2);
  const at::Tensor c = seen.edge_begin.unsqueeze(1), d = seen.edge_end.unsqueeze(1);
  const at::Tensor sides = crossOf(b - a, c - a) * crossOf(b - a, d - a);
  const at::Tensor others = crossOf(d - c, a - c) * crossOf(d - c, b - c);
  const at::Tensor crosses =
      (sides.lt(0.0) & others.lt(0.0)).to(plans.scalar_type()) * seen.edge_sure.unsqueeze(1);
  return at::cumsum(crosses.amax(2), 1).lt(0.5).to(plans.scalar_type());
}

}  // namespace

at::Tensor commandedPlans(const at::Tensor& plans, const std::vector<const EgoExample*>& examples) {
  std::vector<std::int64_t> commands;
  for (const EgoExample* example : examples)
    commands.push_back(static_cast<std::int64_t>(example->command));
  const at::Tensor index = learning::toIndices(commands, {plans.size(0), 1, 1, 1}, plans.device())
                               .expand({plans.size(0), 1, plans.size(2), 2});
  return plans.gather(1, index).squeeze(1);
}

at::Tensor imitationLoss(const at::Tensor& plans, const std::vector<const EgoExample*>& examples) {
  std::vector<float> driven, known;
  for (const EgoExample* example : examples) {
    for (std::size_t i = 0; i < example->driven.places.size(); ++i) {
      driven.push_back(static_cast<float>(example->driven.places[i].x()));
      driven.push_back(static_cast<float>(example->driven.places[i].y()));
      known.push_back(i < example->driven.known ? 1.0F : 0.0F);
    }
  }
  const at::Tensor wanted = learning::toTensor(driven, plans.sizes(), plans.device());
  const at::Tensor counted =
      learning::toTensor(known, {plans.size(0), plans.size(1), 1}, plans.device());
  return ((plans - wanted).abs() * counted).sum() / (2.0 * counted.sum()).clamp_min(1.0);
}

at::Tensor boundaryLoss(const at::Tensor& plans, const DetectedSurroundings& seen) {
  const at::Tensor nearest =
      distances(plans, seen.edge_begin, seen.edge_end, seen.edge_sure).amin(2);
  const at::Tensor hinge = at::relu(PlanLossOptions::kBoundaryReach - nearest);
  return (hinge * beforeCrossing(plans, seen)).mean();
}

at::Tensor collisionLoss(const at::Tensor& plans, const DetectedSurroundings& seen) {
  const at::Tensor apart = plans.unsqueeze(1) - seen.agents;  // [B, A, 6, 2]
  const at::Tensor distance =
      at::sqrt(apart.detach().square().sum(-1)) + kFar * (1.0 - seen.agent_sure.unsqueeze(2));
  const auto [nearest, index] = distance.min(1, true);  // [B, 1, 6]
  const at::Tensor near =
      nearest.squeeze(1).lt(PlanLossOptions::kCollisionReach).to(plans.scalar_type());
  const at::Tensor gap = apart.gather(1, index.unsqueeze(3).expand({-1, -1, -1, 2})).squeeze(1);
  const at::Tensor along = at::relu(PlanLossOptions::kCollisionAlong - gap.select(2, 0).abs());
  const at::Tensor across = at::relu(PlanLossOptions::kCollisionAcross - gap.select(2, 1).abs());
  return ((along + across) * near).mean();
}

at::Tensor directionLoss(const at::Tensor& plans, const DetectedSurroundings& seen) {
  const at::Tensor apart = distances(plans, seen.lane_begin, seen.lane_end, seen.lane_sure);
  const auto [nearest, index] = apart.detach().min(2);  // [B, 6]
  const at::Tensor near = nearest.lt(PlanLossOptions::kLaneReach).to(plans.scalar_type());
  const at::Tensor ways = seen.lane_end - seen.lane_begin;
  const at::Tensor lane = ways.gather(1, index.unsqueeze(2).expand({-1, -1, 2}));
  const at::Tensor path = withStart(plans);
  const at::Tensor step = path.narrow(1, 1, kEgoWaypoints) - path.narrow(1, 0, kEgoWaypoints);
  const at::Tensor length = at::sqrt(step.square().sum(2) + 1e-6);
  const at::Tensor lane_length = at::sqrt(lane.square().sum(2) + 1e-6);
  // The angle from the sine, which is the same to either way along the lane.
  const at::Tensor sine = crossOf(step, lane).abs() / (length * lane_length);
  const at::Tensor angle = at::asin(at::clamp(sine, 0.0, 0.999));
  const at::Tensor moves = (path.select(1, kEgoWaypoints) - path.select(1, 1))
                               .detach()
                               .norm(2, {1}, true)
                               .ge(PlanLossOptions::kLeastWay)
                               .to(plans.scalar_type());
  return (angle * near * moves).mean();
}

ForecastLoss forecastLoss(const at::Tensor& ways, const at::Tensor& logits,
                          const std::vector<const EgoExample*>& examples,
                          const QueryMatches& matches, const PlanLossOptions& options) {
  const auto queries = static_cast<std::size_t>(logits.size(1));
  std::vector<std::int64_t> rows, last;
  std::vector<float> wanted, known;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    for (std::size_t i = 0; i < matches[b].size(); ++i) {
      const AgentLabel& label = examples[b]->agents[i];
      if (matches[b][i] < 0 || label.future.known == 0) continue;
      rows.push_back(static_cast<std::int64_t>(b * queries) + matches[b][i]);
      last.push_back(static_cast<std::int64_t>(label.future.known) - 1);
      for (std::size_t k = 0; k < label.future.places.size(); ++k) {
        const bool counts = k < label.future.known;
        const Eigen::Vector2d place = label.future.places[k];
        wanted.push_back(counts ? static_cast<float>(place.x()) - label.box[0] : 0.0F);
        wanted.push_back(counts ? static_cast<float>(place.y()) - label.box[1] : 0.0F);
        known.push_back(counts ? 1.0F : 0.0F);
      }
    }
  }
  const at::Tensor none = at::zeros({}, ways.options());
  if (rows.empty()) return {none, none};
  const at::Device device = ways.device();
  const auto count = static_cast<std::int64_t>(rows.size());
  const at::Tensor index = learning::toIndices(rows, {count}, device);
  const at::Tensor of = ways.flatten(0, 1).index_select(0, index);        // [N, 6, 6, 2]
  const at::Tensor scores = logits.flatten(0, 1).index_select(0, index);  // [N, 6]
  const at::Tensor target = learning::toTensor(wanted, {count, 1, kEgoWaypoints, 2}, device);
  const at::Tensor counted = learning::toTensor(known, {count, kEgoWaypoints, 1}, device);
  const at::Tensor end = learning::toIndices(last, {count, 1, 1}, device);
  const at::Tensor apart = (of - target).detach().norm(2, {3});  // [N, 6 modes, 6]
  const at::Tensor best = apart.gather(2, end.expand({-1, apart.size(1), -1})).squeeze(2).argmin(1);
  const at::Tensor chosen =
      of.gather(1, best.reshape({count, 1, 1, 1}).expand({-1, -1, kEgoWaypoints, 2})).squeeze(1);
  const at::Tensor places =
      ((chosen - target.squeeze(1)).abs() * counted).sum() / counted.sum().clamp_min(1.0);
  const at::Tensor hot = at::zeros_like(scores).scatter(1, best.unsqueeze(1), 1.0);
  return {options.forecast * places,
          options.forecast_score * focalLoss(scores, hot) / static_cast<double>(count)};
}

}  // namespace cdiff::planners
