// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>

#include "storyboard/reading.h"

namespace cdiff::storyboard {
namespace {

using Measure = EntityCondition::Measure;
using Along = EntityCondition::Along;

Rule readRule(const XoscElement& element) {
  constexpr Rule kRules[] = {Rule::kGreater,     Rule::kGreaterOrEqual, Rule::kLess,
                             Rule::kLessOrEqual, Rule::kEqual,          Rule::kNotEqual};
  return kRules[element.choice("rule", {"greaterThan", "greaterOrEqual", "lessThan", "lessOrEqual",
                                        "equalTo", "notEqualTo"})];
}

void readValue(const XoscElement& element, EntityCondition& condition) {
  Reading::refuseAttributes(element, {"direction"});
  condition.rule = readRule(element);
  condition.value = element.number("value");
}

/// How a distance is measured; `relative` where its type is an attribute of the element.
void readFrame(const XoscElement& element, EntityCondition& condition) {
  condition.freespace = element.flag("freespace", false);
  condition.lane_frame = element.flag("alongRoute", false);
  if (element.has("coordinateSystem")) condition.lane_frame = Reading::isAlongLanes(element);
  if (element.has("relativeDistanceType")) {
    constexpr Along kTypes[] = {Along::kLongitudinal, Along::kLateral, Along::kStraight,
                                Along::kStraight};
    condition.along =
        kTypes[element.choice("relativeDistanceType", {"longitudinal", "lateral",
                                                       "cartesianDistance", "euclidianDistance"})];
  } else if (condition.lane_frame) {
    condition.along = Along::kLongitudinal;
  }
}

void readSpeed(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kSpeed;
  readValue(element, condition);
}

void readRelativeSpeed(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kRelativeSpeed;
  condition.other = element.text("entityRef");
  readValue(element, condition);
}

void readAcceleration(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kAcceleration;
  readValue(element, condition);
}

void readStandStill(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kStandStill;
  condition.rule = Rule::kGreaterOrEqual;
  condition.value = element.number("duration");
}

void readTraveled(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kTraveledDistance;
  condition.rule = Rule::kGreaterOrEqual;
  condition.value = element.number("value");
}

void readEndOfRoad(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kEndOfRoad;
  condition.rule = Rule::kGreaterOrEqual;
  condition.value = element.number("duration");
}

void readOffroad(const XoscElement& element, const Reading& reading, EntityCondition& condition) {
  readEndOfRoad(element, reading, condition);
  condition.measure = Measure::kOffroad;
}

void readReach(const XoscElement& element, const Reading& reading, EntityCondition& condition) {
  condition.measure = Measure::kReachPosition;
  condition.rule = Rule::kLessOrEqual;
  condition.value = element.number("tolerance");
  condition.place = readPosition(element, reading);
}

void readDistance(const XoscElement& element, const Reading& reading, EntityCondition& condition) {
  condition.measure = Measure::kDistance;
  readValue(element, condition);
  readFrame(element, condition);
  condition.place = readPosition(element, reading);
}

void readRelativeDistance(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kDistance;
  readValue(element, condition);
  readFrame(element, condition);
  condition.other = element.text("entityRef");
}

void readHeadway(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kHeadway;
  readValue(element, condition);
  readFrame(element, condition);
  condition.other = element.text("entityRef");
}

void readTimeToCollision(const XoscElement& element, const Reading& reading,
                         EntityCondition& condition) {
  condition.measure = Measure::kTimeToCollision;
  readValue(element, condition);
  readFrame(element, condition);
  const XoscElement target = element.child("TimeToCollisionConditionTarget");
  if (const auto entity = target.find("EntityRef")) {
    condition.other = entity->text("entityRef");
  } else {
    condition.place = readPosition(target, reading);
  }
}

void readCollision(const XoscElement& element, const Reading&, EntityCondition& condition) {
  condition.measure = Measure::kCollision;
  if (const auto entity = element.find("EntityRef")) condition.other = entity->text("entityRef");
  const auto type = element.find("ByType");
  if (!type) return;
  using Kind = Entity::Kind;
  const std::vector<std::vector<Kind>> kinds = {
      {Kind::kPedestrian}, {Kind::kVehicle, Kind::kBicycle}, {Kind::kObject}};
  condition.other_kinds = kinds[type->choice("type", {"pedestrian", "vehicle", "miscellaneous"})];
}

struct ConditionRow {
  const char* element;
  void (*read)(const XoscElement&, const Reading&, EntityCondition&);  ///< nullptr: refused
};

constexpr ConditionRow kConditions[] = {{"SpeedCondition", readSpeed},
                                        {"RelativeSpeedCondition", readRelativeSpeed},
                                        {"AccelerationCondition", readAcceleration},
                                        {"StandStillCondition", readStandStill},
                                        {"TraveledDistanceCondition", readTraveled},
                                        {"ReachPositionCondition", readReach},
                                        {"DistanceCondition", readDistance},
                                        {"RelativeDistanceCondition", readRelativeDistance},
                                        {"TimeHeadwayCondition", readHeadway},
                                        {"TimeToCollisionCondition", readTimeToCollision},
                                        {"CollisionCondition", readCollision},
                                        {"EndOfRoadCondition", readEndOfRoad},
                                        {"OffroadCondition", readOffroad},
                                        {"RelativeClearanceCondition", nullptr},
                                        {"RelativeAngleCondition", nullptr},
                                        {"AngleCondition", nullptr}};

EntityCondition readByEntity(const XoscElement& element, const Reading& reading) {
  EntityCondition condition;
  const XoscElement triggering = element.child("TriggeringEntities");
  condition.all = triggering.choice("triggeringEntitiesRule", {"any", "all"}) == 1;
  for (const XoscElement& entity : triggering.children("EntityRef"))
    condition.entities.push_back(entity.text("entityRef"));
  const XoscElement measured = element.child("EntityCondition").only();
  const auto& row = rowOf(kConditions, measured, "this condition");
  row.read(measured, reading, condition);
  return condition;
}

using ConditionWhat = decltype(Condition::what);

ConditionWhat readTime(const XoscElement& element) {
  return TimeCondition{readRule(element), element.number("value")};
}

ConditionWhat readParameter(const XoscElement& element) {
  const char* key = element.has("parameterRef") ? "parameterRef" : "variableRef";
  return ParameterCondition{element.text(key), readRule(element), element.text("value")};
}

ConditionWhat readElementState(const XoscElement& element) {
  element.choice("storyboardElementType",
                 {"story", "act", "maneuverGroup", "maneuver", "event", "action"});
  element.choice("state", {"startTransition", "endTransition", "stopTransition", "skipTransition",
                           "standbyState", "runningState", "completeState"});
  return ElementStateCondition{element.text("storyboardElementType"),
                               element.text("storyboardElementRef"), element.text("state")};
}

struct ValueRow {
  const char* element;
  ConditionWhat (*read)(const XoscElement&);  ///< nullptr: refused
};

constexpr ValueRow kValueRows[] = {{"SimulationTimeCondition", readTime},
                                   {"ParameterCondition", readParameter},
                                   {"VariableCondition", readParameter},
                                   {"StoryboardElementStateCondition", readElementState},
                                   {"TimeOfDayCondition", nullptr},
                                   {"TrafficSignalCondition", nullptr},
                                   {"TrafficSignalControllerCondition", nullptr},
                                   {"UserDefinedValueCondition", nullptr}};

ConditionWhat readByValue(const XoscElement& element) {
  const XoscElement value = element.only();
  const auto& row = rowOf(kValueRows, value, "this condition");
  return row.read(value);
}

Condition readCondition(const XoscElement& element, Reading& reading) {
  using Edge = Condition::Edge;
  constexpr Edge kEdges[] = {Edge::kNone, Edge::kRising, Edge::kFalling, Edge::kRisingOrFalling};
  Condition condition;
  condition.name = element.plainText("name");
  condition.source = element.source();
  const bool known = element.has("conditionEdge") && !reading.carla;  // scenario_runner has none
  if (known) {
    condition.edge =
        kEdges[element.choice("conditionEdge", {"none", "rising", "falling", "risingOrFalling"})];
  }
  condition.delay = std::max(0.0, element.number("delay", 0.0));
  try {
    if (const auto by_value = element.find("ByValueCondition")) {
      condition.what = readByValue(*by_value);
    } else {
      condition.what = readByEntity(element.child("ByEntityCondition"), reading);
    }
  } catch (const Unsupported& error) {
    reading.ignore(error);
  }
  return condition;
}

}  // namespace

Trigger readTrigger(const XoscElement& element, Reading& reading) {
  Trigger trigger;
  for (const XoscElement& group : element.children("ConditionGroup")) {
    trigger.groups.emplace_back();
    for (const XoscElement& condition : group.children("Condition"))
      trigger.groups.back().push_back(readCondition(condition, reading));
  }
  return trigger;
}

std::vector<ElementSupport> conditionSupport() {
  std::vector<ElementSupport> rows;
  const auto add = [&](const char* element, bool read) {
    rows.push_back({element, read ? Support::kSupported : Support::kRefused});
  };
  for (const ConditionRow& row : kConditions) add(row.element, row.read != nullptr);
  for (const ValueRow& row : kValueRows) add(row.element, row.read != nullptr);
  return rows;
}

}  // namespace cdiff::storyboard
