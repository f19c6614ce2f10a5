// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/carla/carla_conversions.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "cv_bridge/cv_bridge.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::node_graph {
namespace {

using derived_object_msgs::Object;

bool isVehicle(const Object& object) {
  using Box = shape_msgs::SolidPrimitive;
  switch (object.classification) {
    case Object::CLASSIFICATION_PEDESTRIAN:
    case Object::CLASSIFICATION_BARRIER:
    case Object::CLASSIFICATION_SIGN:
      return false;
    default:
      return object.shape.type == Box::BOX && object.shape.dimensions.size() > Box::BOX_Z;
  }
}

double headingOf(const geometry_msgs::Quaternion& q) {
  return std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z));
}

cv_bridge::CvImagePtr rgbOf(const sensor_msgs::Image& message, const std::string& topic) {
  try {
    return cv_bridge::toCvCopy(message, "rgb8");
  } catch (const cv_bridge::Exception& error) {
    throw core::InputError(topic + ": an image that cannot be read: " + error.what());
  }
}

}  // namespace

std::optional<traffic::Vehicle> carlaVehicle(const Object& object, const Eigen::Vector2d& offset) {
  using Box = shape_msgs::SolidPrimitive;
  if (!isVehicle(object)) return std::nullopt;
  traffic::Vehicle vehicle;
  const geometry_msgs::Point& place = object.pose.position;
  const geometry_msgs::Vector3& velocity = object.twist.linear;
  vehicle.state.position = Eigen::Vector2d(place.x, place.y) + offset;
  vehicle.state.elevation = place.z;
  vehicle.state.heading = headingOf(object.pose.orientation);
  const Eigen::Vector2d forward = geometry::direction(vehicle.state.heading);
  vehicle.state.speed = std::max(0.0, forward.dot(Eigen::Vector2d(velocity.x, velocity.y)));
  const std::vector<double>& size = object.shape.dimensions;
  vehicle.dimensions = {size[Box::BOX_X], size[Box::BOX_Y], size[Box::BOX_Z]};
  return vehicle;
}

carla_msgs::CarlaEgoVehicleControl carlaControl(const traffic::ControlAction& action,
                                                const ros::Time& stamp) {
  carla_msgs::CarlaEgoVehicleControl control;
  control.header.stamp = stamp;
  control.throttle = static_cast<float>(action.throttle);
  control.steer = static_cast<float>(-action.steer);
  control.brake = static_cast<float>(action.brake);
  return control;
}

traffic::ControlAction carlaAction(const carla_msgs::CarlaEgoVehicleControl& control) {
  traffic::ControlAction action;
  action.throttle = std::clamp(static_cast<double>(control.throttle), 0.0, 1.0);
  action.steer = std::clamp(-static_cast<double>(control.steer), -1.0, 1.0);
  action.brake = std::clamp(static_cast<double>(control.brake), 0.0, 1.0);
  return action;
}

std::vector<Eigen::Vector3d> carlaRoute(const nav_msgs::Path& path, const Eigen::Vector2d& offset,
                                        const std::string& topic) {
  constexpr double kSpacing = 10.0;  // [m]
  constexpr double kSame = 0.1;      // [m]
  if (path.poses.size() < 2) {
    throw core::InputError("the route on " + topic + " has " + std::to_string(path.poses.size()) +
                           " places; expected two or more");
  }
  std::vector<Eigen::Vector3d> points;
  const auto distance = [&](const Eigen::Vector3d& point) {
    return (point - points.back()).head<2>().norm();
  };
  Eigen::Vector3d point;
  for (const geometry_msgs::PoseStamped& pose : path.poses) {
    const geometry_msgs::Point& place = pose.pose.position;
    point = {place.x + offset.x(), place.y + offset.y(), place.z};
    if (points.empty() || distance(point) >= kSpacing) points.push_back(point);
  }
  if (distance(point) > kSame) points.push_back(point);
  return points;
}

traffic::CameraImage carlaImage(const sensor_msgs::Image& message, const std::string& topic,
                                const rendering::RigCamera& camera, std::uint64_t tick) {
  if (message.width != camera.width || message.height != camera.height) {
    throw core::InputError(topic + ": an image of " + std::to_string(message.width) + " x " +
                           std::to_string(message.height) + " pixels; expected " +
                           std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  const std::string& encoding = message.encoding;
  if (encoding != "bgra8" && encoding != "bgr8" && encoding != "rgb8") {
    throw core::InputError(topic + ": an image in encoding '" + core::shortened(encoding) +
                           "'; expected bgra8, bgr8 or rgb8");
  }
  const cv_bridge::CvImagePtr picture = rgbOf(message, topic);
  traffic::CameraImage image;
  image.width = picture->image.cols;
  image.height = picture->image.rows;
  image.tick = tick;
  const std::size_t bytes = picture->image.total() * picture->image.elemSize();
  image.rgb.assign(picture->image.datastart, picture->image.datastart + bytes);
  return image;
}

}  // namespace cdiff::node_graph
