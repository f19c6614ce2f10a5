// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session_client.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "dynamic_reconfigure/Reconfigure.h"
#include "e2e_cdiff/GetSimulationState.h"
#include "e2e_cdiff/SetSimulationState.h"
#include "e2e_cdiff/SteerSession.h"
#include "e2e_cdiff/StepSimulation.h"

namespace cdiff::rviz_panel {
namespace {

namespace msgs = ::e2e_cdiff;
using State = SessionFigures::State;

constexpr std::size_t kWorkers = 2;       // so that a long step does not hold up a pause
constexpr double kAskEvery = 0.5;         // [s] of wall time
constexpr std::size_t kMostFaults = 100;  // that are kept
constexpr std::uint32_t kQueueSize = 10;
constexpr const char* kRunning = "running";
constexpr const char* kSimulator = "traffic_simulator_node/";

std::string numberText(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

/// Calls a service with a result; empty when it did what it says, else why not.
template <class Service>
std::string callService(const std::string& name, Service& service) {
  if (!ros::service::call(name, service)) return name + " does not answer: no session is running";
  const msgs::Result& result = service.response.result;
  if (result.result == msgs::Result::RESULT_OK) return "";
  return result.error_message.empty() ? name + " refused it" : result.error_message;
}

std::string statusText(std::uint8_t status) {
  const char* const texts[] = {kRunning,    "completed", "blocked",     "deviated",
                               "timed out", "collided",  "interrupted", "error"};
  return status < std::size(texts) ? texts[status] : "unknown";
}

const msgs::Measure* find(const msgs::MetricReport& report, const std::string& name) {
  const auto found = std::find_if(report.measures.begin(), report.measures.end(),
                                  [&](const auto& measure) { return measure.name == name; });
  return found == report.measures.end() || !found->defined ? nullptr : &*found;
}

}  // namespace

SessionClient::SessionClient(const ros::NodeHandle& node) : node_(node) {
  node_.setCallbackQueue(&queue_);
  listen();
  asking_ = node_.createWallTimer(ros::WallDuration(kAskEvery),
                                  [this](const ros::WallTimerEvent&) { askState(); });
  for (std::size_t i = 0; i < kWorkers; ++i) workers_.emplace_back([this] { work(); });
  spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
  spinner_->start();
}

SessionClient::~SessionClient() {
  spinner_->stop();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
    requests_.clear();
  }
  wanted_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void SessionClient::listen() {
  const auto to = [this](auto message, const std::string& topic) {
    using Message = decltype(message);
    const boost::function<void(const boost::shared_ptr<const Message>&)> callback =
        [this](const boost::shared_ptr<const Message>& received) { take(*received); };
    inputs_.push_back(node_.subscribe<Message>(topic, kQueueSize, callback));
  };
  to(msgs::CbvSelection(), "cbv/selection");
  to(msgs::MetricReport(), "metrics");
  to(dynamic_reconfigure::ConfigDescription(), std::string(kSimulator) + "parameter_descriptions");
  to(dynamic_reconfigure::Config(), std::string(kSimulator) + "parameter_updates");
  const boost::function<void(const msgs::TrafficSnapshot::ConstPtr&)> take_traffic =
      [this](const msgs::TrafficSnapshot::ConstPtr& snapshot) {
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          newest_ = snapshot;
        }
        take(*snapshot);
      };
  inputs_.push_back(node_.subscribe<msgs::TrafficSnapshot>("traffic", kQueueSize, take_traffic));
  const boost::function<void(const geometry_msgs::PointStamped::ConstPtr&)> take_point =
      [this](const geometry_msgs::PointStamped::ConstPtr& point) {
        chooseAt(point->point.x, point->point.y);
      };
  inputs_.push_back(
      node_.subscribe<geometry_msgs::PointStamped>("/clicked_point", kQueueSize, take_point));
}

void SessionClient::listenToSlot(int slot) {
  const std::string prefix = "cbv_" + std::to_string(slot) + "/";
  const boost::function<void(const std_msgs::Float64::ConstPtr&)> take_ttc =
      [this, slot](const std_msgs::Float64::ConstPtr& time) {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto found = figures_.slots.find(slot);
        if (found != figures_.slots.end()) found->second.ttc = time->data;
      };
  const boost::function<void(const msgs::ControlAction::ConstPtr&)> take_control =
      [this](const msgs::ControlAction::ConstPtr& control) {
        const std::lock_guard<std::mutex> lock(mutex_);
        figures_.latency_ms = control->planner_latency_ms;
      };
  slot_inputs_[slot] = {
      node_.subscribe<std_msgs::Float64>(prefix + "ttc", kQueueSize, take_ttc),
      node_.subscribe<msgs::ControlAction>(prefix + "control", kQueueSize, take_control)};
}

void SessionClient::request(Request request) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto same = std::find_if(requests_.begin(), requests_.end(), [&](const Request& other) {
      return other.subject == request.subject;
    });
    if (same != requests_.end()) requests_.erase(same);
    requests_.push_back(std::move(request));
  }
  wanted_.notify_one();
}

