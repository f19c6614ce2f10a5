// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/scenario_reader.h"

#include <strings.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>

#include "core/text.h"
#include "storyboard/reading.h"

namespace cdiff::storyboard {
namespace {

namespace fs = std::filesystem;

void requireVersion(const XoscElement& header) {
  const int major = header.integer("revMajor");
  const int minor = header.integer("revMinor");
  if (major == 1 && minor >= 0 && minor <= 3) return;
  header.fail("the version is " + std::to_string(major) + "." + std::to_string(minor) +
              "; expected 1.0 to 1.3");
}

/// Box and center; the center's y and z do not matter here.
void readBox(const XoscElement& body, Entity& entity) {
  const XoscElement box = body.child("BoundingBox");
  const XoscElement center = box.child("Center");
  const XoscElement size = box.child("Dimensions");
  entity.dimensions = {size.number("length"), size.number("width"), size.number("height")};
  entity.center = {center.number("x"), center.number("y")};
  const traffic::VehicleDimensions& found = entity.dimensions;
  const double least = std::min({found.length, found.width, found.height});
  const double most = std::max({found.length, found.width, found.height});
  if (least <= 0.0 || most > 100.0) size.fail("expected lengths above 0 and up to 100 m");
}

Entity::Kind readKind(const XoscElement& body) {
  if (body.name() == "Pedestrian") return Entity::Kind::kPedestrian;
  if (body.name() == "MiscObject") return Entity::Kind::kObject;
  if (body.name() != "Vehicle") Reading::refuse(body, "this kind of entity");
  const bool bicycle = body.text("vehicleCategory", "car") == "bicycle";
  return bicycle ? Entity::Kind::kBicycle : Entity::Kind::kVehicle;
}

/// CARLA goes by the model and not by the box of the file, which often is that of a car.
void takeUsualSize(Entity& entity) {
  if (entity.kind != Entity::Kind::kBicycle && entity.kind != Entity::Kind::kPedestrian) return;
  const bool bicycle = entity.kind == Entity::Kind::kBicycle;
  entity.dimensions = bicycle ? traffic::VehicleDimensions{1.7, 0.6, 1.7}
                              : traffic::VehicleDimensions{0.5, 0.6, 1.8};
  entity.center = Eigen::Vector2d::Zero();
}

std::string controllerOf(const XoscElement& object, const Reading& reading) {
  const auto holder = object.find("ObjectController");
  if (!holder || holder->children().empty()) return {};
  return readControllerName(holder->only(), reading);
}

Entity readEntity(const XoscElement& object, Reading& reading) {
  Entity entity;
  entity.name = object.text("name");
  entity.source = object.source();
  for (const XoscElement& child : object.children()) {
    if (child.name() == "ObjectController") continue;
    const XoscElement body = reading.catalogs.resolve(child);
    entity.kind = readKind(body);
    readBox(body, entity);
    if (reading.carla) takeUsualSize(entity);
    entity.controller = controllerOf(object, reading);
    return entity;
  }
  object.fail("the entity '" + entity.name +
              "' has no model; expected a <Vehicle>, <Pedestrian>, <MiscObject> or "
              "<CatalogReference>");
}

void readEntities(const XoscElement& root, Reading& reading, Scenario& scenario) {
  const XoscElement entities = root.child("Entities");
  for (const XoscElement& object : entities.children()) {
    try {
      if (object.name() != "ScenarioObject") Reading::refuse(object, "a group of entities");
      const std::string name = object.text("name");
      if (scenario.find(name) != nullptr)
        object.fail("the name '" + name + "' is that of another entity");
      scenario.entities.push_back(readEntity(object, reading));
    } catch (const Unsupported& error) {
      reading.ignore(error);
    }
  }
  if (scenario.entities.empty()) entities.fail("expected at least one <ScenarioObject>");
}

std::optional<Trigger> readTriggerOf(const XoscElement& element, const char* name,
                                     Reading& reading) {
  const auto trigger = element.find(name);
  if (!trigger) return std::nullopt;
  return readTrigger(*trigger, reading);
}

int readExecutions(const XoscElement& element) {
  const int most = element.integer("maximumExecutionCount", 1);
  if (most < 1) element.fail("'maximumExecutionCount' is below 1");
  return most;
}

Event readEvent(const XoscElement& element, Reading& reading) {
  using Priority = Event::Priority;
  constexpr Priority kPriorities[] = {Priority::kOverride, Priority::kOverride, Priority::kSkip,
                                      Priority::kParallel};
  Event event;
  event.name = element.text("name");
  event.priority =
      kPriorities[element.choice("priority", {"overwrite", "override", "skip", "parallel"})];
  event.executions = readExecutions(element);
  for (const XoscElement& action : element.children("Action"))
    event.actions.push_back(readAction(action, reading));
  event.start = readTriggerOf(element, "StartTrigger", reading);
  return event;
}

ManeuverGroup readGroup(const XoscElement& element, Reading& reading) {
  ManeuverGroup group;
  group.name = element.text("name");
  group.executions = readExecutions(element);
  const XoscElement actors = element.child("Actors");
  if (actors.flag("selectTriggeringEntities", false))
    Reading::refuse(actors, "the choice of triggering entities as actors");
  for (const XoscElement& actor : actors.children("EntityRef"))
    group.actors.push_back(actor.text("entityRef"));
  for (const XoscElement& child : element.children()) {
    if (child.name() != "Maneuver" && child.name() != "CatalogReference") continue;
    const XoscElement maneuver =
        child.name() == "Maneuver" ? child.declaring() : reading.catalogs.entry(child);
    group.maneuvers.push_back({maneuver.text("name"), {}});
    for (const XoscElement& event : maneuver.children("Event"))
      group.maneuvers.back().events.push_back(readEvent(event, reading));
    if (group.maneuvers.back().events.empty()) maneuver.fail("expected at least one <Event>");
  }
  return group;
}

Story readStory(const XoscElement& plain, Reading& reading) {
  const XoscElement element = plain.declaring();
  Story story{element.text("name", ""), {}};
  for (const XoscElement& child : element.children("Act")) {
    Act act{child.text("name"),
            {},
            readTriggerOf(child, "StartTrigger", reading),
            readTriggerOf(child, "StopTrigger", reading)};
    for (const XoscElement& group : child.children("ManeuverGroup")) {
      try {
        act.groups.push_back(readGroup(group, reading));
      } catch (const Unsupported& error) {
        reading.ignore(error);
      }
    }
    story.acts.push_back(std::move(act));
  }
  return story;
}

void addInit(const XoscElement& action, const std::string& entity, Reading& reading,
             Scenario& scenario) {
  const InitAction init{entity, readAction(action, reading)};
  const auto* const controller = std::get_if<ControllerAction>(&init.action.what);
  for (Entity& known : scenario.entities)
    if (controller != nullptr && known.name == entity) known.controller = controller->controller;
  scenario.init.push_back(init);
}

void readInit(const XoscElement& actions, Reading& reading, Scenario& scenario) {
  for (const XoscElement& element : actions.children()) {
    if (element.name() != "Private") {
      addInit(element, "", reading, scenario);
      continue;
    }
    const std::string entity = element.text("entityRef");
    if (scenario.find(entity) == nullptr) element.fail("there is no entity '" + entity + "'");
    for (const XoscElement& action : element.children("PrivateAction")) {
      const auto controller = action.only().name() == "ControllerAction"
                                  ? action.find("ControllerAction")
                                  : std::nullopt;
      // Version 1.0 puts an assignment and an override into one element.
      const auto parts = controller ? controller->children() : std::vector<XoscElement>{action};
      for (const XoscElement& part : parts) addInit(part, entity, reading, scenario);
    }
  }
}

/// Every entity and parameter that is spoken of must be there, so that no session fails over a
/// name.
class NameCheck {
 public:
  explicit NameCheck(const Scenario& scenario) : scenario_(scenario) {}

