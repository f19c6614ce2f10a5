// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// An independent reader (pugixml) compares OpenSCENARIO files with trace.csv.
#include <gtest/gtest.h>

#include <cstring>
#include <pugixml.hpp>

#include "exchange/openscenario_writer.h"
#include "exchange/recorded_session.h"
#include "record/result_folder.h"

namespace cdiff::exchange {
namespace {

class OpenScenarioWriter : public testing::Test {
 protected:
  pugi::xml_node write(const SceneOptions& options, ExportedEgo ego = ExportedEgo::kTrajectory) {
    const std::string text =
        openScenarioText(readScene(session_.folder(), options), "crossing.xodr", ego);
    EXPECT_TRUE(document_.load_string(text.c_str()));
    return document_.child("OpenSCENARIO");
  }
  pugi::xml_node named(const char* element, const std::string& name) const {
    return document_.find_node([&](const pugi::xml_node& node) {
      return std::strcmp(node.name(), element) == 0 && name == node.attribute("name").value();
    });
  }
  /// Places and times of a vehicle's course.
  std::vector<pugi::xml_node> course(const std::string& id) const {
    const pugi::xml_node line =
        named("Trajectory", "course_" + id).child("Shape").child("Polyline");
    const auto vertices = line.children("Vertex");
    return {vertices.begin(), vertices.end()};
  }
  /// Rows of a vehicle in trace.csv.
  std::vector<record::TraceRow> rows(const std::string& id) const {
    std::vector<record::TraceRow> rows;
    for (const record::TraceRow& row : record::readTrace(session_.folder() / "trace.csv"))
      if (row.id == id) rows.push_back(row);
    return rows;
  }
  test::RecordedSession session_;
  pugi::xml_document document_;
};

double number(pugi::xml_node node, const char* attribute) {
  EXPECT_TRUE(node.attribute(attribute)) << attribute;
  return node.attribute(attribute).as_double();
}

/// The center of the box that a reader of the standard finds: the box's center in the vehicle's
/// frame, turned to its heading at the vertex.
Eigen::Vector2d boxCenter(pugi::xml_node vertex, pugi::xml_node center) {
  const pugi::xml_node place = vertex.child("Position").child("WorldPosition");
  const double heading = number(place, "h");
  const Eigen::Rotation2Dd turn(heading);
  return Eigen::Vector2d(number(place, "x"), number(place, "y")) +
         turn * Eigen::Vector2d(number(center, "x"), number(center, "y"));
}

TEST_F(OpenScenarioWriter, EveryVertexIsTheTracesPlaceAtItsTime) {
  write({0.0, {}, "all"});
  for (const std::string id : {"ego", "bg_1", "bg_2"}) {
    const auto vertices = course(id);
    const auto trace = rows(id);
    const pugi::xml_node center = named("Vehicle", id).child("BoundingBox").child("Center");
    ASSERT_EQ(vertices.size(), test::RecordedSession::kLastTick + 1) << id;
    ASSERT_EQ(vertices.size(), trace.size()) << id;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const pugi::xml_node place = vertices[i].child("Position").child("WorldPosition");
      EXPECT_NEAR(number(vertices[i], "time"), 0.05 * static_cast<double>(trace[i].tick), 1e-9);
      EXPECT_NEAR(std::remainder(number(place, "h") - trace[i].heading, 2.0 * M_PI), 0.0, 1e-9);
      EXPECT_LT((boxCenter(vertices[i], center) - trace[i].position).norm(), 1e-9) << id << i;
    }
  }
}

TEST_F(OpenScenarioWriter, TheReferencePointIsTheRearAxle) {
  write({0.0, {}, "ego"});
  // The ego of 4.5 m starts at (5, -2) and drives east: its rear axle is 0.315 * 4.5 m behind.
  const pugi::xml_node place = course("ego").front().child("Position").child("WorldPosition");
  EXPECT_NEAR(number(place, "x"), 5.0 - 1.4175, 1e-9);
  EXPECT_NEAR(number(place, "y"), -2.0, 1e-9);
  const pugi::xml_node body = named("Vehicle", "ego");
  EXPECT_EQ(number(body.child("Axles").child("RearAxle"), "positionX"), 0.0);
  EXPECT_GT(number(body.child("Axles").child("FrontAxle"), "positionX"), 2.0);
  // The front bumper is half a length before the center.
  const pugi::xml_node box = body.child("BoundingBox");
  EXPECT_NEAR(number(place, "x") + number(box.child("Center"), "x") +
                  0.5 * number(box.child("Dimensions"), "length"),
              5.0 + 2.25, 1e-9);
}

TEST_F(OpenScenarioWriter, APartOfTheSessionStartsAtZeroAndEndsWithTheStopTrigger) {
  const pugi::xml_node root = write({1.0, 3.0, "ego"});
  const auto vertices = course("ego");
  ASSERT_EQ(vertices.size(), 41U);  // 2 s at 0.05 s, both ends
  EXPECT_EQ(number(vertices.front(), "time"), 0.0);
  EXPECT_NEAR(number(vertices.back(), "time"), 2.0, 1e-9);
  // At 1 s the ego's center is at x = 5 + 8.
  const pugi::xml_node center = named("Vehicle", "ego").child("BoundingBox").child("Center");
  EXPECT_NEAR(boxCenter(vertices.front(), center).x(), 13.0, 1e-9);
  const pugi::xml_node stop = root.child("Storyboard").child("StopTrigger");
  EXPECT_NEAR(number(stop.child("ConditionGroup")
                         .child("Condition")
                         .child("ByValueCondition")
                         .child("SimulationTimeCondition"),
                     "value"),
              2.0, 1e-9);
}

TEST_F(OpenScenarioWriter, TheChosenVehiclesAreThere) {
  write({0.0, {}, "ego,cbv"});
  EXPECT_TRUE(named("ScenarioObject", "ego"));
  EXPECT_TRUE(named("ScenarioObject", "bg_1"));  // a CBV from tick 53 on
  EXPECT_FALSE(named("ScenarioObject", "bg_2"));
  write({0.0, 0.5, "ego,cbv,near"});
  EXPECT_FALSE(named("ScenarioObject", "bg_1"));  // no CBV yet, and more than 100 m away
}

TEST_F(OpenScenarioWriter, AnExternalEgoHasAControllerAndNoCourse) {
  const pugi::xml_node root = write({0.0, {}, "ego,cbv"}, ExportedEgo::kExternal);
  EXPECT_TRUE(named("ScenarioObject", "ego").child("ObjectController").child("Controller"));
  EXPECT_TRUE(course("ego").empty());
  EXPECT_FALSE(course("bg_1").empty());
  const pugi::xml_node start =
      root.child("Storyboard")
          .child("Init")
          .child("Actions")
          .find_child([](const pugi::xml_node& node) {
            return std::strcmp(node.attribute("entityRef").value(), "ego") == 0;
          });
  EXPECT_NEAR(number(start.find_node([](const pugi::xml_node& node) {
                return std::strcmp(node.name(), "AbsoluteTargetSpeed") == 0;
              }),
                     "value"),
              8.0, 1e-9);
}

TEST_F(OpenScenarioWriter, ASceneWithoutAnyRoadConditionIsNotLeftToTheReader) {
  const pugi::xml_node root = write({0.0, {}, "ego"});
  const pugi::xml_node environment = root.child("Storyboard")
                                         .child("Init")
                                         .child("Actions")
                                         .child("GlobalAction")
                                         .child("EnvironmentAction")
                                         .child("Environment");
  EXPECT_EQ(number(environment.child("RoadCondition"), "frictionScaleFactor"), 1.0);
  EXPECT_EQ(std::string(root.child("RoadNetwork").child("LogicFile").attribute("filepath").value()),
            "crossing.xodr");
}

TEST_F(OpenScenarioWriter, TheSameSceneGivesTheSameBytes) {
  const auto text = [&] {
    return openScenarioText(readScene(session_.folder(), {}), "a.xodr", ExportedEgo::kTrajectory);
  };
  EXPECT_EQ(text(), text());
}

/// A vehicle at (10, 0) that heads north, from tick 10 to 12 of a scene of 20 ticks.
RecordedScene lateScene() {
  RecordedScene scene;
  scene.steps = 20;
  SceneVehicle vehicle{"late", traffic::VehicleRole::kBackground, {6.0, 2.0, 2.0}, {}};
  for (std::uint64_t step = 10; step <= 12; ++step)
    vehicle.states.push_back({step, {{10.0, 0.0}, 3.0, 0.5 * M_PI, 1.0}});
  scene.vehicles = {vehicle};
  return scene;
}

TEST_F(OpenScenarioWriter, AVehicleThatComesLaterIsAddedThenAndDeletedWhenItGoes) {
  ASSERT_TRUE(document_.load_string(
      openScenarioText(lateScene(), "a.xodr", ExportedEgo::kTrajectory).c_str()));
  const pugi::xml_node added = named("Action", "add_late")
                                   .child("GlobalAction")
                                   .child("EntityAction")
                                   .child("AddEntityAction")
                                   .child("Position")
                                   .child("WorldPosition");
  EXPECT_NEAR(number(added, "x"), 10.0, 1e-9);
  EXPECT_NEAR(number(added, "y"), -0.315 * 6.0, 1e-9);
  EXPECT_EQ(number(added, "z"), 3.0);
  const auto time = [&](const char* condition) {
    return number(
        named("Condition", condition).child("ByValueCondition").child("SimulationTimeCondition"),
        "value");
  };
  EXPECT_NEAR(time("begin_late"), 0.5, 1e-9);  // tick 10
  EXPECT_NEAR(time("end_late"), 0.65, 1e-9);   // the tick after its last one
  EXPECT_TRUE(named("Action", "delete_late"));
  EXPECT_FALSE(document_.find_node([](const pugi::xml_node& node) {
    return std::strcmp(node.name(), "TeleportAction") == 0;
  })) << "it is not there at the start";
}

}  // namespace
}  // namespace cdiff::exchange
