// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "dynamic_reconfigure/Config.h"
#include "dynamic_reconfigure/ConfigDescription.h"
#include "dynamic_reconfigure/Reconfigure.h"
#include "node_graph/lockstep/hosted_nodes.h"
#include "session/session_control.h"

namespace cdiff::node_graph {

/// The weights of the CBVs' objectives and their target speed as dynamic parameters of the node, by
/// the service and topics of dynamic_reconfigure, so that its tools steer a session. Objectives are
/// known when the program runs only, so the description is made here and by no `.cfg` file.
class ReconfigureServer {
 public:
  /// References must outlive the object; the service is answered from `queue`.
  ReconfigureServer(session::SessionControl& control, const session::SessionSetup& setup,
                    ros::CallbackQueue& queue);
  ReconfigureServer(const ReconfigureServer&) = delete;
  ReconfigureServer& operator=(const ReconfigureServer&) = delete;

  /// Publishes the values again, which something else may have changed.
  void update();

 private:
  using Reconfigure = ::dynamic_reconfigure::Reconfigure;
  using Event = ros::ServiceEvent<Reconfigure::Request, Reconfigure::Response>;
  struct Parameter {
    std::string name;
    std::string what;  ///< that it steers
    std::string text;  ///< for people
    double minimum;
    double maximum;
  };
  void describe(const session::SessionSetup& setup);
  bool set(Event& event);
  ::dynamic_reconfigure::Config values() const;

  session::SessionControl& control_;
  double target_speed_;  ///< of the scenario [m/s]
  std::vector<Parameter> parameters_;
  ros::NodeHandle node_ = privateNodeHandle();
  ros::Publisher descriptions_;
  ros::Publisher updates_;
  ros::ServiceServer server_;
};

}  // namespace cdiff::node_graph
