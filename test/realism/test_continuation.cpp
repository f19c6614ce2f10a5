// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "realism/continuation.h"
#include "session/session_request.h"

namespace cdiff::realism {
namespace {

session::ScenarioOptions scenario(const std::vector<std::string>& set) {
  session::SessionRequest request;
  request.scenario = "crossing_straight";
  request.seed = "1";
  request.set = set;
  return session::resolveRequest(request);
}

const std::vector<std::string> kDrivers = {"pdm_lite.cbv_speed_spread=0.1",
                                           "pdm_lite.cbv_headway_spread=0.5"};

/// Equal values, NaN equal to NaN.
bool same(const Series& left, const Series& right) {
  return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                    [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); });
}

TEST(Continuation, IsTheSameUpToTheHandOverWhoeverDrives) {
  const session::SessionSetup setup(scenario(kDrivers));
  constexpr double kSeconds = 3.0;
  const auto first = continueSession(setup, {"pdm_lite", 1}, kSeconds);
  const auto again = continueSession(setup, {"pdm_lite", 1}, kSeconds);
  const auto other = continueSession(setup, {"pdm_lite", 2}, kSeconds);
  const auto sumo = continueSession(setup, {"", 1}, kSeconds);
  const auto diffusion = continueSession(setup, {"diffusion", 1}, kSeconds);
  const auto noise = continueSession(setup, {"diffusion", 2}, kSeconds);
  ASSERT_TRUE(first && again && other && sumo && diffusion && noise);
  ASSERT_FALSE(first->objects.empty());
  for (const auto* driven : {&again, &other, &sumo, &diffusion, &noise}) {
    EXPECT_EQ((*driven)->sha256, first->sha256);
    EXPECT_EQ((*driven)->hand_over_tick, first->hand_over_tick);
    EXPECT_EQ((*driven)->objects, first->objects);
  }
  const auto speed = [](const auto& driven) { return driven->courses[0][kLinearSpeed]; };
  EXPECT_EQ(speed(first).size(), 30U);
  EXPECT_FALSE(std::isnan(speed(first)[0]));
  EXPECT_TRUE(same(speed(first), speed(again)));
  EXPECT_FALSE(same(speed(first), speed(other)));
  EXPECT_FALSE(same(speed(first), speed(sumo)));
  EXPECT_FALSE(same(speed(diffusion), speed(noise)));
  for (std::size_t feature = 0; feature < kFeatures; ++feature)
    EXPECT_EQ(sumo->courses[0][feature].size(), 30U) << featureDefinitions()[feature].key;
}

TEST(Continuation, ScoresADriverAgainstTheLog) {
  const session::SessionSetup setup(scenario(kDrivers));
  ContinuationOptions options;
  options.rollouts = 2;
  options.seconds = 2.0;
  const ContinuationScore score = scoreDriver(setup, "pdm_lite", options);
  ASSERT_TRUE(score.hand_over_tick.has_value());
  EXPECT_EQ(score.log_steps, 20U * score.objects.size());
  EXPECT_EQ(score.rollout_steps, 2U * score.log_steps);
  EXPECT_EQ(score.sums[kCollision].n, score.objects.size());
  EXPECT_EQ(score.sums[kNearestObject].n, score.log_steps);
  const double meta = metaMetric(likelihoodsOf(score.sums)).value();
  EXPECT_GT(meta, 0.3);
  EXPECT_LE(meta, 1.0);
}

TEST(Continuation, DriversDrawTheirTargetSpeedsAndTheLogKeepsIts) {
  session::CbvSpeedOptions drawn;
  drawn.distribution = "normal";
  const session::SessionSetup setup(scenario(kDrivers));
  const session::SessionSetup other(scenario({kDrivers[0], kDrivers[1], "target_speed=6"}));
  const auto speed = [](const session::SessionSetup& of, const HandOverDriver& driver) {
    return continueSession(of, driver, 3.0).value().courses[0][kLinearSpeed];
  };
  EXPECT_FALSE(same(speed(setup, {"diffusion", 1}), speed(setup, {"diffusion", 1, drawn})));
  EXPECT_TRUE(same(speed(setup, {"diffusion", 1, drawn}), speed(setup, {"diffusion", 1, drawn})));
  EXPECT_FALSE(same(speed(setup, {"pdm_lite", 1}), speed(other, {"pdm_lite", 1})))
      << "fixed: the scenario's";
  // The log is the same whether or not the scenario draws.
  std::vector<std::string> set = kDrivers;
  set.push_back("cbv_target_speed.distribution=normal");
  const session::SessionSetup drawing(scenario(set));
  EXPECT_TRUE(same(speed(setup, {"pdm_lite", 1}), speed(drawing, {"pdm_lite", 1})));
}

TEST(Continuation, RefusesOneDriverForAll) {
  const session::SessionSetup setup(scenario({}));
  EXPECT_THROW(scoreDriver(setup, "pdm_lite", {}), core::InputError);
}

TEST(Continuation, SaysWhereNothingIsHandedOver) {
  const session::SessionSetup setup(scenario({"max_cbv=0", "protocol.time_limit=5"}));
  EXPECT_FALSE(continueSession(setup, {"pdm_lite", 1}, 8.0).has_value());
}

}  // namespace
}  // namespace cdiff::realism
