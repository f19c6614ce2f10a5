// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/small_scene.h"
#include "planners/pluto/pluto_course.h"
#include "planners/pluto/training/pluto_losses.h"

namespace cdiff::planners {
namespace {

using testing::smallPluto;

/// A moment on a road 3.2 m wide; the vehicle is 4.5 m by 1.8 m: its circles have a radius of
/// sqrt(1.8^2 + 1.5^2) / 2 - 0.2 = 0.9715 m.
class PlutoLosses : public ::testing::Test {
 protected:
  PlutoLosses() : scene_(recorded_, worlds_.of(recorded_)) {
    example_ = plutoExample(scene_, place_, scene_.moment(place_.decision, place_.drive), true);
  }
  /// A plan that stays `offset` to the left of the vehicle.
  static at::Tensor standingPlan(double offset) {
    at::Tensor plan = at::zeros({1, kPlutoSteps, kPlutoChannels});
    plan.select(2, 1).fill_(offset);
    plan.select(2, 2).fill_(1.0);
    return plan;
  }
  double areaOf(const at::Tensor& plan) {
    return areaLoss(plan, at::ones({1, kPlutoSteps, 1}), {&example_}).item<double>();
  }

  learning::Scene recorded_ = test::platoonScene("small", 15.0);
  PlutoWorlds worlds_{smallPluto()};
  PlutoScene scene_;
  PlutoPlace place_ = {0, 40, 1, 80};
  PlutoExample example_;
};

// The border is 1.6 m to the side: at an offset y the circles reach 0.9715 - (1.6 - y) beyond it.
TEST_F(PlutoLosses, AreaIsTheExcessOfTheCirclesOverTheBorder) {
  EXPECT_EQ(areaOf(standingPlan(0.0)), 0.0);
  EXPECT_EQ(areaOf(standingPlan(0.62)), 0.0);
  const double radius = 0.5 * std::hypot(1.8, 1.5) - 0.2;
  EXPECT_NEAR(areaOf(standingPlan(1.0)), radius - 0.6, 1e-4);
  EXPECT_NEAR(areaOf(standingPlan(-2.0)), radius + 0.4, 1e-4);
}

// On a road that climbs 1 m in 10 m, "a" drives 48 m and comes 4.8 m higher. The area of a level
// holds what is within 3 m of its height: that of the start ends before.
TEST_F(PlutoLosses, AreaIsThatOfTheLevelToWhichThePlanClimbs) {
  recorded_.network_text =
      "<net><edge id=\"road\"><lane id=\"road_0\" index=\"0\" speed=\"13.89\" shape=\"" +
      testing::pointText({{0, 0, 0}, {400, 0, 40}}) + "\"/></edge></net>";
  for (traffic::TrafficSnapshot& snapshot : recorded_.decisions) {
    for (traffic::Vehicle& vehicle : snapshot.vehicles)
      vehicle.state.elevation = 0.1 * vehicle.state.position.x();
  }
  const PlutoScene scene(recorded_, worlds_.of(recorded_));
  example_ = plutoExample(scene, place_, scene.moment(place_.decision, place_.drive), true);
  at::Tensor plan = at::zeros({1, kPlutoSteps, kPlutoChannels});
  for (std::int64_t i = 0; i < kPlutoSteps; ++i) {
    for (std::int64_t c = 0; c < kPlutoChannels; ++c) plan[0][i][c] = example_.target.future(i, c);
  }
  EXPECT_EQ(areaOf(plan), 0.0);
}

TEST_F(PlutoLosses, TheGradientOfTheAreaLeadsBackToTheRoad) {
  at::Tensor plan = standingPlan(1.2).set_requires_grad(true);
  areaLoss(plan, at::ones({1, kPlutoSteps, 1}), {&example_}).backward();
  // Of the mean over 80 places: 1 / 80 each, across the road.
  EXPECT_NEAR(plan.grad()[0][7][1].item<double>(), 1.0 / 80.0, 1e-6);
  EXPECT_NEAR(plan.grad()[0][7][0].item<double>(), 0.0, 1e-6);
}

// Equal directions: ln 2. a = p and a = -n: exp(-10) against exp(10).
TEST_F(PlutoLosses, ContrastIsTheCrossEntropyOfCosines) {
  const at::Tensor a = learning::toTensor({1.0F, 0.0F}, {1, 2}, at::kCPU);
  const at::Tensor up = learning::toTensor({0.0F, 1.0F}, {1, 2}, at::kCPU);
  EXPECT_NEAR(contrastLoss(a, a, a).item<double>(), std::log(2.0), 1e-6);
  EXPECT_NEAR(contrastLoss(a, a, -a).item<double>(), 0.0, 1e-6);
  EXPECT_NEAR(contrastLoss(a, up, a).item<double>(), std::log(1.0 + std::exp(10.0)), 1e-4);
}

TEST_F(PlutoLosses, HasAllTermsAndTheirSum) {
  PlutoNet net(smallPluto(), 1);
  net.parameters().setTrained(true);
  const std::vector<const PlutoExample*> examples = {&example_, &example_, &example_};
  const PlutoBatch batch = plutoBatch(examples, {}, at::kCPU);
  const learning::Loss loss = plutoLoss(net, batch, examples, {}, {{0, 1, 2}});
  ASSERT_EQ(loss.terms.size(), 6U);
  double sum = 0.0;
  for (const auto& [name, term] : loss.terms) sum += term.item<double>();
  EXPECT_NEAR(loss.total.item<double>(), sum, 1e-3);
  loss.total.backward();
  for (const std::string& name : net.parameters().names())
    EXPECT_TRUE(net.parameters()(name).grad().defined()) << name;
}

// A negative imitates nothing: with it or without it the terms are the same.
TEST_F(PlutoLosses, NegativesCountForNothingButTheContrast) {
  PlutoNet net(smallPluto(), 1);
  net.parameters().setTrained(false);
  PlutoExample negative = example_;
  negative.imitates = false;
  negative.target.mode = 0;
  negative.target.future.setConstant(50.0F);
  const std::vector<const PlutoExample*> alone = {&example_};
  const std::vector<const PlutoExample*> both = {&example_, &negative};
  const auto one = plutoLoss(net, plutoBatch(alone, {}, at::kCPU), alone, {}, {});
  const auto two = plutoLoss(net, plutoBatch(both, {}, at::kCPU), both, {}, {});
  for (std::size_t i = 0; i < one.terms.size(); ++i) {
    const double expected = one.terms[i].second.item<double>();
    EXPECT_NEAR(two.terms[i].second.item<double>(), expected, 1e-4 * (1.0 + std::abs(expected)))
        << one.terms[i].first;
  }
}

// Dropout hides motion and history: the tokens that it takes change nothing any more.
TEST_F(PlutoLosses, DropoutHidesWhatItTakes) {
  PlutoNet net(smallPluto(), 1);
  net.parameters().setTrained(false);
  PlutoDropout dropout;
  dropout.motion = {{true, true, true}};
  dropout.history = {0};
  PlutoExample other = example_;
  other.input.motion = {0.1F, -0.9F, 0.7F};
  for (PlutoAgent& agent : other.input.agents) agent.history.fill(0.3F);
  const auto queries = [&](const PlutoExample& example, const PlutoDropout& taken) {
    return net.forward(plutoBatch({&example}, taken, at::kCPU)).queries;
  };
  EXPECT_TRUE(at::equal(queries(example_, dropout), queries(other, dropout)));
  EXPECT_FALSE(at::equal(queries(example_, {}), queries(other, {})));
}

}  // namespace
}  // namespace cdiff::planners