void SessionClient::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  // Of one subject only one is called at a time, so that the newest comes last.
  const auto next = [this] {
    return std::find_if(requests_.begin(), requests_.end(), [this](const Request& request) {
      return busy_.count(request.subject) == 0;
    });
  };
  while (true) {
    wanted_.wait(lock, [&] { return ends_ || next() != requests_.end(); });
    if (ends_) return;
    const auto found = next();
    const Request request = std::move(*found);
    requests_.erase(found);
    busy_.insert(request.subject);
    lock.unlock();
    const std::string refusal = request.call();
    lock.lock();
    busy_.erase(request.subject);
    wanted_.notify_all();
    if (request.quiet) continue;
    figures_.refused = !refusal.empty();
    figures_.answer = request.subject + ": " + (refusal.empty() ? "done" : refusal);
  }
}

void SessionClient::setState(std::uint8_t state, const std::string& subject) {
  request({subject, [this, state] {
             msgs::SetSimulationState service;
             service.request.state.state = state;
             const std::string refusal =
                 callService(node_.resolveName("set_simulation_state"), service);
             askState();
             return refusal;
           }});
}

void SessionClient::play() { setState(msgs::SimulationState::STATE_PLAYING, "play"); }

void SessionClient::pause() { setState(msgs::SimulationState::STATE_PAUSED, "pause"); }

void SessionClient::step(std::uint64_t ticks) {
  request({"step", [this, ticks] {
             msgs::StepSimulation service;
             service.request.steps = ticks;
             return callService(node_.resolveName("step_simulation"), service);
           }});
}

void SessionClient::setPace(double at_most) { steer("pace", numberText(at_most)); }

void SessionClient::steer(const std::string& what, const std::string& value) {
  request({what, [this, what, value] {
             msgs::SteerSession service;
             service.request.what = what;
             service.request.value = value;
             return callService(node_.resolveName("steer"), service);
           }});
}

void SessionClient::setParameter(const std::string& name, double value) {
  request({name, [this, name, value]() -> std::string {
             dynamic_reconfigure::Reconfigure service;
             service.request.config.doubles.resize(1);
             service.request.config.doubles[0].name = name;
             service.request.config.doubles[0].value = value;
             const std::string service_name =
                 node_.resolveName(std::string(kSimulator) + "set_parameters");
             if (!ros::service::call(service_name, service))
               return service_name + " does not answer: no session is running";
             for (const auto& parameter : service.response.config.doubles) {
               if (parameter.name == name && parameter.value == value) return "";
             }
             return "refused; it is as it was";
           }});
}

void SessionClient::chooseAt(double x, double y) {
  constexpr double kReach = 6.0;  // [m]
  msgs::TrafficSnapshot::ConstPtr snapshot;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    snapshot = newest_;
  }
  const msgs::Vehicle* nearest = nullptr;
  double least = kReach;
  for (const msgs::Vehicle& vehicle :
       snapshot ? snapshot->vehicles : std::vector<msgs::Vehicle>()) {
    const double distance = std::hypot(vehicle.state.x - x, vehicle.state.y - y);
    if (vehicle.role == msgs::Vehicle::EGO || distance >= least) continue;
    nearest = &vehicle;
    least = distance;
  }
  if (nearest != nullptr) return steer("choose", nearest->id);
  request({"choose", [] { return std::string("no vehicle within 6 m of the point"); }});
}

