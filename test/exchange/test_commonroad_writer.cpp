// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// An independent reader (pugixml) compares CommonRoad files with trace.csv and the network.
#include <gtest/gtest.h>

#include <pugixml.hpp>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "exchange/commonroad_writer.h"
#include "exchange/recorded_session.h"
#include "record/result_folder.h"

namespace cdiff::exchange {
namespace {

class CommonRoadWriter : public testing::Test {
 protected:
  pugi::xml_node write(const SceneOptions& options) {
    file_ = commonRoadFile(readScene(session_.folder(), options));
    EXPECT_TRUE(document_.load_string(file_.text.c_str()));
    return document_.child("commonRoad");
  }
  test::RecordedSession session_;
  CommonRoadFile file_;
  pugi::xml_document document_;
};

Eigen::Vector2d placeOf(pugi::xml_node state) {
  const pugi::xml_node point = state.child("position").child("point");
  return {point.child("x").text().as_double(), point.child("y").text().as_double()};
}

double exact(pugi::xml_node state, const char* name) {
  return state.child(name).child("exact").text().as_double();
}

TEST_F(CommonRoadWriter, ObstaclesAreWhereTheTraceHasThem) {
  const pugi::xml_node root = write({0.0, {}, "all"});
  std::vector<record::TraceRow> rows;
  for (const record::TraceRow& row : record::readTrace(session_.folder() / "trace.csv"))
    if (row.id == "bg_1") rows.push_back(row);
  const pugi::xml_node obstacle = root.child("dynamicObstacle");  // the first one beside the ego
  std::vector<pugi::xml_node> states = {obstacle.child("initialState")};
  for (const pugi::xml_node state : obstacle.child("trajectory").children("state"))
    states.push_back(state);
  ASSERT_EQ(states.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_LT((placeOf(states[i]) - rows[i].position).norm(), 2e-6);
    EXPECT_NEAR(exact(states[i], "orientation"), rows[i].heading, 1e-6);
    EXPECT_NEAR(exact(states[i], "velocity"), rows[i].speed, 1e-6);
    EXPECT_EQ(exact(states[i], "time"), static_cast<double>(rows[i].tick));
  }
  EXPECT_EQ(file_.left_out, 0U);
}

TEST_F(CommonRoadWriter, TheEgoIsThePlanningProblem) {
  const pugi::xml_node problem = write({1.0, 3.0, "ego"}).child("planningProblem");
  EXPECT_FALSE(document_.child("commonRoad").child("dynamicObstacle"));
  EXPECT_LT((placeOf(problem.child("initialState")) - Eigen::Vector2d(13.0, -2.0)).norm(), 1e-6);
  const pugi::xml_node goal = problem.child("goalState");
  EXPECT_EQ(goal.child("time").child("intervalEnd").text().as_int(), 40);  // 2 s of 0.05 s
  EXPECT_NEAR(
      goal.child("position").child("rectangle").child("center").child("x").text().as_double(), 29.0,
      1e-6);  // 5 + 8 * 3
}

TEST_F(CommonRoadWriter, LaneletsHaveTheLanesBordersAndLinks) {
  const pugi::xml_node root = write({0.0, {}, "all"});
  std::set<int> ids;
  for (const pugi::xml_node lanelet : root.children("lanelet"))
    ids.insert(lanelet.attribute("id").as_int());
  EXPECT_EQ(ids.size(), 9U);  // six edges and three lanes inside the junction
  // The first lane leads east along y = -2 and is 4 m wide: its left border is at y = 0.
  const pugi::xml_node lanelet = root.child("lanelet");
  const pugi::xml_node left = lanelet.child("leftBound").child("point");
  EXPECT_NEAR(left.child("y").text().as_double(), 0.0, 1e-6);
  const pugi::xml_node right = lanelet.child("rightBound").child("point");
  EXPECT_NEAR(right.child("y").text().as_double(), -4.0, 1e-6);
  for (const char* link : {"predecessor", "successor"}) {
    for (const pugi::xml_node each : root.children("lanelet"))
      for (const pugi::xml_node to : each.children(link))
        EXPECT_EQ(ids.count(to.attribute("ref").as_int()), 1U);
  }
  EXPECT_TRUE(lanelet.child("successor"));
}

TEST_F(CommonRoadWriter, WithoutTheEgoThereIsNoFile) {
  EXPECT_THROW(write({0.0, {}, "cbv"}), core::InputError);
}

}  // namespace
}  // namespace cdiff::exchange
