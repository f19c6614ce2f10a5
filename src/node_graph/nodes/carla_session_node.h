// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "node_graph/carla/carla_link.h"
#include "node_graph/carla/carla_world.h"
#include "node_graph/lockstep/image_inbox.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/parameters.h"
#include "page/result_writer.h"
#include "record/result_folder.h"
#include "session/closed_loop.h"

namespace cdiff::node_graph {

/// The node's name; it is a session on its own.
inline constexpr const char* kCarlaSessionNode = "carla_session_node";

/// A session that CARLA simulates, over its ROS bridge in synchronous mode: finds the critical
/// vehicles, drives them, measures and writes the result folder. What is no CBV at the moment is
/// left to CARLA's traffic manager.
class CarlaSessionNode {
 public:
  /// Throws InputError for parameters, and for a session that CARLA cannot run.
  CarlaSessionNode(const Parameters& parameters, StopSignal& stop);

  /// Runs the session to its end and returns the exit code. Throws as CarlaLink::waitForBridge
  /// does, InputError for a map or a route that cannot be driven, and Error where the session broke
  /// off, once CARLA drives its vehicles again and the exit code is written.
  int run();

 private:
  using Clock = std::chrono::steady_clock;
  struct Decision;
  void requireFitting(const session::ScenarioOptions& options) const;
  void setUp();
  void runTicks();
  /// False when the session came to its end instead.
  bool takeFrame(CarlaFrame& frame);
  /// Decides where the frame's tick is one of a decision; false as above.
  bool fill(session::TickRecord& record, Decision& decision);
  Decision decide();
  void ask(const session::LoopPlanner& asked, const std::string& name,
           const std::vector<planning::PlanningTask>& tasks, Decision& decision);
  void see(const planning::PlanningTask& task, Decision& decision);
  std::string roleOf(const planning::PlanningTask& task) const;
  void hold(const Decision& decision);
  void command(const CarlaFrame& frame);
  void handBack();
  int finish();

  StopSignal& stop_;
  Parameters parameters_;
  CarlaLink link_;
  double answer_timeout_;  ///< [s] of wall time
  double image_timeout_;   ///< [s] of wall time
  std::filesystem::path results_;
  std::unique_ptr<record::ResultFolder> folder_;
  std::unique_ptr<session::SessionSetup> setup_;
  std::unique_ptr<cbv::VehicleSelector> selector_;
  session::LoopPlanner ego_planner_;  ///< none where the ego is the user's
  session::LoopPlanner cbv_planner_;
  std::unique_ptr<CarlaWorld> world_;
  std::unique_ptr<page::ResultWriter> writer_;
  ImageInbox inbox_;
  std::map<std::string, traffic::ControlAction> held_;  ///< of vehicles that we drive, by role
  Clock::time_point begin_;                             ///< of the first frame
};

/// Runs the node; bad input is reported in one line, and in the exit code's file where the result
/// folder was given.
int runCarlaSession(StopSignal& stop);

}  // namespace cdiff::node_graph
