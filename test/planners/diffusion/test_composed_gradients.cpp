// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/reference_denoiser.h"
#include "diffusion/sampling_batch.h"
#include "dynamics/action_rollout.h"
#include "guidance/guidance_world.h"
#include "guidance/objective_registry.h"
#include "planners/diffusion/guided_batch.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

using diffusion::Doubles;
using traffic::kActionColumns;
using traffic::kRolloutColumns;
using traffic::kStateColumns;
using traffic::Rollout;

constexpr int kStep = 3;  // of K = 5
constexpr double kWeight = 0.7;
constexpr std::size_t kRows = test::kRows;

/// A random small network, a vehicle 1.2 m left in a lane of 4 m with an oblique heading, another
/// 12 m ahead and two more near. Differences are taken on a path of its own: reference network,
/// normalizer formula and objective in double.
class ComposedGradients : public ::testing::Test {
 protected:
  ComposedGradients() {
    world_.scene().state = world_.placed(40.0, 1.2, 0.1, 8.0);
    denoiser_.setContexts({context_});
  }

  static diffusion::Architecture sizes() {
    diffusion::Architecture sizes = diffusion::smallArchitecture();
    sizes.horizon = static_cast<std::int64_t>(kRows);
    return sizes;
  }
  static guidance::GuidanceOptions only(const std::string& name) {
    guidance::GuidanceOptions options;
    options.find(name).weight = kWeight;
    return options;
  }
  /// Every objective of the table; they oppose each other.
  static guidance::GuidanceOptions all() {
    guidance::GuidanceOptions options;
    for (auto& entry : options.objectives) entry.weight = kWeight;
    return options;
  }

  /// J of a clean normalized trajectory.
  double valueOf(const guidance::GuidanceOptions& options, const Doubles& states,
                 const Doubles& actions) {
    Rollout metric(static_cast<Eigen::Index>(kRows), kRolloutColumns);
    for (Eigen::Index row = 0; row < metric.rows(); ++row) {
      for (int column = 0; column < kRolloutColumns; ++column) {
        const auto i = static_cast<std::size_t>(row);
        const auto c = static_cast<std::size_t>(column);
        const double cell = column < kStateColumns
                                ? states[i * kStateColumns + c]
                                : actions[i * kActionColumns + c - kStateColumns];
        metric(row, column) =
            model_.normalizer.mean(row, column) + model_.normalizer.scale(row, column) * cell;
      }
    }
    double sum = 0.0;
    for (const auto& entry : options.objectives) {
      if (entry.weight > 0.0)
        sum += entry.weight * test::valueOf(*entry.objective, world_.scene(), metric);
    }
    return sum;
  }
  double learnedValue(const guidance::GuidanceOptions& options, const Doubles& actions) {
    return valueOf(options, reference_.states(actions, kStep, context_), actions);
  }
  /// States by the dynamics from the actions as they are executed.
  double exactValue(const guidance::GuidanceOptions& options, const Doubles& actions) {
    Rollout rollout = Rollout::Zero(static_cast<Eigen::Index>(kRows), kRolloutColumns);
    const auto& [mean, scale] = model_.normalizer;
    const auto cellOf = [](Eigen::Index row, int column, int columns) {
      return static_cast<std::size_t>(row * columns + column);
    };
    for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
      for (int c = 0; c < kActionColumns; ++c)
        rollout(row, kStateColumns + c) =
            mean(row, kStateColumns + c) +
            scale(row, kStateColumns + c) * actions[cellOf(row, c, kActionColumns)];
    }
    dynamics::makeExecutable(rollout);
    dynamics::ActionRollout().rollOut(world_.scene().state.speed, rollout);
    Doubles states(kRows * kStateColumns);
    for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
      for (int c = 0; c < kStateColumns; ++c)
        states[cellOf(row, c, kStateColumns)] = (rollout(row, c) - mean(row, c)) / scale(row, c);
    }
    return valueOf(options, states, actions);
  }

  /// dJ/d(actions) of the sampler's own path.
  std::vector<float> actionGradient(const guidance::GuidanceOptions& options,
                                    diffusion::StateBranch& branch,
                                    const std::vector<float>& actions) {
    guidance::TotalObjective objective(options, world_.scene());
    GuidedBatch guided(model_.normalizer, {&objective});
    diffusion::SamplingBatch batch(1, static_cast<Eigen::Index>(kRows));
    std::copy(actions.begin(), actions.end(), batch.actions(0));
    batch.predictStates(branch, kStep);
    batch.evaluate(guided, kStep);
    return batch.actionGradient(branch);
  }
  /// dJ/d(tau^k) of the sampler's own path, as mode `paper` uses it.
  std::vector<float> noisyGradient(const guidance::GuidanceOptions& options,
                                   const std::vector<float>& noisy) {
    guidance::TotalObjective objective(options, world_.scene());
    GuidedBatch guided(model_.normalizer, {&objective});
    diffusion::SamplingBatch batch(1, static_cast<Eigen::Index>(kRows));
    std::copy(noisy.begin(), noisy.end(), batch.noisy(0));
    diffusion::LearnedStateBranch branch(denoiser_);
    batch.predict(denoiser_, branch, kStep);
    batch.evaluate(guided, kStep);
    return batch.noisyGradient(denoiser_, branch);
  }

  test::GuidanceWorld world_;
  diffusion::Model model_ = cdiff::testing::randomDenoiser(sizes());
  diffusion::ReferenceDenoiser reference_{model_};
  diffusion::CpuDenoiser denoiser_{model_};
  diffusion::Context context_ = diffusion::randomContext(sizes(), 4);
};

using Function = std::function<double(const Doubles&)>;

