// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "planners/camera_ego/bev_encoder.h"
#include "planners/camera_ego/navigation.h"
#include "planners/camera_ego/road_lines.h"
#include "planners/camera_ego/waypoint_controller.h"
#include "planners/pluto/training/pluto_samples.h"
#include "rendering/rig_renderer.h"

namespace cdiff::planners {

// Labeled examples for camera egos, made of moments of recorded scenes.

/// A box as the networks answer it: x, y, log width, log length, z, log height, sin, cos, vx, vy
/// (body frame of the ego, SI units).
inline constexpr std::size_t kAgentBoxNumbers = 10;
using AgentBox = std::array<float, kAgentBoxNumbers>;

/// Where a vehicle will be at kEgoWaypointPeriod, 2 kEgoWaypointPeriod ... (body frame of the ego
/// now [m]); the first `known` of them.
struct FuturePlaces {
  EgoWaypoints places{};
  std::size_t known = 0;
};

/// Another vehicle that the ego sees.
struct AgentLabel {
  std::uint32_t vehicle = 0;  ///< number in the scene's table
  AgentBox box{};
  double heading = 0.0;  ///< in the body frame [rad]
  traffic::VehicleDimensions size;
  FuturePlaces future;
};

/// What the cameras saw at one decision, with the ego's motion.
struct EgoFrame {
  std::vector<traffic::CameraImage> images;  ///< in the rig's order
  EgoPoses poses;                            ///< with the pose of the look before, if there is one
  EgoMotion motion{};
  std::vector<AgentLabel> agents;  ///< of a past look, where past_agents asks for them
};

/// A moment to learn from, or to be judged on.
struct EgoExample {
  std::uint64_t network = 0;    ///< hash of its network's name, where it is known
  std::vector<EgoFrame> looks;  ///< kPastAge apart, the present one last
  double speed = 0.0;           ///< of the ego [m/s]
  RoadCommand command = RoadCommand::kFollow;
  Eigen::Vector2d target = Eigen::Vector2d::Zero();  ///< of the route (body frame [m])
  FuturePlaces driven;                               ///< where the ego was then
  std::vector<AgentLabel> agents;  ///< with enough pixels in an image, nearest first
  std::vector<AgentLabel> others;  ///< all within 60 m, seen or not, for collisions
  std::vector<BevLine> lines;
};

/// How an example is made of a moment.
struct EgoExampleOptions {
  std::size_t looks = 2;  ///< most looks, the past ones before the present one
  double beside = 0.0;    ///< the ego is moved so far to the left [m]
  double turned = 0.0;    ///< and turned to the left [rad]
  std::size_t most_agents = 24;
  std::size_t most_lines = 16;
  bool past_agents = false;  ///< past looks are labeled, too: body frame and sight of then
};

/// Vehicles with fewer pixels in every image are not labeled.
inline constexpr int kLeastPixels = 20;

/// Makes examples of the moments of scenes: renders again what the cameras saw, and reads labels
/// from the simulator's states. One per thread.
class EgoExamples {
 public:
  EgoExamples(const rendering::CameraRig& rig, const BevGrid& bev) : rig_(rig), bev_(bev) {}

  EgoExample make(const PlutoScene& scene, const PlutoPlace& place,
                  const EgoExampleOptions& options = {});
  /// The command at a place.
  RoadCommand commandAt(const PlutoScene& scene, const PlutoPlace& place);

 private:
  /// What is drawn of a network, and its lines.
  struct World {
    World(const PlutoWorld& world, const rendering::CameraRig& rig)
        : renderer(rig, world.network), lines(world.network, world.area) {}
    rendering::RigRenderer renderer;
    RoadLines lines;
  };
  World& worldOf(const PlutoScene& scene);
  EgoFrame lookAt(const PlutoScene& scene, const PlutoPlace& place, std::size_t decision,
                  const EgoExampleOptions& options, EgoExample* labeled);
  void addAgents(const PlutoScene& scene, const PlutoPlace& place, const geometry::Pose2d& pose,
                 const std::vector<int>& pixels, EgoExample& example) const;
  const NavigationNode& nextNode(const PlutoScene& scene, const PlutoPlace& place);

  rendering::CameraRig rig_;
  BevGrid bev_;
  std::map<const PlutoWorld*, std::unique_ptr<World>> worlds_;
  std::map<std::pair<const PlutoScene*, std::size_t>, Navigation> navigations_;
};

/// A decision of a scene as the cameras draw it; the vehicles in the order of the frame's points.
traffic::TrafficSnapshot snapshotOf(const PlutoScene& scene, std::size_t decision);

}  // namespace cdiff::planners
