// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_losses.h"

#include <array>
#include <cmath>

namespace cdiff::planners {
namespace {

constexpr double kTemperature = 0.1;
constexpr double kMargin = 0.2;  // that circles are smaller [m]
constexpr std::size_t kCircles = 3;

/// Sum over the last axis of smooth L1, mean over what counts.
at::Tensor meanSmoothL1(const at::Tensor& values, const at::Tensor& targets,
                        const at::Tensor& weights) {
  const at::Tensor errors =
      at::smooth_l1_loss(values, targets, at::Reduction::None).sum(-1, true) * weights;
  return errors.sum() / weights.sum().clamp_min(1.0);
}

/// Trajectories [B, 80, 6] whose places [m] are along the headings of `targets` and, `kAcross`
/// times, to the left of them: what leads off the road counts more than what is early or late.
at::Tensor alongAndAcross(const at::Tensor& values, const at::Tensor& targets) {
  constexpr double kAcross = 4.0;
  const at::Tensor x = values.select(2, 0);
  const at::Tensor y = values.select(2, 1);
  const at::Tensor cosine = targets.select(2, 2);
  const at::Tensor sine = targets.select(2, 3);
  return at::cat({at::stack({x * cosine + y * sine, kAcross * (y * cosine - x * sine)}, 2),
                  values.narrow(2, 2, kPlutoChannels - 2)},
                 2);
}

/// Excess of circles over the signed distance, and its gradient, at the places of a plan.
struct AreaRows {
  std::vector<float> excess;     ///< [B, 80, 3]
  std::vector<float> gradients;  ///< [B, 80, 3, 2], by the circle's place in the body frame
};

double circleRadius(const traffic::VehicleDimensions& size) {
  return 0.5 * std::hypot(size.width, size.length / 3.0) - kMargin;
}

void addCircle(const PlutoExample& example, std::size_t step, const Eigen::Vector2d& center,
               AreaRows& rows) {
  const map::SignedDistance found = example.world->area.signedDistanceWithGradient(
      example.frame.toMap(center), example.target.elevations[step]);
  const double excess = circleRadius(example.size) - found.distance;
  const bool outside = excess > 0.0;
  const Eigen::Vector2d forward = geometry::direction(example.frame.heading);
  rows.excess.push_back(outside ? static_cast<float>(excess) : 0.0F);
  for (const Eigen::Vector2d& axis : {forward, geometry::leftNormal(forward)}) {
    const double slope = outside ? -axis.dot(found.gradient) : 0.0;
    rows.gradients.push_back(static_cast<float>(slope));
  }
}

std::array<double, kCircles> circleOffsets(const traffic::VehicleDimensions& size) {
  return {-size.length / 3.0, 0.0, size.length / 3.0};
}

/// Places of the circles of plans [B, 80, 3, 2].
at::Tensor circlePlaces(const at::Tensor& plans, const std::vector<const PlutoExample*>& examples) {
  std::vector<float> offsets;
  for (const PlutoExample* example : examples) {
    for (const double offset : circleOffsets(example->size))
      offsets.push_back(static_cast<float>(offset));
  }
  const auto count = static_cast<std::int64_t>(examples.size());
  const at::Tensor along = learning::toTensor(offsets, {count, 1, kCircles, 1}, plans.device());
  const at::Tensor heading = plans.narrow(2, 2, 2);
  const at::Tensor unit = heading / (heading.norm(2, {2}, true) + 1e-6);
  return plans.narrow(2, 0, 2).unsqueeze(2) + along * unit.unsqueeze(2);
}

}  // namespace

at::Tensor areaLoss(const at::Tensor& plans, const at::Tensor& weights,
                    const std::vector<const PlutoExample*>& examples) {
  const at::Tensor places = circlePlaces(plans, examples);
  const std::vector<float> centers = learning::toVector(places);
  const std::size_t per_step = kCircles * 2;
  const auto per_example = static_cast<std::size_t>(kPlutoSteps) * per_step;
  AreaRows rows;
  for (std::size_t i = 0; i < centers.size(); i += 2) {
    addCircle(*examples[i / per_example], i % per_example / per_step,
              Eigen::Vector2d(static_cast<double>(centers[i]), static_cast<double>(centers[i + 1])),
              rows);
  }
  const at::Tensor excess =
      learning::toTensor(rows.excess, {plans.size(0), kPlutoSteps, kCircles}, plans.device());
  const at::Tensor slopes =
      learning::toTensor(rows.gradients, {plans.size(0), kPlutoSteps, kCircles, 2}, plans.device());
  const at::Tensor value = excess + (slopes * (places - places.detach())).sum(3);
  const double circles = static_cast<double>(kCircles);
  return (value * weights).sum() / (circles * weights.sum()).clamp_min(1.0);
}

at::Tensor contrastLoss(const at::Tensor& anchors, const at::Tensor& positives,
                        const at::Tensor& negatives) {
  const at::Tensor both =
      at::stack({(anchors * positives).sum(1), (anchors * negatives).sum(1)}, 1) / kTemperature;
  return -at::log_softmax(both, 1).select(1, 0).mean();
}

namespace {

at::Tensor rowsOf(const at::Tensor& tokens, const std::vector<Triplet>& triplets,
                  std::int64_t Triplet::*part) {
  at::Tensor indices = at::empty({static_cast<std::int64_t>(triplets.size())}, at::kLong);
  for (std::size_t i = 0; i < triplets.size(); ++i)
    indices.data_ptr<std::int64_t>()[i] = triplets[i].*part;
  return tokens.index_select(0, indices.to(tokens.device()));
}

/// Of agents whose future is known.
at::Tensor forecastLoss(const PlutoNet& net, const PlutoBatch& batch, const at::Tensor& tokens) {
  const std::int64_t agents = batch.history.size(1);
  const at::Tensor weights =
      (batch.agent_weight * batch.imitates.reshape({-1, 1, 1, 1})).flatten(0, 1);
  const at::Tensor known = weights.sum({1, 2}).nonzero().squeeze(1);
  if (known.size(0) == 0) return at::zeros({}, tokens.options());
  const at::Tensor rows = tokens.narrow(1, 1, agents).flatten(0, 1).index_select(0, known);
  return meanSmoothL1(net.forecasts(rows), batch.agent_future.flatten(0, 1).index_select(0, known),
                      weights.index_select(0, known));
}

at::Tensor scoreLoss(const PlutoNet& net, const PlutoBatch& batch, const at::Tensor& queries) {
  const std::int64_t moments = queries.size(0);
  const std::int64_t count = queries.size(1);
  const at::Tensor mask =
      batch.line_mask.unsqueeze(2).expand({moments, count / kPlutoModes, kPlutoModes});
  const at::Tensor logits =
      net.scores(queries.flatten(0, 1)).reshape({moments, count}) + mask.reshape({moments, count});
  const at::Tensor chosen =
      at::log_softmax(logits, 1).gather(1, batch.chosen.unsqueeze(1)).squeeze(1);
  return -(chosen * batch.imitates).sum() / batch.imitates.sum().clamp_min(1.0);
}

}  // namespace

learning::Loss plutoLoss(const PlutoNet& net, const PlutoBatch& batch,
                         const std::vector<const PlutoExample*>& examples,
                         const LayerFactors& factors, const std::vector<Triplet>& triplets) {
  const PlutoNet::Features features = net.forward(batch, factors);
  const at::Tensor own = features.tokens.select(1, 0);
  const at::Tensor weights = batch.future_weight * batch.imitates.reshape({-1, 1, 1});
  const at::Tensor place =
      batch.chosen.reshape({-1, 1, 1}).expand({-1, 1, features.queries.size(2)});
  const at::Tensor plans = net.trajectories(features.queries.gather(1, place).squeeze(1));
  learning::Loss loss;
  loss.terms = {
      {"plan", meanSmoothL1(alongAndAcross(plans, batch.future),
                            alongAndAcross(batch.future, batch.future), weights)},
      {"score", scoreLoss(net, batch, features.queries)},
      {"forecast", forecastLoss(net, batch, features.tokens)},
      {"free", meanSmoothL1(net.freePlans(own), batch.future.narrow(2, 0, kFreeChannels), weights)},
      {"area", areaLoss(plans, weights, examples)}};
  if (!triplets.empty()) {
    const at::Tensor directions = net.contrasts(own);
    loss.terms.emplace_back("contrast",
                            contrastLoss(rowsOf(directions, triplets, &Triplet::anchor),
                                         rowsOf(directions, triplets, &Triplet::positive),
                                         rowsOf(directions, triplets, &Triplet::negative)));
  }
  loss.total = at::zeros({}, own.options());
  for (const auto& [name, term] : loss.terms) loss.total = loss.total + term;
  return loss;
}

}  // namespace cdiff::planners
