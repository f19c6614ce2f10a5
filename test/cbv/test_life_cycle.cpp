// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// How long a CBV keeps its slot, in both life cycles.
#include <gtest/gtest.h>

#include "cbv/candidate_gates.h"
#include "cbv/cbv_options.h"
#include "cbv/crossing_world.h"

namespace cdiff::cbv {
namespace {

constexpr std::uint64_t kFirst = 52;  // 2.6 s
constexpr std::uint64_t kPeriod = 4;  // 0.2 s

/// As the simulator reports a vehicle once it drives it as a CBV.
traffic::Vehicle driven(traffic::Vehicle vehicle, int slot) {
  vehicle.role = traffic::VehicleRole::kCbv;
  vehicle.cbv_slot = slot;
  return vehicle;
}

CbvOptions reselecting() {
  CbvOptions options;
  options.life_cycle = "reselect";
  return options;
}

TEST(LifeCycle, DistancesOfAHeldCbvAreThoseOfTheDecision) {
  CrossingWorld world({}, 1);
  world.selector.update(
      crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));  // conflict point x = 148
  // Between selections, too: 0.1 s later the ego is 1 m and the CBV 0.9 m farther.
  const auto next = world.selector.update(
      crossingSnapshot(kFirst + 2, 71.0, {driven(fromSouth("a", -29.1, 5.0), 0)}));
  ASSERT_EQ(next.assignments.size(), 1u);
  const ConflictPoint& point = next.assignments[0].conflict_point;
  EXPECT_NEAR(point.position.x(), 148.0, 1e-9);
  EXPECT_NEAR(point.ego_distance, 77.0, 1e-6);
  // 70.07 m at first; the route that rounds corners is at most 0.92 m shorter, so the 0.9 m driven
  // count for at most 0.9 x 70.07 / 69.15 = 0.912 m.
  EXPECT_NEAR(point.cbv_distance, 24.1 + std::sqrt(50.0) + 38.0, 0.012);
  EXPECT_NEAR(point.cbv_arrival, point.cbv_distance / 5.0, 1e-12);
  EXPECT_NEAR(point.ego_arrival, 7.7, 1e-6);
  EXPECT_EQ(next.assignments[0].selected_tick, kFirst);
  // Both have passed it.
  const auto passed = world.selector.update(
      crossingSnapshot(kFirst + 4, 160.0, {driven(test::vehicle("a", {151.0, 0.0, 0.0, 5.0}), 0)}));
  ASSERT_EQ(passed.assignments.size(), 1u);
  EXPECT_EQ(passed.assignments[0].conflict_point.ego_distance, 0.0);
  EXPECT_EQ(passed.assignments[0].conflict_point.cbv_distance, 0.0);
}

TEST(LifeCycle, OfChallengingReselectsWhereTheScenarioDoesNotSay) {
  CbvOptions options;
  EXPECT_EQ(options.inMode("challenging").life_cycle, "reselect");
  EXPECT_EQ(options.inMode("safety_critical").life_cycle, "rift");
  EXPECT_EQ(options.inMode("naturalistic").life_cycle, "rift");
  options.life_cycle = "rift";
  EXPECT_EQ(options.inMode("challenging").life_cycle, "rift");
}

traffic::TrafficSnapshot steered(traffic::TrafficSnapshot snapshot, const std::string& what,
                                 const std::string& id) {
  const bool ends = what != traffic::steered::kChoose;
  snapshot.steering = {{"me", what, ends ? id : "", ends ? "" : id}};
  return snapshot;
}

TEST(LifeCycle, AChosenVehicleTakesTheSlotOfTheWeakest) {
  CrossingWorld world({}, 1);
  world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("first", -20.0, 2.0)}));
  const auto chosen = world.selector.update(steered(
      crossingSnapshot(kFirst + 2, 70.0,
                       {driven(fromSouth("first", -20.0, 2.0), 0), fromNorth("wanted", 30.0, 9.0)}),
      "choose", "wanted"));
  ASSERT_EQ(chosen.assignments.size(), 1u);
  EXPECT_EQ(chosen.assignments[0].vehicle_id, "wanted");
  ASSERT_EQ(chosen.released.size(), 1u);
  EXPECT_EQ(chosen.released[0].vehicle_id, "first");
  EXPECT_EQ(chosen.released[0].reason, kSteered);
}

