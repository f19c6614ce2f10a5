// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/file.h"
#include "storyboard/reading.h"
#include "storyboard/scenario_reader.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cdiff::storyboard {
namespace {

constexpr const char* kBox =
    R"(<BoundingBox><Center x="1.5" y="0" z="0.7"/><Dimensions width="2" length="4" height="1.4"/></BoundingBox>)";

class ScenarioReader : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = folder_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file.string();
  }
  /// A scenario whose parts are filled in, each on lines of its own.
  std::string scenario(const std::string& init, const std::string& catalogs = "",
                       const std::string& entities = "", const std::string& story = "") const {
    return write("scenario.xosc",
                 R"(<OpenSCENARIO>
<FileHeader revMajor="1" revMinor="1" description="test"/>
<ParameterDeclarations><ParameterDeclaration name="v" value="4"/></ParameterDeclarations>
<CatalogLocations>)" +
                     catalogs +
                     R"(</CatalogLocations>
<RoadNetwork><LogicFile filepath="road.xodr"/></RoadNetwork>
<Entities>
<ScenarioObject name="Ego"><Vehicle name="a">)" +
                     kBox + "</Vehicle></ScenarioObject>\n" + entities +
                     "</Entities>\n<Storyboard><Init><Actions>\n" + init + "</Actions></Init>\n" +
                     story + "</Storyboard></OpenSCENARIO>");
  }
  static std::string privateAction(const std::string& action) {
    return "<Private entityRef=\"Ego\"><PrivateAction>\n" + action + "</PrivateAction></Private>\n";
  }
  static std::string speed(const std::string& value) {
    return privateAction(
        "<LongitudinalAction><SpeedAction><SpeedActionDynamics dynamicsShape=\"linear\" "
        "dynamicsDimension=\"rate\" value=\"2\"/><SpeedActionTarget><AbsoluteTargetSpeed value=\"" +
        value + "\"/></SpeedActionTarget></SpeedAction></LongitudinalAction>");
  }
  static std::string errorIn(const std::string& file, bool ignore = false) {
    return test::errorOf([&] { readScenario(file, ignore); });
  }
  static void expectText(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  test::TemporaryFolder folder_;
};

TEST_F(ScenarioReader, ReadsEntitiesActionsAndExpressions) {
  const Scenario read = readScenario(scenario(speed("${$v / 2}")), false);
  ASSERT_EQ(read.entities.size(), 1U);
  EXPECT_EQ(read.entities[0].dimensions.length, 4.0);
  EXPECT_EQ(read.entities[0].center.x(), 1.5);
  ASSERT_EQ(read.init.size(), 1U);
  const auto& action = std::get<SpeedAction>(read.init[0].action.what);
  EXPECT_EQ(action.value, 2.0);
  EXPECT_EQ(action.dynamics.shape, Dynamics::Shape::kLinear);
  EXPECT_EQ(action.dynamics.dimension, Dynamics::Dimension::kRate);
  EXPECT_EQ(read.parameters.at("v"), "4");
}

TEST_F(ScenarioReader, InFilesOfCarlaStepsLastAndEdgesDoNotCount) {
  const std::string file = scenario(
      privateAction("<LongitudinalAction><SpeedAction><SpeedActionDynamics dynamicsShape=\"step\" "
                    "dynamicsDimension=\"distance\" value=\"1.5\"/><SpeedActionTarget>"
                    "<AbsoluteTargetSpeed value=\"2\"/></SpeedActionTarget></SpeedAction>"
                    "</LongitudinalAction>"),
      "", "",
      "<StopTrigger><ConditionGroup><Condition name=\"c\" delay=\"0\" conditionEdge=\"rising\">"
      "<ByValueCondition><SimulationTimeCondition value=\"1\" rule=\"greaterThan\"/>"
      "</ByValueCondition></Condition></ConditionGroup></StopTrigger>");
  const auto dynamics = [](const Scenario& read) {
    return std::get<SpeedAction>(read.init.front().action.what).dynamics;
  };
  const auto edge = [](const Scenario& read) { return read.stop->groups.front().front().edge; };
  const Scenario plain = readScenario(file, false);
  EXPECT_EQ(dynamics(plain).value, 0.0);
  EXPECT_EQ(edge(plain), Condition::Edge::kRising);
  std::string text = core::readFile(file, "scenario");
  const std::string description = "description=\"test";
  text.replace(text.find(description), description.size(), "description=\"CARLA:test");
  const Scenario carla = readScenario(write("carla.xosc", text), false);
  EXPECT_EQ(dynamics(carla).value, 1.5);
  EXPECT_EQ(dynamics(carla).dimension, Dynamics::Dimension::kDistance);
  EXPECT_EQ(edge(carla), Condition::Edge::kNone);
  EXPECT_TRUE(carla.ends_with_stories);
  EXPECT_FALSE(plain.ends_with_stories);
}

