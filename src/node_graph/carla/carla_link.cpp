// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/carla/carla_link.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::node_graph {
namespace {

constexpr std::uint32_t kQueue = 100;  // messages
constexpr const char* kWorldTopic = "/carla/world_info";
constexpr const char* kStatusTopic = "/carla/status";
constexpr const char* kActorTopic = "/carla/actor_list";
constexpr const char* kObjectTopic = "/carla/objects";

std::string topicOf(const std::string& role, const std::string& name) {
  return "/carla/" + role + "/" + name;
}

ros::TransportHints atOnce() { return ros::TransportHints().tcpNoDelay(); }

}  // namespace

std::vector<std::string> CarlaRoles::all() const {
  std::vector<std::string> names = {ego};
  names.insert(names.end(), cbvs.begin(), cbvs.end());
  return names;
}

std::string CarlaRoles::idOf(std::uint32_t actor, const std::string& role) const {
  if (role == ego) return traffic::kEgoId;
  if (std::find(cbvs.begin(), cbvs.end(), role) != cbvs.end()) return role;
  return "carla_" + std::to_string(actor);
}

void CarlaRoles::validate() const {
  if (cbvs.empty())
    throw core::InputError(
        "parameter ~cbv_roles is empty; expected role names, as in 'hero1 hero2'");
  std::set<std::string> seen;
  for (const std::string& role : all()) {
    std::string error;
    if (role.empty() || role == traffic::kEgoId || !ros::names::validate("/" + role, error)) {
      throw core::InputError("role name '" + core::shortened(role) +
                             "'; expected letters, digits and '_', and not '" + traffic::kEgoId +
                             "'");
    }
    if (!seen.insert(role).second)
      throw core::InputError("role name '" + role + "' is given twice; expected each once");
  }
}

CarlaLink::CarlaLink(CarlaRoles roles, const std::string& route_topic, StopSignal& stop)
    : roles_(std::move(roles)),
      route_topic_(route_topic.empty() ? topicOf(roles_.ego, "waypoints") : route_topic),
      stop_(stop) {
  const auto listen = [this](const std::string& topic, auto& kept) {
    using Pointer = std::decay_t<decltype(kept)>;
    using Message = std::remove_const_t<typename Pointer::element_type>;
    inputs_.push_back(node_.subscribe<Message>(
        topic, kQueue, [&kept](const Pointer& message) { kept = message; }, {}, atOnce()));
  };
  listen(kWorldTopic, world_);
  listen(kStatusTopic, status_);
  listen(kActorTopic, actors_);
  listen(route_topic_, route_);
  inputs_.push_back(node_.subscribe<derived_object_msgs::ObjectArray>(
      kObjectTopic, kQueue,
      [this](const derived_object_msgs::ObjectArray::ConstPtr& objects) {
        if (CarlaFrame* frame = frameAt(objects->header.stamp)) frame->objects = objects;
      },
      {}, atOnce()));
  for (const std::string& role : roles_.all()) {
    listenToStates(role);
    commands_[role] = node_.advertise<Control>(topicOf(role, "vehicle_control_cmd"), kQueue);
    autopilots_[role] =
        node_.advertise<std_msgs::Bool>(topicOf(role, "enable_autopilot"), kQueue, true);
  }
}

void CarlaLink::listenToStates(const std::string& role) {
  inputs_.push_back(node_.subscribe<carla_msgs::CarlaEgoVehicleStatus>(
      topicOf(role, "vehicle_status"), kQueue,
      [this, role](const carla_msgs::CarlaEgoVehicleStatus::ConstPtr& state) {
        if (CarlaFrame* frame = frameAt(state->header.stamp)) frame->states[role] = state;
      },
      {}, atOnce()));
  const std::string topic = topicOf(role, "vehicle_control_manual_override");
  inputs_.push_back(node_.subscribe<std_msgs::Bool>(
      topic, kQueue, [this, role, topic](const std_msgs::Bool::ConstPtr& manual) {
        if (manual->data != 0)
          note("'" + role + "' ignores commands, which " + topic + " has asked for");
      }));
}

/// Names other nodes that command a vehicle that is ours.
void CarlaLink::watch(const std::string& role) {
  const std::string topic = topicOf(role, "vehicle_control_cmd");
  const boost::function<void(const ros::MessageEvent<const Control>&)> look =
      [this, topic](const ros::MessageEvent<const Control>& event) {
        const std::string& sender = event.getPublisherName();
        if (sender == nodeName()) return;
        note("node " + sender + " commands on " + topic +
             ", too; the bridge does not wait for the commands of the frame after");
      };
  inputs_.push_back(node_.subscribe<const ros::MessageEvent<const Control>&>(topic, kQueue, look));
}

bool CarlaLink::waitUntil(double seconds, const std::function<bool()>& done) {
  const auto begin = std::chrono::steady_clock::now();
  while (!done()) {
    const double left = seconds - secondsSince(begin);
    if (left <= 0.0 || stop_.raised()) return false;
    spin(std::min(left, kSpinPeriod));
  }
  return true;
}

std::string CarlaLink::silentTopics() const {
  std::vector<std::string> silent;
  if (!world_) silent.emplace_back(kWorldTopic);
  if (!status_) silent.emplace_back(kStatusTopic);
  if (!actors_) silent.emplace_back(kActorTopic);
  if (!route_) silent.emplace_back(route_topic_);
  return core::joinText(silent, ", ");
}

