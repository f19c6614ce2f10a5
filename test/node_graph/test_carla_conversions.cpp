// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "carla_msgs/CarlaActorList.h"
#include "carla_msgs/CarlaEgoVehicleStatus.h"
#include "carla_msgs/CarlaStatus.h"
#include "carla_msgs/CarlaWorldInfo.h"
#include "derived_object_msgs/ObjectArray.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/carla/carla_conversions.h"
#include "node_graph/carla/carla_link.h"

namespace cdiff::node_graph {
namespace {

constexpr double kPi = 3.14159265358979;
using derived_object_msgs::Object;

template <class Message>
std::string typeOf() {
  return std::string(ros::message_traits::datatype<Message>()) + " " +
         ros::message_traits::md5sum<Message>();
}

// As genmsg computes them from the definitions of the bridge's own packages.
TEST(CarlaMessages, AreThoseOfTheBridge) {
  EXPECT_EQ(typeOf<carla_msgs::CarlaEgoVehicleControl>(),
            "carla_msgs/CarlaEgoVehicleControl e5b57fc698c12ff4c20a5fc71fba832f");
  EXPECT_EQ(typeOf<carla_msgs::CarlaEgoVehicleStatus>(),
            "carla_msgs/CarlaEgoVehicleStatus 7d24d9cd2c1c81e9a2b845b347cb2162");
  EXPECT_EQ(typeOf<carla_msgs::CarlaStatus>(),
            "carla_msgs/CarlaStatus 0a6e668a0d517dead8f5c68762fc1dab");
  EXPECT_EQ(typeOf<carla_msgs::CarlaWorldInfo>(),
            "carla_msgs/CarlaWorldInfo 7a3a7a7fc8c213a8bec2ce7928b0a46c");
  EXPECT_EQ(typeOf<carla_msgs::CarlaActorList>(),
            "carla_msgs/CarlaActorList a10ababa303f55dd50f485b995641f71");
  EXPECT_EQ(typeOf<derived_object_msgs::ObjectArray>(),
            "derived_object_msgs/ObjectArray 492c83cd255b9a57845d0c197d7977be");
}

/// A car that heads along `heading` and moves with a velocity in frame map.
Object carAt(double heading, double vx, double vy) {
  Object object;
  object.classification = Object::CLASSIFICATION_CAR;
  object.pose.position.x = 10.0;
  object.pose.position.y = 20.0;
  object.pose.position.z = 3.0;
  object.pose.orientation.z = std::sin(0.5 * heading);
  object.pose.orientation.w = std::cos(0.5 * heading);
  object.twist.linear.x = vx;
  object.twist.linear.y = vy;
  object.shape.type = shape_msgs::SolidPrimitive::BOX;
  object.shape.dimensions = {4.0, 2.0, 1.5};
  return object;
}

TEST(CarlaVehicle, IsMovedByTheOffsetAndDrivesAlongItsHeading) {
  const auto vehicle = carlaVehicle(carAt(0.5 * kPi, 1.0, 7.0), {100.0, -5.0});
  ASSERT_TRUE(vehicle);
  EXPECT_NEAR(vehicle->state.position.x(), 110.0, 1e-12);
  EXPECT_NEAR(vehicle->state.position.y(), 15.0, 1e-12);
  EXPECT_NEAR(vehicle->state.elevation, 3.0, 1e-12);
  EXPECT_NEAR(vehicle->state.heading, 0.5 * kPi, 1e-9);
  EXPECT_NEAR(vehicle->state.speed, 7.0, 1e-9);  // the part along +y
  EXPECT_EQ(vehicle->dimensions.length, 4.0);
  EXPECT_EQ(vehicle->dimensions.width, 2.0);
  EXPECT_EQ(vehicle->dimensions.height, 1.5);
}

TEST(CarlaVehicle, BackwardIsNoSpeed) {
  EXPECT_EQ(carlaVehicle(carAt(0.0, -2.0, 0.0), {0.0, 0.0})->state.speed, 0.0);
}

TEST(CarlaVehicle, WalkersAndWhatHasNoBoxAreNone) {
  Object walker = carAt(0.0, 1.0, 0.0);
  walker.classification = Object::CLASSIFICATION_PEDESTRIAN;
  EXPECT_FALSE(carlaVehicle(walker, {0.0, 0.0}));
  Object flat = carAt(0.0, 1.0, 0.0);
  flat.shape.dimensions.clear();
  EXPECT_FALSE(carlaVehicle(flat, {0.0, 0.0}));
}

TEST(CarlaControl, SteersTheOtherWay) {
  const auto control = carlaControl({0.25, 0.5, 0.0}, ros::Time(3.5));
  EXPECT_EQ(control.throttle, 0.25F);
  EXPECT_EQ(control.steer, -0.5F);
  EXPECT_EQ(control.brake, 0.0F);
  EXPECT_EQ(control.header.stamp, ros::Time(3.5));
  EXPECT_EQ(carlaAction(control), (traffic::ControlAction{0.25, 0.5, 0.0}));
}

nav_msgs::Path pathOf(std::size_t places) {
  nav_msgs::Path path;
  for (std::size_t i = 0; i < places; ++i) {
    path.poses.emplace_back();
    path.poses.back().pose.position.x = static_cast<double>(i);
  }
  return path;
}

// Places every meter from 0 to 25: the first, those at 10 and 20, the last.
TEST(CarlaRoute, KeepsAPointEveryTenMetersAndTheEnds) {
  const auto points = carlaRoute(pathOf(26), {1.0, 2.0}, "/route");
  ASSERT_EQ(points.size(), 4U);
  const double x[] = {1.0, 11.0, 21.0, 26.0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].x(), x[i]);
    EXPECT_EQ(points[i].y(), 2.0);
  }
}

