// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/set_losses.h"

#include <algorithm>
#include <cmath>

#include "learning/parameters.h"
#include "planners/camera_ego/hungarian.h"

namespace cdiff::planners {
namespace {

constexpr double kAlpha = 0.25;
constexpr std::size_t kVelocity = 8;  // where vx and vy begin in a box
constexpr std::size_t kLineNumbers = 2 * kLinePoints;

/// A tensor's numbers on the processor.
std::vector<float> numbersOf(const at::Tensor& tensor) {
  return learning::toVector(tensor.detach().to(at::kCPU).contiguous());
}

double boxCost(const float* box, const AgentBox& label, double velocity) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kAgentBoxNumbers; ++i)
    sum += (i < kVelocity ? 1.0 : velocity) * std::abs(static_cast<double>(box[i] - label[i]));
  return sum;
}

/// The query of each label; where there are more labels than queries, the first labels get one.
std::vector<int> matched(const std::vector<double>& cost, std::size_t labels, std::size_t queries) {
  const std::size_t rows = std::min(labels, queries);
  std::vector<int> result = hungarian(
      {cost.begin(), cost.begin() + static_cast<std::ptrdiff_t>(rows * queries)}, rows, queries);
  result.resize(labels, -1);
  return result;
}

/// A label's points as shares of the BEV, from either end.
std::vector<float> sharesOf(const BevLine& line, const BevGrid& bev, bool reversed) {
  std::vector<float> shares;
  for (std::size_t i = 0; i < kLinePoints; ++i) {
    const Eigen::Vector2d share = bev.toShare(line.points[reversed ? kLinePoints - 1 - i : i]);
    shares.push_back(static_cast<float>(share.x()));
    shares.push_back(static_cast<float>(share.y()));
  }
  return shares;
}

double pointCost(const float* points, const std::vector<float>& label) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kLineNumbers; ++i)
    sum += std::abs(static_cast<double>(points[i] - label[i]));
  return sum;
}

/// Targets of a batch of queries, filled label by label.
struct LineTargets {
  std::vector<float> kinds;    ///< [B, L, 3]
  std::vector<float> points;   ///< [B, L, 10, 2]
  std::vector<float> weights;  ///< [B, L]
  double count = 0.0;
};

/// What the queries of one sample say of lines.
struct LineQueries {
  const float* logits;  ///< [count, 3]
  const float* lines;   ///< [count, 10, 2]
  std::size_t count;
};

/// One sample's lines: costs, matching, targets.
void addLineTargets(const LineQueries& queries, const std::vector<BevLine>& labels,
                    const BevGrid& bev, const SetLossWeights& weights, std::size_t sample,
                    LineTargets& targets) {
  constexpr std::size_t kKinds = 3;
  std::vector<double> cost;
  std::vector<std::vector<std::vector<float>>> ends;  // by label: from its begin, from its end
  for (const BevLine& label : labels) {
    ends.push_back({sharesOf(label, bev, false)});
    if (hasNoDirection(label.kind)) ends.back().push_back(sharesOf(label, bev, true));
    for (std::size_t q = 0; q < queries.count; ++q) {
      double least = 1e9;
      for (const auto& end : ends.back())
        least = std::min(least, pointCost(queries.lines + q * kLineNumbers, end));
      cost.push_back(
          weights.line_kind *
              focalCost(queries.logits[q * kKinds + static_cast<std::size_t>(label.kind)]) +
          weights.line_points * least);
    }
  }
  const std::vector<int> found = matched(cost, labels.size(), queries.count);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (found[i] < 0) continue;
    const std::size_t q = static_cast<std::size_t>(found[i]), row = sample * queries.count + q;
    const float* points = queries.lines + q * kLineNumbers;
    const bool from_end =
        ends[i].size() > 1 && pointCost(points, ends[i][1]) < pointCost(points, ends[i][0]);
    targets.kinds[row * kKinds + static_cast<std::size_t>(labels[i].kind)] = 1.0F;
    std::copy(ends[i][from_end].begin(), ends[i][from_end].end(),
              targets.points.begin() + static_cast<std::ptrdiff_t>(row * kLineNumbers));
    targets.weights[row] = 1.0F;
    targets.count += 1.0;
  }
}

/// Unit vectors from point to point, in meters.
at::Tensor directionsOf(const at::Tensor& shares, const BevGrid& bev) {
  const at::Tensor size = learning::toTensor(
      {static_cast<float>(bev.length()), static_cast<float>(bev.width())}, {2}, shares.device());
  const at::Tensor meters = shares * size;
  const auto points = static_cast<std::int64_t>(kLinePoints);
  const at::Tensor way = meters.narrow(2, 1, points - 1) - meters.narrow(2, 0, points - 1);
  return way / (way.norm(2, {3}, true) + 1e-3);
}

}  // namespace