std::string CarlaLink::roleOf(std::uint32_t actor) const {
  for (const carla_msgs::CarlaActorInfo& info : actors_->actors) {
    if (info.id == actor) return info.rolename;
  }
  return {};
}

void CarlaLink::requireRoles() const {
  std::set<std::string> there;
  for (const carla_msgs::CarlaActorInfo& info : actors_->actors) {
    if (!info.rolename.empty()) there.insert(info.rolename);
  }
  for (const std::string& role : roles_.all()) {
    if (there.count(role) != 0) continue;
    throw core::InputError("no actor of CARLA has the role name '" + role + "'; there are " +
                           core::joinText({there.begin(), there.end()}, ", "));
  }
}

bool CarlaLink::listensToCommands() const {
  return std::all_of(commands_.begin(), commands_.end(),
                     [](const auto& entry) { return entry.second.getNumSubscribers() > 0; });
}

void CarlaLink::waitForBridge(double seconds) {
  const auto begin = std::chrono::steady_clock::now();
  const bool told = waitUntil(seconds, [this] { return silentTopics().empty(); });
  if (stop_.raised()) throw core::Interrupted("interrupted before CARLA's ROS bridge was there");
  if (!told) {
    throw core::SimulatorError("CARLA's ROS bridge: nothing came on " + silentTopics() +
                               " within " + core::formatNumber(seconds) + " s");
  }
  if (status_->synchronous_mode == 0)
    throw core::InputError("CARLA's ROS bridge has synchronous_mode false; expected true");
  requireRoles();
  waitUntil(seconds - secondsSince(begin), [this] { return listensToCommands(); });
  for (const auto& [role, publisher] : commands_) {
    if (publisher.getNumSubscribers() > 0) continue;
    throw core::InputError("nobody listens to " + publisher.getTopic() + "; expected '" + role +
                           "' among the bridge's ego_vehicle_role_name");
  }
  for (const std::string& role : roles_.cbvs) watch(role);
}

std::string CarlaLink::imageTopic(const std::string& role, const std::string& camera) {
  return topicOf(role, "rgb_" + camera + "/image");
}

void CarlaLink::listenToCameras(const std::vector<std::string>& ego,
                                const std::vector<std::string>& cbv) {
  for (const std::string& role : roles_.all()) {
    for (const std::string& camera : role == roles_.ego ? ego : cbv) {
      inputs_.push_back(node_.subscribe<sensor_msgs::Image>(
          imageTopic(role, camera), kQueue,
          [this, role, camera](const sensor_msgs::Image::ConstPtr& image) {
            if (image->header.stamp >= last_) images_[image->header.stamp][{role, camera}] = image;
          },
          {}, atOnce()));
    }
  }
}

/// Where what comes of a frame is kept; nullptr for a frame that has passed.
CarlaFrame* CarlaLink::frameAt(const ros::Time& stamp) {
  if (stamp <= last_) return nullptr;
  CarlaFrame& frame = frames_[stamp];
  frame.stamp = stamp;
  return &frame;
}

/// Whether the objects have come, and the states of all our vehicles among them.
bool CarlaLink::whole(const CarlaFrame& frame) const {
  if (!frame.objects) return false;
  const std::vector<std::string> roles = roles_.all();
  return std::all_of(frame.objects->objects.begin(), frame.objects->objects.end(),
                     [&](const auto& object) {
                       const std::string role = roleOf(object.id);
                       const bool ours = std::find(roles.begin(), roles.end(), role) != roles.end();
                       return !ours || frame.states.count(role) != 0;
                     });
}

void CarlaLink::forgetFrames() {
  spin(0.0);
  if (!frames_.empty()) last_ = frames_.rbegin()->first;
  frames_.clear();
  images_.clear();
}

std::optional<CarlaFrame> CarlaLink::nextFrame(double seconds) {
  auto next = frames_.end();
  waitUntil(seconds, [&] {
    next = std::find_if(frames_.begin(), frames_.end(),
                        [this](const auto& entry) { return whole(entry.second); });
    return next != frames_.end();
  });
  if (next == frames_.end()) return std::nullopt;
  CarlaFrame frame = next->second;
  last_ = frame.stamp;
  frames_.erase(frames_.begin(), std::next(next));
  images_.erase(images_.begin(), images_.lower_bound(last_));
  return frame;
}

bool CarlaLink::superseded() const {
  return std::any_of(frames_.begin(), frames_.end(),
                     [](const auto& entry) { return entry.second.objects != nullptr; });
}

sensor_msgs::Image::ConstPtr CarlaLink::waitForImage(const std::string& role,
                                                     const std::string& camera, double seconds) {
  waitUntil(seconds, [&] { return images_[last_].count({role, camera}) != 0; });
  const auto& images = images_[last_];
  const auto found = images.find({role, camera});
  return found == images.end() ? nullptr : found->second;
}

void CarlaLink::command(const std::string& role, const Control& control) {
  commands_.at(role).publish(control);
}

void CarlaLink::setAutopilot(const std::string& role, bool on) {
  std_msgs::Bool message;
  message.data = on;
  autopilots_.at(role).publish(message);
}

void CarlaLink::note(const std::string& fault) {
  if (noted_.insert(fault).second) faults_.push_back(fault);
}

std::vector<std::string> CarlaLink::takeFaults() { return std::exchange(faults_, {}); }

}  // namespace cdiff::node_graph
