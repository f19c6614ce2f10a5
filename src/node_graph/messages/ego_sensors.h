// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>

#include "e2e_cdiff/TrackedObjects.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "geometry_msgs/TransformStamped.h"
#include "rendering/range_sensor.h"
#include "ros/ros.h"
#include "sensor_msgs/LaserScan.h"
#include "sensor_msgs/PointCloud2.h"
#include "session/session_setup.h"
#include "visualization_msgs/MarkerArray.h"

namespace cdiff::node_graph {

/// The vehicles whose centers are at most `range` [m] from the ego's, nearest first. Without an ego
/// there are none.
::e2e_cdiff::TrackedObjects toObjectsMsg(const traffic::TrafficSnapshot& snapshot, double range);
/// The same as boxes in `map`, which live for 0.5 s of simulated time; id by place in the list.
visualization_msgs::MarkerArray toObjectMarkers(const ::e2e_cdiff::TrackedObjects& objects);
/// In the frame "<vehicle>/laser"; angles from -pi, counter-clockwise.
sensor_msgs::LaserScan toLaserScanMsg(const rendering::RangeSensor& sensor,
                                      const rendering::RangeScan& scan, double time,
                                      const std::string& vehicle_id);
/// Where a vehicle's laser scanner is: base_link -> laser, which never changes.
geometry_msgs::TransformStamped laserMount(const std::string& vehicle_id, double height,
                                           double time);
/// What was hit, in the frame "<vehicle>/base_link": x, y, z as float32.
sensor_msgs::PointCloud2 toPointCloudMsg(const rendering::RangeSensor& sensor,
                                         const rendering::RangeScan& scan, double time,
                                         const std::string& vehicle_id);

/// What true sensors of the ego tell at a tick: odometry and objects at every tick, laser scan and
/// lidar cloud at decisions; each while someone subscribes.
class EgoSensors {
 public:
  /// `setup` must outlive this object.
  EgoSensors(ros::NodeHandle& node, const session::SessionSetup& setup);
  void publish(const traffic::TrafficSnapshot& snapshot);

 private:
  void publishObjects(const traffic::TrafficSnapshot& snapshot);
  void publishScans(const traffic::TrafficSnapshot& snapshot);
  /// Made when somebody first listens.
  rendering::RangeSensor& made(std::optional<rendering::RangeSensor>& sensor,
                               const rendering::RangeSensorOptions& options);

  const session::SessionSetup& setup_;
  ros::Publisher odometry_;
  ros::Publisher objects_;
  ros::Publisher object_markers_;
  ros::Publisher scan_;
  ros::Publisher points_;
  std::optional<rendering::RangeSensor> laser_;
  std::optional<rendering::RangeSensor> lidar_;
};

}  // namespace cdiff::node_graph
