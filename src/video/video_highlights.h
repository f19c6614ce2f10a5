// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <string>

#include "e2e_cdiff/traffic/vehicle.h"
#include "metrics/formulas/contact_fault.h"
#include "session/session_setup.h"

namespace cdiff::video {

// What the video draws attention to: the CBV nearest to the ego, and contacts for as long as it
// takes to see them (map frame, SI units).

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
  std::string partner;        ///< partner of the ego; empty when the ego has no part in it
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

// Colors of the video (blue, green, red), those of the page's light palette, and text in it.

namespace ink {
inline const cv::Scalar kPage{255, 255, 255};
inline const cv::Scalar kText{36, 32, 28};
inline const cv::Scalar kSoft{112, 102, 93};
inline const cv::Scalar kPanel{248, 246, 245};
inline const cv::Scalar kGround{236, 241, 238};
inline const cv::Scalar kRoad{220, 215, 211};
inline const cv::Scalar kEdge{177, 169, 163};
inline const cv::Scalar kRoute{178, 222, 178};
inline const cv::Scalar kEgo{40, 40, 198};
inline const cv::Scalar kBackground{196, 111, 31};
inline const cv::Scalar kContact{0, 81, 230};
inline const cv::Scalar kPassed{54, 110, 27};
inline const cv::Scalar kFailed{25, 25, 163};
inline const cv::Scalar kStruck{0, 74, 122};
inline const cv::Scalar kError{134, 42, 91};
}  // namespace ink

/// Red for the ego, blue for background vehicles, a shade of purple by slot for CBVs.
cv::Scalar inkOf(traffic::VehicleRole role, int slot);

/// Red where the ego is at fault, amber where it is struck, orange where it has no part.
cv::Scalar inkOf(const ContactMark& contact);

/// One line of text, its left lower corner at `at` [pixels]; letters that are not ASCII appear as
/// '?'. `size` 1 is 22 pixels high.
void writeText(cv::Mat picture, const std::string& text, const cv::Point& at, double size,
               const cv::Scalar& color, bool bold = false);
/// Its width [pixels].
int textWidth(const std::string& text, double size, bool bold = false);
/// `text` cut to `width` pixels, with ".." where something is missing.
std::string cutText(const std::string& text, int width, double size);

}  // namespace cdiff::video
