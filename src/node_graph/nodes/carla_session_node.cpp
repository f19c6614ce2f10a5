// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/carla_session_node.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "core/file.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/import/network_import.h"
#include "node_graph/carla/carla_conversions.h"
#include "node_graph/messages/channel_conversions.h"
#include "node_graph/session_files.h"
#include "planners/registry.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;
using planning::PlanningTask;
using traffic::SessionStatus;

constexpr const char* kCarlaDeployment = "carla.launch";

std::vector<std::string> knownCarlaParameters() {
  return {"scenario",  "mode",        "ego_planner",   "cbv_planner",    "seed",
          "set",       "results",     "overwrite",     "folder",         "ego_role",
          "cbv_roles", "route_topic", "start_timeout", "answer_timeout", "image_timeout"};
}

CarlaRoles rolesOf(const Parameters& parameters) {
  parameters.requireKnown(knownCarlaParameters());
  const std::string ego = parameters.text("ego_role");
  CarlaRoles roles{ego.empty() ? "hero" : ego, core::splitText(parameters.text("cbv_roles"), ' ')};
  roles.validate();
  return roles;
}

/// The map as a file of the cache, which a result's session.yaml can name.
std::string mapFile(const carla_msgs::CarlaWorldInfo& world) {
  if (world.opendrive.empty())
    throw core::InputError("CARLA's ROS bridge sent no OpenDRIVE text of map '" +
                           core::shortened(world.map_name) + "'");
  const fs::path file =
      core::cacheFolder() / ("carla_" + core::sha256(world.opendrive).substr(0, 16) + ".xodr");
  core::writeFileAtomically(file, world.opendrive);
  return file.string();
}

std::string pointsText(const std::vector<Eigen::Vector3d>& points) {
  std::vector<std::string> texts;
  for (const Eigen::Vector3d& point : points) {
    texts.push_back("[" + core::formatNumber(point.x()) + ", " + core::formatNumber(point.y()) +
                    ", " + core::formatNumber(point.z()) + "]");
  }
  return "[" + core::joinText(texts, ", ") + "]";
}

/// The scenario that was asked for, in the bridge's map and on its route.
session::ScenarioOptions carlaScenario(const Parameters& parameters, const CarlaLink& link) {
  session::SessionRequest request = sessionRequest(parameters);
  if (parameters.text("scenario").empty())
    request.scenario = (core::shareFolder() / "config" / "carla" / "session.yaml").string();
  request.network = mapFile(link.world());
  const map::ImportedNetwork network = map::importNetwork(request.network);
  const Eigen::Vector2d offset =
      map::RoadNetwork::fromText(network.text, network.source.string()).netOffset();
  const std::vector<Eigen::Vector3d> route = carlaRoute(link.route(), offset, link.routeTopic());
  const std::string set[] = {"route.points=" + pointsText(route),
                             "cbv.only=[" + core::joinText(link.roles().cbvs, ", ") + "]"};
  request.set.insert(request.set.begin(), std::begin(set), std::end(set));
  return session::resolveRequest(request);
}

/// By seeing planners of a session: names of the cameras of a slot.
std::vector<std::string> camerasOf(const session::LoopPlanner& planner,
                                   const session::SessionSetup& setup, int slot) {
  return planner.sees ? setup.rigs().of(slot).names() : std::vector<std::string>();
}

}  // namespace

struct CarlaSessionNode::Decision {
  cbv::CbvSelection selection;
  std::vector<planning::PlannedAction> actions;
  std::vector<session::SlotImage> images;
  std::vector<session::PlannerLatency> latencies;
};

CarlaSessionNode::CarlaSessionNode(const Parameters& parameters, StopSignal& stop)
    : stop_(stop),
      parameters_(parameters),
      link_(rolesOf(parameters), parameters.text("route_topic"), stop),
      answer_timeout_(parameters.positive("answer_timeout", 30.0)),
      image_timeout_(parameters.positive("image_timeout", 1.0)) {
  enterFolder(parameters.text("folder"));
}

/// What the bridge has no part for, or a step that is another than the scenario's.
void CarlaSessionNode::requireFitting(const session::ScenarioOptions& options) const {
  constexpr double kSameStep = 1e-6;  // [s]
  session::requireLockstep(options);
  if (std::abs(link_.frameStep() - options.simulation_step) > kSameStep) {
    throw core::InputError("CARLA's ROS bridge has fixed_delta_seconds " +
                           core::formatNumber(link_.frameStep()) +
                           "; expected key 'simulation_step', which is " +
                           core::formatNumber(options.simulation_step) + " s");
  }
  if (!options.steering.empty() || !options.storyboard.file.empty())
    throw core::InputError(
        "the scenario has the key 'steering' or 'storyboard'; expected neither with CARLA");
}