TEST(LifeCycle, AChosenVehicleThatPassesNoGateIsRejectedOnce) {
  CrossingWorld world({}, 1);
  const auto selection = world.selector.update(
      steered(crossingSnapshot(kFirst, 70.0, {fromSouth("far", -104.0, 9.0)}), "choose", "far"));
  EXPECT_TRUE(selection.assignments.empty());
  ASSERT_EQ(selection.rejected.size(), 1u);
  EXPECT_EQ(selection.rejected[0].reason, kTooFar);
  const auto gone =
      world.selector.update(steered(crossingSnapshot(kFirst + 2, 70.0, {}), "choose", "nobody"));
  EXPECT_EQ(reasonOf(gone, "nobody"), kGone);
}

TEST(LifeCycle, WhoWasReleasedBySteeringCanBeChosenAgain) {
  CrossingWorld world({}, 1);
  const auto car = fromSouth("car", -30.0, 9.0);
  world.selector.update(crossingSnapshot(kFirst, 70.0, {car}));
  const auto released = world.selector.update(
      steered(crossingSnapshot(kFirst + 2, 70.0, {driven(car, 0)}), "release", "car"));
  EXPECT_TRUE(released.assignments.empty());
  ASSERT_EQ(released.released.size(), 1u);
  EXPECT_EQ(released.released[0].reason, kSteered);
  EXPECT_TRUE(world.selector.update(crossingSnapshot(kFirst + 4, 70.0, {car})).assignments.empty());
  const auto again =
      world.selector.update(steered(crossingSnapshot(kFirst + 6, 70.0, {car}), "choose", "car"));
  EXPECT_EQ(again.assignments.size(), 1u);
}

TEST(LifeCycle, WhoWasReleasedBySteeringStaysReleasedWhereVehiclesAreChosenAgain) {
  CbvOptions options;
  options.life_cycle = "reselect";
  CrossingWorld world(options, 1);
  const auto car = fromSouth("car", -30.0, 9.0);
  ASSERT_EQ(world.selector.update(crossingSnapshot(kFirst, 70.0, {car})).assignments.size(), 1u);
  world.selector.update(
      steered(crossingSnapshot(kFirst + 2, 70.0, {driven(car, 0)}), "release", "car"));
  EXPECT_TRUE(world.selector.update(crossingSnapshot(kFirst + 4, 70.0, {car})).assignments.empty());
}

TEST(LifeCycle, OnlyTheNamedBecomeCbvs) {
  CbvOptions options;
  options.only = {"named"};
  CrossingWorld world(options, 2);
  const auto selection = world.selector.update(crossingSnapshot(
      kFirst, 70.0, {fromSouth("other", -30.0, 9.0), fromNorth("named", 30.0, 9.0)}));
  ASSERT_EQ(selection.assignments.size(), 1u);
  EXPECT_EQ(selection.assignments[0].vehicle_id, "named");
  EXPECT_EQ(reasonOf(selection, "other"), kNotNamed);
}

TEST(LifeCycle, PedestriansAndBicyclesNeverBecomeCbvs) {
  CrossingWorld world({}, 2);
  traffic::Vehicle walker = fromSouth("walker", -30.0, 9.0);
  walker.dimensions = {0.4, 0.6, 1.8};
  traffic::Vehicle cyclist = fromNorth("cyclist", 30.0, 9.0);
  cyclist.dimensions = {1.8, 0.6, 1.7};
  const auto selection = world.selector.update(crossingSnapshot(kFirst, 70.0, {walker, cyclist}));
  EXPECT_TRUE(selection.assignments.empty());
  EXPECT_EQ(reasonOf(selection, "walker"), kTooSmall);
  EXPECT_EQ(reasonOf(selection, "cyclist"), kTooSmall);
}

TEST(LifeCycle, RiftNeverRanksAgain) {
  CrossingWorld world({}, 1);
  world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("weak", -20.0, 2.0)}));
  const auto later = world.selector.update(
      crossingSnapshot(kFirst + kPeriod, 70.0,
                       {driven(fromSouth("weak", -20.0, 2.0), 0), fromNorth("better", 30.0, 9.0)}));
  ASSERT_EQ(later.assignments.size(), 1u);
  EXPECT_EQ(later.assignments[0].vehicle_id, "weak");
  EXPECT_TRUE(later.released.empty());
  EXPECT_EQ(reasonOf(later, "better"), kOutranked);
  EXPECT_EQ(reasonOf(later, "weak"), "");
}

