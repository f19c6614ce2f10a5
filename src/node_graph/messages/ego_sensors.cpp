// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/ego_sensors.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "e2e_cdiff/core/angle.h"
#include "node_graph/messages/display.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "sensor_msgs/point_cloud2_iterator.h"

namespace cdiff::node_graph {
namespace {

msgs::TrackedObject objectOf(const traffic::Vehicle& vehicle, const traffic::Vehicle& ego) {
  msgs::TrackedObject object;
  object.id = vehicle.id;
  object.state = toMsg(vehicle.state);
  object.length = vehicle.dimensions.length;
  object.width = vehicle.dimensions.width;
  object.height = vehicle.dimensions.height;
  object.velocity_x = vehicle.state.velocity().x();
  object.velocity_y = vehicle.state.velocity().y();
  object.acceleration = vehicle.acceleration;
  object.yaw_rate = vehicle.yaw_rate;
  object.distance = (vehicle.state.position - ego.state.position).norm();
  return object;
}

std::string laserFrame(const std::string& vehicle_id) { return frameId(vehicle_id + "/laser"); }

}  // namespace

geometry_msgs::TransformStamped laserMount(const std::string& vehicle_id, double height,
                                           double time) {
  geometry_msgs::TransformStamped mount;
  mount.header.stamp = toStamp(time);
  mount.header.frame_id = frameId(vehicle_id + "/base_link");
  mount.child_frame_id = laserFrame(vehicle_id);
  mount.transform.translation.z = height;
  mount.transform.rotation.w = 1.0;
  return mount;
}

msgs::TrackedObjects toObjectsMsg(const traffic::TrafficSnapshot& snapshot, double range) {
  msgs::TrackedObjects objects;
  objects.header.stamp = toStamp(snapshot.time);
  objects.header.frame_id = frameId(kMapFrame);
  objects.tick = snapshot.tick;
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return objects;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (&vehicle == ego) continue;
    const msgs::TrackedObject object = objectOf(vehicle, *ego);
    if (object.distance <= range) objects.objects.push_back(object);
  }
  std::sort(objects.objects.begin(), objects.objects.end(),
            [](const auto& left, const auto& right) {
              return std::tie(left.distance, left.id) < std::tie(right.distance, right.id);
            });
  return objects;
}

visualization_msgs::MarkerArray toObjectMarkers(const msgs::TrackedObjects& objects) {
  constexpr double kLifetime = 0.5;  // [s] of simulated time
  visualization_msgs::MarkerArray array;
  for (const msgs::TrackedObject& object : objects.objects) {
    visualization_msgs::Marker marker;
    marker.header = objects.header;
    marker.ns = "objects";
    marker.id = static_cast<int>(array.markers.size());
    marker.type = visualization_msgs::Marker::CUBE;
    marker.pose.position.x = object.state.x;
    marker.pose.position.y = object.state.y;
    marker.pose.position.z = object.state.z + 0.5 * object.height;
    marker.pose.orientation.z = std::sin(0.5 * object.state.heading);
    marker.pose.orientation.w = std::cos(0.5 * object.state.heading);
    marker.scale.x = object.length;
    marker.scale.y = object.width;
    marker.scale.z = object.height;
    marker.color.g = marker.color.b = marker.color.a = 0.8F;
    marker.text = object.id;
    marker.lifetime = ros::Duration(kLifetime);
    array.markers.push_back(marker);
  }
  return array;
}

sensor_msgs::LaserScan toLaserScanMsg(const rendering::RangeSensor& sensor,
                                      const rendering::RangeScan& scan, double time,
                                      const std::string& vehicle_id) {
  const rendering::RangeSensorOptions& options = sensor.options();
  sensor_msgs::LaserScan message;
  message.header.stamp = toStamp(time);
  message.header.frame_id = laserFrame(vehicle_id);
  message.angle_increment =
      static_cast<float>(2.0 * core::kPi / static_cast<double>(options.beams));
  message.angle_min = static_cast<float>(options.azimuth(0));
  message.angle_max = static_cast<float>(options.azimuth(options.beams - 1));
  message.range_max = static_cast<float>(options.range);
  message.ranges.assign(scan.ranges.begin(), scan.ranges.begin() + options.beams);
  return message;
}