TEST_F(ScenarioReader, KnowsWhoIsNoMotorVehicle) {
  const std::string others =
      "<ScenarioObject name=\"b\"><Vehicle name=\"b\" vehicleCategory=\"bicycle\">" +
      std::string(kBox) +
      "</Vehicle></ScenarioObject><ScenarioObject name=\"p\"><Pedestrian name=\"p\">" + kBox +
      "</Pedestrian></ScenarioObject><ScenarioObject name=\"o\"><MiscObject name=\"o\">" + kBox +
      "</MiscObject></ScenarioObject>";
  const std::string file = scenario("", "", others);
  const Scenario read = readScenario(file, false);
  EXPECT_EQ(read.find("Ego")->kind, Entity::Kind::kVehicle);
  EXPECT_EQ(read.find("b")->kind, Entity::Kind::kBicycle);
  EXPECT_EQ(read.find("p")->kind, Entity::Kind::kPedestrian);
  EXPECT_EQ(read.find("o")->kind, Entity::Kind::kObject);
  EXPECT_EQ(read.find("p")->dimensions.length, 4.0);
  std::string text = core::readFile(file, "scenario");
  const std::string description = "description=\"test";
  text.replace(text.find(description), description.size(), "description=\"CARLA:test");
  const Scenario carla = readScenario(write("carla.xosc", text), false);
  EXPECT_EQ(carla.find("p")->dimensions.length, 0.5);  // not the car's box that the file gives
  EXPECT_EQ(carla.find("b")->dimensions.width, 0.6);
  EXPECT_EQ(carla.find("Ego")->dimensions.length, 4.0);
}

TEST_F(ScenarioReader, ReadsTheActionsOnSeveralEntities) {
  const auto read = [&](const std::string& inside) {
    return readScenario(scenario(privateAction(inside)), false).init.front().action.what;
  };
  const std::string place = "<WorldPosition x=\"1\" y=\"2\"/>";
  const auto meeting = std::get<SynchronizeAction>(
      read("<SynchronizeAction masterEntityRef=\"Ego\" targetTolerance=\"2\">"
           "<TargetPositionMaster>" +
           place + "</TargetPositionMaster><TargetPosition>" + place +
           "</TargetPosition><FinalSpeed><AbsoluteSpeed value=\"3\"><TargetDistanceSteadyState "
           "distance=\"5\"/></AbsoluteSpeed></FinalSpeed></SynchronizeAction>"));
  EXPECT_EQ(meeting.target.point.y(), 2.0);
  EXPECT_EQ(meeting.tolerance, 2.0);
  EXPECT_EQ(meeting.final_speed->value, 3.0);
  EXPECT_EQ(meeting.steady_distance, 5.0);
  const auto gap = std::get<DistanceAction>(
      read("<LongitudinalAction><LongitudinalDistanceAction entityRef=\"Ego\" distance=\"7\" "
           "coordinateSystem=\"lane\" "
           "displacement=\"leadingReferencedEntity\"><DynamicConstraints maxAcceleration=\"2\" "
           "maxSpeed=\"9\"/></LongitudinalDistanceAction></LongitudinalAction>"));
  EXPECT_EQ(gap.side, Side::kAheadOrLeft);
  EXPECT_TRUE(gap.along_lanes);
  EXPECT_EQ(gap.limits->deceleration, 2.0);  // as of the acceleration where none is given
  EXPECT_EQ(gap.limits->speed, 9.0);
  const auto beside = std::get<LateralDistanceAction>(
      read("<LateralAction><LateralDistanceAction entityRef=\"Ego\" continuous=\"True\" "
           "displacement=\"rightToReferencedEntity\"/></LateralAction>"));
  EXPECT_EQ(beside.side, Side::kBehindOrRight);
  EXPECT_TRUE(beside.continuous);
  EXPECT_FALSE(beside.value);
  const auto profile = std::get<SpeedProfileAction>(
      read("<LongitudinalAction><SpeedProfileAction><SpeedProfileEntry speed=\"3\" time=\"2\"/>"
           "<SpeedProfileEntry speed=\"1\"/></SpeedProfileAction></LongitudinalAction>"));
  ASSERT_EQ(profile.parts.size(), 2U);
  EXPECT_EQ(profile.parts[0].dynamics.dimension, Dynamics::Dimension::kTime);
  EXPECT_EQ(profile.parts[1].dynamics.dimension, Dynamics::Dimension::kRate);
}

