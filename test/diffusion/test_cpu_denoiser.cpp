// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/reference_denoiser.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

using InstructionSet = CpuDenoiser::InstructionSet;

/// A model with a batch of contexts, the second without route, and inputs.
struct Case {
  explicit Case(const Architecture& architecture, std::uint32_t samples)
      : model(randomModel(architecture)), rows(architecture.horizon) {
    for (std::uint32_t b = 0; b < samples; ++b) {
      contexts.push_back(randomContext(architecture, b, b != 1));
    }
    noisy = randomValues(samples * rows * 7, 1);
    action_gradient = randomValues(samples * rows * 3, 2);
    actions = randomValues(samples * rows * 3, 3);
    state_gradient = randomValues(samples * rows * 4, 4);
  }
  /// Sample b of an array of `columns`.
  std::vector<float> part(const std::vector<float>& values, std::size_t b,
                          std::int64_t columns) const {
    const std::ptrdiff_t size = rows * columns;
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(b) * size;
    return std::vector<float>(first, first + size);
  }

  Model model;
  std::int64_t rows;
  std::vector<Context> contexts;
  std::vector<float> noisy, action_gradient, actions, state_gradient;
};

/// Everything a denoiser computes for a case.
struct Results {
  std::vector<float> actions, noisy_gradient, states, action_gradient;
};

Results resultsOf(CpuDenoiser& denoiser, const Case& given, int k) {
  Results results;
  const auto values = given.contexts.size() * static_cast<std::size_t>(given.rows);
  results.actions.resize(values * 3);
  results.noisy_gradient.resize(values * 7);
  results.states.resize(values * 4);
  results.action_gradient.resize(values * 3);
  denoiser.setContexts(given.contexts);
  denoiser.predictActions(given.noisy.data(), k, results.actions.data());
  denoiser.backwardActions(given.action_gradient.data(), results.noisy_gradient.data());
  denoiser.predictStates(given.actions.data(), k, results.states.data());
  denoiser.backwardStates(given.state_gradient.data(), results.action_gradient.data());
  return results;
}

/// J direction by central differences of `function` at `point`.
template <class Function>
Doubles directional(const Function& function, const Doubles& point, const Doubles& direction) {
  constexpr double kStep = 1e-4;
  Doubles ahead = point;
  Doubles behind = point;
  for (std::size_t i = 0; i < point.size(); ++i) {
    ahead[i] += kStep * direction[i];
    behind[i] -= kStep * direction[i];
  }
  Doubles result = function(ahead);
  const Doubles subtracted = function(behind);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = (result[i] - subtracted[i]) / (2.0 * kStep);
  }
  return result;
}

/// J^T gradient, one unit direction after the other.
template <class Function>
Doubles pulledBack(const Function& function, const Doubles& point, const Doubles& gradient) {
  Doubles result;
  for (std::size_t i = 0; i < point.size(); ++i) {
    Doubles unit(point.size(), 0.0);
    unit[i] = 1.0;
    result.push_back(dot(directional(function, point, unit), gradient));
  }
  return result;
}

class CpuDenoiserOf : public testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    if (GetParam() > CpuDenoiser::bestInstructionSet()) {
      GTEST_SKIP() << "this CPU lacks " << CpuDenoiser::toText(GetParam());
    }
  }
};

void expectForward(const Case& given, InstructionSet set, int k) {
  CpuDenoiser denoiser(given.model, set);
  const Results results = resultsOf(denoiser, given, k);
  const ReferenceDenoiser reference(given.model);
  for (std::size_t b = 0; b < given.contexts.size(); ++b) {
    const Doubles actions =
        reference.actions(toDoubles(given.part(given.noisy, b, 7)), k, given.contexts[b]);
    EXPECT_LT(relativeError(given.part(results.actions, b, 3), actions), 1e-5);
    const Doubles states =
        reference.states(toDoubles(given.part(given.actions, b, 3)), k, given.contexts[b]);
    EXPECT_LT(relativeError(given.part(results.states, b, 4), states), 1e-5);
  }
}

TEST_P(CpuDenoiserOf, SmallNetworkAgreesWithTheReference) {
  for (const int k : {1, 5}) expectForward(Case(smallArchitecture(), 3), GetParam(), k);
}

TEST_P(CpuDenoiserOf, DefaultNetworkAgreesWithTheReference) {
  for (const int k : {1, 100}) expectForward(Case(Architecture(), 2), GetParam(), k);
}

TEST_P(CpuDenoiserOf, NetworkWhoseChannelsHalveAgreesWithTheReference) {
  // Then up.0.a has as many inputs (2 x 4) as outputs (8), hence no skip layer, but other padding.
  Architecture architecture = smallArchitecture();
  architecture.channels = {8, 4};
  expectForward(Case(architecture, 2), GetParam(), 2);
}

