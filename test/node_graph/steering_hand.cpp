// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Steers a running session by its services, as a user's panel would:
//     steering_hand FOUND RESULTS
// Once there is a CBV it pauses the session, steps, steers, and lets it go on; what the services
// answered is written to the file FOUND, a line each. Ends when the session's exit code is in
// RESULTS.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/DeleteEntity.h"
#include "e2e_cdiff/GetEntitiesStates.h"
#include "e2e_cdiff/GetEntityState.h"
#include "e2e_cdiff/GetSimulationState.h"
#include "e2e_cdiff/ResetSimulation.h"
#include "e2e_cdiff/SetSimulationState.h"
#include "e2e_cdiff/SpawnEntity.h"
#include "e2e_cdiff/SteerSession.h"
#include "e2e_cdiff/StepSimulation.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "nav_msgs/Odometry.h"
#include "ros/ros.h"

namespace {

namespace msgs = e2e_cdiff;

/// Calls a service; the code of its result, -1 where it does not answer.
template <class Service>
int call(const std::string& name, Service& service) {
  if (!ros::service::call(name, service)) return -1;
  if (!service.response.result.error_message.empty())
    ROS_INFO("%s: %s", name.c_str(), service.response.result.error_message.c_str());
  return service.response.result.result;
}

int setState(std::uint8_t state) {
  msgs::SetSimulationState service;
  service.request.state.state = state;
  return call("/set_simulation_state", service);
}

int step(std::uint64_t steps) {
  msgs::StepSimulation service;
  service.request.steps = steps;
  return call("/step_simulation", service);
}

int steer(const std::string& what, const std::string& value) {
  msgs::SteerSession service;
  service.request.what = what;
  service.request.value = value;
  return call("/steer", service);
}

/// By dynamic_reconfigure's own client; its exit code.
int tune(const std::string& name, const std::string& value) {
  return std::system(("/usr/bin/python3 /usr/lib/dynamic_reconfigure/dynparam set "
                      "/traffic_simulator_node " +
                      name + " " + value)
                         .c_str());
}

/// As a slider does, by the same client: 100 values in a row, and at last one that is no number;
/// the program's exit code.
int slide() {
  return std::system(
      "/usr/bin/python3 -c '\n"
      "import rospy\n"
      "from dynamic_reconfigure.client import Client\n"
      "rospy.init_node(\"slider\")\n"
      "client = Client(\"/traffic_simulator_node\", timeout=20)\n"
      "for i in range(1, 101): now = client.update_configuration({\"speed_weight\": 0.01 * i})\n"
      "now = client.update_configuration({\"speed_weight\": float(\"nan\")})\n"
      "exit(0 if now[\"speed_weight\"] == 1.0 else 1)'");
}

/// Two clients at once; the smaller answer first.
template <class Call>
std::pair<int, int> together(const Call& call) {
  std::future<int> other = std::async(std::launch::async, call);
  const int one = call();
  return std::minmax({one, other.get()});
}

int remove(const std::string& id) {
  msgs::DeleteEntity service;
  service.request.entity = id;
  return call("/delete_entity", service);
}

/// Tick of the newest snapshot.
long tickNow() {
  msgs::GetEntityState service;
  service.request.entity = "ego";
  call("/get_entity_state", service);
  return std::lround(service.response.state.header.stamp.toSec() / 0.05);
}

/// A second ego where the first one is.
int spawnOnEgo() {
  msgs::GetEntityState where;
  where.request.entity = "ego";
  call("/get_entity_state", where);
  msgs::SpawnEntity service;
  service.request.name = "ego";
  service.request.initial_pose.pose = where.response.state.pose;
  return call("/spawn_entity", service);
}

class Hand {
 public:
  explicit Hand(const std::string& found) : found_(found) {
    const boost::function<void(const msgs::TrafficSnapshot::ConstPtr&)> look =
        [this](const auto& snapshot) { newest_ = snapshot; };
    traffic_ = node_.subscribe<msgs::TrafficSnapshot>("/traffic", 10, look);
    const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> follow =
        [this](const auto& odometry) { odometry_ = odometry; };
    cbv_odometry_ = node_.subscribe<nav_msgs::Odometry>("/cbv_0/odometry", 10, follow);
  }

