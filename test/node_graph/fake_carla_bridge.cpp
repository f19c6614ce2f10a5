// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// CARLA and its ROS bridge in synchronous mode as far as a session notices: a left-handed world of
// an ego, three vehicles that can be controlled and one that cannot; a cycle that publishes a frame
// and waits at most 1 s for one command of each; a second command makes the next frame wait for
// none. Private parameters: frames, report (file), controlled (role names), ego_commanded,
// image_delay (frames by which the stamps of images are too old), commander (only disturbs: sends
// commands to hero1).
#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "carla_msgs/CarlaActorList.h"
#include "carla_msgs/CarlaEgoVehicleControl.h"
#include "carla_msgs/CarlaEgoVehicleStatus.h"
#include "carla_msgs/CarlaStatus.h"
#include "carla_msgs/CarlaWorldInfo.h"
#include "core/text.h"
#include "derived_object_msgs/ObjectArray.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "exchange/opendrive_network.h"
#include "map/route_source.h"
#include "nav_msgs/Path.h"
#include "ros/callback_queue.h"
#include "ros/ros.h"
#include "rosgraph_msgs/Clock.h"
#include "sensor_msgs/Image.h"
#include "std_msgs/Bool.h"

namespace cdiff {
namespace {

using Clock = std::chrono::steady_clock;
using carla_msgs::CarlaEgoVehicleControl;

constexpr double kStep = 0.05;  // [s]
constexpr double kPi = 3.14159265358979;
constexpr std::uint32_t kFirstActor = 100;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A vehicle in CARLA's world: y to the right, degrees clockwise.
struct Actor {
  std::string role;
  map::Route route;         ///< of its autopilot
  double arc_length = 0.0;  ///< on it [m]
  double cruise = 0.0;      ///< speed of its autopilot [m/s]
  double x = 0.0, y = 0.0, yaw = 0.0, speed = 0.0;
  bool autopilot = true;
  CarlaEgoVehicleControl control;

  traffic::VehicleState state() const { return {{x, -y}, 0.0, -yaw * kPi / 180.0, speed}; }
  void place(const traffic::VehicleState& state) {
    x = state.position.x();
    y = -state.position.y();
    yaw = -state.heading * 180.0 / kPi;
    speed = state.speed;
  }
  void move() {
    if (autopilot) {
      arc_length = std::min(arc_length + cruise * kStep, route.path().length());
      place({route.path().pointAt(arc_length).head<2>(), 0.0, route.path().headingAt(arc_length),
             cruise});
      return;
    }
    place(dynamics::BicycleModel().step(
        state(), {control.throttle, -static_cast<double>(control.steer), control.brake}, kStep));
    arc_length = route.path().project(state().position, 0.0, route.path().length()).arc_length;
  }
};

struct Plan {
  const char* role;
  std::vector<std::string> edges;
  double start;   ///< on the route [m]
  double cruise;  ///< [m/s]
};

/// Each of the heroes meets the ego at one of the crossings of its street.
std::vector<Plan> plans() {
  return {{"hero", {"w2_a2", "a2_b2", "b2_c2", "c2_e2"}, 60.0, 6.5},
          {"hero1", {"sb_b1", "b1_b2", "b2_b3", "b3_nb"}, 59.0, 6.0},
          {"hero2", {"sc_c1", "c1_c2", "c2_c3"}, 28.0, 4.0},
          {"hero3", {"na_a3", "a3_a2", "a2_a1"}, 165.0, 6.5},
          {"autopilot", {"e2_c2", "c2_b2", "b2_a2", "a2_w2"}, 5.0, 7.0}};
}

class Bridge {
 public:
  Bridge();
  void run(int frames);
  nlohmann::json report() const;

 private:
  template <class Message>
  ros::Publisher advertise(const std::string& topic, bool latch = false) {
    return node_.advertise<Message>(topic, 10, latch);
  }
  void addActor(const Plan& plan, const map::LaneGraph& graph, bool controlled);
  void publishStart(const map::ImportedNetwork& network);
  void take(const std::string& role, const CarlaEgoVehicleControl& control);
  void publishFrame();
  void publishActor(std::size_t index, derived_object_msgs::ObjectArray& objects);
  void publishImage(const std::string& role);
  void waitForCommands();

