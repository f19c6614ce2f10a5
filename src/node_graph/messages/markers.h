// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "node_graph/messages/marker_parts.h"
#include "rendering/signal_heads.h"
#include "session/session_observer.h"
#include "session/session_setup.h"
#include "visualization_msgs/MarkerArray.h"

namespace cdiff::node_graph {

/// What happens in a session as rviz markers in `map`: vehicles by role with heading, id and speed,
/// trails of those that are driven, traffic lights, conflict points with both arrival times,
/// conflict-aware routes, plans in words, times to collision, contacts, and of each candidate its
/// score or why it was rejected. One per session: gives each vehicle an id that it keeps.
class SessionMarkers {
 public:
  explicit SessionMarkers(const session::SessionSetup& setup);

  /// Every tick in order, whether it is built or not: remembers contacts.
  void note(const traffic::TrafficSnapshot& snapshot);
  /// A tick that was noted, with selection and actions where there are some. Each marker lives for
  /// 0.5 s of simulated time, so what is not sent again vanishes. The first array starts with
  /// DELETEALL.
  visualization_msgs::MarkerArray build(const session::TickRecord& record);

 private:
  using Markers = std::vector<visualization_msgs::Marker>;
  /// Where a vehicle was and when [s].
  using Trail = std::deque<std::pair<double, Eigen::Vector3d>>;
  /// A contact that is still shown.
  struct ShownContact {
    double begin = 0.0;  ///< [s]
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    std::string text;
  };
  int idOf(const std::string& vehicle_id);
  void addVehicles(const traffic::TrafficSnapshot& snapshot, LabelRoom& room, Markers& markers);
  void addTrails(const traffic::TrafficSnapshot& snapshot, Markers& markers);
  void addContacts(LabelRoom& room, Markers& markers) const;
  void addSignals(const traffic::TrafficSnapshot& snapshot, Markers& markers);
  void addCandidates(const traffic::TrafficSnapshot& snapshot, const cbv::CbvSelection& selection,
                     LabelRoom& room, Markers& markers);

  rendering::SignalHeads signals_;
  std::map<std::string, int> ids_;
  std::map<std::string, Trail> trails_;  ///< of ego and CBVs
  std::deque<ShownContact> contacts_;
  bool first_ = true;
};

}  // namespace cdiff::node_graph