  void check() const {
    for (const InitAction& init : scenario_.init) checkAction(init.action);
    if (scenario_.stop) checkTrigger(*scenario_.stop);
    for (const Story& story : scenario_.stories)
      for (const Act& act : story.acts) checkAct(act);
  }

 private:
  void require(const std::string& entity, const Source& source) const {
    if (entity.empty() || scenario_.find(entity) != nullptr) return;
    std::vector<std::string> known;
    for (const Entity& one : scenario_.entities) known.push_back(one.name);
    throw core::InputError(source.text() + ": there is no entity '" + entity +
                           "'; expected one of {" + core::joinText(known, ", ") + "}");
  }
  void requireParameter(const std::string& name, const Source& source) const {
    if (scenario_.parameters.count(name) != 0) return;
    throw core::InputError(source.text() + ": '" + name +
                           "' is declared neither among the parameters nor among the variables of "
                           "the whole file");
  }
  void checkPlace(const Position& position) const {
    require(position.entity, position.source);
    for (const Position& waypoint : position.route) checkPlace(waypoint);
  }
  void checkAct(const Act& act) const {
    if (act.start) checkTrigger(*act.start);
    if (act.stop) checkTrigger(*act.stop);
    for (const ManeuverGroup& group : act.groups) {
      for (const Maneuver& maneuver : group.maneuvers) {
        for (const Event& event : maneuver.events) {
          if (event.start) checkTrigger(*event.start);
          for (const Action& action : event.actions) {
            checkAction(action);
            for (const std::string& actor : group.actors) require(actor, action.source);
          }
        }
      }
    }
  }
  void checkAction(const Action& action) const {
    const auto& what = action.what;
    if (const auto* speed = std::get_if<SpeedAction>(&what)) require(speed->entity, action.source);
    if (const auto* lane = std::get_if<LaneChangeAction>(&what))
      require(lane->entity, action.source);
    if (const auto* gap = std::get_if<DistanceAction>(&what)) require(gap->entity, action.source);
    if (const auto* gap = std::get_if<LateralDistanceAction>(&what))
      require(gap->entity, action.source);
    if (const auto* meeting = std::get_if<SynchronizeAction>(&what)) {
      require(meeting->master, action.source);
      for (const Position* place : {&meeting->master_target, &meeting->target}) checkPlace(*place);
    }
    if (const auto* parameter = std::get_if<ParameterAction>(&what))
      requireParameter(parameter->name, action.source);
    if (const auto* entity = std::get_if<EntityAction>(&what)) {
      require(entity->entity, action.source);
      if (entity->place) checkPlace(*entity->place);
    }
    if (const auto* course = std::get_if<FollowTrajectoryAction>(&what))
      for (const TrajectoryVertex& vertex : course->vertices) checkPlace(vertex.position);
    if (const auto* teleport = std::get_if<TeleportAction>(&what)) checkPlace(teleport->to);
    if (const auto* route = std::get_if<RouteAction>(&what))
      for (const Position& waypoint : route->waypoints) checkPlace(waypoint);
  }
  /// One of scenario_runner's in the stop trigger, whose parameter is nobody's.
  static bool isCriterion(const std::string& name) {
    constexpr std::string_view kBegin = "criteria_";
    return ::strncasecmp(name.c_str(), kBegin.data(), kBegin.size()) == 0;
  }
  void checkTrigger(const Trigger& trigger) const {
    for (const auto& group : trigger.groups) {
      for (const Condition& condition : group) {
        const auto* const parameter = std::get_if<ParameterCondition>(&condition.what);
        if (parameter != nullptr && !isCriterion(condition.name) && !isCriterion(parameter->name))
          requireParameter(parameter->name, condition.source);
        const auto* const measured = std::get_if<EntityCondition>(&condition.what);
        if (measured == nullptr) continue;
        require(measured->other, condition.source);
        for (const std::string& entity : measured->entities) require(entity, condition.source);
        if (measured->place) checkPlace(*measured->place);
      }
    }
  }