void SessionClient::askState() {
  request({"state",
           [this] {
             const State state = stateOfSession();
             const std::lock_guard<std::mutex> lock(mutex_);
             figures_.state = state;
             return std::string();
           },
           true});
}

State SessionClient::stateOfSession() const {
  const SessionFigures known = figures();
  if (known.connected && known.status != kRunning) return State::kOver;
  const std::string name = node_.resolveName("get_simulation_state");
  msgs::GetSimulationState service;
  if (!ros::service::exists(name, false) || !ros::service::call(name, service))
    return known.connected ? State::kOver : State::kUnknown;
  const std::uint8_t state = service.response.state.state;
  if (state == msgs::SimulationState::STATE_PAUSED) return State::kPaused;
  return state == msgs::SimulationState::STATE_PLAYING ? State::kPlaying : State::kOver;
}

void SessionClient::take(const msgs::TrafficSnapshot& snapshot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (snapshot.tick < figures_.tick) {  // another session
    const auto parameters = figures_.parameters;
    figures_ = SessionFigures();
    figures_.parameters = parameters;
  }
  figures_.connected = true;
  figures_.tick = snapshot.tick;
  figures_.time = snapshot.header.stamp.toSec();
  figures_.status = statusText(snapshot.status);
  figures_.vehicles.clear();
  for (const msgs::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != msgs::Vehicle::EGO) figures_.vehicles.push_back(vehicle.id);
  }
  for (const msgs::Fault& fault : snapshot.faults)
    figures_.faults.push_back("tick " + std::to_string(fault.tick) + ", " + fault.source + ": " +
                              fault.text);
  while (figures_.faults.size() > kMostFaults) figures_.faults.erase(figures_.faults.begin());
}

void SessionClient::take(const msgs::CbvSelection& selection) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::map<int, SessionSlot> slots;
  for (const msgs::CbvAssignment& assignment : selection.assignments) {
    SessionSlot& slot = slots[assignment.slot];
    const auto before = figures_.slots.find(assignment.slot);
    const bool same =
        before != figures_.slots.end() && before->second.vehicle_id == assignment.vehicle_id;
    if (same) slot.ttc = before->second.ttc;
    slot.vehicle_id = assignment.vehicle_id;
    slot.score = assignment.interaction_score;
    if (slot_inputs_.count(assignment.slot) == 0) listenToSlot(assignment.slot);
  }
  figures_.slots = slots;
}

void SessionClient::take(const msgs::MetricReport& report) {
  if (report.measures.empty()) return;
  std::ostringstream text;
  text.precision(3);
  text << "route " << std::lround(report.route_completion_percent) << " %";
  if (const msgs::Measure* contacts = find(report, "ego_collisions"))
    text << ", contacts of the ego: " << contacts->value;
  if (const msgs::Measure* at_fault = find(report, "ego_contacts_at_fault"))
    text << ", its fault: " << at_fault->value;
  if (const msgs::Measure* score = find(report, "ego_driving_score"))
    text << ", driving score " << score->value;
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.verdict = text.str();
}

void SessionClient::take(const dynamic_reconfigure::ConfigDescription& description) {
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.parameters.clear();
  for (const auto& parameter : description.dflt.doubles)
    figures_.parameters[parameter.name].value = parameter.value;
  for (const auto& parameter : description.min.doubles)
    figures_.parameters[parameter.name].minimum = parameter.value;
  for (const auto& parameter : description.max.doubles)
    figures_.parameters[parameter.name].maximum = parameter.value;
}

void SessionClient::take(const dynamic_reconfigure::Config& config) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& parameter : config.doubles) {
    const auto known = figures_.parameters.find(parameter.name);
    if (known != figures_.parameters.end()) known->second.value = parameter.value;
  }
}

SessionFigures SessionClient::figures() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return figures_;
}

}  // namespace cdiff::rviz_panel