void CarlaSessionNode::setUp() {
  const session::ScenarioOptions options = carlaScenario(parameters_, link_);
  requireFitting(options);
  results_ = resultFolder(parameters_.text("results"), options);
  const bool overwrite = parameters_.flag("overwrite", false);
  record::requireFreeFolder(results_, overwrite);
  setup_ = std::make_unique<session::SessionSetup>(options);
  selector_ = setup_->makeCbvSelector();
  cbv_planner_ = {setup_->makeCbvPlanner(), planners::seesImages(options.cbv_planner)};
  if (options.ego_planner != planning::kExternalPlanner)
    ego_planner_ = {setup_->makeEgoPlanner(), planners::seesImages(options.ego_planner)};
  inbox_ = ImageInbox(setup_->rigs(), options.simulation_step);
  link_.listenToCameras(camerasOf(ego_planner_, *setup_, traffic::kEgoSlot),
                        camerasOf(cbv_planner_, *setup_, 0));
  folder_ = std::make_unique<record::ResultFolder>(results_, kCarlaDeployment, overwrite);
  writer_ = std::make_unique<page::ResultWriter>(
      *setup_,
      record::RunFacts{kCarlaDeployment, "CARLA, map " + core::shortened(link_.world().map_name),
                       false},
      results_);
  world_ = std::make_unique<CarlaWorld>(*setup_, link_);
}

int CarlaSessionNode::run() {
  link_.waitForBridge(parameters_.positive("start_timeout", 30.0));
  setUp();
  for (const std::string& role : link_.roles().cbvs) link_.setAutopilot(role, true);
  link_.forgetFrames();
  begin_ = Clock::now();
  try {
    runTicks();
    handBack();
    return finish();
  } catch (const std::exception& error) {  // a disk that is full, for example
    handBack();
    try {
      writeExitCode(results_, core::ExitCode::kRunTimeError);
    } catch (const core::Error&) {
      // What went wrong first is what counts.
    }
    throw core::Error(error.what());
  }
}

bool CarlaSessionNode::takeFrame(CarlaFrame& frame) {
  std::optional<CarlaFrame> next = link_.nextFrame(answer_timeout_);
  while (!next && link_.paused() && !stop_.raised()) next = link_.nextFrame(answer_timeout_);
  for (const std::string& fault : link_.takeFaults()) world_->recordFault(kCarlaBridge, fault);
  if (stop_.raised()) {
    world_->end(SessionStatus::kInterrupted, "user", "interrupted");
    return false;
  }
  if (!next) {
    world_->end(SessionStatus::kError, kCarlaBridge,
                "no frame came within " + core::formatNumber(answer_timeout_) + " s");
    return false;
  }
  try {
    world_->take(*next, link_.superseded());
  } catch (const core::SimulatorError& error) {
    world_->end(SessionStatus::kError, kCarlaBridge, error.what());
    return false;
  }
  frame = *next;
  return true;
}

void CarlaSessionNode::runTicks() {
  bool running = true;
  while (running) {
    CarlaFrame frame;
    Decision decision;
    session::TickRecord record;
    record.snapshot = &world_->snapshot();
    if (takeFrame(frame) && fill(record, decision)) command(frame);
    writer_->observe(record);
    running = world_->snapshot().status == SessionStatus::kRunning;
    if (record.selection != nullptr) world_->assign(decision.selection);
  }
}

bool CarlaSessionNode::fill(session::TickRecord& record, Decision& decision) {
  try {
    if (world_->snapshot().decision_tick) {
      decision = decide();
      record.selection = &decision.selection;
      record.actions = &decision.actions;
      record.images = &decision.images;
      record.latencies = decision.latencies;
    } else {
      selector_->observe(world_->snapshot());
    }
  } catch (const std::exception& error) {
    world_->end(SessionStatus::kError, kCbvIdentificationNode, error.what());
    return false;
  }
  return true;
}

CarlaSessionNode::Decision CarlaSessionNode::decide() {
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  const session::ScenarioOptions& options = setup_->options();
  Decision decision;
  decision.selection = selector_->update(snapshot);
  if (ego_planner_.planner)
    ask(ego_planner_, "ego:" + options.ego_planner,
        session::egoTasks(snapshot, setup_->egoRoute(), options.target_speed), decision);
  ask(cbv_planner_, "cbv:" + options.cbv_planner,
      session::cbvTasks(snapshot, decision.selection, *setup_), decision);
  hold(decision);
  inbox_.forgetBefore(snapshot.tick + 1);
  return decision;
}