TEST_F(ScenarioReader, AnUnknownMasterIsRefused) {
  const std::string place = "<WorldPosition x=\"1\" y=\"2\"/>";
  expectText(errorIn(scenario(privateAction(
                 "<SynchronizeAction masterEntityRef=\"nobody\"><TargetPositionMaster>" + place +
                 "</TargetPositionMaster><TargetPosition>" + place +
                 "</TargetPosition></SynchronizeAction>"))),
             "there is no entity 'nobody'");
}

TEST_F(ScenarioReader, ReadsAPlaceOnARoute) {
  const std::string waypoint =
      "<Waypoint routeStrategy=\"shortest\"><Position><WorldPosition x=\"1\" y=\"2\"/></Position>"
      "</Waypoint>";
  const auto teleport = [&](const std::string& waypoints) {
    return privateAction(
        "<TeleportAction><Position><RoutePosition><RouteRef><Route name=\"r\" closed=\"false\">" +
        waypoints +
        "</Route></RouteRef><InRoutePosition><FromLaneCoordinates pathS=\"20\" laneId=\"1\"/>"
        "</InRoutePosition></RoutePosition></Position></TeleportAction>");
  };
  const Scenario read = readScenario(scenario(teleport(waypoint + waypoint)), false);
  const Position& place = std::get<TeleportAction>(read.init.front().action.what).to;
  EXPECT_EQ(place.kind, Position::Kind::kRoute);
  EXPECT_EQ(place.route.size(), 2U);
  EXPECT_EQ(place.s, 20.0);
  EXPECT_EQ(place.lane, 1);
  expectText(errorIn(scenario(teleport(waypoint))), "expected a route of at least two <Waypoint>");
}

TEST_F(ScenarioReader, AConditionMayHaveNoEdgeAndAnyName) {
  const Scenario read = readScenario(
      scenario("", "", "",
               "<StopTrigger><ConditionGroup><Condition name=\"${late + $v}\" delay=\"0\">"
               "<ByValueCondition><SimulationTimeCondition value=\"1\" rule=\"greaterThan\"/>"
               "</ByValueCondition></Condition></ConditionGroup></StopTrigger>"),
      false);
  const Condition& condition = read.stop->groups.front().front();
  EXPECT_EQ(condition.name, "${late + $v}");
  EXPECT_EQ(condition.edge, Condition::Edge::kNone);
}

TEST_F(ScenarioReader, ReadsCurvesOfTrajectories) {
  const std::string place = "<Position><WorldPosition x=\"1\" y=\"2\"/></Position>";
  const auto course = [&](const std::string& shape) {
    return scenario(privateAction(
        "<RoutingAction><FollowTrajectoryAction><Trajectory name=\"t\" closed=\"false\"><Shape>" +
        shape +
        "</Shape></Trajectory><TimeReference><None/></TimeReference></FollowTrajectoryAction>"
        "</RoutingAction>"));
  };
  const auto read = [&](const std::string& shape) {
    return std::get<FollowTrajectoryAction>(
        readScenario(course(shape), false).init.front().action.what);
  };
  const auto clothoid = read("<Clothoid curvature=\"0.1\" curvatureDot=\"0.2\" length=\"30\">" +
                             place + "</Clothoid>");
  EXPECT_EQ(clothoid.clothoid->change, 0.2);
  EXPECT_EQ(clothoid.clothoid->length, 30.0);
  const std::string points = "<ControlPoint weight=\"2\">" + place +
                             "</ControlPoint><ControlPoint>" + place + "</ControlPoint>";
  const auto knots = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += "<Knot value=\"" + std::to_string(i) + "\"/>";
    return text;
  };
  const auto spline = read("<Nurbs order=\"2\">" + points + knots(4) + "</Nurbs>");
  EXPECT_EQ(spline.spline->weights, (std::vector<double>{2.0, 1.0}));
  EXPECT_EQ(spline.spline->knots.size(), 4U);
  expectText(errorIn(course("<Nurbs order=\"2\">" + points + knots(3) + "</Nurbs>")),
             "expected 4 knots");
  expectText(errorIn(course("<Nurbs order=\"3\">" + points + knots(5) + "</Nurbs>")),
             "'order' is not between 2 and the number of control points");
}

