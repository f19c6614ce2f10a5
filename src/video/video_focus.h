// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the video draws attention to: the CBV nearest to the ego, and contacts for as long as it
/// takes to see them (map frame, SI units).
#pragma once

#include <deque>
#include <string>

#include "metrics/contact_fault.h"
#include "session/session_setup.h"

namespace cdiff::video {

/// Time that a contact stays marked [s].
inline constexpr double kContactTime = 1.5;

/// Whether a vehicle can be drawn: position, heading and elevation are finite.
bool isPlaced(const traffic::Vehicle& vehicle);

/// The CBV nearest to the ego by the gap between their boxes. Another one is shown only once it is
/// nearer by kMargin, so that two at about the same distance do not take turns.
class FollowedCbv {
 public:
  static constexpr double kMargin = 3.0;  ///< [m]

  /// Every tick in order. The CBV to show (ties: the lower slot), or nullptr without one.
  const traffic::Vehicle* update(const traffic::TrafficSnapshot& snapshot);

 private:
  std::string id_;  ///< shown at the last tick
};

/// A contact that is to be seen now.
struct ContactMark {
  double begin = 0.0;  ///< its time [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  std::string partner;        ///< of the ego; empty when the ego has no part in it
  bool ego_at_fault = false;  ///< where it has
  std::string label;          ///< who, and whose fault
  std::string reason;         ///< why; empty without the ego
};

/// Contacts of the last kContactTime, oldest first.
class ContactMarks {
 public:
  /// `setup` must outlive the object.
  explicit ContactMarks(const session::SessionSetup& setup);
  /// Every tick in order.
  void update(const traffic::TrafficSnapshot& snapshot);
  const std::deque<ContactMark>& marks() const { return marks_; }
  /// The last one of the ego, or nullptr.
  const ContactMark* ofEgo() const;

 private:
  void addOthers(const traffic::TrafficSnapshot& snapshot);

  metrics::EgoContacts ego_contacts_;
  std::size_t seen_ = 0;  ///< of the ego's contacts
  std::deque<ContactMark> marks_;
};

}  // namespace cdiff::video