sensor_msgs::PointCloud2 toPointCloudMsg(const rendering::RangeSensor& sensor,
                                         const rendering::RangeScan& scan, double time,
                                         const std::string& vehicle_id) {
  const std::vector<Eigen::Vector3f> points = sensor.points(scan);
  sensor_msgs::PointCloud2 message;
  message.header.stamp = toStamp(time);
  message.header.frame_id = frameId(vehicle_id + "/base_link");
  sensor_msgs::PointCloud2Modifier modifier(message);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  modifier.resize(points.size());
  message.is_dense = true;
  sensor_msgs::PointCloud2Iterator<float> place(message, "x");
  for (const Eigen::Vector3f& point : points) {
    for (int axis = 0; axis < 3; ++axis) place[axis] = point[axis];
    ++place;
  }
  return message;
}

namespace {

template <class Message>
ros::Publisher advertised(ros::NodeHandle& node, ChannelId id) {
  constexpr std::uint32_t kQueueSize = 100;
  return node.advertise<Message>(Topic(id).name(), kQueueSize);
}

}  // namespace

EgoSensors::EgoSensors(ros::NodeHandle& node, const session::SessionSetup& setup)
    : setup_(setup),
      odometry_(advertised<nav_msgs::Odometry>(node, ChannelId::kEgoOdometry)),
      objects_(advertised<msgs::TrackedObjects>(node, ChannelId::kEgoObjects)),
      object_markers_(
          advertised<visualization_msgs::MarkerArray>(node, ChannelId::kEgoObjectMarkers)),
      scan_(advertised<sensor_msgs::LaserScan>(node, ChannelId::kEgoScan)),
      points_(advertised<sensor_msgs::PointCloud2>(node, ChannelId::kEgoPoints)) {}

void EgoSensors::publish(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return;
  if (odometry_.getNumSubscribers() > 0) odometry_.publish(toOdometryMsg(*ego, snapshot.time));
  publishObjects(snapshot);
  if (snapshot.decision_tick) publishScans(snapshot);
}

void EgoSensors::publishObjects(const traffic::TrafficSnapshot& snapshot) {
  const bool marked = object_markers_.getNumSubscribers() > 0;
  if (!marked && objects_.getNumSubscribers() == 0) return;
  const msgs::TrackedObjects objects = toObjectsMsg(snapshot, setup_.options().ego.object_range);
  objects_.publish(objects);
  if (marked) object_markers_.publish(toObjectMarkers(objects));
}

void EgoSensors::publishScans(const traffic::TrafficSnapshot& snapshot) {
  const session::EgoOptions& options = setup_.options().ego;
  const std::string ego = traffic::kEgoId;
  if (scan_.getNumSubscribers() > 0) {
    rendering::RangeSensor& laser = made(laser_, options.laser);
    sensor_msgs::LaserScan scan =
        toLaserScanMsg(laser, laser.scan(snapshot, ego), snapshot.time, ego);
    scan.scan_time = static_cast<float>(setup_.options().decision_period);
    scan_.publish(scan);
  }
  if (points_.getNumSubscribers() > 0) {
    rendering::RangeSensor& lidar = made(lidar_, options.lidar);
    points_.publish(toPointCloudMsg(lidar, lidar.scan(snapshot, ego), snapshot.time, ego));
  }
}

rendering::RangeSensor& EgoSensors::made(std::optional<rendering::RangeSensor>& sensor,
                                         const rendering::RangeSensorOptions& options) {
  if (!sensor) sensor.emplace(options, setup_.network());
  return *sensor;
}

}  // namespace cdiff::node_graph