TEST_F(ScenarioReader, RefusesCurvesThatNobodyCanDrive) {
  const std::string place = "<Position><WorldPosition x=\"1\" y=\"2\"/></Position>";
  const auto errorOf = [&](const std::string& shape) {
    return errorIn(scenario(privateAction(
        "<RoutingAction><FollowTrajectoryAction><Trajectory name=\"t\" closed=\"false\"><Shape>" +
        shape +
        "</Shape></Trajectory><TimeReference><None/></TimeReference></FollowTrajectoryAction>"
        "</RoutingAction>")));
  };
  const auto clothoid = [&](const std::string& change, const std::string& length) {
    return errorOf("<Clothoid curvature=\"0\" curvatureDot=\"" + change + "\" length=\"" + length +
                   "\">" + place + "</Clothoid>");
  };
  expectText(clothoid("0", "1e9"), ":11: <Clothoid>: 'length' is not above 0 and up to 50000 m");
  expectText(clothoid("1e300", "10"), ":11: <Clothoid>: the curvature at an end");
  std::string knots;
  for (int i = 0; i < 4; ++i) knots += "<Knot value=\"0\"/>";
  const std::string point = "<ControlPoint>" + place + "</ControlPoint>";
  expectText(errorOf("<Nurbs order=\"2\">" + point + point + knots + "</Nurbs>"),
             ":11: <Nurbs>: the knots do not rise");
}

TEST_F(ScenarioReader, ATimeBelowZeroIsRefusedAndTheSignOfARateDoesNotCount) {
  const auto file = [&](const std::string& dimension) {
    return scenario(privateAction(
        "<LongitudinalAction><SpeedAction><SpeedActionDynamics dynamicsShape=\"linear\" "
        "dynamicsDimension=\"" +
        dimension +
        "\" value=\"-3\"/><SpeedActionTarget><AbsoluteTargetSpeed value=\"2\"/>"
        "</SpeedActionTarget></SpeedAction></LongitudinalAction>"));
  };
  expectText(errorIn(file("time")), ":11: <SpeedActionDynamics>: 'value' is below 0");
  expectText(errorIn(file("distance")), ":11: <SpeedActionDynamics>: 'value' is below 0");
  const Scenario read = readScenario(file("rate"), false);
  EXPECT_EQ(std::get<SpeedAction>(read.init.front().action.what).dynamics.value, 3.0);
}

TEST_F(ScenarioReader, AManeuverWithoutEventsIsRefused) {
  const std::string file =
      scenario("", "", "",
               "<Story name=\"s\"><Act name=\"a\"><ManeuverGroup name=\"g\"><Actors/>\n"
               "<Maneuver name=\"m\"/></ManeuverGroup></Act></Story>");
  expectText(errorIn(file), ":12: <Maneuver>: expected at least one <Event>");
}

TEST_F(ScenarioReader, EntriesOfCatalogsTakeParameters) {
  write("catalogs/cars.xosc", std::string(R"(<OpenSCENARIO><Catalog name="cars">
<Vehicle name="long"><ParameterDeclarations><ParameterDeclaration name="l" value="5"/></ParameterDeclarations>
<BoundingBox><Center x="1" y="0" z="0"/><Dimensions width="2" length="$l" height="1"/></BoundingBox></Vehicle>
</Catalog></OpenSCENARIO>)"));
  const std::string entity =
      R"(<ScenarioObject name="truck"><CatalogReference catalogName="cars" entryName="long">
<ParameterAssignments><ParameterAssignment parameterRef="l" value="9"/></ParameterAssignments>
</CatalogReference></ScenarioObject>)";
  const std::string place = R"(<VehicleCatalog><Directory path="catalogs"/></VehicleCatalog>)";
  const Scenario read = readScenario(scenario("", place, entity), false);
  EXPECT_EQ(read.find("truck")->dimensions.length, 9.0);
}

