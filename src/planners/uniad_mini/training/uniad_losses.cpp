// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/training/uniad_losses.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planners/camera_ego/training/open_loop.h"

namespace cdiff::planners {
namespace {

/// The box of an agent at an occupancy step.
geometry::OrientedBox boxAt(const AgentLabel& label, std::size_t step) {
  if (step > 0) return futureBox(label, step - 1);
  return {{label.box[0], label.box[1]}, label.heading, label.size.length, label.size.width};
}

/// Half the extents of a box along x and y.
Eigen::Vector2d hullOf(const geometry::OrientedBox& box) {
  return {geometry::halfExtent(box, Eigen::Vector2d::UnitX()),
          geometry::halfExtent(box, Eigen::Vector2d::UnitY())};
}

void addPair(const Eigen::Vector2d& pair, std::vector<float>& to) {
  to.push_back(static_cast<float>(pair.x()));
  to.push_back(static_cast<float>(pair.y()));
}

/// Hulls of a batch: of the ego by waypoint, and of V vehicles.
struct Hulls {
  at::Tensor own;      ///< half extents [B, 6, 1, 2]
  at::Tensor centers;  ///< [B, 6, V, 2]
  at::Tensor halves;   ///< likewise
  at::Tensor there;    ///< [B, 6, V]: 1 where the vehicle and the ego's place are known
};

Hulls hullsOf(const std::vector<const EgoExample*>& examples, double inflated,
              const at::Device& device) {
  std::size_t most = 1;
  for (const EgoExample* example : examples) most = std::max(most, example->others.size());
  std::vector<float> own, centers, halves, there;
  for (const EgoExample* example : examples) {
    const auto headings = drivenHeadings(example->driven);
    for (std::size_t i = 0; i < headings.size(); ++i) {
      addPair(hullOf({Eigen::Vector2d::Zero(), headings[i], kEgoBoxLength + inflated,
                      kEgoBoxWidth + inflated}),
              own);
      for (std::size_t v = 0; v < most; ++v) {
        const bool known = v < example->others.size() && i < example->driven.known &&
                           i < example->others[v].future.known;
        const geometry::OrientedBox box =
            known ? futureBox(example->others[v], i) : geometry::OrientedBox{};
        addPair(box.center, centers);
        addPair(hullOf(box), halves);
        there.push_back(known ? 1.0F : 0.0F);
      }
    }
  }
  const auto samples = static_cast<std::int64_t>(examples.size());
  const auto count = static_cast<std::int64_t>(most);
  return {learning::toTensor(own, {samples, kEgoWaypoints, 1, 2}, device),
          learning::toTensor(centers, {samples, kEgoWaypoints, count, 2}, device),
          learning::toTensor(halves, {samples, kEgoWaypoints, count, 2}, device),
          learning::toTensor(there, {samples, kEgoWaypoints, count}, device)};
}

/// Masks of matched agents: where they lie in the logits, what they are to be, and their weights.
struct MaskTargets {
  std::vector<std::int64_t> rows;
  std::vector<float> masks;
  std::vector<float> weights;
};

MaskTargets maskTargets(const BevGrid& bev, const std::vector<const EgoExample*>& examples,
                        const QueryMatches& matches, std::int64_t slots) {
  MaskTargets targets;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    for (std::size_t i = 0; i < matches[b].size(); ++i) {
      const AgentLabel& label = examples[b]->agents[i];
      for (std::size_t step = 0; matches[b][i] >= 0 && step < kOccupancySteps; ++step) {
        if (step > label.future.known) break;
        const auto first = static_cast<std::int64_t>(b * kOccupancySteps + step);
        targets.rows.push_back(first * slots + matches[b][i]);
        targets.weights.push_back(
            static_cast<float>(std::pow(UniadLossOptions::kDiscount, static_cast<double>(step))));
        const std::vector<float> mask = maskOf(bev, boxAt(label, step));
        targets.masks.insert(targets.masks.end(), mask.begin(), mask.end());
      }
    }
  }
  return targets;
}

}  // namespace

