// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/ego_examples.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {
namespace {

constexpr double kOthersReach = 60.0;  // [m]
const auto kPastDecisions = static_cast<std::size_t>(std::lround(kPastAge / kPlutoPeriod));
const auto kWaypointDecisions =
    static_cast<std::size_t>(std::lround(kEgoWaypointPeriod / kPlutoPeriod));

/// The pose of a vehicle, moved as the options say.
geometry::Pose2d movedPose(const traffic::VehicleState& state, const EgoExampleOptions& options) {
  return {state.pose().toMap({0.0, options.beside}),
          core::wrapAngle(state.heading + options.turned)};
}

FuturePlaces futureOf(const PlutoScene& scene, std::size_t decision, std::uint32_t vehicle,
                      const geometry::Pose2d& frame) {
  FuturePlaces future;
  for (EgoWaypoints::size_type i = 0; i < future.places.size(); ++i) {
    const std::size_t then = decision + (i + 1) * kWaypointDecisions;
    const TrackPoint* point =
        then < scene.frames().size() ? scene.frames()[then].find(vehicle) : nullptr;
    if (point == nullptr) break;
    future.places[i] = frame.toBody(point->state.position);
    future.known = i + 1;
  }
  return future;
}

AgentBox boxOf(const geometry::Pose2d& frame, double elevation, const traffic::VehicleState& state,
               const traffic::VehicleDimensions& size) {
  const Eigen::Vector2d place = frame.toBody(state.position);
  const double heading = state.heading - frame.heading;
  const Eigen::Vector2d velocity = state.speed * geometry::direction(heading);
  const double numbers[kAgentBoxNumbers] = {place.x(),
                                            place.y(),
                                            std::log(size.width),
                                            std::log(size.length),
                                            state.elevation - elevation,
                                            std::log(size.height),
                                            std::sin(heading),
                                            std::cos(heading),
                                            velocity.x(),
                                            velocity.y()};
  AgentBox box;
  for (std::size_t i = 0; i < kAgentBoxNumbers; ++i) box[i] = static_cast<float>(numbers[i]);
  return box;
}

double squareDistance(const AgentLabel& label) {
  const auto x = static_cast<double>(label.box[0]), y = static_cast<double>(label.box[1]);
  return x * x + y * y;
}

/// Rate at which it turned since the decision before [rad/s].
double yawRateAt(const PlutoScene& scene, std::uint32_t vehicle, std::size_t decision) {
  const TrackPoint* before = decision > 0 ? scene.frames()[decision - 1].find(vehicle) : nullptr;
  if (before == nullptr) return 0.0;
  const double heading = scene.frames()[decision].find(vehicle)->state.heading;
  return core::wrapAngle(heading - before->state.heading) / kPlutoPeriod;
}

}  // namespace

traffic::TrafficSnapshot snapshotOf(const PlutoScene& scene, std::size_t decision) {
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = decision;
  snapshot.signals = scene.signals(decision);
  for (const TrackPoint& point : scene.frames()[decision].points) {
    traffic::Vehicle vehicle;
    vehicle.id = scene.vehicles().id(point.vehicle);
    vehicle.dimensions = scene.vehicles().size(point.vehicle);
    vehicle.state = point.state;
    vehicle.acceleration = point.acceleration;
    vehicle.applied_action = traffic::ControlAction{0.0, 0.0, static_cast<double>(point.brake)};
    snapshot.vehicles.push_back(std::move(vehicle));
  }
  return snapshot;
}

EgoExamples::World& EgoExamples::worldOf(const PlutoScene& scene) {
  std::unique_ptr<World>& world = worlds_[&scene.world()];
  if (!world) world = std::make_unique<World>(scene.world(), rig_);
  return *world;
}

const NavigationNode& EgoExamples::nextNode(const PlutoScene& scene, const PlutoPlace& place) {
  const PlutoDrive& drive = scene.drives()[place.drive];
  const auto key = std::make_pair(&scene, static_cast<std::size_t>(place.drive));
  auto known = navigations_.find(key);
  if (known == navigations_.end())
    known = navigations_.emplace(key, Navigation(scene.world().network, drive.route)).first;
  return known->second.next(drive.places.at(place.decision));
}

RoadCommand EgoExamples::commandAt(const PlutoScene& scene, const PlutoPlace& place) {
  return nextNode(scene, place).command;
}