  bool waitForCbv() {
    for (int i = 0; i < 6000 && ros::ok(); ++i) {
      ros::spinOnce();
      if (!idOf(msgs::Vehicle::CBV).empty()) return true;
      ros::WallDuration(0.01).sleep();
    }
    return false;
  }

  void steerSession() {
    using Code = msgs::SimulationState;
    const auto [first, second] = together([] { return setState(Code::STATE_PAUSED); });
    note("pause", first);
    note("pause by another client", second);
    note("pause again", setState(Code::STATE_PAUSED));
    note("no step", step(0));
    note("too many steps", step(1000000000));
    note("step", step(1));
    const long before = tickNow();
    note("steps", step(5));
    note("ticks of 5 steps", static_cast<int>(tickNow() - before));
    note("odometry of the CBV", odometryCame() ? 1 : 0);
    note("profile", steer("profile", "safety_critical"));
    const auto [one, other] = together([] { return steer("weight.collision_seeking", "20"); });
    note("weight", one);
    note("weight by another client", other);
    note("weight by dynparam", tune("traffic_avoidance_weight", "3"));
    note("too large by dynparam", tune("speed_weight", "2000"));
    note("slider", slide());
    note("weight out of range", steer("weight.speed", "2000"));
    note("weight that is no number", steer("weight.speed", "nan"));
    note("unknown vehicle", steer("choose", "nobody"));
    note("target speed", steer("target_speed", "10"));
    note("remove", remove(nearestOfTraffic()));
    note("remove nobody", remove("nobody"));
    note("spawn on the ego", spawnOnEgo());
    msgs::ResetSimulation reset;
    note("reset", call("/reset_simulation", reset));
    note("steps with what was steered", step(2));
    note("resume", setState(Code::STATE_PLAYING));
    note("step while running", step(1));
    note("pace", steer("pace", "0"));
  }

 private:
  /// Whether the CBV of slot 0 has told where it is in the newest snapshot; the session is paused.
  bool odometryCame() {
    for (int i = 0; i < 1000 && ros::ok(); ++i) {
      ros::spinOnce();
      for (const msgs::Vehicle& vehicle : newest_->vehicles) {
        if (vehicle.role == msgs::Vehicle::CBV && vehicle.cbv_slot == 0 && odometry_ &&
            odometry_->header.stamp == newest_->header.stamp)
          return odometry_->child_frame_id == vehicle.id + "/base_link" &&
                 odometry_->pose.pose.position.x == vehicle.state.x;
      }
      ros::WallDuration(0.01).sleep();
    }
    return false;
  }
  std::string idOf(std::uint8_t role) const {
    if (!newest_) return "";
    for (const msgs::Vehicle& vehicle : newest_->vehicles) {
      if (vehicle.role == role) return vehicle.id;
    }
    return "";
  }
  /// The background vehicle nearest to the ego, of those of the newest tick.
  std::string nearestOfTraffic() const {
    msgs::GetEntitiesStates service;
    call("/get_entities_states", service);
    std::string nearest;
    double least = 1e9;
    for (const msgs::Vehicle& vehicle : newest_->vehicles) {
      if (vehicle.role != msgs::Vehicle::BACKGROUND) continue;
      const auto& there = service.response.entities;
      if (std::find(there.begin(), there.end(), vehicle.id) == there.end()) continue;
      const msgs::VehicleState& ego = newest_->vehicles.front().state;
      const double apart = std::hypot(vehicle.state.x - ego.x, vehicle.state.y - ego.y);
      if (apart >= least) continue;
      least = apart;
      nearest = vehicle.id;
    }
    return nearest;
  }
  void note(const std::string& what, int answer) { found_ << what << " " << answer << std::endl; }

  ros::NodeHandle node_;
  std::ofstream found_;
  ros::Subscriber traffic_;
  ros::Subscriber cbv_odometry_;
  msgs::TrafficSnapshot::ConstPtr newest_;
  nav_msgs::Odometry::ConstPtr odometry_;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "steering_hand");
  if (argc < 3) return 3;
  Hand hand(argv[1]);
  if (ros::service::waitForService("/set_simulation_state", 60000) && hand.waitForCbv())
    hand.steerSession();
  for (int i = 0; i < 700 && !std::filesystem::exists(std::string(argv[2]) + "/exit_code"); ++i)
    ros::WallDuration(0.1).sleep();
}
