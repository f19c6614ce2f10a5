// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planners/uniad_mini/training/uniad_losses.h"

namespace cdiff::planners {
namespace {

/// Targets as tensors: N rows.
struct TargetTensors {
  at::Tensor rows;    ///< [N]
  at::Tensor places;  ///< [N, 6, 2]
  at::Tensor known;   ///< [N, 6]: 1 or 0
  at::Tensor last;    ///< [N] number of the last known place
};

TargetTensors tensorsOf(const std::vector<MotionTarget>& targets, const at::Device& device) {
  std::vector<std::int64_t> rows, last;
  std::vector<float> places, known;
  for (const MotionTarget& target : targets) {
    rows.push_back(target.row);
    last.push_back(static_cast<std::int64_t>(target.known) - 1);
    for (std::size_t i = 0; i < target.places.size(); ++i) {
      const bool counts = i < target.known;
      places.push_back(counts ? static_cast<float>(target.places[i].x()) : 0.0F);
      places.push_back(counts ? static_cast<float>(target.places[i].y()) : 0.0F);
      known.push_back(counts ? 1.0F : 0.0F);
    }
  }
  const auto count = static_cast<std::int64_t>(targets.size());
  return {learning::toIndices(rows, {count}, device),
          learning::toTensor(places, {count, kEgoWaypoints, 2}, device),
          learning::toTensor(known, {count, kEgoWaypoints}, device),
          learning::toIndices(last, {count}, device)};
}

/// The part of x [N, modes, 6, n] of one mode each [N, 6, n].
at::Tensor ofMode(const at::Tensor& x, const at::Tensor& mode) {
  const std::int64_t count = x.size(0);
  return x.gather(1, mode.reshape({count, 1, 1, 1}).expand({count, 1, x.size(2), x.size(3)}))
      .squeeze(1);
}

at::Tensor layerLoss(const at::Tensor& ways, const at::Tensor& spreads, const at::Tensor& logits,
                     const TargetTensors& target) {
  const std::int64_t count = target.rows.size(0);
  const at::Tensor of = ways.flatten(0, 1).index_select(0, target.rows);  // [N, M, 6, 2]
  const at::Tensor last = target.last.reshape({count, 1, 1}).expand({count, of.size(1), 1});
  const at::Tensor apart = (of - target.places.unsqueeze(1)).detach().norm(2, {3});
  const at::Tensor best = apart.gather(2, last).squeeze(2).argmin(1);
  const at::Tensor chosen = ofMode(of, best);
  const at::Tensor spread = ofMode(spreads.flatten(0, 1).index_select(0, target.rows), best);
  const at::Tensor nll = gaussianNll((target.places - chosen).flatten(0, 1), spread.flatten(0, 1))
                             .reshape({count, kEgoWaypoints});
  const at::Tensor square = (target.places - chosen).square().sum(2) + 1e-6;
  const at::Tensor end = at::sqrt(square).gather(1, target.last.unsqueeze(1));
  const at::Tensor scores = logits.flatten(0, 1).index_select(0, target.rows);
  const at::Tensor kind = -at::log_softmax(scores, 1).gather(1, best.unsqueeze(1));
  return UniadLossOptions::kMotionKind * kind.mean() +
         UniadLossOptions::kMotionNll * ((nll * target.known).sum(1) / target.known.sum(1)).mean() +
         UniadLossOptions::kMotionEnd * end.mean();
}

}  // namespace

at::Tensor egoVelocityLoss(const TrackAnswer& answer,
                           const std::vector<const EgoExample*>& examples) {
  std::vector<float> driven;
  for (const EgoExample* example : examples) {
    driven.push_back(static_cast<float>(example->speed));
    driven.push_back(0.0F);
  }
  at::Tensor loss = at::zeros({}, answer.features.options());
  for (const at::Tensor& velocity : answer.ego_velocities) {
    const at::Tensor wanted = learning::toTensor(driven, velocity.sizes(), velocity.device());
    loss = loss + (velocity - wanted).abs().sum(1).mean();
  }
  return UniadLossOptions::kEgoVelocity * loss;
}

std::vector<MotionTarget> motionTargets(const std::vector<const EgoExample*>& examples,
                                        const QueryMatches& matches, std::int64_t rows) {
  std::vector<MotionTarget> targets;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    const std::int64_t first = static_cast<std::int64_t>(b) * rows;
    for (std::size_t i = 0; i < matches[b].size(); ++i) {
      const AgentLabel& label = examples[b]->agents[i];
      if (matches[b][i] < 0 || label.future.known == 0) continue;
      MotionTarget target{first + matches[b][i], label.future.places, label.future.known};
      for (Eigen::Vector2d& place : target.places)
        place -= Eigen::Vector2d(label.box[0], label.box[1]);
      targets.push_back(target);
    }
    const FuturePlaces& driven = examples[b]->driven;
    if (driven.known > 0) targets.push_back({first + rows - 1, driven.places, driven.known});
  }
  return targets;
}

at::Tensor gaussianNll(const at::Tensor& offsets, const at::Tensor& spreads) {
  const at::Tensor log_x = at::clamp(spreads.select(1, 0), UniadLossOptions::kLeastSpread,
                                     UniadLossOptions::kMostSpread);
  const at::Tensor log_y = at::clamp(spreads.select(1, 1), UniadLossOptions::kLeastSpread,
                                     UniadLossOptions::kMostSpread);
  const at::Tensor rho = 0.95 * at::tanh(spreads.select(1, 2));
  const at::Tensor rest = 1.0 - rho.square();
  const at::Tensor x = offsets.select(1, 0) * at::exp(-log_x);
  const at::Tensor y = offsets.select(1, 1) * at::exp(-log_y);
  return std::log(2.0 * core::kPi) + log_x + log_y + 0.5 * at::log(rest) +
         (x.square() + y.square() - 2.0 * rho * x * y) / (2.0 * rest);
}

at::Tensor motionLoss(const MotionAnswer& answer, const std::vector<MotionTarget>& targets) {
  at::Tensor loss = at::zeros({}, answer.ways.back().options());
  if (targets.empty()) return loss;
  const TargetTensors target = tensorsOf(targets, loss.device());
  for (std::size_t i = 0; i < answer.ways.size(); ++i)
    loss = loss + layerLoss(answer.ways[i], answer.spreads[i], answer.logits[i], target);
  return loss;
}

}  // namespace cdiff::planners