// `by_mode` follows a mode that steering sets. A life cycle that the scenario names stays.
TEST(LifeCycle, FollowsTheModeThatSteeringSets) {
  for (const char* life_cycle : {"by_mode", "rift"}) {
    CbvOptions options;
    options.life_cycle = life_cycle;
    CrossingWorld world(options, 1);
    world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("weak", -20.0, 2.0)}));
    auto snapshot = crossingSnapshot(
        kFirst + kPeriod, 70.0,
        {driven(fromSouth("weak", -20.0, 2.0), 0), fromNorth("better", 30.0, 9.0)});
    snapshot.steering = {{"me", "mode", "naturalistic", "challenging"}};
    const auto later = world.selector.update(snapshot);
    ASSERT_EQ(later.assignments.size(), 1u);
    const bool follows = options.life_cycle == "by_mode";
    EXPECT_EQ(later.assignments[0].vehicle_id, follows ? "better" : "weak") << life_cycle;
    EXPECT_EQ(later.released.size(), follows ? 1u : 0u);
  }
}

TEST(LifeCycle, ContactReleasesAndTheFreedSlotIsFilled) {
  CrossingWorld world;
  const std::vector<traffic::Vehicle> both = {fromSouth("a", -30.0, 9.0),
                                              fromNorth("b", 30.0, 9.0)};
  ASSERT_EQ(world.selector.update(crossingSnapshot(kFirst, 70.0, both)).assignments.size(), 2u);
  auto snapshot = crossingSnapshot(
      kFirst + kPeriod, 70.0, {driven(both[0], 0), driven(both[1], 1), fromSouth("c", -40.0, 9.0)});
  snapshot.contacts.push_back({"a", "other"});
  const auto selection = world.selector.update(snapshot);
  ASSERT_EQ(selection.released.size(), 1u);
  EXPECT_EQ(selection.released[0].vehicle_id, "a");
  EXPECT_EQ(selection.released[0].slot, 0);
  EXPECT_EQ(selection.released[0].reason, kContact);
  ASSERT_EQ(selection.assignments.size(), 2u);
  EXPECT_EQ(selection.assignments[0].vehicle_id, "c");  // the lowest free slot
  EXPECT_EQ(selection.assignments[1].vehicle_id, "b");
}

TEST(LifeCycle, RemovedVehicleCountsAsContact) {
  CrossingWorld world;
  world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
  auto snapshot = crossingSnapshot(kFirst + 2, 70.0, {});
  snapshot.removed.push_back("a");
  const auto selection = world.selector.update(snapshot);
  EXPECT_TRUE(selection.assignments.empty());
  ASSERT_EQ(selection.released.size(), 1u);
  EXPECT_EQ(selection.released[0].reason, kContact);
}

// The contact falls on a tick between decisions and its vehicles are gone at the next; pairs are
// sorted, so the CBV may be second.
TEST(LifeCycle, ContactBetweenDecisionsIsRemembered) {
  for (const traffic::Contact& contact : {traffic::Contact{"a", "b"}, traffic::Contact{"0", "a"}}) {
    CrossingWorld world;
    world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
    auto between = crossingSnapshot(kFirst + 1, 70.0, {});
    between.contacts.push_back(contact);
    world.selector.observe(between);
    const auto selection = world.selector.update(crossingSnapshot(kFirst + 2, 70.0, {}));
    ASSERT_EQ(selection.released.size(), 1u);
    EXPECT_EQ(selection.released[0].reason, kContact) << contact.first;
  }
}

TEST(LifeCycle, VanishedVehicleIsGone) {
  CrossingWorld world;
  world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
  const auto selection = world.selector.update(crossingSnapshot(kFirst + 2, 70.0, {}));
  ASSERT_EQ(selection.released.size(), 1u);
  EXPECT_EQ(selection.released[0].reason, kGone);
}

TEST(LifeCycle, EndOfTheRouteReleasesForGood) {
  CrossingWorld world({}, 1);
  const auto first =
      world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
  ASSERT_EQ(first.assignments.size(), 1u);
  const map::Route& route = first.assignments[0].conflict_aware_route;
  const auto at = [&](double remaining) {
    const Eigen::Vector2d position = route.path().positionAt(route.length() - remaining);
    return driven(test::vehicle("a", {position.x(), position.y(), 0.0, 9.0}), 0);
  };
  EXPECT_TRUE(
      world.selector.update(crossingSnapshot(kFirst + 2, 150.0, {at(4.0)})).released.empty());
  const auto end = world.selector.update(crossingSnapshot(kFirst + 4, 150.0, {at(2.5)}));
  ASSERT_EQ(end.released.size(), 1u);
  EXPECT_EQ(end.released[0].reason, kRouteEnd);
  EXPECT_TRUE(end.assignments.empty());
  // Back among the background, where it would have a conflict: never chosen again.
  const auto again =
      world.selector.update(crossingSnapshot(kFirst + 8, 70.0, {fromSouth("a", -30.0, 9.0)}));
  EXPECT_TRUE(again.assignments.empty());
  EXPECT_EQ(reasonOf(again, "a"), kAlreadyChosen);
}

