// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "diagnostic_msgs/DiagnosticArray.h"
#include "dynamic_reconfigure/Config.h"
#include "dynamic_reconfigure/ConfigDescription.h"
#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "geometry_msgs/PointStamped.h"
#include "ros/callback_queue.h"
#include "ros/ros.h"
#include "std_msgs/Float64.h"

namespace cdiff::rviz_panel {

/// A number of the session that can be set: v* [m/s] or the weight of an objective.
struct SessionParameter {
  double value = 0.0;
  double minimum = 0.0;
  double maximum = 0.0;
};

/// A slot with a CBV.
struct SessionSlot {
  std::string vehicle_id;
  double score = 0.0;                                     ///< interaction score at selection
  double ttc = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: they miss each other
};

/// What is known of a session at present, for people.
struct SessionFigures {
  enum class State { kUnknown, kPlaying, kPaused, kOver };
  State state = State::kUnknown;
  bool connected = false;  ///< a tick has come
  std::uint64_t tick = 0;
  double time = 0.0;  ///< simulated [s]
  std::string status = "no session";
  std::vector<std::string> vehicles;  ///< ids, without the ego
  std::map<int, SessionSlot> slots;
  std::map<std::string, SessionParameter> parameters;  ///< by their names in dynamic_reconfigure
  double latency_ms = 0.0;                             ///< of the newest CBV's answer
  std::string verdict;                                 ///< so far, a sentence
  std::vector<std::string> faults;                     ///< oldest first
  std::string answer;                                  ///< of the last call; empty before the first
  bool refused = false;                                ///< whether it was refused
};

/// The session's services for a panel, without any graphics: requests return at once and are called
/// by threads of its own, so that a window never waits; of several that wait for one thing, as of a
/// slider that moves, the newest alone is called. What the session tells is gathered meanwhile.
class SessionClient {
 public:
  /// `node`: in the session's namespace.
  explicit SessionClient(const ros::NodeHandle& node = ros::NodeHandle());
  ~SessionClient();
  SessionClient(const SessionClient&) = delete;
  SessionClient& operator=(const SessionClient&) = delete;

  void play();
  void pause();
  void step(std::uint64_t ticks);
  /// At most so many times real time; 0: as fast as possible.
  void setPace(double at_most);
  /// As the service `steer`: profile, mode, choose, release ... with its value.
  void steer(const std::string& what, const std::string& value);
  /// v* or the weight of an objective, by its name in SessionFigures::parameters.
  void setParameter(const std::string& name, double value);
  /// The vehicle nearest to a point of `map` within 6 m becomes a CBV.
  void chooseAt(double x, double y);

  SessionFigures figures() const;

 private:
  /// What became of a call: empty when it was done, else why not.
  using Call = std::function<std::string()>;
  struct Request {
    std::string subject;  ///< of requests for one the newest is called
    Call call;
    bool quiet = false;  ///< its answer is of no interest
  };
  void listen();
  void listenToSlot(int slot);
  void request(Request request);
  void work();
  void setState(std::uint8_t state, const std::string& subject);
  void askState();
  SessionFigures::State stateOfSession() const;
  void take(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  void take(const ::e2e_cdiff::CbvSelection& selection);
  void take(const ::e2e_cdiff::MetricReport& report);
  void take(const ::dynamic_reconfigure::ConfigDescription& description);
  void take(const ::dynamic_reconfigure::Config& config);

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  std::vector<ros::Subscriber> inputs_;
  std::map<int, std::vector<ros::Subscriber>> slot_inputs_;
  ros::WallTimer asking_;
  mutable std::mutex mutex_;
  std::condition_variable wanted_;
  std::deque<Request> requests_;
  std::set<std::string> busy_;  ///< subjects that are being called
  SessionFigures figures_;
  ::e2e_cdiff::TrafficSnapshot::ConstPtr newest_;
  bool ends_ = false;
  std::vector<std::thread> workers_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
};

}  // namespace cdiff::rviz_panel