/// A look at a decision; labels of what was seen go into `labeled` where that is asked for.
EgoFrame EgoExamples::lookAt(const PlutoScene& scene, const PlutoPlace& place, std::size_t decision,
                             const EgoExampleOptions& options, EgoExample* labeled) {
  const std::uint32_t number = scene.drives()[place.drive].vehicle;
  traffic::Vehicle own;
  own.id = scene.vehicles().id(number);
  own.dimensions = scene.vehicles().size(number);
  own.state = scene.frames()[decision].find(number)->state;
  EgoFrame look;
  look.poses.present = movedPose(own.state, options);
  own.state.position = look.poses.present.position;
  own.state.heading = look.poses.present.heading;
  const traffic::TrafficSnapshot snapshot = snapshotOf(scene, decision);
  const auto labels =
      labeled == nullptr ? rendering::Labels::kNone : rendering::Labels::kClassesAndInstances;
  std::vector<rendering::RenderedView> views =
      worldOf(scene).renderer.render(snapshot, own, labels);
  if (labeled != nullptr)
    addAgents(scene, place, look.poses.present,
              rendering::mostPixels(views, snapshot.vehicles.size()), *labeled);
  for (rendering::RenderedView& view : views) look.images.push_back(std::move(view.image));
  return look;
}

void EgoExamples::addAgents(const PlutoScene& scene, const PlutoPlace& place,
                            const geometry::Pose2d& pose, const std::vector<int>& pixels,
                            EgoExample& example) const {
  const std::uint32_t own = scene.drives()[place.drive].vehicle;
  const TrackFrame& frame = scene.frames()[place.decision];
  const double elevation = frame.find(own)->state.elevation;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const TrackPoint& point = frame.points[i];
    if (point.vehicle == own || traffic::onDifferentLevels(point.state.elevation, elevation) ||
        (point.state.position - pose.position).norm() > kOthersReach)
      continue;
    AgentLabel label;
    label.vehicle = point.vehicle;
    label.size = scene.vehicles().size(point.vehicle);
    label.box = boxOf(pose, elevation, point.state, label.size);
    label.heading = core::wrapAngle(point.state.heading - pose.heading);
    label.future = futureOf(scene, place.decision, point.vehicle, pose);
    example.others.push_back(label);
    if (pixels[i] >= kLeastPixels && bev_.contains({label.box[0], label.box[1]}))
      example.agents.push_back(label);
  }
  std::stable_sort(example.agents.begin(), example.agents.end(),
                   [](const AgentLabel& left, const AgentLabel& right) {
                     return squareDistance(left) < squareDistance(right);
                   });
}

EgoExample EgoExamples::make(const PlutoScene& scene, const PlutoPlace& place,
                             const EgoExampleOptions& options) {
  EgoExample example;
  const std::uint32_t number = scene.drives()[place.drive].vehicle;
  std::vector<std::size_t> decisions = {place.decision};
  while (decisions.size() < options.looks && decisions.front() >= kPastDecisions &&
         scene.frames()[decisions.front() - kPastDecisions].find(number) != nullptr)
    decisions.insert(decisions.begin(), decisions.front() - kPastDecisions);
  for (const std::size_t decision : decisions) {
    EgoExample past;
    PlutoPlace then = place;
    then.decision = static_cast<std::uint32_t>(decision);
    EgoExample* labeled = options.past_agents ? &past : nullptr;
    if (decision == place.decision) labeled = &example;
    EgoFrame look = lookAt(scene, then, decision, options, labeled);
    if (past.agents.size() > options.most_agents) past.agents.resize(options.most_agents);
    look.agents = std::move(past.agents);
    if (!example.looks.empty()) look.poses.past = example.looks.back().poses.present;
    look.motion = egoMotion(scene.frames()[decision].find(number)->state.speed,
                            yawRateAt(scene, number, decision), look.poses);
    example.looks.push_back(std::move(look));
  }
  const traffic::VehicleState& state = scene.frames()[place.decision].find(number)->state;
  const geometry::Pose2d& pose = example.looks.back().poses.present;
  example.speed = state.speed;
  example.driven = futureOf(scene, place.decision, number, pose);
  example.lines = worldOf(scene).lines.around({pose, state.elevation}, bev_, options.most_lines);
  if (example.agents.size() > options.most_agents) example.agents.resize(options.most_agents);
  const NavigationNode& node = nextNode(scene, place);
  example.command = node.command;
  example.target = pose.toBody(node.position);
  return example;
}

}  // namespace cdiff::planners