TEST_F(ScenarioReader, CatalogsInACircleAreRefused) {
  write("catalogs/cars.xosc", R"(<OpenSCENARIO><Catalog name="cars">
<CatalogReference name="a" catalogName="cars" entryName="b"/>
<CatalogReference name="b" catalogName="cars" entryName="a"/></Catalog></OpenSCENARIO>)");
  const std::string entity =
      R"(<ScenarioObject name="car"><CatalogReference catalogName="cars" entryName="a"/></ScenarioObject>)";
  const std::string place = R"(<VehicleCatalog><Directory path="catalogs"/></VehicleCatalog>)";
  expectText(errorIn(scenario("", place, entity)), "in a circle");
}

// Routes whose eight waypoints are each the next route: 8^7 positions in a few kilobytes.
TEST_F(ScenarioReader, CatalogsThatMultiplyAreRefused) {
  std::string routes = R"(<OpenSCENARIO><Catalog name="routes">)";
  for (int i = 0; i < 7; ++i) {
    routes += "<Route name=\"r" + std::to_string(i) + "\" closed=\"false\">";
    for (int k = 0; k < 8; ++k) {
      routes += R"(<Waypoint routeStrategy="shortest"><Position><RoutePosition><RouteRef>)"
                R"(<CatalogReference catalogName="routes" entryName="r)" +
                std::to_string(i + 1) +
                R"("/></RouteRef><InRoutePosition><FromRoadCoordinates pathS="0" t="0"/>)"
                R"(</InRoutePosition></RoutePosition></Position></Waypoint>)";
    }
    routes += "</Route>";
  }
  routes += R"(<Route name="r7" closed="false">)";
  for (int k = 0; k < 2; ++k)
    routes += R"(<Waypoint routeStrategy="shortest"><Position><WorldPosition x="0" y="0"/>)"
              R"(</Position></Waypoint>)";
  write("catalogs/routes.xosc", routes + "</Route></Catalog></OpenSCENARIO>");
  const std::string place = R"(<RouteCatalog><Directory path="catalogs"/></RouteCatalog>)";
  const std::string assign = privateAction(
      R"(<RoutingAction><AssignRouteAction><CatalogReference catalogName="routes" entryName="r0"/>)"
      R"(</AssignRouteAction></RoutingAction>)");
  expectText(errorIn(scenario(assign, place)), "refer to each other more than");
}

TEST_F(ScenarioReader, ManyParametersAreReadInTheOrderOfTheirDeclaration) {
  std::string text = core::readFile(scenario(speed("$p9999")), "scenario");
  std::string declarations;
  for (int i = 0; i < 10000; ++i)
    declarations += "<ParameterDeclaration name=\"p" + std::to_string(i) + "\" value=\"" +
                    (i == 0 ? std::string("3") : "$p" + std::to_string(i - 1)) + "\"/>";
  text.insert(text.find("</ParameterDeclarations>"), declarations);
  const Scenario read = readScenario(write("many.xosc", text), false);
  EXPECT_EQ(std::get<SpeedAction>(read.init[0].action.what).value, 3.0);
}

TEST_F(ScenarioReader, DocumentTypesAreRefusedWithTheirLine) {
  const std::string file = write("bomb.xosc",
                                 "<?xml version=\"1.0\"?>\n<!DOCTYPE a [<!ENTITY b "
                                 "\"cc\">]>\n<OpenSCENARIO>&b;</OpenSCENARIO>");
  expectText(errorIn(file), file + ":2: <!DOCTYPE> is refused");
}

TEST_F(ScenarioReader, BrokenFilesNameTheirLine) {
  const std::string file = write("broken.xosc", "<OpenSCENARIO>\n<FileHeader\n");
  expectText(errorIn(file), file + ":2: not XML");
}

TEST_F(ScenarioReader, ADivisionByZeroNamesFileAndLine) {
  const std::string file = scenario(speed("${1 / ($v - 4)}"));
  expectText(errorIn(file), file + ":11: <AbsoluteTargetSpeed>");
  expectText(errorIn(file), "divides by zero");
}

