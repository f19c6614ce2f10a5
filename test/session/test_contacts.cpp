// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Contacts of the world with the real SUMO: each is reported once, at the first tick of the
// overlap, and who is not the ego leaves.
#include <gtest/gtest.h>

#include <fstream>

#include "core/text.h"
#include "session/world.h"
#include "simulation/crossing_world.h"

namespace cdiff::session {
namespace {

using traffic::TrafficSnapshot;

// All boxes are 4.5 x 1.8 m and head east: they overlap where the centers are less than 4.5 m apart
// along x and less than 1.8 m along y.
constexpr double kLength = 4.5;
constexpr double kWidth = 1.8;
constexpr double kEgoStart = -100.0;  // [m] along x

/// The crossing with cars that stand on the eastward lane, each with its front at `x`.
class ContactWorld {
 public:
  explicit ContactWorld(const std::vector<std::pair<std::string, double>>& fronts,
                        double start_speed = 0.0)
      : made_(test::makeCrossing(folder_, false)), setup_(scenario(fronts, start_speed)) {}

  World& world() { return world_; }
  const TrafficSnapshot& now() const { return world_.snapshot(); }
  const traffic::Vehicle* car(const std::string& id) const { return now().find(id); }
  const traffic::Vehicle& ego() const { return *now().ego(); }

  /// To the next tick, with a selection that takes `id` over, or none.
  void advance(const std::string& id = "", const traffic::ControlAction& ego = {0.0, 0.0, 1.0}) {
    cbv::CbvSelection selection;
    if (!id.empty()) {
      selection.assignments.emplace_back();
      selection.assignments.back().vehicle_id = id;
      selection.assignments.back().conflict_aware_route = setup_.egoRoute();
    }
    world_.advance(&selection, {{-1, traffic::kEgoId, ego, {}}});
  }
  /// As `advance`, with the vehicle set to `place` as it is taken over.
  void takeOverAt(const std::string& id, const Eigen::Vector2d& place) {
    world_.setTakeOverDisturbance([place](const std::string&, traffic::VehicleState state) {
      state.position = place;
      return state;
    });
    advance(id);
  }
  bool overlapsEgo(const traffic::Vehicle& other) const {
    const Eigen::Vector2d apart = other.state.position - ego().state.position;
    return std::abs(apart.x()) < kLength && std::abs(apart.y()) < kWidth;
  }

 private:
  ScenarioOptions scenario(const std::vector<std::pair<std::string, double>>& fronts,
                           double start_speed) const {
    const std::string demand = (folder_.path() / "standing.rou.xml").string();
    std::ofstream file(demand);
    file << "<routes><vType id=\"car\" length=\"4.5\" width=\"1.8\"/>";
    for (const auto& [id, front] : fronts) {
      const std::string position =
          core::formatNumber(front + 200.0);  // edge west starts at x = -200
      file << "<vehicle id=\"" << id << "\" type=\"car\" depart=\"0\" departPos=\"" << position
           << "\" departSpeed=\"0\"><route edges=\"west east far\"/><stop lane=\"west_0\" endPos=\""
           << position << "\" duration=\"1000\"/></vehicle>";
    }
    file << "</routes>";
    ScenarioOptions options;
    options.cbv_planner = "pdm_lite";
    options.network = made_.file.string();
    options.demand = demand;
    options.route.edges = {"west", "east"};
    options.route.start_offset = kEgoStart + 200.0;
    options.route.start_speed = start_speed;
    options.traffic.warm_up = 0.0;
    options.traffic.clear_start = 0.0;
    return options;
  }

