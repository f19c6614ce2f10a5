// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/training/vad_mini_loss.h"

namespace cdiff::planners {
namespace {

/// Segments of lines [B, L, 10, 2] in meters: begin or end of each [B, L x 9, 2].
at::Tensor segmentEnds(const at::Tensor& meters, std::int64_t first) {
  const std::int64_t segments = kMapPoints - 1;
  return meters.narrow(2, first, segments).reshape({meters.size(0), -1, 2});
}

/// 1 for each segment of lines that are surely of a kind.
at::Tensor sureSegments(const at::Tensor& logits, MapKind kind) {
  const at::Tensor sure = at::sigmoid(logits.select(2, static_cast<std::int64_t>(kind)))
                              .gt(PlanLossOptions::kSure)
                              .to(logits.scalar_type());
  return sure.unsqueeze(2)
      .expand({sure.size(0), sure.size(1), kMapPoints - 1})
      .reshape({sure.size(0), -1});
}

void addSets(const VadMiniAnswer& answer, const BevGrid& bev,
             const std::vector<const EgoExample*>& examples, const VadMiniLossOptions& options,
             learning::Loss& loss) {
  QueryMatches matches;
  for (std::size_t i = 0; i < answer.boxes.size(); ++i) {
    matches = matchAgents(answer.agent_logits[i], answer.boxes[i], examples, options.sets);
    const AgentLoss agents =
        agentLoss(answer.agent_logits[i], answer.boxes[i], examples, matches, options.sets);
    loss.add("agent_class", agents.kind);
    loss.add("agent_box", agents.box);
    const LineLoss lines =
        lineLoss(answer.line_logits[i], answer.lines[i], examples, bev, options.sets);
    loss.add("line_class", lines.kind);
    loss.add("line_points", lines.points);
    loss.add("line_direction", lines.direction);
  }
  const ForecastLoss forecasts =
      forecastLoss(answer.ways, answer.way_logits, examples, matches, options.plan);
  loss.add("forecast", forecasts.places);
  loss.add("forecast_class", forecasts.kind);
}

}  // namespace

DetectedSurroundings seenAround(const VadMiniAnswer& answer, const BevGrid& bev) {
  const at::NoGradGuard no_gradient;
  DetectedSurroundings seen;
  const at::Tensor meters = metersOfShares(bev, answer.lines.back());
  const at::Tensor& kinds = answer.line_logits.back();
  seen.edge_begin = seen.lane_begin = segmentEnds(meters, 0);
  seen.edge_end = seen.lane_end = segmentEnds(meters, 1);
  seen.edge_sure = sureSegments(kinds, MapKind::kEdge);
  seen.lane_sure = sureSegments(kinds, MapKind::kCenter);
  const at::Tensor centers = answer.boxes.back().narrow(2, 0, 2).unsqueeze(2);
  const at::Tensor best = answer.way_logits.argmax(2, true).unsqueeze(3).unsqueeze(4);
  seen.agents =
      centers + answer.ways.gather(2, best.expand({-1, -1, 1, kEgoWaypoints, 2})).squeeze(2);
  seen.agent_sure = at::sigmoid(answer.agent_logits.back().squeeze(2))
                        .gt(PlanLossOptions::kSure)
                        .to(centers.scalar_type());
  return seen;
}

learning::Loss vadMiniLoss(const VadMiniAnswer& answer, const BevGrid& bev,
                           const std::vector<const EgoExample*>& examples,
                           const VadMiniLossOptions& options) {
  learning::Loss loss;
  if (options.intermediate) addSets(answer, bev, examples, options, loss);
  const at::Tensor plans = commandedPlans(answer.plans, examples);
  loss.add("plan", options.plan.imitation * imitationLoss(plans, examples));
  if (!options.constraints || !options.intermediate) return loss;
  const DetectedSurroundings seen = seenAround(answer, bev);
  loss.add("plan_boundary", options.plan.boundary * boundaryLoss(plans, seen));
  loss.add("plan_collision", options.plan.collision * collisionLoss(plans, seen));
  loss.add("plan_direction", options.plan.direction * directionLoss(plans, seen));
  return loss;
}

}  // namespace cdiff::planners