double focalCost(double logit) {
  constexpr double kSmall = 1e-12;
  const double p = 1.0 / (1.0 + std::exp(-logit));
  const double positive = -std::log(p + kSmall) * (1.0 - p) * (1.0 - p) * kAlpha;
  const double negative = -std::log(1.0 - p + kSmall) * p * p * (1.0 - kAlpha);
  return positive - negative;
}

at::Tensor focalLoss(const at::Tensor& logits, const at::Tensor& targets) {
  const at::Tensor p = at::sigmoid(logits);
  const at::Tensor miss = targets * (1.0 - p) + (1.0 - targets) * p;
  const at::Tensor share = targets * kAlpha + (1.0 - targets) * (1.0 - kAlpha);
  const at::Tensor entropy =
      at::clamp_min(logits, 0.0) - logits * targets + at::log1p(at::exp(-logits.abs()));
  return (share * miss.square() * entropy).sum();
}

QueryMatches matchAgents(const at::Tensor& logits, const at::Tensor& boxes,
                         const std::vector<const EgoExample*>& examples,
                         const SetLossWeights& weights) {
  const std::vector<float> scores = numbersOf(logits), places = numbersOf(boxes);
  const auto queries = static_cast<std::size_t>(logits.size(1));
  QueryMatches matches;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    std::vector<double> cost;
    for (const AgentLabel& label : examples[b]->agents) {
      for (std::size_t q = 0; q < queries; ++q) {
        const std::size_t row = b * queries + q;
        cost.push_back(weights.kind * focalCost(static_cast<double>(scores[row])) +
                       weights.box * boxCost(places.data() + row * kAgentBoxNumbers, label.box,
                                             weights.velocity));
      }
    }
    matches.push_back(matched(cost, examples[b]->agents.size(), queries));
  }
  return matches;
}

AgentLoss agentLoss(const at::Tensor& logits, const at::Tensor& boxes,
                    const std::vector<const EgoExample*>& examples, const QueryMatches& matches,
                    const SetLossWeights& weights) {
  const auto queries = static_cast<std::size_t>(logits.size(1));
  std::vector<float> kinds(examples.size() * queries), targets(kinds.size() * kAgentBoxNumbers),
      shares(targets.size());
  double count = 0.0;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    for (std::size_t i = 0; i < matches[b].size(); ++i) {
      if (matches[b][i] < 0) continue;
      const std::size_t row = b * queries + static_cast<std::size_t>(matches[b][i]);
      kinds[row] = 1.0F;
      count += 1.0;
      for (std::size_t n = 0; n < kAgentBoxNumbers; ++n) {
        targets[row * kAgentBoxNumbers + n] = examples[b]->agents[i].box[n];
        shares[row * kAgentBoxNumbers + n] =
            n < kVelocity ? 1.0F : static_cast<float>(weights.velocity);
      }
    }
  }
  const at::Device device = logits.device();
  const at::Tensor wanted = learning::toTensor(targets, boxes.sizes(), device);
  const at::Tensor counted = learning::toTensor(shares, boxes.sizes(), device);
  const double scale = 1.0 / std::max(1.0, count);
  return {
      weights.kind * scale * focalLoss(logits, learning::toTensor(kinds, logits.sizes(), device)),
      weights.box * scale * ((boxes - wanted).abs() * counted).sum()};
}

LineLoss lineLoss(const at::Tensor& logits, const at::Tensor& lines,
                  const std::vector<const EgoExample*>& examples, const BevGrid& bev,
                  const SetLossWeights& weights) {
  const std::vector<float> scores = numbersOf(logits), places = numbersOf(lines);
  const auto queries = static_cast<std::size_t>(logits.size(1));
  LineTargets targets{std::vector<float>(scores.size()), std::vector<float>(places.size()),
                      std::vector<float>(examples.size() * queries), 0.0};
  for (std::size_t b = 0; b < examples.size(); ++b)
    addLineTargets(
        {scores.data() + b * queries * 3, places.data() + b * queries * kLineNumbers, queries},
        examples[b]->lines, bev, weights, b, targets);
  const at::Device device = logits.device();
  const at::Tensor kinds = learning::toTensor(targets.kinds, logits.sizes(), device);
  const at::Tensor points = learning::toTensor(targets.points, lines.sizes(), device);
  const at::Tensor counted =
      learning::toTensor(targets.weights, {logits.size(0), logits.size(1), 1}, device);
  const double scale = 1.0 / std::max(1.0, targets.count);
  const at::Tensor along =
      (directionsOf(lines, bev) * directionsOf(points, bev)).sum(3);  // [B, L, 9]
  return {weights.line_kind * scale * focalLoss(logits, kinds),
          weights.line_points * scale * ((lines - points).abs() * counted.unsqueeze(3)).sum(),
          weights.line_direction * scale * ((1.0 - along) * counted).sum()};
}

}  // namespace cdiff::planners
