// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/policy_plans.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "inference/precision.h"
#include "planners/rift/rift_reward.h"
#include "planning/route_follower.h"

namespace cdiff::collection {
namespace {

using traffic::Rollout;

diffusion::SamplerOptions unguidedSampler() {
  diffusion::SamplerOptions options;
  options.mode = "real_time";  // with no objective
  return options;
}

/// The vehicle as a row of its rollout has it, from `start`.
traffic::Vehicle atRow(const traffic::Vehicle& start, const Rollout& rollout, Eigen::Index row,
                       double elevation) {
  traffic::Vehicle vehicle = start;
  vehicle.state.position = start.state.pose().toMap(
      {rollout(row, traffic::kRolloutX), rollout(row, traffic::kRolloutY)});
  vehicle.state.heading =
      core::wrapAngle(start.state.heading + rollout(row, traffic::kRolloutHeading));
  vehicle.state.speed = rollout(row, traffic::kRolloutSpeed);
  vehicle.state.elevation = elevation;
  return vehicle;
}

bool collides(const traffic::Vehicle& vehicle, const traffic::TrafficSnapshot& snapshot) {
  constexpr double kNear = 30.0;  // [m]
  return std::any_of(
      snapshot.vehicles.begin(), snapshot.vehicles.end(), [&](const traffic::Vehicle& other) {
        return other.id != vehicle.id && !traffic::onDifferentLevels(vehicle, other) &&
               (other.state.position - vehicle.state.position).norm() < kNear &&
               geometry::overlap(vehicle.box(), other.box());
      });
}

bool offRoad(const traffic::Vehicle& vehicle, const map::DrivableArea& area) {
  return area.signedDistance(vehicle.box(), vehicle.state.elevation) < 0.0;
}

}  // namespace

double rolloutReturn(const Rollout& rollout, const traffic::Vehicle& vehicle,
                     const SampleSurroundings& around,
                     const std::vector<const traffic::TrafficSnapshot*>& future) {
  double sum = 0.0;
  double discount = 1.0;
  double arc_length = around.arc_length;
  double last_speed = vehicle.state.speed;
  double last_heading = 0.0;
  double last_turn = 0.0;  // [rad/s]
  for (Eigen::Index t = 0; t < rollout.rows(); ++t) {
    const traffic::TrafficSnapshot& snapshot = *future.at(static_cast<std::size_t>(t));
    const traffic::Vehicle* recorded = snapshot.find(vehicle.id);
    const double elevation =
        recorded == nullptr ? vehicle.state.elevation : recorded->state.elevation;
    const traffic::Vehicle here = atRow(vehicle, rollout, t, elevation);
    const double reach = std::max(1.0, here.state.speed);
    arc_length = planning::extendedProjection(around.route, here.state.position, arc_length - reach,
                                              arc_length + reach);
    const double place = std::clamp(arc_length, 0.0, around.route.length());
    const double turn =
        (rollout(t, traffic::kRolloutHeading) - last_heading) / traffic::kRolloutStep;
    planners::RiftStep step;
    step.speed = here.state.speed;
    step.acceleration = (here.state.speed - last_speed) / traffic::kRolloutStep;
    step.yaw_acceleration = t == 0 ? 0.0 : (turn - last_turn) / traffic::kRolloutStep;
    step.offset = (around.route.path().positionAt(place) - here.state.position).norm();
    step.heading_error =
        core::angleDifference(here.state.heading, around.route.path().headingAt(place));
    step.off_road = offRoad(here, around.setup.drivableArea());
    step.collides = collides(here, snapshot);
    sum += discount * planners::riftReward(step);
    if (step.collides) break;
    discount *= planners::kRiftDiscount;
    last_speed = here.state.speed;
    last_heading = rollout(t, traffic::kRolloutHeading);
    last_turn = turn;
  }
  return sum;
}

std::vector<double> returnWeights(const std::vector<double>& returns) {
  constexpr double kTemperature = 0.5;
  constexpr double kMost = 3.0;
  const auto count = static_cast<double>(returns.size());
  const double mean = std::accumulate(returns.begin(), returns.end(), 0.0) / count;
  double variance = 0.0;
  for (const double value : returns) variance += (value - mean) * (value - mean) / count;
  std::vector<double> weights;
  for (const double value : returns) {
    const double advantage = (value - mean) / (std::sqrt(variance) + 1e-5);
    weights.push_back(std::min(kMost, std::exp(advantage / kTemperature)));
  }
  return weights;
}

PolicyPlans::PolicyPlans(const std::string& model, std::int64_t count,
                         const session::SessionSetup& setup)
    : count_(count),
      model_(diffusion::loadModel(model)),
      schedule_(static_cast<int>(model_.architecture.diffusion_steps)),
      encoder_(model_, inference::precisionNamed("auto", "auto", "collection.policy_plans")),
      denoiser_(model_),
      sampler_(
          unguidedSampler(), schedule_, model_.spread,
          core::RandomStream(static_cast<std::uint64_t>(setup.options().seed), "policy_plans")),
      dynamics_(setup.options().vehicle),
      choice_(static_cast<std::uint64_t>(setup.options().seed), "policy_plans_choice") {
  if (!model_.architecture.takesRoute())
    throw core::InputError("collection.policy_plans: model '" + model + "' takes no route");
  const diffusion::Architecture samples;
  if (model_.architecture.horizon != samples.horizon ||
      model_.architecture.image_width != samples.image_width ||
      model_.architecture.image_height != samples.image_height ||
      model_.architecture.route_points != samples.route_points ||
      model_.architecture.route_spacing != samples.route_spacing) {
    throw core::InputError(
        "collection.policy_plans: model '" + model +
        "' has another horizon, image size or number or spacing of route points than the "
        "samples");
  }
}

std::vector<Rollout> PolicyPlans::plansFor(const learning::DrivingSample& sample) {
  diffusion::Context context;
  context.image_features = encoder_.encode(sample.image);
  context.route = sample.route;
  context.speed = sample.speed;
  if (model_.architecture.takesPrevious() && !sample.previous_image.empty())
    context.previous = encoder_.encode(sample.previous_image);
  if (model_.architecture.takesTarget() && std::isfinite(sample.target_speed))
    context.target_speed = sample.target_speed;
  std::vector<diffusion::SampleRequest> requests;
  for (std::int64_t i = 0; i < count_; ++i) {
    requests.push_back(
        {{core::hashText(sample.vehicle), static_cast<std::uint32_t>(sample.tick), 0},
         static_cast<std::uint32_t>(i),
         nullptr});
  }
  denoiser_.setContexts(std::vector<diffusion::Context>(requests.size(), context));
  diffusion::LearnedStateBranch states(denoiser_);
  std::vector<Rollout> plans;
  for (const auto& sampled : sampler_.sample(denoiser_, states, requests, nullptr)) {
    plans.push_back(model_.normalizer.denormalize(sampled.clean));
    dynamics::makeExecutable(plans.back());
    dynamics_.rollOut(sample.speed, plans.back());
  }
  return plans;
}

std::optional<learning::DrivingSample> PolicyPlans::improved(
    const learning::DrivingSample& sample, const SampleSurroundings& around,
    const std::vector<const traffic::TrafficSnapshot*>& future) {
  const traffic::Vehicle& vehicle = *around.snapshot.find(sample.vehicle);
  std::vector<Rollout> plans = plansFor(sample);
  std::vector<double> returns;
  for (const Rollout& plan : plans) returns.push_back(rolloutReturn(plan, vehicle, around, future));
  const auto [least, most] = std::minmax_element(returns.begin(), returns.end());
  if (*most - *least < 1e-9) return std::nullopt;
  const std::vector<double> weights = returnWeights(returns);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  const core::RandomKey key{core::hashText(sample.vehicle), static_cast<std::uint32_t>(sample.tick),
                            0};
  double left = choice_.uniform(key, 0) * total;
  std::size_t chosen = 0;
  while (chosen + 1 < weights.size() && left >= weights[chosen]) left -= weights[chosen++];
  learning::DrivingSample improved = sample;
  improved.rollout = plans[chosen];
  return improved;
}

}  // namespace cdiff::collection
