// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/scene_file.h"
#include "learning/small_scene.h"
#include "planners/pluto/pluto_course.h"
#include "planners/pluto/training/pluto_examples.h"

namespace cdiff::planners {
namespace {

/// 15 s of the small scene: 151 decisions.
class PlutoSamples : public ::testing::Test {
 protected:
  PlutoScene sceneOf() {
    PlutoWorlds worlds(PlutoArchitecture{});
    return PlutoScene(recorded_, worlds.of(recorded_));
  }
  std::vector<PlutoPlace> placesOf(const PlutoScene& scene) {
    return plutoPlaces(scene, 0, options_);
  }
  static std::vector<PlutoPlace> ofDrive(const std::vector<PlutoPlace>& places,
                                         std::uint32_t drive) {
    std::vector<PlutoPlace> found;
    for (const PlutoPlace& place : places) {
      if (place.drive == drive) found.push_back(place);
    }
    return found;
  }

  static PlutoTarget targetOf(const PlutoScene& scene, const PlutoPlace& place) {
    const PlutoMoment moment = scene.moment(place.decision, place.drive);
    return plutoTarget(scene, place, moment.point().state.pose(),
                       scene.world().builder.linesOf(moment));
  }

  learning::Scene recorded_ = test::platoonScene("small", 15.0);
  PlutoSampleOptions options_;
};

// A sample every 5 decisions, if 30 follow: decisions up to 120 of 0 to 150. 80 count at most.
TEST_F(PlutoSamples, AreTakenWhileEnoughFollows) {
  const PlutoScene scene = sceneOf();
  const auto places = ofDrive(placesOf(scene), 0);
  ASSERT_EQ(places.size(), 25U);
  EXPECT_EQ(places.front().decision, 0U);
  EXPECT_EQ(places.front().steps, 80U);
  EXPECT_EQ(places.back().decision, 120U);
  EXPECT_EQ(places.back().steps, 30U);
}

// Samples of "a" are at decisions 4, 9, ... Taken over at 4, it is put 0.4 m to the side, which no
// future may hold: the first is at 9.
TEST_F(PlutoSamples, BeginAfterTheTakeOver) {
  for (std::size_t i = 0; i < 5; ++i)
    recorded_.decisions[i].vehicles[1].applied_action.reset();  // of "a"
  for (std::size_t i = 5; i < recorded_.decisions.size(); ++i)
    recorded_.decisions[i].vehicles[1].state.position.y() += 0.4;
  const PlutoScene scene = sceneOf();
  const auto places = ofDrive(placesOf(scene), 1);
  ASSERT_FALSE(places.empty());
  EXPECT_EQ(places.front().decision, 9U);
  EXPECT_EQ(places.front().steps, 80U);
}

TEST_F(PlutoSamples, DecisionsThatAreNotATenthApartAreNamed) {
  recorded_.decisions.erase(recorded_.decisions.begin() + 20);
  recorded_.driven.pop_back();
  EXPECT_THROW(sceneOf(), core::InputError);
}

// A contact of "a" at decision 100: what comes before ends at 99; no sample from 70 to 100 has 30.
TEST_F(PlutoSamples, EndBeforeAContact) {
  recorded_.contacts.push_back({200, {"a", "ego"}});
  const PlutoScene scene = sceneOf();
  const std::vector<PlutoPlace> places = ofDrive(placesOf(scene), 1);
  ASSERT_FALSE(places.empty());
  EXPECT_LT(places.front().decision, 100U);
  for (const PlutoPlace& place : places) {
    if (place.decision < 100) {
      EXPECT_LE(place.decision + place.steps, 99U);
      EXPECT_LE(place.decision, 69U);
    }
  }
  recorded_.contacts.clear();
  EXPECT_EQ(ofDrive(placesOf(scene), 2).size(), ofDrive(placesOf(sceneOf()), 2).size())
      << "of no concern to b";
}

// Noise at decisions 50 to 53: no sample whose first 10 decisions hold one. A stop from 100 to 119
// is longer than 1 s: the future ends where it begins.
TEST_F(PlutoSamples, NoiseIsNoneInTheFirstSecondAndNeverLong) {
  for (std::uint64_t i = 50; i < 54; ++i) recorded_.disturbed.insert({"ego", 2 * i});
  for (std::uint64_t i = 100; i < 120; ++i) recorded_.disturbed.insert({"ego", 2 * i});
  const PlutoScene scene = sceneOf();
  const std::vector<PlutoPlace> places = ofDrive(placesOf(scene), 0);
  ASSERT_FALSE(places.empty());
  EXPECT_LT(places.front().decision, 100U);
  for (const PlutoPlace& place : places) {
    EXPECT_FALSE(place.decision > 40 && place.decision < 54) << place.decision;
    if (place.decision < 100) {
      EXPECT_LE(place.decision + place.steps, 100U) << place.decision;
    }
  }
}

// A stop from decision 110 on begins within the last second of the futures of samples at 35: they
// end where it begins, though only 6 of its decisions lie in them.
TEST_F(PlutoSamples, AStopThatBeginsInTheLastSecondCutsAFuture) {
  for (std::uint64_t i = 110; i < 130; ++i) recorded_.disturbed.insert({"ego", 2 * i});
  const PlutoScene scene = sceneOf();
  for (const PlutoPlace& place : ofDrive(placesOf(scene), 0)) {
    if (place.decision == 35) {
      EXPECT_EQ(place.steps, 75U);
    }
  }
  EXPECT_EQ(ofDrive(placesOf(scene), 0).front().steps, 80U);
}

// "a" drives 0.6 m in 0.1 s: 48 m in 8 s, so mode 4 of the route's line.
TEST_F(PlutoSamples, TheTargetIsWhereTheVehicleWas) {
  const PlutoScene scene = sceneOf();
  const PlutoTarget target = targetOf(scene, ofDrive(placesOf(scene), 1).front());
  EXPECT_EQ(target.line, 0U);
  EXPECT_EQ(target.mode, 4U);
  for (Eigen::Index i = 0; i < kPlutoSteps; ++i) {
    const double expected[] = {0.6 * static_cast<double>(i + 1), 0.0, 1.0, 0.0, 6.0, 0.0};
    for (Eigen::Index c = 0; c < kPlutoChannels; ++c)
      EXPECT_NEAR(target.future(i, c), expected[c], 1e-4) << i;
  }
}

// Only 3 s are known: 18 m, and 5 s more at 6 m/s.
TEST_F(PlutoSamples, ACutFutureIsLedOnForItsMode) {
  const PlutoScene scene = sceneOf();
  const PlutoTarget target = targetOf(scene, {0, 120, 1, 30});
  EXPECT_EQ(target.mode, 4U);
  EXPECT_EQ(target.steps, 30);
  EXPECT_EQ(target.future(30, 0), 0.0F);
}

// 79 m along a road that bends left at 100 m, "a" is known for 3 s, up to 97 m; 5 s more at 6 m/s
// are 30 m along the road: 48 m, mode 4. Straight on they would end 27 m beside it, abreast of the
// bend, in mode 2.
TEST_F(PlutoSamples, ACutFutureIsLedOnAlongTheRoad) {
  const std::string bend = testing::pointText({{0, 0, 0}, {100, 0, 0}, {100, 300, 0}});
  recorded_.network_text =
      "<net><edge id=\"road\"><lane id=\"road_0\" index=\"0\" speed=\"13.89\" shape=\"" + bend +
      "\"/></edge></net>";
  for (learning::SceneDrive& drive : recorded_.drives) {
    for (std::size_t i = 100; i < drive.route_points.size(); ++i)
      drive.route_points[i] = {100.0, static_cast<double>(i) - 100.0, 0.0};
  }
  const PlutoScene scene = sceneOf();
  const PlutoTarget target = targetOf(scene, {0, 40, 1, 30});
  EXPECT_EQ(target.line, 0U);
  EXPECT_EQ(target.mode, 4U);
}

TEST_F(PlutoSamples, OfferedFuturesOfOthersAreInTheirOwnFrames) {
  const PlutoScene scene = sceneOf();
  const AgentFuture future = agentFuture(scene, 100, scene.drives()[2].vehicle);
  EXPECT_NEAR(future.future(9, 0), 7.0, 1e-4);
  EXPECT_TRUE(future.known[49]);
  EXPECT_FALSE(future.known[50]) << "the scene is over";
}

/// A stream that gives the same draws for all samples.
const core::RandomStream kChanges(3, "changes");

TEST_F(PlutoSamples, APositiveIsDisplacedWithinItsLimitsAndKeepsTheWay) {
  const PlutoScene scene = sceneOf();
  const PlutoPlace place = {0, 20, 1, 80};
  const geometry::Pose2d pose = scene.moment(20, 1).point().state.pose();
  bool moved = false;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto changed = positiveMoment(scene, place, {kChanges, {i, 0, 0}});
    const traffic::VehicleState& state = changed->moment.point().state;
    const Eigen::Vector2d offset = pose.toBody(state.position);
    EXPECT_LE(std::abs(offset.x()), 1.0);
    EXPECT_LE(std::abs(offset.y()), 0.75);
    EXPECT_LE(std::abs(state.heading - pose.heading), 0.35);
    moved = moved || offset.norm() > 0.1;
    const PlutoExample example = plutoExample(scene, place, changed->moment, true);
    // The end of the way is the same place.
    const Eigen::Vector2d end =
        example.frame.toMap(example.target.future.row(79).head<2>().transpose().cast<double>());
    EXPECT_NEAR(end.x(), pose.position.x() + 48.0, 1e-3);
    EXPECT_NEAR(end.y(), 0.0, 1e-3);
  }
  EXPECT_TRUE(moved);
}

// "a" drives 0.6 m in 0.1 s along y = 0. Of a frame 1.5 m to the left and turned by 0.2 to the
// left, 2 s x 6 m/s = 12 m lead back: first on in its own direction, then the way that was
// recorded.
TEST_F(PlutoSamples, AWayOffTheRecordedOneLeadsBackToIt) {
  const PlutoScene scene = sceneOf();
  const PlutoPlace place = {0, 20, 1, 80};
  ChangedMoment changed(scene.moment(20, 1));
  geometry::Pose2d frame = changed.moment.point().state.pose();
  const Eigen::Vector2d start = frame.position;
  frame.position.y() += 1.5;
  frame.heading = 0.2;
  const PlutoTarget target =
      plutoTarget(scene, place, frame, scene.world().builder.linesOf(changed.moment));
  const auto placeAt = [&](Eigen::Index row) {
    return frame.toMap(target.future.row(row).head<2>().transpose().cast<double>());
  };
  EXPECT_NEAR(target.future(0, 0), 0.6, 0.02) << "on from where it is";
  EXPECT_NEAR(target.future(0, 1), 0.0, 0.03);
  EXPECT_NEAR(placeAt(9).x(), start.x() + 6.0, 1e-3);
  // e(s) = 1.5 (1 - 3 u^2 + 2 u^3) + tan(0.2) s (1 - u)^2 with u = 6 m / 12 m.
  EXPECT_NEAR(placeAt(9).y(), 0.75 + std::tan(0.2) * 1.5, 1e-3);
  const double slope = -1.5 * 1.5 / 12.0 - 0.25 * std::tan(0.2);
  EXPECT_NEAR(std::atan2(target.future(9, 3), target.future(9, 2)), std::atan(slope) - 0.2, 1e-4);
  for (const Eigen::Index row : {19, 40, 79}) {
    EXPECT_NEAR(placeAt(row).x(), start.x() + 0.6 * static_cast<double>(row + 1), 1e-3);
    EXPECT_NEAR(placeAt(row).y(), 0.0, 1e-3);
  }
}

// A vehicle that is put 2 m ahead is 2 m farther on its route: its line begins there.
TEST_F(PlutoSamples, ADisturbedVehicleIsWhereItIsOnItsRoute) {
  const PlutoScene scene = sceneOf();
  const double place = scene.moment(20, 1).arc_length;
  for (std::uint64_t i = 0; i < 20; ++i) {
    ChangedMoment changed(scene.moment(20, 1));
    const double x = changed.own().state.position.x();
    disturbOwn(changed, {2.0, 1.0, 0.3, 0.0, 0.0, 0.0}, {kChanges, {i, 0, 0}});
    const double moved = changed.own().state.position.x() - x;
    EXPECT_NEAR(changed.moment.arc_length, place + moved, 1e-6);
    const auto lines = scene.world().builder.linesOf(changed.moment);
    EXPECT_NEAR(lines[0].poses[0].position.x(), x + moved, 1e-6);
  }
}

// "ego" at 5 m/s never comes within reach of "a" 25 m ahead at 6 m/s in 4 s, but would drive where
// "a" was: it interacts with it.
TEST_F(PlutoSamples, WhoDrivesAheadInteracts) {
  const PlutoScene scene = sceneOf();
  const auto found = interactingVehicles(scene, {0, 0, 0, 80});
  EXPECT_EQ(found.count(scene.drives()[1].vehicle), 0U) << "20 m in 4 s, 25 m apart";
  learning::Scene near = recorded_;
  for (auto& snapshot : near.decisions) snapshot.vehicles[1].state.position.x() -= 10.0;
  PlutoWorlds worlds(PlutoArchitecture{});
  const PlutoScene closer(near, worlds.of(near));
  EXPECT_EQ(interactingVehicles(closer, {0, 0, 0, 80}).count(closer.drives()[1].vehicle), 1U);
}

TEST_F(PlutoSamples, ANegativeOnAFreeRoadHasASlowLeader) {
  const PlutoScene scene = sceneOf();
  const PlutoPlace place = {0, 30, 2, 80};
  const auto changed = negativeMoment(scene, place, {kChanges, {1, 0, 0}});
  ASSERT_NE(changed, nullptr);
  const TrackFrame& now = changed->frames.back();
  ASSERT_EQ(now.points.size(), 5U);
  const TrackPoint& leader = now.points.back();
  const TrackPoint& own = changed->moment.point();
  EXPECT_GT(leader.state.position.x(), own.state.position.x() + 4.5);
  EXPECT_LT(leader.state.speed, 0.8 * own.state.speed);
  // It has driven like that before.
  const double before = changed->frames.front().points.back().state.position.x();
  EXPECT_NEAR(leader.state.position.x() - before, 2.0 * leader.state.speed, 1e-6);
}

TEST_F(PlutoSamples, SamplesKeepTheirPlaces) {
  const PlutoScene scene = sceneOf();
  const PlutoPlace place = {0, 35, 2, 77};
  const PlutoPlace back = toPlutoPlace(toSample(place, scene));
  EXPECT_EQ(back.scene, place.scene);
  EXPECT_EQ(back.decision, place.decision);
  EXPECT_EQ(back.drive, place.drive);
  EXPECT_EQ(back.steps, place.steps);
  plutoFields().check(toSample(place, scene));
}

}  // namespace
}  // namespace cdiff::planners