TEST_P(CpuDenoiserOf, BackwardPassAgreesWithCentralDifferences) {
  const int k = 3;
  for (const std::vector<std::int64_t>& channels :
       {smallArchitecture().channels, std::vector<std::int64_t>{8, 4}}) {
    Architecture architecture = smallArchitecture();
    architecture.channels = channels;
    const Case given(architecture, 2);
    CpuDenoiser denoiser(given.model, GetParam());
    const Results results = resultsOf(denoiser, given, k);
    const ReferenceDenoiser reference(given.model);
    for (std::size_t b = 0; b < 2; ++b) {
      const Doubles noisy_gradient = pulledBack(
          [&](const Doubles& noisy) { return reference.actions(noisy, k, given.contexts[b]); },
          toDoubles(given.part(given.noisy, b, 7)),
          toDoubles(given.part(given.action_gradient, b, 3)));
      EXPECT_LT(relativeError(given.part(results.noisy_gradient, b, 7), noisy_gradient), 1e-5);
      const Doubles action_gradient = pulledBack(
          [&](const Doubles& actions) { return reference.states(actions, k, given.contexts[b]); },
          toDoubles(given.part(given.actions, b, 3)),
          toDoubles(given.part(given.state_gradient, b, 4)));
      EXPECT_LT(relativeError(given.part(results.action_gradient, b, 3), action_gradient), 1e-5);
    }
  }
}

TEST_P(CpuDenoiserOf, BackwardPassIsAdjointToTheJacobians) {
  const int k = 40;
  const Case given(Architecture(), 1);
  CpuDenoiser denoiser(given.model, GetParam());
  const Results results = resultsOf(denoiser, given, k);
  const ReferenceDenoiser reference(given.model);
  const auto expectAdjoint = [](const Doubles& jacobian_u, const Doubles& u, const Doubles& v,
                                const Doubles& transposed_v) {
    // <J u, v> = <u, J^T v>, compared with the size that its terms may have.
    const double scale = std::sqrt(dot(u, u) * dot(transposed_v, transposed_v));
    EXPECT_NEAR(dot(jacobian_u, v), dot(u, transposed_v), 1e-5 * scale);
  };
  for (std::uint32_t direction = 0; direction < 4; ++direction) {
    const Doubles u = toDoubles(randomValues(given.rows * 7, 50 + direction));
    expectAdjoint(
        directional(
            [&](const Doubles& noisy) { return reference.actions(noisy, k, given.contexts[0]); },
            toDoubles(given.noisy), u),
        u, toDoubles(given.action_gradient), toDoubles(results.noisy_gradient));
    const Doubles w = toDoubles(randomValues(given.rows * 3, 60 + direction));
    expectAdjoint(
        directional(
            [&](const Doubles& actions) { return reference.states(actions, k, given.contexts[0]); },
            toDoubles(given.actions), w),
        w, toDoubles(given.state_gradient), toDoubles(results.action_gradient));
  }
}

TEST_P(CpuDenoiserOf, SamplesDoNotDependOnTheBatch) {
  for (const Architecture& architecture : {smallArchitecture(), Architecture()}) {
    const Case batch(architecture, 9);
    CpuDenoiser denoiser(batch.model, GetParam());
    const Results together = resultsOf(denoiser, batch, 4);
    for (std::size_t b = 0; b < batch.contexts.size(); ++b) {
      Case single = batch;
      single.contexts = {batch.contexts[b]};
      single.noisy = batch.part(batch.noisy, b, 7);
      single.action_gradient = batch.part(batch.action_gradient, b, 3);
      single.actions = batch.part(batch.actions, b, 3);
      single.state_gradient = batch.part(batch.state_gradient, b, 4);
      const Results alone = resultsOf(denoiser, single, 4);
      EXPECT_EQ(alone.actions, batch.part(together.actions, b, 3));
      EXPECT_EQ(alone.noisy_gradient, batch.part(together.noisy_gradient, b, 7));
      EXPECT_EQ(alone.states, batch.part(together.states, b, 4));
      EXPECT_EQ(alone.action_gradient, batch.part(together.action_gradient, b, 3));
    }
  }
}

TEST_P(CpuDenoiserOf, RepeatedCallsGiveTheSame) {
  const Case given(smallArchitecture(), 2);
  CpuDenoiser denoiser(given.model, GetParam());
  const Results first = resultsOf(denoiser, given, 3);
  std::vector<float> gradient(first.noisy_gradient.size());
  denoiser.backwardActions(given.action_gradient.data(), gradient.data());
  EXPECT_EQ(gradient, first.noisy_gradient);
  gradient.resize(first.action_gradient.size());
  denoiser.backwardStates(given.state_gradient.data(), gradient.data());
  EXPECT_EQ(gradient, first.action_gradient);
}