std::vector<float> maskOf(const BevGrid& bev, const geometry::OrientedBox& box) {
  std::vector<float> mask;
  const double reach = 0.5 * std::hypot(box.length, box.width) + bev.cell;
  for (std::int64_t cell = 0; cell < bev.cells(); ++cell) {
    const geometry::OrientedBox square = {bev.center(cell), 0.0, bev.cell, bev.cell};
    const bool near = (square.center - box.center).norm() <= reach;
    mask.push_back(near && geometry::overlap(square, box) ? 1.0F : 0.0F);
  }
  return mask;
}

at::Tensor occupancyLoss(const at::Tensor& logits, const BevGrid& bev,
                         const std::vector<const EgoExample*>& examples,
                         const QueryMatches& matches) {
  const std::int64_t cells = logits.size(3);
  const MaskTargets targets = maskTargets(bev, examples, matches, logits.size(2));
  if (targets.rows.empty()) return at::zeros({}, logits.options());
  const at::Device device = logits.device();
  const auto count = static_cast<std::int64_t>(targets.rows.size());
  const at::Tensor seen = logits.reshape({-1, cells})
                              .index_select(0, learning::toIndices(targets.rows, {count}, device));
  const at::Tensor wanted = learning::toTensor(targets.masks, {count, cells}, device);
  const at::Tensor weights = learning::toTensor(targets.weights, {count}, device);
  const at::Tensor entropy =
      at::clamp_min(seen, 0.0) - seen * wanted + at::log1p(at::exp(-seen.abs()));
  const auto hardest = std::max<std::int64_t>(
      1, static_cast<std::int64_t>(UniadLossOptions::kHardest * static_cast<double>(cells)));
  const at::Tensor hard = std::get<0>(entropy.topk(hardest, 1)).mean(1);
  const at::Tensor p = at::sigmoid(seen);
  const at::Tensor dice =
      1.0 - (2.0 * (p * wanted).sum(1) + 1.0) / (p.sum(1) + wanted.sum(1) + 1.0);
  const at::Tensor each =
      UniadLossOptions::kMaskEntropy * hard + UniadLossOptions::kMaskDice * dice;
  return (each * weights).sum() / weights.sum();
}

at::Tensor averageDisplacement(const at::Tensor& plans,
                               const std::vector<const EgoExample*>& examples) {
  std::vector<float> driven, known;
  for (const EgoExample* example : examples) {
    for (std::size_t i = 0; i < example->driven.places.size(); ++i) {
      const bool counts = i < example->driven.known;
      driven.push_back(counts ? static_cast<float>(example->driven.places[i].x()) : 0.0F);
      driven.push_back(counts ? static_cast<float>(example->driven.places[i].y()) : 0.0F);
      known.push_back(counts ? 1.0F : 0.0F);
    }
  }
  const at::Tensor wanted = learning::toTensor(driven, plans.sizes(), plans.device());
  const at::Tensor counted =
      learning::toTensor(known, {plans.size(0), plans.size(1)}, plans.device());
  const at::Tensor apart = at::sqrt((plans - wanted).square().sum(2) + 1e-6);
  return (apart * counted).sum() / counted.sum().clamp_min(1.0);
}

std::array<double, kEgoWaypoints> drivenHeadings(const FuturePlaces& driven) {
  constexpr double kLeastWay = 0.1;  // shorter ones have no direction [m]
  std::array<double, kEgoWaypoints> headings{};
  Eigen::Vector2d before = Eigen::Vector2d::Zero();
  double heading = 0.0;
  for (std::size_t i = 0; i < driven.known; ++i) {
    const Eigen::Vector2d way = driven.places[i] - before;
    if (way.norm() > kLeastWay) heading = std::atan2(way.y(), way.x());
    headings[i] = heading;
    before = driven.places[i];
  }
  return headings;
}

at::Tensor overlapLoss(const at::Tensor& plans, const std::vector<const EgoExample*>& examples,
                       double inflated) {
  const Hulls hulls = hullsOf(examples, inflated, plans.device());
  const at::Tensor own = plans.unsqueeze(2);  // [B, 6, 1, 2]
  const at::Tensor low = at::max(own - hulls.own, hulls.centers - hulls.halves);
  const at::Tensor high = at::min(own + hulls.own, hulls.centers + hulls.halves);
  const at::Tensor sides = at::relu(high - low);
  const at::Tensor areas = sides.select(3, 0) * sides.select(3, 1) * hulls.there;
  return areas.sum(2).mean();
}

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