TEST_F(ScenarioReader, AnEntityWithoutAModelIsRefused) {
  const std::string file = scenario("", "", "<ScenarioObject name=\"ghost\"/>");
  expectText(errorIn(file), ":8: <ScenarioObject>: the entity 'ghost' has no model");
}

TEST_F(ScenarioReader, UnknownEntitiesAreNamedBeforeAnythingRuns) {
  const std::string file = scenario(privateAction(
      "<TeleportAction><Position><RelativeLanePosition entityRef=\"nobody\" dLane=\"0\" ds=\"5\"/>"
      "</Position></TeleportAction>"));
  expectText(errorIn(file), "there is no entity 'nobody'; expected one of {Ego}");
}

TEST_F(ScenarioReader, WhatIsNotSupportedIsRefusedOrListed) {
  const std::string curve =
      "<RoutingAction><FollowTrajectoryAction><Trajectory name=\"t\" closed=\"false\"><Shape>\n"
      "<ClothoidSpline/></Shape></Trajectory></FollowTrajectoryAction></RoutingAction>";
  const std::string file = scenario(privateAction(curve));
  expectText(errorIn(file),
             file + ":12: <ClothoidSpline>: a trajectory of this shape is not supported");
  const Scenario read = readScenario(file, true);
  ASSERT_EQ(read.ignored.size(), 1U);
  expectText(read.ignored[0], ":12: <ClothoidSpline>");
  EXPECT_TRUE(std::holds_alternative<NoAction>(read.init[0].action.what));
}

TEST_F(ScenarioReader, DeepNestingIsRefusedWithItsLine) {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<PrivateAction>";
  for (int i = 0; i < 100000; ++i) deep += "</PrivateAction>";
  expectText(errorIn(scenario(privateAction(deep))),
             ":11: <PrivateAction>: elements are nested too deeply");
}

TEST_F(ScenarioReader, ASecondActionInOneElementIsRefused) {
  const std::string file = scenario(privateAction("<LateralAction/>\n<RoutingAction/>"));
  expectText(errorIn(file), file + ":12: <RoutingAction>: one element was expected");
}

TEST_F(ScenarioReader, UnknownWordsOfConditionsAreRefused) {
  const auto errorOf = [&](const std::string& condition) {
    return errorIn(scenario("", "", "",
                            "<StopTrigger><ConditionGroup><Condition conditionEdge=\"none\">" +
                                condition + "</Condition></ConditionGroup></StopTrigger>"));
  };
  const auto byEntity = [&](const std::string& condition) {
    return errorOf(
        "<ByEntityCondition><TriggeringEntities triggeringEntitiesRule=\"any\"><EntityRef "
        "entityRef=\"Ego\"/></TriggeringEntities><EntityCondition>" +
        condition + "</EntityCondition></ByEntityCondition>");
  };
  const std::string distance =
      "<RelativeDistanceCondition entityRef=\"Ego\" value=\"1\" rule=\"lessThan\" ";
  expectText(errorOf("<ByValueCondition><StoryboardElementStateCondition state=\"started\" "
                     "storyboardElementType=\"act\" storyboardElementRef=\"a\"/>"
                     "</ByValueCondition>"),
             "'state' is 'started'; expected one of");
  expectText(byEntity(distance + "relativeDistanceType=\"long\"/>"), "'relativeDistanceType'");
  expectText(byEntity(distance + "coordinateSystem=\"lanes\"/>"), "'coordinateSystem'");
  expectText(byEntity("<SpeedCondition value=\"1\" rule=\"lessThan\" direction=\"lateral\"/>"),
             ":11: <SpeedCondition>: the attribute 'direction' is not supported");
}

TEST_F(ScenarioReader, NobodyInAVertexIsNamedBeforeAnythingRuns) {
  const std::string vertex =
      "<Vertex time=\"0\"><Position><RelativeObjectPosition entityRef=\"nobody\" dx=\"1\" "
      "dy=\"0\"/></Position></Vertex>";
  const std::string file = scenario(privateAction(
      "<RoutingAction><FollowTrajectoryAction><Trajectory name=\"t\" closed=\"false\"><Shape>"
      "<Polyline>" +
      vertex + vertex +
      "</Polyline></Shape></Trajectory></FollowTrajectoryAction></RoutingAction>"));
  expectText(errorIn(file), "there is no entity 'nobody'");
}