  ros::NodeHandle node_;
  std::vector<Actor> actors_;
  std::vector<ros::Subscriber> inputs_;
  std::map<std::string, ros::Publisher> states_, images_;  ///< by role
  ros::Publisher clock_, status_, world_, list_, objects_, path_;
  bool ego_commanded_ = false;
  int image_delay_ = 0;
  std::uint64_t frame_ = 1000;
  std::set<std::string> awaited_;
  bool received_ = false;  ///< the event that ends a cycle's waiting
  Clock::time_point published_;
  std::map<ros::Time, std::map<std::string, int>> counts_;  ///< commands by stamp and role
  std::vector<double> latencies_;                           ///< to the last command [ms]
  int unexpected_ = 0, timeouts_ = 0;
};

Bridge::Bridge() {
  const ros::NodeHandle parameters("~");
  std::string controlled = "hero hero1 hero2 hero3";
  parameters.getParam("controlled", controlled);
  parameters.getParam("ego_commanded", ego_commanded_);
  parameters.getParam("image_delay", image_delay_);
  const std::vector<std::string> roles = core::splitText(controlled, ' ');
  const map::ImportedNetwork network = map::importNetwork("crossing_district");
  const map::RoadNetwork roads = map::RoadNetwork::fromText(network.text, "crossing_district");
  const map::LaneGraph graph(roads);
  clock_ = advertise<rosgraph_msgs::Clock>("/clock");
  status_ = advertise<carla_msgs::CarlaStatus>("/carla/status");
  world_ = advertise<carla_msgs::CarlaWorldInfo>("/carla/world_info", true);
  list_ = advertise<carla_msgs::CarlaActorList>("/carla/actor_list", true);
  objects_ = advertise<derived_object_msgs::ObjectArray>("/carla/objects");
  path_ = advertise<nav_msgs::Path>("/carla/hero/waypoints", true);
  for (const Plan& plan : plans())
    addActor(plan, graph, std::find(roles.begin(), roles.end(), plan.role) != roles.end());
  publishStart(network);
}

void Bridge::addActor(const Plan& plan, const map::LaneGraph& graph, bool controlled) {
  const std::string role = plan.role;
  Actor actor;
  actor.role = role;
  actor.route = map::routeAlongEdges(graph, plan.edges, 5.0, 5.0);
  actor.arc_length = plan.start;
  actor.cruise = plan.cruise;
  actor.move();
  actor.autopilot = role != "hero" || !ego_commanded_;
  actors_.push_back(actor);
  if (!controlled) return;
  const std::string prefix = "/carla/" + role + "/";
  states_[role] = advertise<carla_msgs::CarlaEgoVehicleStatus>(prefix + "vehicle_status");
  images_[role] = advertise<sensor_msgs::Image>(prefix + "rgb_front/image");
  inputs_.push_back(node_.subscribe<CarlaEgoVehicleControl>(
      prefix + "vehicle_control_cmd", 10,
      [this, role](const CarlaEgoVehicleControl::ConstPtr& control) { take(role, *control); }, {},
      ros::TransportHints().tcpNoDelay()));
  inputs_.push_back(node_.subscribe<std_msgs::Bool>(
      prefix + "enable_autopilot", 10, [this, role](const std_msgs::Bool::ConstPtr& enable) {
        for (Actor& one : actors_) {
          if (one.role == role) one.autopilot = enable->data != 0;
        }
      }));
}

void Bridge::publishStart(const map::ImportedNetwork& network) {
  carla_msgs::CarlaWorldInfo world;
  world.map_name = "Carla/Maps/crossing_district";
  world.opendrive = exchange::openDriveOf(network).text;
  world_.publish(world);
  carla_msgs::CarlaActorList list;
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    list.actors.emplace_back();
    list.actors.back().id = kFirstActor + static_cast<std::uint32_t>(i);
    list.actors.back().rolename = actors_[i].role;
  }
  list_.publish(list);
  nav_msgs::Path path;
  const geometry::Polyline& ego = actors_.front().route.path();
  for (double s = actors_.front().arc_length; s < ego.length(); s += 1.0) {
    path.poses.emplace_back();  // with empty headers, as the bridge does
    path.poses.back().pose.position.x = ego.pointAt(s).x();
    path.poses.back().pose.position.y = ego.pointAt(s).y();
  }
  path_.publish(path);
}

/// As the bridge: a command is applied at once, one that nothing waits for ends the next waiting.
void Bridge::take(const std::string& role, const CarlaEgoVehicleControl& control) {
  for (Actor& actor : actors_) {
    if (actor.role == role) actor.control = control;
  }
  ++counts_[control.header.stamp][role];
  if (awaited_.erase(role) == 0) ++unexpected_;
  if (awaited_.empty()) received_ = true;
}

void Bridge::publishActor(std::size_t index, derived_object_msgs::ObjectArray& objects) {
  const Actor& actor = actors_[index];
  const traffic::VehicleState state = actor.state();  // y turned, as the bridge does
  derived_object_msgs::Object object;
  object.header = objects.header;
  object.id = kFirstActor + static_cast<std::uint32_t>(index);
  object.classification = derived_object_msgs::Object::CLASSIFICATION_CAR;
  object.pose.position.x = state.position.x();
  object.pose.position.y = state.position.y();
  object.pose.orientation.z = std::sin(0.5 * state.heading);
  object.pose.orientation.w = std::cos(0.5 * state.heading);
  object.twist.linear.x = state.velocity().x();
  object.twist.linear.y = state.velocity().y();
  object.shape.type = shape_msgs::SolidPrimitive::BOX;
  object.shape.dimensions = {4.5, 1.8, 1.5};
  objects.objects.push_back(object);
  if (states_.count(actor.role) == 0) return;
  carla_msgs::CarlaEgoVehicleStatus status;
  status.header = objects.header;
  status.velocity = static_cast<float>(actor.speed);
  status.control = actor.control;
  states_.at(actor.role).publish(status);
}

/// One color, another one in each frame: what the image shows is of no interest here.
void Bridge::publishImage(const std::string& role) {
  constexpr int kWidth = 160, kHeight = 96, kBytes = 4;
  sensor_msgs::Image image;
  image.header.stamp = ros::Time(kStep * static_cast<double>(frame_ - image_delay_));
  image.header.frame_id = role + "/rgb_front";
  image.width = kWidth;
  image.height = kHeight;
  image.step = kBytes * kWidth;
  image.encoding = "bgra8";
  image.data.assign(std::size_t{kBytes} * kWidth * kHeight, static_cast<std::uint8_t>(frame_));
  images_.at(role).publish(image);
}

void Bridge::publishFrame() {
  ++frame_;
  rosgraph_msgs::Clock clock;
  clock.clock = ros::Time(kStep * static_cast<double>(frame_));
  carla_msgs::CarlaStatus status;
  status.frame = frame_;
  status.fixed_delta_seconds = static_cast<float>(kStep);
  status.synchronous_mode = status.synchronous_mode_running = 1;
  derived_object_msgs::ObjectArray objects;
  objects.header.stamp = clock.clock;
  objects.header.frame_id = "map";
  status_.publish(status);
  clock_.publish(clock);
  for (std::size_t i = 0; i < actors_.size(); ++i) publishActor(i, objects);
  published_ = Clock::now();
  objects_.publish(objects);
  for (const auto& [role, publisher] : images_) publishImage(role);
}

/// Before the first commands somebody may still start; later only what hangs takes long.
void Bridge::waitForCommands() {
  const double patience = counts_.empty() ? 1.0 : 5.0;  // [s] of wall time
  while (ros::ok() && !received_ && secondsSince(published_) < patience)
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  if (!received_) ++timeouts_;
  if (awaited_.empty()) latencies_.push_back(1e3 * secondsSince(published_));
  received_ = false;
}

void Bridge::run(int frames) {
  for (int i = 0; ros::ok() && i < frames; ++i) {
    awaited_.clear();
    for (const auto& [role, publisher] : states_) {
      if (role != "hero" || ego_commanded_) awaited_.insert(role);
    }
    for (Actor& actor : actors_) actor.move();
    publishFrame();
    waitForCommands();
  }
}

/// Of the frames from the first that was commanded to the last but one.
nlohmann::json Bridge::report() const {
  nlohmann::json report = {{"frames", frame_ - 1000},
                           {"timeouts", timeouts_},
                           {"unexpected", unexpected_},
                           {"commanded", counts_.size()}};
  const std::size_t vehicles = states_.size() - (ego_commanded_ ? 0 : 1);
  int least = 1000, most = 0;
  for (const auto& [stamp, roles] : counts_) {
    if (roles.size() < vehicles) least = 0;
    for (const auto& [role, count] : roles) {
      least = std::min(least, count);
      most = std::max(most, count);
    }
  }
  report["least_commands"] = least;
  report["most_commands"] = most;
  std::vector<double> sorted = latencies_;
  std::sort(sorted.begin(), sorted.end());
  if (!sorted.empty()) report["latency_p95_ms"] = sorted[sorted.size() * 95 / 100];
  if (!counts_.empty()) {
    const double span = (counts_.rbegin()->first - counts_.begin()->first).toSec();
    report["frames_between"] = std::lround(span / kStep) + 1;
  }
  return report;
}

/// Another node that commands hero1.
void disturb() {
  ros::NodeHandle node;
  const ros::Publisher commands =
      node.advertise<CarlaEgoVehicleControl>("/carla/hero1/vehicle_control_cmd", 1);
  while (ros::ok()) {
    commands.publish(CarlaEgoVehicleControl());
    ros::WallDuration(0.2).sleep();
  }
}

}  // namespace
}  // namespace cdiff

int main(int argc, char** argv) {
  ros::init(argc, argv, "carla_ros_bridge");
  const ros::NodeHandle parameters("~");
  if (parameters.param("commander", false)) {
    cdiff::disturb();
    return 0;
  }
  cdiff::Bridge bridge;
  bridge.run(parameters.param("frames", 100));
  std::ofstream(parameters.param("report", std::string())) << bridge.report().dump() << "\n";
  return 0;
}
