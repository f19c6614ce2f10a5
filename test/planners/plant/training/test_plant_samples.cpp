// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/random.h"
#include "learning/small_scene.h"
#include "planners/plant/training/plant_samples.h"

namespace cdiff::planners {
namespace {

using learning::Scene;
using test::smallScene;

std::vector<PlantExample> examplesOf(const Scene& scene,
                                     const learning::SceneSampleOptions& options = {}) {
  return PlantSampler({}, options).examplesOf(scene);
}

// 60 decisions, of which 40 have 2 s behind them. Every fifth is a sample: the ego's at 0, 5 ... 35
// (slot -1), those of "a", which is driven from decision 2 on, at 4, 9 ... 39.
TEST(PlantSamples, EveryHalfSecondAMomentOfEachDrivenVehicle) {
  EXPECT_EQ(examplesOf(smallScene()).size(), 8U + 8U);
  learning::SceneSampleOptions options;
  options.period = 1.0;  // the ego's at 0, 10, 20, 30, those of "a" at 9, 19, 29, 39
  EXPECT_EQ(examplesOf(smallScene(), options).size(), 4U + 4U);
}

// The ego drives at 8 m/s along its heading: 4 m every 0.5 s. "a" is 30 m ahead; 0.5 s later it is
// 34 m from where the ego was, outside of the 30 m of the bins: in the last one. "b" stands across
// at (60, 3.5), 50 m ahead.
TEST(PlantSamples, HoldWhatTheVehicleSawAndDrove) {
  const PlantExample example = examplesOf(smallScene()).front();
  EXPECT_EQ(example.speed, 8.0);
  EXPECT_EQ(example.session, core::hashText("small_seed1"));
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_NEAR(example.driven[n].x(), 4.0 * static_cast<double>(n + 1), 1e-9);
    EXPECT_NEAR(example.driven[n].y(), 0.0, 1e-9);
  }
  ASSERT_EQ(example.input.vehicles.size(), 1U) << "50.1 m are too far";
  EXPECT_NEAR(example.input.vehicles[0][0], 0.6, 1e-6);
  EXPECT_EQ(example.next.at(0)[0], 127);
  EXPECT_EQ(example.next.at(0)[1], 64) << "y = 0 begins the upper half";
  EXPECT_EQ(example.input.route.size(), 2U);
}

// x of 10 m: (10 + 30) / 60 of 128 = 85.3; y of -31 m: below the first; heading 0: the upper half
// of 32; 9 m/s of 16.67: 8.64 of 16; 1.8 m and 4.5 m of 30 m: 7.68 and 19.2 of 128.
TEST(PlantSamples, AttributesFallIntoTheirBins) {
  const PlantToken token =
      plantToken({}, {{10.0, -31.0}, 0.0, 0.0, 9.0}, traffic::VehicleDimensions());
  EXPECT_EQ(plantBins(token), (std::array<std::uint8_t, 6>{85, 0, 16, 8, 7, 19}));
}

TEST(PlantSamples, AVehicleThatIsGoneHalfASecondLaterHasNoBins) {
  Scene scene = smallScene();
  for (std::size_t i = 3; i < scene.decisions.size(); ++i) scene.decisions[i].vehicles.resize(1);
  const auto examples = examplesOf(scene);
  ASSERT_EQ(examples.size(), 8U) << "the ego's";
  EXPECT_EQ(examples.front().next.at(0)[0], kNoBin);
}

// Noise at decision 12 spoils the ego's samples whose 2 s hold it: those at 0, 5 and 10.
TEST(PlantSamples, NoiseContactAndJumpsAreNoExample) {
  Scene noisy = smallScene();
  noisy.disturbed = {{"ego", 24}};
  EXPECT_EQ(examplesOf(noisy).size(), 16U - 3U);
  Scene touching = smallScene();
  touching.contacts = {{24, {"b", "ego"}}};
  EXPECT_EQ(examplesOf(touching).size(), 16U - 3U);
  Scene jumping = smallScene();
  for (std::size_t i = 12; i < jumping.decisions.size(); ++i)
    jumping.decisions[i].vehicles[0].state.position.y() = 1.5;
  EXPECT_EQ(examplesOf(jumping).size(), 16U - 3U);
}

// Taken over at decision 2, "a" has no action of ours at its samples before decision 20: 4, 9, 14
// and 19 fall.
TEST(PlantSamples, WhatTheSimulatorDroveIsNoExample) {
  Scene scene = smallScene();
  for (std::size_t i = 0; i < 20; ++i) scene.decisions[i].vehicles[1].applied_action.reset();
  EXPECT_EQ(examplesOf(scene).size(), 16U - 4U);
}

TEST(PlantSamples, OfMomentsAtWhichItStandsAShareIsKept) {
  Scene scene = smallScene(600);
  for (std::size_t i = 0; i < scene.decisions.size(); ++i) {
    for (std::size_t n = 0; n < 2; ++n) {
      scene.decisions[i].vehicles[n].state.speed = 0.0;
      scene.decisions[i].vehicles[n].state.position.x() = 10.0 + 30.0 * static_cast<double>(n);
    }
  }
  learning::SceneSampleOptions options;
  options.standing_share = 1.0;
  const std::size_t all = examplesOf(scene, options).size();
  EXPECT_EQ(all, 116U + 116U);
  options.standing_share = 0.0;
  EXPECT_EQ(examplesOf(scene, options).size(), 0U);
  options.standing_share = 0.25;  // 58 of 232 expected, standard deviation 6.6
  EXPECT_NEAR(static_cast<double>(examplesOf(scene, options).size()), 58.0, 20.0);
}

TEST(PlantSamples, DriversWithAnotherTargetSpeedAreLeftOut) {
  Scene scene = smallScene();
  scene.drives[1].driver.target_speed = 11.0;
  learning::SceneSampleOptions options;
  options.highest_speed = 9.0;
  EXPECT_EQ(examplesOf(scene, options).size(), 8U);
  options.lowest_speed = 8.5;
  EXPECT_EQ(examplesOf(scene, options).size(), 0U);
}

TEST(PlantSamples, DecisionsThatAreNotATenthApartAreNamed) {
  Scene scene = smallScene();
  for (traffic::TrafficSnapshot& snapshot : scene.decisions) snapshot.time *= 2.0;
  EXPECT_THROW(examplesOf(scene), core::InputError);
}

TEST(PlantSamples, ComeBackFromTheirStoredForm) {
  const PlantExample example = examplesOf(smallScene()).at(3);
  const learning::Sample sample = toSample(example);
  plantFields().check(sample);
  const PlantExample back = toExample(sample);
  EXPECT_EQ(back.input.vehicles, example.input.vehicles);
  EXPECT_EQ(back.input.route, example.input.route);
  EXPECT_EQ(back.input.red_light, example.input.red_light);
  EXPECT_EQ(back.input.target, example.input.target);
  EXPECT_EQ(back.next, example.next);
  EXPECT_EQ(back.session, example.session);
  EXPECT_NEAR(back.speed, example.speed, 1e-6);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((back.driven[i] - example.driven[i]).norm(), 1e-6);
}

}  // namespace
}  // namespace cdiff::planners