std::string CarlaSessionNode::roleOf(const PlanningTask& task) const {
  return task.slot == traffic::kEgoSlot ? link_.roles().ego : task.vehicle->id;
}

/// Waits for what the vehicle's cameras show at this frame.
void CarlaSessionNode::see(const PlanningTask& task, Decision& decision) {
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  for (const rendering::RigCamera& camera : setup_->rigs().of(task.slot).cameras) {
    const std::string role = roleOf(task);
    const auto message = link_.waitForImage(role, camera.name, image_timeout_);
    if (!message) continue;
    try {
      traffic::CameraImage image =
          carlaImage(*message, CarlaLink::imageTopic(role, camera.name), camera, snapshot.tick);
      inbox_.add(task.slot,
                 boost::make_shared<sensor_msgs::Image>(
                     toMsg(image, snapshot.time, task.vehicle->id, camera.name)),
                 camera.name);
      decision.images.push_back({task.slot, std::move(image), camera.name});
    } catch (const core::InputError& error) {
      world_->recordFault(kCarlaBridge, error.what());
    }
  }
}

void CarlaSessionNode::ask(const session::LoopPlanner& asked, const std::string& name,
                           const std::vector<PlanningTask>& tasks, Decision& decision) {
  if (tasks.empty()) return;
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  if (asked.sees) {
    for (const PlanningTask& task : tasks) see(task, decision);
  }
  PlannerDecision planned = asked.sees ? planSeeing(*asked.planner, snapshot, tasks, inbox_)
                                       : planBlind(*asked.planner, snapshot, tasks);
  decision.latencies.push_back({name, planned.latency_ms});
  for (planning::PlannedAction& action : planned.actions) {
    if (!planned.fault.empty()) action.fault = planned.fault;
    if (!action.action.valid()) {
      action.fault = "vehicle '" + action.vehicle_id + "' got an action out of range; full braking";
      action.action = traffic::ControlAction::failSafe();
    }
    if (!action.fault.empty()) world_->recordFault(name, action.fault);
    decision.actions.push_back(std::move(action));
  }
}

/// Keeps the actions until the next decision; who is a CBV no more goes back to CARLA.
void CarlaSessionNode::hold(const Decision& decision) {
  std::map<std::string, traffic::ControlAction> held;
  for (const planning::PlannedAction& action : decision.actions) {
    const bool ego = action.slot == traffic::kEgoSlot;
    held[ego ? link_.roles().ego : action.vehicle_id] = action.action;
  }
  for (const std::string& role : link_.roles().cbvs) {
    const bool ours = held.count(role) != 0;
    if (ours != (held_.count(role) != 0)) link_.setAutopilot(role, !ours);
  }
  held_ = std::move(held);
}

/// One command for each vehicle that the bridge waits for. A vehicle that CARLA drives gets the
/// command that it reports. None is sent where the bridge has gone on: it would count for the wrong
/// frame.
void CarlaSessionNode::command(const CarlaFrame& frame) {
  spin(0.0);
  if (link_.superseded()) {
    world_->recordFault(kCarlaBridge, "the bridge did not wait for the commands of tick " +
                                          std::to_string(world_->snapshot().tick));
    return;
  }
  for (const std::string& role : link_.roles().all()) {
    const auto held = held_.find(role);
    const auto state = frame.states.find(role);
    if (held != held_.end()) {
      link_.command(role, carlaControl(held->second, frame.stamp));
    } else if (role != link_.roles().ego && state != frame.states.end()) {
      carla_msgs::CarlaEgoVehicleControl same = state->second->control;
      same.header.stamp = frame.stamp;
      link_.command(role, same);
    }
  }
}

void CarlaSessionNode::handBack() {
  for (const auto& [role, action] : held_) {
    if (role != link_.roles().ego) link_.setAutopilot(role, true);
  }
  held_.clear();
}

int CarlaSessionNode::finish() {
  writer_->finish(std::chrono::duration<double>(Clock::now() - begin_).count());
  const int exit_code = writer_->exitCode();
  std::cout << writer_->table() << "  frames lost             " << world_->lostFrames() << "\n"
            << std::flush;
  writeExitCode(writer_->folder(), exit_code);
  return exit_code;
}

int runCarlaSession(StopSignal& stop) {
  const Parameters parameters = Parameters::ofThisNode();
  try {
    requireHeededLaunchArguments();
    return runNodeObject<CarlaSessionNode>(parameters, stop);
  } catch (const core::Error& error) {
    writeRefusal(parameters.text("results"), core::failureOf(error).exit_code);
    throw;
  }
}

}  // namespace cdiff::node_graph
