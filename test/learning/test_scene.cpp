// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/dataset.h"
#include "learning/samples/scene_file.h"
#include "learning/samples/scene_tables.h"
#include "learning/small_scene.h"
#include "support/same_vehicle.h"
#include "support/temporary_folder.h"
#include "traffic/vehicle_class.h"

namespace cdiff::learning {
namespace {

using test::smallScene;

void expectSame(const SceneDrive& found, const SceneDrive& expected) {
  EXPECT_EQ(found.vehicle_id, expected.vehicle_id);
  EXPECT_EQ(found.selected_tick, expected.selected_tick);
  EXPECT_EQ(found.driver.target_speed, expected.driver.target_speed);
  EXPECT_EQ(found.driver.minimum_gap, expected.driver.minimum_gap);
  EXPECT_EQ(found.driver.time_headway, expected.driver.time_headway);
  EXPECT_EQ(found.driver.acceleration, expected.driver.acceleration);
  EXPECT_EQ(found.driver.deceleration, expected.driver.deceleration);
  EXPECT_EQ(found.interaction_score, expected.interaction_score);
  EXPECT_EQ(found.conflict_point, expected.conflict_point);
  EXPECT_EQ(found.route_points, expected.route_points);
  EXPECT_EQ(found.route_lanes, expected.route_lanes);
}

std::string errorOf(const std::string& bytes) {
  try {
    sceneOf(bytes, "scene 'x'");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Scene, ComesBackFromItsFileToTheLastBit) {
  Scene scene = smallScene();
  scene.decisions[3].vehicles[1].state.position.x() = 1.0 / 3.0;
  scene.disturbed = {{"a", 6}, {"ego", 8}};
  scene.contacts = {{7, {"a", "gone"}}};
  const test::TemporaryFolder folder;
  writeScene(folder.path() / "a.scene", scene);
  const Scene found = readScene(folder.path() / "a.scene");
  EXPECT_EQ(found.name, scene.name);
  EXPECT_EQ(found.scenario_yaml, scene.scenario_yaml);
  EXPECT_EQ(found.network_source, scene.network_source);
  EXPECT_EQ(found.network_source_sha256, scene.network_source_sha256);
  EXPECT_EQ(found.network_text, scene.network_text);
  EXPECT_EQ(found.seconds, scene.seconds);
  EXPECT_EQ(found.disturbed, scene.disturbed);
  ASSERT_EQ(found.contacts.size(), 1U);
  EXPECT_EQ(found.contacts[0].first, 7U);
  EXPECT_EQ(found.contacts[0].second.second, "gone");
  EXPECT_EQ(found.driven, scene.driven);
  ASSERT_EQ(found.drives.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) expectSame(found.drives[i], scene.drives[i]);
  ASSERT_EQ(found.decisions.size(), scene.decisions.size());
  for (std::size_t i = 0; i < found.decisions.size(); ++i) {
    EXPECT_EQ(found.decisions[i].tick, scene.decisions[i].tick);
    EXPECT_EQ(found.decisions[i].time, scene.decisions[i].time);
    EXPECT_TRUE(found.decisions[i].decision_tick);
    ASSERT_EQ(found.decisions[i].signals.size(), 1U);
    EXPECT_EQ(found.decisions[i].signals[0].id, "light");
    EXPECT_EQ(found.decisions[i].signals[0].state, scene.decisions[i].signals[0].state);
    ASSERT_EQ(found.decisions[i].vehicles.size(), 3U);
    for (std::size_t n = 0; n < 3; ++n)
      test::expectSame(found.decisions[i].vehicles[n], scene.decisions[i].vehicles[n]);
  }
}

TEST(Scene, TheSameSceneGivesTheSameBytes) {
  EXPECT_EQ(sceneBytes(smallScene()), sceneBytes(smallScene()));
}

TEST(Scene, AnEmptySessionIsOneToo) {
  Scene scene;
  scene.name = "none";
  const Scene found = sceneOf(sceneBytes(scene), "scene 'x'");
  EXPECT_EQ(found.name, "none");
  EXPECT_TRUE(found.decisions.empty());
}

TEST(Scene, EveryTruncationAndEveryChangedByteIsRefused) {
  const std::string bytes = sceneBytes(smallScene(4));
  for (std::size_t length = 0; length < bytes.size(); length += 97)
    EXPECT_NE(errorOf(bytes.substr(0, length)).find("scene 'x'"), std::string::npos) << length;
  EXPECT_NE(errorOf(bytes.substr(0, bytes.size() / 2)).find("truncated"), std::string::npos);
  for (std::size_t place = 0; place < bytes.size(); place += 101) {
    std::string changed = bytes;
    changed[place] = static_cast<char>(changed[place] ^ 1);
    EXPECT_NE(errorOf(changed), "") << place;
  }
}

TEST(Scene, ForeignFilesAreNamed) {
  EXPECT_EQ(errorOf("not a scene at all, but long enough to be one, by its length alone; really"),
            "scene 'x': is not a scene");
  ShardWriter shard(sceneSchema());
  shard.append(tablesOf(smallScene(2)));
  EXPECT_EQ(errorOf(shard.take()), "scene 'x': is not a scene");
  const test::TemporaryFolder folder;
  core::writeFileAtomically(folder.path() / "a.scene", "");
  EXPECT_THROW(readScene(folder.path() / "a.scene"), core::InputError);
  EXPECT_THROW(readScene(folder.path() / "none.scene"), core::InputError);
}

/// A file of the kind of a scene with these tables and this version.
std::string fileOf(const SampleSchema& schema, const Sample& tables, const std::string& version) {
  ShardWriter writer(schema, {"CDIFFSCN", "scene"});
  writer.append(tables);
  return writer.take({{"scene_version", version}});
}

TEST(Scene, AnotherVersionIsNamed) {
  const Sample tables = tablesOf(smallScene(2));
  EXPECT_EQ(errorOf(fileOf(sceneSchema(), tables, "1")), "");
  EXPECT_NE(errorOf(fileOf(sceneSchema(), tables, "2"))
                .find("scene version 2, this program reads 1; collect it again"),
            std::string::npos);
  SampleSchema other = sceneSchema();
  other.fields.pop_back();
  Sample less = tables;
  less.fields.erase("seconds");
  EXPECT_NE(errorOf(fileOf(other, less, "1")).find("its tables are not those of a scene"),
            std::string::npos);
}

TEST(Scene, TablesThatDoNotFitEachOtherAreRefused) {
  const auto refuses = [](const char* table, auto change) {
    Sample tables = tablesOf(smallScene(4));
    change(tables.fields.at(table));
    EXPECT_EQ(errorOf(fileOf(sceneSchema(), tables, "1")),
              "scene 'x': its tables do not fit each other")
        << table;
  };
  using Counts = std::vector<std::uint64_t>;
  const auto last = [](std::uint64_t value) {
    return [value](FieldValue& field) { std::get<Counts>(field).back() = value; };
  };
  refuses("vehicles", last(4));       // more rows than there are
  refuses("vehicle", last(3));        // of three vehicles
  refuses("lane", last(2));           // of "road_0" and ""
  refuses("drive_vehicle", last(3));  // as above
  refuses("route_size", last(1000));
  refuses("route_lane", last(9));
  refuses("driven", last(2));  // of two drives
  refuses("signals", last(2));
  refuses("role", [](FieldValue& field) { std::get<std::vector<std::uint8_t>>(field)[0] = 3; });
  refuses("x", [](FieldValue& field) { std::get<std::vector<double>>(field).pop_back(); });
  refuses("seconds", [](FieldValue& field) { std::get<std::vector<double>>(field).clear(); });
}

TEST(Scene, AStateThatIsNotFiniteIsNotWritten) {
  Scene scene = smallScene(2);
  scene.decisions[1].vehicles[0].state.speed = std::nan("");
  EXPECT_THROW(sceneBytes(scene), core::InputError);
}

TEST(Scene, RoutesLieOnTheLanesOfItsNetwork) {
  const Scene scene = smallScene(2);
  const map::RoadNetwork network =
      map::RoadNetwork::fromText(scene.network_text, scene.network_source);
  const map::Route route = routeOf(scene, scene.drives[1], network);
  EXPECT_DOUBLE_EQ(route.length(), 270.0);
  EXPECT_EQ(route.edges(), std::vector<std::string>{"road"});
  SceneDrive lost = scene.drives[1];
  lost.route_lanes[5] = "none_0";
  try {
    routeOf(scene, lost, network);
    FAIL() << "accepted";
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "scene 'small_seed1': the route of vehicle 'a' uses lane 'none_0', which its "
                 "network lacks");
  }
}

// A car is at most 2.1 m high and 6.5 m long, and more than 1.1 m wide.
TEST(VehicleClass, IsToldByTheBox) {
  using traffic::VehicleClass;
  EXPECT_EQ(traffic::classOf({4.5, 1.8, 1.5}), VehicleClass::kCar);
  EXPECT_EQ(traffic::classOf({6.6, 1.8, 1.5}), VehicleClass::kLarge);
  EXPECT_EQ(traffic::classOf({4.5, 1.8, 2.2}), VehicleClass::kLarge);
  EXPECT_EQ(traffic::classOf({2.2, 1.1, 1.7}), VehicleClass::kNarrow);
}

}  // namespace
}  // namespace cdiff::learning