// SUMO removes vehicles where their routes end: within 10 m of its end a CBV has arrived.
TEST(LifeCycle, RemovedNearTheEndOfItsRouteIsArrival) {
  for (const auto& [remaining, reason] : {std::pair{9.5, kRouteEnd}, {10.5, kContact}}) {
    CrossingWorld world({}, 1);
    const auto first =
        world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
    ASSERT_EQ(first.assignments.size(), 1u);
    const map::Route& route = first.assignments[0].conflict_aware_route;
    const Eigen::Vector2d position = route.path().positionAt(route.length() - remaining);
    const auto last = driven(test::vehicle("a", {position.x(), position.y(), 0.0, 9.0}), 0);
    ASSERT_TRUE(
        world.selector.update(crossingSnapshot(kFirst + 2, 150.0, {last})).released.empty());
    auto snapshot = crossingSnapshot(kFirst + 4, 150.0, {});
    snapshot.removed.push_back("a");
    const auto selection = world.selector.update(snapshot);
    ASSERT_EQ(selection.released.size(), 1u);
    EXPECT_EQ(selection.released[0].reason, reason) << remaining;
  }
}

// Seen from 2 m ahead of "a", the ego's route along y = 0 is at least 28 m away.
TEST(LifeCycle, ARouteBeyondTheRadiusIsOutOfView) {
  for (const auto& [radius, seen] : {std::pair{90.0, true}, {27.0, false}}) {
    CbvOptions options;
    options.interaction_radius = radius;
    CrossingWorld world(options, 1);
    const auto selection =
        world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
    EXPECT_EQ(selection.assignments.size(), seen ? 1u : 0u);
    EXPECT_EQ(reasonOf(selection, "a"), seen ? "" : kOutOfView);
  }
}

TEST(LifeCycle, VehicleInContactIsNotChosen) {
  CrossingWorld world;
  auto snapshot = crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)});
  snapshot.contacts.push_back({"a", "b"});
  const auto selection = world.selector.update(snapshot);
  EXPECT_TRUE(selection.assignments.empty());
  EXPECT_EQ(reasonOf(selection, "a"), kInContact);
}

TEST(LifeCycle, ReselectTakesABetterCandidateBeyondTheHysteresis) {
  const std::vector<traffic::Vehicle> first = {fromSouth("weak", -20.0, 2.0)};
  const std::vector<traffic::Vehicle> then = {driven(first[0], 0), fromNorth("better", 30.0, 9.0)};
  CbvOptions options = reselecting();
  options.hysteresis = 0.1;
  CrossingWorld world(options, 1);
  world.selector.update(crossingSnapshot(kFirst, 70.0, first));
  const auto replaced = world.selector.update(crossingSnapshot(kFirst + kPeriod, 70.0, then));
  ASSERT_EQ(replaced.assignments.size(), 1u);
  EXPECT_EQ(replaced.assignments[0].vehicle_id, "better");
  ASSERT_EQ(replaced.released.size(), 1u);
  EXPECT_EQ(replaced.released[0].reason, kOutranked);
  // The better score is exp(-0.31 - 1.15) = 0.23 at most: no challenger can be better by 0.3.
  options.hysteresis = 0.3;
  CrossingWorld inert(options, 1);
  inert.selector.update(crossingSnapshot(kFirst, 70.0, first));
  const auto kept = inert.selector.update(crossingSnapshot(kFirst + kPeriod, 70.0, then));
  EXPECT_EQ(kept.assignments.at(0).vehicle_id, "weak");
  EXPECT_EQ(reasonOf(kept, "better"), kOutranked);
}