  const Scenario& scenario_;
};

/// A name without a file stays as it is, because a user may give another network.
void readNetwork(const XoscElement& root, Scenario& scenario) {
  const XoscElement logic = root.child("RoadNetwork").child("LogicFile");
  const fs::path named = logic.text("filepath");
  const fs::path file =
      named.is_absolute() ? named : fs::path(logic.source().file).parent_path() / named;
  scenario.network = fs::exists(file) ? file.lexically_normal().string() : named.string();
  scenario.network_source = logic.source();
}

}  // namespace

Scenario readScenario(const std::string& file, bool ignore_unsupported) {
  const XoscElement root = XoscElement::load(file).declaring();
  requireVersion(root.child("FileHeader"));
  Reading reading;
  reading.ignore_unsupported = ignore_unsupported;
  reading.carla = root.child("FileHeader").text("description", "").rfind("CARLA:", 0) == 0;
  if (const auto locations = root.find("CatalogLocations")) reading.catalogs = Catalogs(*locations);
  Scenario scenario;
  scenario.files = {file};
  const std::vector<std::string>& catalogs = reading.catalogs.files();
  scenario.files.insert(scenario.files.end(), catalogs.begin(), catalogs.end());
  scenario.name = fs::path(file).stem().string();
  scenario.parameters = root.parameters();
  if (const auto variables = root.find("VariableDeclarations"))
    for (const XoscElement& variable : variables->children("VariableDeclaration"))
      scenario.parameters[variable.text("name")] = variable.text("value");
  readNetwork(root, scenario);
  readEntities(root, reading, scenario);
  const XoscElement board = root.child("Storyboard");
  readInit(board.child("Init").child("Actions"), reading, scenario);
  for (const XoscElement& story : board.children("Story"))
    scenario.stories.push_back(readStory(story, reading));
  scenario.stop = readTriggerOf(board, "StopTrigger", reading);
  // In files of scenario_runner the stop trigger only holds criteria.
  scenario.ends_with_stories = reading.carla;
  scenario.ignored = std::move(reading.ignored);
  NameCheck(scenario).check();
  return scenario;
}

std::string supportTable() {
  std::string table = "| Element | Support |\n|---|---|\n";
  for (const auto& rows : {actionSupport(), conditionSupport(), positionSupport()}) {
    for (const ElementSupport& row : rows) {
      const char* text = row.support == Support::kSupported       ? "yes"
                         : row.support == Support::kWithoutEffect ? "read, without effect"
                                                                  : "refused";
      table += "| `" + row.element + "` | " + text + " |\n";
    }
  }
  return table;
}

}  // namespace cdiff::storyboard