/// Central differences. In double with values up to 1e4 and step 1e-5: rounding 1e4 x 2e-16 / 1e-5
/// = 2e-7, truncation h^2 / 6 J''' = 2e-11 J'''.
Doubles differences(const Function& function, const Doubles& point) {
  constexpr double kDifference = 1e-5;
  Doubles result;
  for (std::size_t i = 0; i < point.size(); ++i) {
    Doubles above = point;
    Doubles below = point;
    above[i] += kDifference;
    below[i] -= kDifference;
    result.push_back((function(above) - function(below)) / (2.0 * kDifference));
  }
  return result;
}

/// The sampler's path is in float32 (2^-24 = 6e-8): states agree with the reference within 1e-5 of
/// the largest (test_diffusion_cpu_denoiser), so a gradient whose relative change per normalized
/// unit is up to 10 agrees within 1e-4 of its largest cell; its own sums of up to 200 products add
/// 200 x 6e-8 = 1e-5. A forgotten factor of the normalizer (0.5 or 5) or of a head is 0.5 at least.
constexpr double kTolerance = 2e-4;

constexpr double kTiny = 1e-3;

double largestOf(const Doubles& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// The largest difference over the largest expected value; 1 where all of these are tiny.
double errorOf(const std::vector<float>& gradient, const Doubles& expected) {
  return largestOf(expected) < kTiny ? 1.0 : diffusion::relativeError(gradient, expected);
}

TEST_F(ComposedGradients, EachObjectiveThroughTheStateHeadToTheActions) {
  const std::vector<float> actions = diffusion::randomValues(3 * test::kRows, 3);
  diffusion::LearnedStateBranch branch(denoiser_);
  for (const std::string& name : guidance::objectiveNames()) {
    const guidance::GuidanceOptions options = only(name);
    const Doubles expected =
        differences([&](const Doubles& at) { return learnedValue(options, at); },
                    diffusion::toDoubles(actions));
    EXPECT_LT(errorOf(actionGradient(options, branch, actions), expected), kTolerance) << name;
  }
}

TEST_F(ComposedGradients, EachObjectiveThroughTheNetworkToTheNoisyTrajectory) {
  const std::vector<float> noisy = diffusion::randomValues(7 * test::kRows, 5);
  for (const std::string& name : guidance::objectiveNames()) {
    const guidance::GuidanceOptions options = only(name);
    const Doubles expected = differences(
        [&](const Doubles& at) {
          return learnedValue(options, reference_.actions(at, kStep, context_));
        },
        diffusion::toDoubles(noisy));
    EXPECT_LT(errorOf(noisyGradient(options, noisy), expected), kTolerance) << name;
  }
}

TEST_F(ComposedGradients, SumOfAllObjectives) {
  const guidance::GuidanceOptions options = all();
  const std::vector<float> actions = diffusion::randomValues(3 * test::kRows, 3);
  diffusion::LearnedStateBranch branch(denoiser_);
  EXPECT_LT(errorOf(actionGradient(options, branch, actions),
                    differences([&](const Doubles& at) { return learnedValue(options, at); },
                                diffusion::toDoubles(actions))),
            kTolerance);
}

/// Normalized actions off every bound and switch: rows drive with throttle 0.4 to 0.9, every third
/// brakes with 0.1 to 0.4; the pedal that does not act is 0.1 beyond its bound 0.
std::vector<float> smoothActions(const diffusion::Normalizer& normalizer) {
  const core::RandomStream random(6, "actions");
  std::vector<float> actions;
  for (Eigen::Index row = 0; row < test::kRows; ++row) {
    const auto draw = [&](std::uint32_t element, double low, double high) {
      return random.uniform({0, static_cast<std::uint32_t>(row)}, element, low, high);
    };
    const bool brakes = row % 3 == 2;
    const double metric[] = {brakes ? -0.1 : draw(0, 0.4, 0.9), draw(1, -0.6, 0.6),
                             brakes ? draw(2, 0.1, 0.4) : -0.1};
    for (int c = 0; c < kActionColumns; ++c) {
      const int column = kStateColumns + c;
      actions.push_back(static_cast<float>((metric[c] - normalizer.mean(row, column)) /
                                           normalizer.scale(row, column)));
    }
  }
  return actions;
}

/// Of the pedal that does not act: its derivative is straight-through, not that of the difference.
bool isIdlePedal(std::size_t cell) {
  const bool brakes = cell / 3 % 3 == 2;
  return cell % 3 == (brakes ? 0 : 2);
}

TEST_F(ComposedGradients, EachObjectiveThroughTheDynamicsToTheActions) {
  const std::vector<float> actions = smoothActions(model_.normalizer);
  for (const std::string& name : guidance::objectiveNames()) {
    const guidance::GuidanceOptions options = only(name);
    int acting = 0;
    for (const double speed : {8.0, 1.0}) {
      world_.scene().state.speed = speed;
      diffusion::ExactStateBranch branch({}, model_.normalizer, {speed});
      Doubles expected = differences([&](const Doubles& at) { return exactValue(options, at); },
                                     diffusion::toDoubles(actions));
      std::vector<float> gradient = actionGradient(options, branch, actions);
      for (std::size_t i = 0; i < gradient.size(); ++i) {
        if (isIdlePedal(i)) gradient[i] = 0.0F;
        if (isIdlePedal(i)) expected[i] = 0.0;
      }
      if (largestOf(expected) < kTiny && largestOf(diffusion::toDoubles(gradient)) < kTiny)
        continue;
      EXPECT_LT(errorOf(gradient, expected), kTolerance) << name << " at " << speed << " m/s";
      ++acting;
    }
    EXPECT_GT(acting, 0) << name << " acts at neither speed";
  }
}

}  // namespace
}  // namespace cdiff::planners