// "strong" stands as "better" does below, so only "weak" can be outranked, in either slot.
TEST(LifeCycle, ReselectReplacesTheWeakest) {
  const auto weak = fromSouth("weak", -20.0, 2.0);
  const auto strong = fromNorth("strong", 30.0, 9.0);
  CbvOptions options = reselecting();
  options.hysteresis = 0.1;
  options.clear_time = 0.0;  // "better" follows "strong" closely
  for (const bool weak_first : {true, false}) {
    CrossingWorld world(options, 2);
    const auto& one = weak_first ? weak : strong;
    const auto& other = weak_first ? strong : weak;
    world.selector.update(crossingSnapshot(kFirst, 70.0, {one}));
    const auto two =
        world.selector.update(crossingSnapshot(kFirst + kPeriod, 70.0, {driven(one, 0), other}));
    ASSERT_EQ(two.assignments.size(), 2u);
    const auto then = world.selector.update(
        crossingSnapshot(kFirst + 2 * kPeriod, 70.0,
                         {driven(one, 0), driven(other, 1), fromNorth("better", 34.6, 9.0)}));
    ASSERT_EQ(then.released.size(), 1u);
    EXPECT_EQ(then.released[0].vehicle_id, "weak");
    EXPECT_EQ(then.released[0].slot, weak_first ? 0 : 1);
    ASSERT_EQ(then.assignments.size(), 2u);
    EXPECT_EQ(then.assignments[weak_first ? 0 : 1].vehicle_id, "better");
  }
}

// By nearness "weak" comes first, though "better" has the better score: whoever is chosen at a
// selection is not replaced in the same one.
TEST(LifeCycle, ReselectKeepsWhomItHasJustChosen) {
  CbvOptions options = reselecting();
  options.ranking = "nearest";
  CrossingWorld world(options, 1);
  const std::vector<traffic::Vehicle> both = {fromSouth("weak", -20.0, 2.0),
                                              fromNorth("better", 30.0, 9.0)};
  const auto first = world.selector.update(crossingSnapshot(kFirst, 70.0, both));
  ASSERT_EQ(first.assignments.size(), 1u);
  EXPECT_EQ(first.assignments[0].vehicle_id, "weak");
  EXPECT_TRUE(first.released.empty());
  EXPECT_EQ(reasonOf(first, "better"), kOutranked);
  const auto then = world.selector.update(
      crossingSnapshot(kFirst + kPeriod, 70.0, {driven(both[0], 0), both[1]}));
  EXPECT_EQ(then.assignments.at(0).vehicle_id, "better");
}

TEST(LifeCycle, ReselectReleasesALostConflictAfterItsTimeAndMayChooseAgain) {
  CrossingWorld world(reselecting(), 1);
  world.selector.update(crossingSnapshot(kFirst, 70.0, {fromSouth("a", -30.0, 9.0)}));
  // The ego has driven on: at x = 200 it is 90 m ahead of the CBV's turn, so no distances agree.
  // Lost from 2.8 s on.
  const auto waits = driven(fromSouth("a", -30.0, 0.0), 0);
  for (std::uint64_t tick = kFirst + kPeriod; tick < kFirst + kPeriod + 40; tick += kPeriod) {
    ASSERT_EQ(world.selector.update(crossingSnapshot(tick, 200.0, {waits})).assignments.size(), 1u)
        << tick;
  }
  const auto lost =
      world.selector.update(crossingSnapshot(kFirst + kPeriod + 40, 200.0, {waits}));  // 4.8 s
  EXPECT_TRUE(lost.assignments.empty());
  ASSERT_EQ(lost.released.size(), 1u);
  EXPECT_EQ(lost.released[0].reason, kConflictLost);
  // On the ego's own route behind it, 15 m apart at every point: a conflict again.
  const auto again = world.selector.update(crossingSnapshot(
      kFirst + 2 * kPeriod + 40, 200.0, {test::vehicle("a", {185.0, 0.0, 0.0, 10.0})}));
  ASSERT_EQ(again.assignments.size(), 1u);
  EXPECT_EQ(again.assignments[0].vehicle_id, "a");
}

TEST(LifeCycle, ReselectForgetsAShortLoss) {
  CrossingWorld world(reselecting(), 1);
  const auto present = fromSouth("a", -30.0, 9.0);
  world.selector.update(crossingSnapshot(kFirst, 70.0, {present}));
  auto askew = driven(present, 0);
  askew.state.heading = 0.0;  // off its lane for a moment: no conflict
  for (std::uint64_t i = 1; i <= 20; ++i) {
    const bool lost = i % 10 != 0;  // 1.8 s without, then one decision with a conflict
    const auto selection = world.selector.update(
        crossingSnapshot(kFirst + i * kPeriod, 70.0, {lost ? askew : driven(present, 0)}));
    ASSERT_EQ(selection.assignments.size(), 1u) << i;
  }
}

}  // namespace
}  // namespace cdiff::cbv