  test::TemporaryFolder folder_;
  test::SumoNetwork made_;
  SessionSetup setup_;
  World world_{setup_};
};

/// Contacts as "first second" of one tick.
std::vector<std::string> pairs(const TrafficSnapshot& snapshot) {
  std::vector<std::string> texts;
  for (const traffic::Contact& contact : snapshot.contacts)
    texts.push_back(contact.first + " " + contact.second);
  return texts;
}

using Texts = std::vector<std::string>;

/// The ego runs into cars on its lane; `taken` is taken over first.
Texts runInto(ContactWorld& contact, const std::string& taken, int ticks) {
  Texts all;
  for (int i = 0; i < ticks; ++i) {
    bool touched = false;
    for (const traffic::Vehicle& vehicle : contact.now().vehicles)
      touched = touched || (vehicle.id != traffic::kEgoId && contact.overlapsEgo(vehicle));
    const Texts at = pairs(contact.now());
    EXPECT_EQ(at.size(), touched ? 1u : 0u) << "tick " << contact.now().tick;
    all.insert(all.end(), at.begin(), at.end());
    const std::vector<traffic::Contact> before = contact.now().contacts;
    contact.advance(taken, {1.0, 0.0, 0.0});
    for (const traffic::Contact& pair : before) {
      const std::string& other = pair.first == traffic::kEgoId ? pair.second : pair.first;
      EXPECT_EQ(contact.car(other), nullptr) << other << " stays after its contact";
      EXPECT_EQ(contact.now().removed, Texts{other});
    }
  }
  return all;
}

// The car's center is at x = -70 - 2.25 = -72.25 m, the ego's bumper 23.25 m behind its rear: at 8
// m/s and full throttle less than 3 s, 60 ticks.
TEST(Contacts, OfTheEgoWithACbvIsOnePairAtTheFirstOverlapAndTheCbvLeaves) {
  ContactWorld contact({{"car", -70.0}}, 8.0);
  ASSERT_NE(contact.car("car"), nullptr);
  EXPECT_EQ(runInto(contact, "car", 70), Texts{"car ego"});
  EXPECT_EQ(contact.now().status, traffic::SessionStatus::kRunning);
  EXPECT_GT(contact.ego().state.position.x(), -72.25) << "the ego goes on";
}

TEST(Contacts, OfTheEgoWithBackgroundVehiclesCountOneByOne) {
  ContactWorld contact({{"near", -70.0}, {"next", -40.0}}, 8.0);
  EXPECT_EQ(runInto(contact, "", 110), (Texts{"ego near", "ego next"}));
  EXPECT_EQ(contact.now().vehicles.size(), 1u) << "the ego alone";
}

// Centers up to |(4.5, 1.8)| = 4.85 m apart overlap, farther than half the lengths' sum, 4.5 m.
TEST(Contacts, ReachToTheCornersOfBothBoxes) {
  struct Case {
    double along, aside;
    bool contact;
  };
  for (const Case& c : {Case{4.4, 0.0, true}, Case{4.6, 0.0, false}, Case{4.4, 1.75, true},
                        Case{4.4, 1.85, false}, Case{-4.4, -1.75, true}, Case{0.0, 1.85, false}}) {
    ContactWorld contact({{"car", -85.0}});
    contact.takeOverAt("car", contact.ego().state.position + Eigen::Vector2d(c.along, c.aside));
    EXPECT_EQ(pairs(contact.now()), c.contact ? Texts{"car ego"} : Texts{})
        << c.along << " m ahead, " << c.aside << " m aside";
    ASSERT_NE(contact.car("car"), nullptr) << "it leaves at the next tick";
    contact.advance("car");
    EXPECT_EQ(contact.car("car") == nullptr, c.contact);
    EXPECT_EQ(pairs(contact.now()), Texts{});
  }
}

TEST(Contacts, OfACbvWithABackgroundVehicleRemoveBothAndLeaveTheEgoAlone) {
  ContactWorld contact({{"back", -85.0}, {"front", -70.0}});
  contact.takeOverAt("back", contact.car("front")->state.position - Eigen::Vector2d(4.4, 0.0));
  EXPECT_EQ(pairs(contact.now()), Texts{"back front"});
  contact.advance("back");
  EXPECT_EQ(contact.now().vehicles.size(), 1u);
  EXPECT_EQ(contact.now().vehicles.front().id, traffic::kEgoId);
  EXPECT_EQ(contact.now().removed, (Texts{"back", "front"}));
}

}  // namespace
}  // namespace cdiff::session
