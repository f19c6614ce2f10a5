// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "guidance/guidance_world.h"
#include "guidance/total_objective.h"

namespace cdiff::guidance {
namespace {

using test::GuidanceWorld;
using traffic::Rollout;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Returns the values that it was constructed with.
class BrokenObjective : public Objective {
 public:
  BrokenObjective(double value, double derivative) : value_(value), derivative_(derivative) {}
  void describe(core::OptionsVisitor&) override {}
  double evaluate(const GuidanceScene&, const Rollout&, Rollout& gradient) const override {
    gradient(0, 0) += derivative_;
    return value_;
  }
  std::unique_ptr<Objective> clone() const override {
    return std::make_unique<BrokenObjective>(*this);
  }

 private:
  double value_;
  double derivative_;
};

GuidanceOptions withWeights(double speed, double area, double avoidance) {
  GuidanceOptions options;
  options.find("speed").weight = speed;
  options.find("drivable_area").weight = area;
  options.find("collision_avoidance").weight = avoidance;
  return options;
}

void addBroken(GuidanceOptions& options, double value, double derivative) {
  options.objectives.insert(
      options.objectives.begin() + 1,
      {"broken", 1.0, 0, 1, 0.0, std::make_unique<BrokenObjective>(value, derivative)});
}

const Rollout kUnitScale = Rollout::Ones(test::kRows, traffic::kRolloutColumns);

struct Evaluation {
  double value = 0.0;
  Rollout gradient;
};

Evaluation evaluate(const GuidanceOptions& options, const GuidanceScene& scene,
                    const Rollout& rollout, int diffusion_step = 50) {
  TotalObjective total(options, scene);
  Evaluation result;
  result.value = total.evaluate(diffusion_step, rollout, kUnitScale, result.gradient);
  return result;
}

void expectSameBits(const Evaluation& left, const Evaluation& right) {
  EXPECT_EQ(left.value, right.value);
  EXPECT_EQ(left.gradient, right.gradient);
}

TEST(TotalObjective, IsTheWeightedSum) {
  GuidanceWorld world;
  const Rollout rollout = test::wandering(1);
  const GuidanceOptions options = withWeights(0.5, 2.0, 3.0);
  const Evaluation total = evaluate(options, world.scene(), rollout);
  double value = 0.0;
  Rollout gradient = Rollout::Zero(test::kRows, traffic::kRolloutColumns);
  for (const WeightedObjective& entry : options.objectives) {
    value += entry.weight * test::valueOf(*entry.objective, world.scene(), rollout);
    gradient += entry.weight * test::gradientOf(*entry.objective, world.scene(), rollout);
  }
  EXPECT_NEAR(total.value, value, 1e-9);
  EXPECT_LT((total.gradient - gradient).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(TotalObjective(options, world.scene()).score(rollout).value, value, 1e-9);
}

TEST(TotalObjective, AllZeroWeightsGiveExactlyZero) {
  GuidanceWorld world;
  const GuidanceOptions options;
  Evaluation total = evaluate(options, world.scene(), test::wandering(1));
  EXPECT_EQ(total.value, 0.0);
  EXPECT_EQ(total.gradient, Rollout::Zero(test::kRows, traffic::kRolloutColumns));
  EXPECT_FALSE(TotalObjective(options, world.scene()).actsAt(50));
  EXPECT_TRUE(TotalObjective(options, world.scene()).report(test::wandering(1)).objectives.empty());
}

TEST(TotalObjective, OrderInTheProfileDoesNotMatter) {
  GuidanceWorld world;
  const std::string speed = "speed:\n  weight: 0.37\n";
  const std::string area = "drivable_area:\n  weight: 0.11\n";
  const std::string collision = "collision_avoidance:\n  weight: 1.7\n";
  GuidanceOptions first;
  GuidanceOptions second;
  core::loadOptions({"first", speed + area + collision}, first);
  core::loadOptions({"second", collision + speed + area}, second);
  for (std::uint32_t trial = 0; trial < 5; ++trial) {
    expectSameBits(evaluate(first, world.scene(), test::wandering(trial)),
                   evaluate(second, world.scene(), test::wandering(trial)));
  }
}

TEST(TotalObjective, DisabledEqualsAbsentBitForBit) {
  GuidanceWorld world;
  const GuidanceOptions disabled = withWeights(0.37, 0.0, 1.7);
  GuidanceOptions absent = disabled;
  absent.objectives.erase(std::remove_if(absent.objectives.begin(), absent.objectives.end(),
                                         [](const auto& entry) { return entry.weight == 0.0; }),
                          absent.objectives.end());
  ASSERT_EQ(absent.objectives.size(), 2U);
  for (std::uint32_t trial = 0; trial < 5; ++trial) {
    expectSameBits(evaluate(disabled, world.scene(), test::wandering(trial)),
                   evaluate(absent, world.scene(), test::wandering(trial)));
  }
}

TEST(TotalObjective, WindowsOpenAndClose) {
  GuidanceWorld world;
  GuidanceOptions options = withWeights(1.0, 0.0, 0.0);
  options.find("speed").first_step = 60;
  options.find("speed").last_step = 10;
  const Rollout rollout = test::standing(0.0, 0.0, 0.0, 5.0);
  EXPECT_EQ(evaluate(options, world.scene(), rollout, 61).value, 0.0);
  EXPECT_EQ(evaluate(options, world.scene(), rollout, 60).value, 9.0 * test::kRows);
  EXPECT_EQ(evaluate(options, world.scene(), rollout, 10).value, 9.0 * test::kRows);
  EXPECT_EQ(evaluate(options, world.scene(), rollout, 9).gradient.norm(), 0.0);
  const TotalObjective total(options, world.scene());
  EXPECT_TRUE(total.actsAt(30));
  EXPECT_FALSE(total.actsAt(9));
  EXPECT_EQ(total.score(rollout).value, 9.0 * test::kRows);  // whatever the window
}

TEST(TotalObjective, TheLastStepOfAllClosesEveryWindow) {
  GuidanceWorld world;
  GuidanceOptions options = withWeights(1.0, 0.0, 0.0);
  options.last_step = 8;
  const Rollout rollout = test::standing(0.0, 0.0, 0.0, 5.0);
  EXPECT_EQ(evaluate(options, world.scene(), rollout, 8).value, 9.0 * test::kRows);
  EXPECT_EQ(evaluate(options, world.scene(), rollout, 7).value, 0.0);
  const TotalObjective total(options, world.scene());
  EXPECT_TRUE(total.actsAt(8));
  EXPECT_FALSE(total.actsAt(7));
  EXPECT_EQ(total.score(rollout).value, 9.0 * test::kRows);
  options.find("speed").last_step = 30;  // an own window that ends before stays
  EXPECT_FALSE(TotalObjective(options, world.scene()).actsAt(29));
}

TEST(TotalObjective, CapsTheNormInNormalizedUnits) {
  GuidanceWorld world;
  GuidanceOptions options = withWeights(0.5, 0.0, 0.0);
  options.find("speed").gradient_cap = 2.0;
  TotalObjective total(options, world.scene());
  Rollout scale = kUnitScale;
  scale.col(traffic::kRolloutSpeed).setConstant(3.0);
  Rollout gradient;
  // One row at 5 m/s, the others at the target of 8: 0.5 x 2 x (-3) x 3 = -9, capped to -2.
  Rollout rollout = test::standing(0.0, 0.0, 0.0, 8.0);
  rollout(2, traffic::kRolloutSpeed) = 5.0;
  total.evaluate(50, rollout, scale, gradient);
  EXPECT_NEAR(gradient(2, traffic::kRolloutSpeed) * 3.0, -2.0, 1e-12);
  // At 7.5 m/s: 0.5 x 2 x (-0.5) x 3 = -1.5, below the cap.
  rollout(2, traffic::kRolloutSpeed) = 7.5;
  total.evaluate(49, rollout, scale, gradient);
  EXPECT_NEAR(gradient(2, traffic::kRolloutSpeed) * 3.0, -1.5, 1e-12);
  const GuidanceReport report = total.report(rollout);
  ASSERT_EQ(report.objectives.size(), 1U);
  EXPECT_EQ(report.objectives[0].name, "speed");
  EXPECT_EQ(report.objectives[0].weight, 0.5);
  EXPECT_EQ(report.objectives[0].value, 0.25);
  EXPECT_NEAR(report.objectives[0].gradient_norm, 0.5 * (9.0 + 1.5), 1e-12);
  EXPECT_EQ(report.objectives[0].capped_share, 0.5);
  EXPECT_EQ(report.objectives[0].dropped, 0);
}

TEST(TotalObjective, NotFiniteIsLeftOutAndCounted) {
  GuidanceWorld world;
  const Rollout rollout = test::wandering(3);
  const GuidanceOptions whole = withWeights(0.5, 0.2, 1.0);
  const double infinity = std::numeric_limits<double>::infinity();
  const double pairs[][2] = {{kNan, 0.0}, {1.0, kNan}, {infinity, 1.0}, {1.0, -infinity}};
  for (const auto& [value, derivative] : pairs) {
    GuidanceOptions options = whole;
    addBroken(options, value, derivative);
    TotalObjective total(options, world.scene());
    Evaluation result;
    for (int step = 3; step > 0; --step) {
      result.value = total.evaluate(step, rollout, kUnitScale, result.gradient);
      expectSameBits(result, evaluate(whole, world.scene(), rollout));
    }
    const GuidanceReport report = total.report(rollout);
    ASSERT_EQ(report.objectives.size(), 4U);
    EXPECT_EQ(report.objectives[1].name, "broken");
    EXPECT_EQ(report.objectives[1].dropped, 3);
    EXPECT_EQ(report.objectives[1].gradient_norm, 0.0);
    EXPECT_EQ(report.objectives[0].dropped, 0);
  }
}

/// Not finite where a row is faster than 10 m/s.
class FragileObjective : public Objective {
 public:
  void describe(core::OptionsVisitor&) override {}
  double evaluate(const GuidanceScene&, const Rollout& rollout, Rollout&) const override {
    return rollout.col(traffic::kRolloutSpeed).maxCoeff() > 10.0 ? kNan : 5.0;
  }
  std::unique_ptr<Objective> clone() const override {
    return std::make_unique<FragileObjective>(*this);
  }
};

TEST(TotalObjective, BecomingUndefinedWithinAStepIsNoImprovement) {
  GuidanceWorld world;
  GuidanceOptions options = withWeights(0.0, 0.0, 0.0);
  options.objectives.push_back({"fragile", 1.0, 0, 1, 0.0, std::make_unique<FragileObjective>()});
  const Rollout slow = test::standing(0.0, 0.0, 0.0, 5.0);
  const Rollout fast = test::standing(0.0, 0.0, 0.0, 11.0);
  TotalObjective total(options, world.scene());
  Rollout gradient;
  EXPECT_EQ(total.evaluate(50, slow, kUnitScale, gradient), 5.0);
  EXPECT_EQ(total.evaluate(50, fast, kUnitScale, gradient),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(total.evaluate(40, fast, kUnitScale, gradient), 0.0);  // a new step: left out
  EXPECT_EQ(total.evaluate(40, slow, kUnitScale, gradient), 0.0);  // of the whole step
  EXPECT_EQ(total.report(slow).objectives[0].dropped, 1);
}

TEST(TotalObjective, TheCapScalesValueAndGradientAlikeWithinAStep) {
  GuidanceWorld world;
  GuidanceOptions options = withWeights(1.0, 0.0, 0.0);
  options.find("speed").gradient_cap = 3.0;
  TotalObjective total(options, world.scene());
  Rollout rollout = test::standing(0.0, 0.0, 0.0, 8.0);
  rollout(0, traffic::kRolloutSpeed) = 5.0;  // J = 9, |g| = 6: c = 0.5
  Rollout gradient;
  EXPECT_DOUBLE_EQ(total.evaluate(50, rollout, kUnitScale, gradient), 4.5);
  rollout(0, traffic::kRolloutSpeed) = 7.0;  // J = 1, |g| = 2: below the cap, c stays
  EXPECT_DOUBLE_EQ(total.evaluate(50, rollout, kUnitScale, gradient), 0.5);
  EXPECT_DOUBLE_EQ(gradient(0, traffic::kRolloutSpeed), -1.0);
  EXPECT_DOUBLE_EQ(total.evaluate(49, rollout, kUnitScale, gradient), 1.0);
}

TEST(TotalObjective, ACandidateWithAnUndefinedObjectiveRanksLast) {
  GuidanceWorld world;
  GuidanceOptions options = withWeights(0.5, 0.0, 0.0);
  const Score whole = TotalObjective(options, world.scene()).score(test::wandering(0));
  addBroken(options, kNan, 0.0);
  const Score broken = TotalObjective(options, world.scene()).score(test::wandering(0));
  EXPECT_EQ(broken.undefined, 1U);
  EXPECT_EQ(broken.value, whole.value);
  EXPECT_TRUE(whole < broken);
  EXPECT_FALSE(broken < whole);
}

TEST(TotalObjective, RaisingAWeightRaisesItsShareOfTheGradient) {
  GuidanceWorld world;
  const Rollout rollout = test::standing(0.0, 3.0, 0.0, 4.0);
  const Rollout weak = evaluate(withWeights(0.5, 1.0, 0.0), world.scene(), rollout).gradient;
  const Rollout strong = evaluate(withWeights(0.5, 2.0, 0.0), world.scene(), rollout).gradient;
  EXPECT_EQ(strong(0, traffic::kRolloutSpeed), weak(0, traffic::kRolloutSpeed));
  EXPECT_EQ(strong(0, traffic::kRolloutY), 2.0 * weak(0, traffic::kRolloutY));
}

TEST(RowsOffRoad, CountsRowsWithACornerBeyondTheBorder) {
  GuidanceWorld world;  // the lane reaches from -2 to 2 m
  world.scene().dimensions.length = 4.0;
  world.scene().dimensions.width = 1.8;
  Rollout rollout = test::standing(0.0, 1.0);
  EXPECT_EQ(rowsOffRoad(world.scene(), rollout, test::kRows), 0U);
  rollout(2, traffic::kRolloutY) = 1.2;                     // the left side at 2.1 m
  rollout(5, traffic::kRolloutHeading) = 0.5 * 3.14159265;  // across: the front at 3 m
  EXPECT_EQ(rowsOffRoad(world.scene(), rollout, test::kRows), 2U);
  EXPECT_EQ(rowsOffRoad(world.scene(), rollout, 3), 1U);
  EXPECT_EQ(rowsOffRoad(world.scene(), rollout, 0), 0U);
  EXPECT_EQ(rowsOffRoad(world.scene(), rollout, 1000), 2U);
}

TEST(Score, RanksByWhatIsUndefinedThenByTheRoadThenByItsValue) {
  const Score good{0, 5.0, 0};
  EXPECT_LT(good, (Score{1, 0.0, 0}));
  EXPECT_LT(good, (Score{0, 0.0, 1}));
  EXPECT_LT((Score{0, 9.0, 3}), (Score{1, 0.0, 0}));
  EXPECT_LT((Score{0, 4.0, 1}), (Score{0, 5.0, 1}));
  EXPECT_FALSE(good < good);
}

}  // namespace
}  // namespace cdiff::guidance