TEST_P(CpuDenoiserOf, InstructionSetsAgree) {
  const Case given(Architecture(), 2);
  CpuDenoiser plain(given.model, InstructionSet::kPlain);
  CpuDenoiser other(given.model, GetParam());
  const Results expected = resultsOf(plain, given, 50);
  const Results results = resultsOf(other, given, 50);
  EXPECT_LT(relativeError(results.actions, toDoubles(expected.actions)), 1e-5);
  EXPECT_LT(relativeError(results.noisy_gradient, toDoubles(expected.noisy_gradient)), 1e-5);
  EXPECT_LT(relativeError(results.states, toDoubles(expected.states)), 1e-5);
  EXPECT_LT(relativeError(results.action_gradient, toDoubles(expected.action_gradient)), 1e-5);
}

TEST_P(CpuDenoiserOf, NanStaysInItsSample) {
  Case given(smallArchitecture(), 2);
  CpuDenoiser denoiser(given.model, GetParam());
  const Results clean = resultsOf(denoiser, given, 1);
  given.noisy[0] = std::numeric_limits<float>::quiet_NaN();
  const Results results = resultsOf(denoiser, given, 1);
  EXPECT_TRUE(std::isnan(results.actions[0]));
  EXPECT_EQ(given.part(results.actions, 1, 3), given.part(clean.actions, 1, 3));
  denoiser.predictActions(Case(smallArchitecture(), 2).noisy.data(), 1, given.actions.data());
  EXPECT_EQ(given.actions, clean.actions);  // and nothing of it is left
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, CpuDenoiserOf,
                         testing::Values(InstructionSet::kPlain, InstructionSet::kAvx2,
                                         InstructionSet::kAvx512),
                         [](const auto& info) { return CpuDenoiser::toText(info.param); });

TEST(CpuDenoiser, WithoutRouteTakesTheLearnedVector) {
  const Architecture architecture = smallArchitecture();
  Case given(architecture, 1);
  given.contexts[0].route.clear();
  CpuDenoiser denoiser(given.model);
  const std::vector<float> actions = resultsOf(denoiser, given, 1).actions;
  given.model.denoiser["no_route"].values[0] += 1.0f;
  CpuDenoiser changed(given.model);
  EXPECT_NE(resultsOf(changed, given, 1).actions, actions);
  given.contexts = {randomContext(architecture, 0)};
  EXPECT_EQ(resultsOf(changed, given, 1).actions, resultsOf(denoiser, given, 1).actions);
}

TEST(CpuDenoiser, RefusesContextsOfAnotherSize) {
  const Case given(smallArchitecture(), 1);
  CpuDenoiser denoiser(given.model);
  Context context = given.contexts[0];
  context.image_features.pop_back();
  EXPECT_THROW(denoiser.setContexts({given.contexts[0], context}), std::invalid_argument);
  context = given.contexts[0];
  context.route.pop_back();
  EXPECT_THROW(denoiser.setContexts({context}), std::invalid_argument);
}

TEST(CpuDenoiser, RefusesCallsOutOfOrderAndUnknownSteps) {
  const Case given(smallArchitecture(), 1);
  std::vector<float> room(static_cast<std::size_t>(given.rows * 7));
  CpuDenoiser denoiser(given.model);
  EXPECT_THROW(denoiser.predictActions(given.noisy.data(), 1, room.data()), std::logic_error);
  denoiser.setContexts(given.contexts);
  EXPECT_THROW(denoiser.backwardActions(given.noisy.data(), room.data()), std::logic_error);
  EXPECT_THROW(denoiser.backwardStates(given.noisy.data(), room.data()), std::logic_error);
  EXPECT_THROW(denoiser.predictActions(given.noisy.data(), 0, room.data()), std::invalid_argument);
  EXPECT_THROW(denoiser.predictStates(given.noisy.data(), 6, room.data()), std::invalid_argument);
}

TEST(CpuDenoiser, RefusesModelsThatDoNotFitTheirArchitecture) {
  Model model = randomModel(smallArchitecture());
  model.denoiser["head.out.weight"].shape = {3, 8, 2};
  EXPECT_THROW(CpuDenoiser{model}, core::InputError);
  model.denoiser.erase("head.out.weight");
  EXPECT_THROW(CpuDenoiser{model}, core::InputError);
}

TEST(CpuDenoiser, EnvironmentLowersTheInstructionSet) {
  setenv("E2E_CDIFF_ISA", "plain", 1);
  EXPECT_EQ(CpuDenoiser::bestInstructionSet(), InstructionSet::kPlain);
  setenv("E2E_CDIFF_ISA", "sse9", 1);
  EXPECT_THROW(CpuDenoiser::bestInstructionSet(), core::InputError);
  unsetenv("E2E_CDIFF_ISA");
}

}  // namespace
}  // namespace cdiff::diffusion
