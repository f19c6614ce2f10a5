// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "carla_msgs/CarlaEgoVehicleControl.h"
#include "derived_object_msgs/Object.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "nav_msgs/Path.h"
#include "sensor_msgs/Image.h"

namespace cdiff::node_graph {

// Between the messages of CARLA's ROS bridge and our values. The bridge has turned CARLA's
// left-handed y axis already: its frame map is that of the OpenDRIVE text. Ours is the network's
// frame, `offset` [m] farther. CARLA's steer is positive right, ours positive left.

/// The vehicle at its place in the network's frame, without id and role; nullopt for walkers,
/// barriers, signs and what has no box.
std::optional<traffic::Vehicle> carlaVehicle(const derived_object_msgs::Object& object,
                                             const Eigen::Vector2d& offset);

/// The command that lets a vehicle do this from the frame after `stamp` on.
carla_msgs::CarlaEgoVehicleControl carlaControl(const traffic::ControlAction& action,
                                                const ros::Time& stamp);
/// What such a command does; values out of range are cut off.
traffic::ControlAction carlaAction(const carla_msgs::CarlaEgoVehicleControl& control);

/// Key points of the ego's route in the network's frame [m]: the first, the last, and between them
/// one after each 10 m. Throws InputError for a path of fewer than two places; `topic` names it.
std::vector<Eigen::Vector3d> carlaRoute(const nav_msgs::Path& path, const Eigen::Vector2d& offset,
                                        const std::string& topic);

/// The image (bgra8, bgr8 or rgb8) as rgb8. Throws InputError naming topic and value for another
/// encoding or size than the camera's.
traffic::CameraImage carlaImage(const sensor_msgs::Image& message, const std::string& topic,
                                const rendering::RigCamera& camera, std::uint64_t tick);

}  // namespace cdiff::node_graph