TEST(CarlaRoute, OfOnePlaceIsRefused) {
  EXPECT_THROW(carlaRoute(pathOf(1), {0.0, 0.0}, "/route"), core::InputError);
}

sensor_msgs::Image imageOf(std::uint32_t width, const std::string& encoding) {
  sensor_msgs::Image image;
  image.width = width;
  image.height = 1;
  image.encoding = encoding;
  image.step = 4 * width;
  for (std::uint32_t i = 0; i < width; ++i) {
    for (const std::uint8_t channel : {1, 2, 3, 255}) image.data.push_back(channel);
  }
  return image;
}

TEST(CarlaImage, BecomesRgb) {
  rendering::RigCamera camera;
  camera.width = 2;
  camera.height = 1;
  const traffic::CameraImage image = carlaImage(imageOf(2, "bgra8"), "/image", camera, 7);
  EXPECT_EQ(image.rgb, (std::vector<std::uint8_t>{3, 2, 1, 3, 2, 1}));
  EXPECT_EQ(image.tick, 7U);
  EXPECT_THROW(carlaImage(imageOf(3, "bgra8"), "/image", camera, 7), core::InputError);
  EXPECT_THROW(carlaImage(imageOf(2, "mono8"), "/image", camera, 7), core::InputError);
  sensor_msgs::Image cut = imageOf(2, "bgra8");
  cut.data.pop_back();
  EXPECT_THROW(carlaImage(cut, "/image", camera, 7), core::InputError);
}

TEST(CarlaRoles, NameTheVehiclesOfASession) {
  const CarlaRoles roles{"hero", {"hero1", "hero2"}};
  roles.validate();
  EXPECT_EQ(roles.idOf(5, "hero"), "ego");
  EXPECT_EQ(roles.idOf(6, "hero2"), "hero2");
  EXPECT_EQ(roles.idOf(7, "autopilot"), "carla_7");
  EXPECT_THROW((CarlaRoles{"hero", {}}.validate()), core::InputError);
  EXPECT_THROW((CarlaRoles{"hero", {"hero"}}.validate()), core::InputError);
  EXPECT_THROW((CarlaRoles{"hero", {"a b"}}.validate()), core::InputError);
}

}  // namespace
}  // namespace cdiff::node_graph