TEST_F(ScenarioReader, ParametersOfActionsMustBeDeclaredAndModifiedByNumbers) {
  const auto error = [&](const std::string& action) {
    return errorIn(scenario("<GlobalAction>" + action + "</GlobalAction>"));
  };
  const std::string value = "\"><SetAction value=\"1\"/></ParameterAction>";
  EXPECT_EQ(error("<ParameterAction parameterRef=\"v" + value), "no error");
  expectText(error("<ParameterAction parameterRef=\"w" + value),
             ":10: 'w' is declared neither among the parameters nor among the variables");
  expectText(error("<ParameterAction parameterRef=\"v\"><ModifyAction><Rule><AddValue "
                   "value=\"some\"/></Rule></ModifyAction></ParameterAction>"),
             ":10: <AddValue>");
}

TEST_F(ScenarioReader, OnlyLimitsMayBeInfinite) {
  const auto place = [&](const std::string& x) {
    return errorIn(scenario(privateAction("<TeleportAction><Position><WorldPosition x=\"" + x +
                                          "\" y=\"0\"/></Position></TeleportAction>")));
  };
  EXPECT_EQ(place("7"), "no error");
  for (const char* x : {"INF", "inf", "${1e308 * 10}"}) expectText(place(x), "<WorldPosition>");
  EXPECT_EQ(errorIn(scenario(privateAction(
                "<LongitudinalAction><LongitudinalDistanceAction entityRef=\"Ego\" distance=\"7\">"
                "<DynamicConstraints maxAcceleration=\"INF\" maxDeceleration=\"inf\" "
                "maxSpeed=\"INF\"/></LongitudinalDistanceAction></LongitudinalAction>"))),
            "no error");
}

TEST_F(ScenarioReader, DistancesAlongTrajectoriesAreRefused) {
  for (const std::string kind : {"Longitudinal", "Lateral"}) {
    expectText(errorIn(scenario(privateAction(
                   "<" + kind + "Action><" + kind + "DistanceAction entityRef=\"Ego\" " +
                   "distance=\"7\" coordinateSystem=\"trajectory\"/></" + kind + "Action>"))),
               "a distance along a trajectory");
  }
}

TEST_F(ScenarioReader, CarlasCoordinatesAreMirrored) {
  const std::string file = scenario(privateAction(
      "<TeleportAction><Position><WorldPosition x=\"1\" y=\"2\" h=\"0.5\"/></Position>"
      "</TeleportAction>"));
  std::string text = core::readFile(file, "scenario");
  text.replace(text.find("description=\"test\""), 18, "description=\"CARLA:test\"");
  const Scenario read = readScenario(write("carla.xosc", text), false);
  const Position& to = std::get<TeleportAction>(read.init[0].action.what).to;
  EXPECT_EQ(to.point.y(), -2.0);
  EXPECT_EQ(to.heading, -0.5);
}

// scenario_runner hands the value to a behavior that counts it to the right.
TEST_F(ScenarioReader, InFilesOfCarlaALaneOffsetIsToTheRight) {
  const std::string file = scenario(privateAction(
      "<LateralAction><LaneOffsetAction continuous=\"true\"><LaneOffsetActionDynamics "
      "maxLateralAcc=\"1\" dynamicsShape=\"linear\"/><LaneOffsetTarget><AbsoluteTargetLaneOffset "
      "value=\"0.5\"/></LaneOffsetTarget></LaneOffsetAction></LateralAction>"));
  std::string text = core::readFile(file, "scenario");
  EXPECT_EQ(std::get<LaneOffsetAction>(readScenario(file, false).init[0].action.what).value, 0.5);
  text.replace(text.find("description=\"test\""), 18, "description=\"CARLA:test\"");
  const Scenario read = readScenario(write("carla.xosc", text), false);
  const auto& offset = std::get<LaneOffsetAction>(read.init[0].action.what);
  EXPECT_EQ(offset.value, -0.5);
  EXPECT_TRUE(offset.continuous);
}

TEST_F(ScenarioReader, TheTableNamesEachElementOnce) {
  std::set<std::string> seen;
  for (const auto& rows : {actionSupport(), conditionSupport(), positionSupport()})
    for (const ElementSupport& row : rows) EXPECT_TRUE(seen.insert(row.element).second);
  EXPECT_NE(supportTable().find("| `TeleportAction` | yes |"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::storyboard
