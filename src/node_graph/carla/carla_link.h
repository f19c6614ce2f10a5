// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "carla_msgs/CarlaActorList.h"
#include "carla_msgs/CarlaEgoVehicleControl.h"
#include "carla_msgs/CarlaEgoVehicleStatus.h"
#include "carla_msgs/CarlaStatus.h"
#include "carla_msgs/CarlaWorldInfo.h"
#include "derived_object_msgs/ObjectArray.h"
#include "nav_msgs/Path.h"
#include "node_graph/lockstep/node_process.h"
#include "ros/ros.h"
#include "sensor_msgs/Image.h"
#include "std_msgs/Bool.h"

namespace cdiff::node_graph {

/// The vehicles that CARLA's ROS bridge lets others control, by CARLA's role names.
struct CarlaRoles {
  std::string ego;                ///< of the ego
  std::vector<std::string> cbvs;  ///< of the vehicles that may become CBVs

  std::vector<std::string> all() const;
  /// Id in the session: "ego", the role name of a vehicle that may become a CBV, or "carla_ACTOR".
  std::string idOf(std::uint32_t actor, const std::string& role) const;
  /// Throws InputError for a role name that is missing, repeated, or part of no topic's name.
  void validate() const;
};

/// What the bridge has published of one frame.
struct CarlaFrame {
  ros::Time stamp;                                                            ///< CARLA's time
  derived_object_msgs::ObjectArray::ConstPtr objects;                         ///< nullptr: not yet
  std::map<std::string, carla_msgs::CarlaEgoVehicleStatus::ConstPtr> states;  ///< by role name
};

/// The topics of CARLA's ROS bridge, in the thread that spins: frames and images come from there;
/// commands go there, one a vehicle and frame.
class CarlaLink {
 public:
  /// `route_topic` empty: /carla/EGO/waypoints. A `stop` that is raised ends every waiting.
  CarlaLink(CarlaRoles roles, const std::string& route_topic, StopSignal& stop);

  /// Waits until the bridge has published what a session needs and listens to all roles' commands.
  /// Throws SimulatorError naming topics that stay silent for `seconds` of wall time; InputError
  /// for a role that no actor has or that the bridge does not control, and for a bridge that is not
  /// in synchronous mode.
  void waitForBridge(double seconds);
  // After waitForBridge.

  const carla_msgs::CarlaWorldInfo& world() const { return *world_; }
  const nav_msgs::Path& route() const { return *route_; }
  const std::string& routeTopic() const { return route_topic_; }
  /// From one frame to the next [s].
  double frameStep() const { return status_->fixed_delta_seconds; }
  /// Whether the bridge is paused.
  bool paused() const { return status_->synchronous_mode_running == 0; }
  const CarlaRoles& roles() const { return roles_; }
  /// Role name of an actor; empty when the bridge lists none.
  std::string roleOf(std::uint32_t actor) const;
  /// The bridge publishes the camera NAME of a vehicle on /carla/ROLE/rgb_NAME/image.
  static std::string imageTopic(const std::string& role, const std::string& camera);

  /// From now on images of these cameras of all that may become CBVs, and of the ego, are kept.
  void listenToCameras(const std::vector<std::string>& ego, const std::vector<std::string>& cbv);
  /// What has come until now is no part of the session.
  void forgetFrames();
  /// The oldest frame that is whole and later than those before it; nullopt when none is within
  /// `seconds` of wall time. Images of earlier frames are forgotten.
  std::optional<CarlaFrame> nextFrame(double seconds);
  /// Whether the bridge has gone on to a later frame than the last that was given.
  bool superseded() const;
  /// The image of the last frame; nullptr when it does not come within `seconds` of wall time.
  sensor_msgs::Image::ConstPtr waitForImage(const std::string& role, const std::string& camera,
                                            double seconds);
  void command(const std::string& role, const carla_msgs::CarlaEgoVehicleControl& control);
  /// Whether CARLA's traffic manager drives the vehicle.
  void setAutopilot(const std::string& role, bool on);
  /// What was noticed since the last call, each text once a session: other nodes that command, and
  /// vehicles that ignore commands.
  std::vector<std::string> takeFaults();

 private:
  using Control = carla_msgs::CarlaEgoVehicleControl;
  void listenToStates(const std::string& role);
  void watch(const std::string& role);
  bool waitUntil(double seconds, const std::function<bool()>& done);
  std::string silentTopics() const;
  void requireRoles() const;
  bool listensToCommands() const;
  bool whole(const CarlaFrame& frame) const;
  void note(const std::string& fault);
  CarlaFrame* frameAt(const ros::Time& stamp);

  CarlaRoles roles_;
  std::string route_topic_;
  StopSignal& stop_;
  ros::NodeHandle node_ = nodeHandle();
  std::vector<ros::Subscriber> inputs_;
  std::map<std::string, ros::Publisher> commands_;    ///< by role name
  std::map<std::string, ros::Publisher> autopilots_;  ///< by role name
  carla_msgs::CarlaWorldInfo::ConstPtr world_;
  carla_msgs::CarlaStatus::ConstPtr status_;
  carla_msgs::CarlaActorList::ConstPtr actors_;
  nav_msgs::Path::ConstPtr route_;
  ros::Time last_;                                     ///< stamp of the last frame that was given
  std::map<ros::Time, CarlaFrame> frames_;             ///< later ones
  using Camera = std::pair<std::string, std::string>;  ///< role name, camera
  std::map<ros::Time, std::map<Camera, sensor_msgs::Image::ConstPtr>> images_;  ///< by stamp
  std::set<std::string> noted_;
  std::vector<std::string> faults_;
};

}  // namespace cdiff::node_graph
