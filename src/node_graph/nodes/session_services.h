// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "e2e_cdiff/DeleteEntity.h"
#include "e2e_cdiff/GetEntities.h"
#include "e2e_cdiff/GetEntitiesStates.h"
#include "e2e_cdiff/GetEntityState.h"
#include "e2e_cdiff/GetSimulationState.h"
#include "e2e_cdiff/GetSimulatorFeatures.h"
#include "e2e_cdiff/ResetSimulation.h"
#include "e2e_cdiff/SetEntityState.h"
#include "e2e_cdiff/SetSimulationState.h"
#include "e2e_cdiff/SpawnEntity.h"
#include "e2e_cdiff/SteerSession.h"
#include "e2e_cdiff/StepSimulation.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/nodes/reconfigure_server.h"
#include "ros/callback_queue.h"
#include "ros/ros.h"
#include "session/session_control.h"

namespace cdiff::node_graph {

/// The services of a session: those of simulation_interfaces 2.x by name and meaning, as far as
/// GetSimulatorFeatures lists them, `steer`, and dynamic parameters. Answered in threads of their
/// own, so that a call that waits for steps holds up neither the ticks nor another call; all that
/// they change goes through the session's control.
class SessionServices {
 public:
  /// Offers the services. References must outlive the object.
  SessionServices(session::SessionControl& control, const session::SessionSetup& setup);
  ~SessionServices();
  SessionServices(const SessionServices&) = delete;
  SessionServices& operator=(const SessionServices&) = delete;

  /// The newest tick.
  void show(const ::e2e_cdiff::TrafficSnapshot::ConstPtr& snapshot);

 private:
  using Snapshot = ::e2e_cdiff::TrafficSnapshot::ConstPtr;
  template <class Service>
  using Answer = void (SessionServices::*)(const typename Service::Request& request,
                                           typename Service::Response& response,
                                           const std::string& by);
  template <class Service>
  void offer(const std::string& name, Answer<Service> answer);
  Snapshot newest() const;
  std::string freeName(const std::string& wanted) const;

  void getState(const ::e2e_cdiff::GetSimulationState::Request& request,
                ::e2e_cdiff::GetSimulationState::Response& response, const std::string& by);
  void setState(const ::e2e_cdiff::SetSimulationState::Request& request,
                ::e2e_cdiff::SetSimulationState::Response& response, const std::string& by);
  void step(const ::e2e_cdiff::StepSimulation::Request& request,
            ::e2e_cdiff::StepSimulation::Response& response, const std::string& by);
  void reset(const ::e2e_cdiff::ResetSimulation::Request& request,
             ::e2e_cdiff::ResetSimulation::Response& response, const std::string& by);
  void spawn(const ::e2e_cdiff::SpawnEntity::Request& request,
             ::e2e_cdiff::SpawnEntity::Response& response, const std::string& by);
  void remove(const ::e2e_cdiff::DeleteEntity::Request& request,
              ::e2e_cdiff::DeleteEntity::Response& response, const std::string& by);
  void getEntities(const ::e2e_cdiff::GetEntities::Request& request,
                   ::e2e_cdiff::GetEntities::Response& response, const std::string& by);
  void getEntity(const ::e2e_cdiff::GetEntityState::Request& request,
                 ::e2e_cdiff::GetEntityState::Response& response, const std::string& by);
  void getStates(const ::e2e_cdiff::GetEntitiesStates::Request& request,
                 ::e2e_cdiff::GetEntitiesStates::Response& response, const std::string& by);
  void setEntity(const ::e2e_cdiff::SetEntityState::Request& request,
                 ::e2e_cdiff::SetEntityState::Response& response, const std::string& by);
  void getFeatures(const ::e2e_cdiff::GetSimulatorFeatures::Request& request,
                   ::e2e_cdiff::GetSimulatorFeatures::Response& response, const std::string& by);
  void steer(const ::e2e_cdiff::SteerSession::Request& request,
             ::e2e_cdiff::SteerSession::Response& response, const std::string& by);

  session::SessionControl& control_;
  const session::SessionSetup& setup_;
  mutable std::mutex mutex_;
  Snapshot newest_;
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ReconfigureServer reconfigure_;
  std::vector<ros::ServiceServer> servers_;
  std::unique_ptr<ros::AsyncSpinner> threads_;
};

}  // namespace cdiff::node_graph
