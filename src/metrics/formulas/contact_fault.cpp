// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/contact_fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"

namespace cdiff::metrics {
namespace {

using geometry::OrientedBox;

constexpr double kTie = 1e-6;  // closing speeds that differ by less are equal [m/s]

/// Share of the tick at which the boxes meet; 0 when they overlapped before.
double firstTouch(const ContactParty& ego, const ContactParty& other) {
  constexpr int kHalvings = 30;
  if (overlap(ego.boxAt(0.0), other.boxAt(0.0))) return 0.0;
  double apart = 0.0;
  double together = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (apart + together);
    (overlap(ego.boxAt(middle), other.boxAt(middle)) ? together : apart) = middle;
  }
  return together;
}

/// Axis of least overlap, pointing from the ego to the other; ties by the order: forward and left
/// of the ego, then of the other.
Eigen::Vector2d normalOf(const OrientedBox& ego, const OrientedBox& other) {
  const Eigen::Vector2d apart = other.center - ego.center;
  Eigen::Vector2d normal = geometry::direction(ego.heading);
  double least = std::numeric_limits<double>::infinity();
  for (const OrientedBox* box : {&ego, &other}) {
    const Eigen::Vector2d forward = geometry::direction(box->heading);
    for (const Eigen::Vector2d& axis : {forward, geometry::leftNormal(forward)}) {
      const double depth = geometry::halfExtent(ego, axis) + geometry::halfExtent(other, axis) -
                           std::abs(apart.dot(axis));
      if (depth >= least - kTie) continue;
      least = depth;
      normal = apart.dot(axis) < 0.0 ? Eigen::Vector2d(-axis) : axis;
    }
  }
  return normal;
}

/// Mean of the corners of each that lie in the other; midway between the centers without one.
Eigen::Vector2d pointOf(const OrientedBox& ego, const OrientedBox& other) {
  constexpr double kTolerance = 1e-6;  // [m]
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (const auto& [box, around] : {std::pair(&ego, other), std::pair(&other, ego)}) {
    const OrientedBox grown{around.center, around.heading, around.length + kTolerance,
                            around.width + kTolerance};
    for (const Eigen::Vector2d& corner : box->corners()) {
      if (!grown.contains(corner)) continue;
      sum += corner;
      ++count;
    }
  }
  if (count > 0) return sum / count;
  return 0.5 * (ego.center + other.center);
}

/// Part of the outline that faces along `normal`.
std::string sideOf(const OrientedBox& box, const Eigen::Vector2d& normal) {
  const Eigen::Vector2d forward = geometry::direction(box.heading);
  const double ahead = forward.dot(normal);
  const double left = geometry::leftNormal(forward).dot(normal);
  if (std::abs(ahead) >= std::abs(left)) return ahead > 0.0 ? "front" : "rear";
  return left > 0.0 ? "left side" : "right side";
}

bool isFlank(const std::string& side) { return side == "left side" || side == "right side"; }

std::string speedText(double speed) {
  const double shown = std::abs(speed) < 0.005 ? 0.0 : speed;  // not "-0.00"
  return core::formatFixed(shown, 2) + " m/s";
}

/// "5.00 m/s toward", for a negative speed toward the other "2.00 m/s away"; without motion
/// "0.00 m/s".
std::string motionText(double closing) {
  const std::string speed = speedText(std::abs(closing));
  if (std::abs(closing) < 0.005) return speed;
  return speed + (closing < 0.0 ? " away" : " toward");
}

/// Perpendicular to the lane, on the side of `normal`; `normal` where no lane is known.
Eigen::Vector2d acrossLane(const ContactParty& ego, const ContactParty& other,
                           const Eigen::Vector2d& normal) {
  const std::optional<double> lane = ego.lane_heading ? ego.lane_heading : other.lane_heading;
  if (!lane) return normal;
  const Eigen::Vector2d left = geometry::leftNormal(geometry::direction(*lane));
  return left.dot(normal) < 0.0 ? Eigen::Vector2d(-left) : left;
}

/// Closing speeds along an axis from the ego to the other [m/s].
struct Closing {
  double ego = 0.0;
  double other = 0.0;
  bool egoStrikes() const { return ego >= other - kTie; }
  /// " at 3.00 m/s: ego 5.00 m/s toward, other 2.00 m/s away": the speed of approach, then its
  /// parts; of boxes that overlapped before, the speed at which they move apart.
  std::string text() const {
    const double approach = ego + other;
    return (approach <= -0.005 ? " while moving apart at " : " at ") +
           speedText(std::abs(approach)) + ": ego " + motionText(ego) + ", other " +
           motionText(other);
  }
};

void judgeSideBySide(const Closing& closing, ContactFault& fault) {
  fault.ego_at_fault = closing.egoStrikes();
  fault.reason =
      std::string("side by side, ") +
      (fault.ego_at_fault ? "the ego moved toward the other" : "the other moved toward the ego") +
      " across the lane" + closing.text();
}

void judgeStrike(const Closing& closing, ContactFault& fault) {
  fault.ego_at_fault = closing.egoStrikes();
  fault.reason = fault.ego_at_fault
                     ? "the ego's " + fault.ego_side + " struck the other's " + fault.other_side
                     : "the other's " + fault.other_side + " struck the ego's " + fault.ego_side;
  fault.reason += closing.text();
}

bool isPlaced(const traffic::Vehicle* vehicle) {
  return vehicle != nullptr && vehicle->state.position.allFinite() &&
         std::isfinite(vehicle->state.heading);
}

/// Both were there at the tick before, and the ego moves.
void judgeMoving(const ContactParty& ego, const ContactParty& other, double step, double touch,
                 ContactFault& fault) {
  const double turn = std::abs(core::angleDifference(other.now.heading, ego.now.heading));
  const bool fronts = fault.ego_side == "front" && fault.other_side == "front";
  const bool head_on = fronts && turn >= core::degreesToRadians(135.0);
  if (head_on && ego.lane_heading.has_value() != other.lane_heading.has_value()) {
    fault.ego_at_fault = !ego.lane_heading;
    fault.reason = std::string("head-on, and only the ") + (fault.ego_at_fault ? "ego" : "other") +
                   " was on no lane of its direction";
    return;
  }
  const Eigen::Vector2d normal = normalOf(ego.boxAt(touch), other.boxAt(touch));
  const bool beside =
      isFlank(fault.ego_side) && isFlank(fault.other_side) && turn <= core::degreesToRadians(45.0);
  const Eigen::Vector2d axis = beside ? acrossLane(ego, other, normal) : normal;
  const Closing closing{ego.velocityAt(fault.point, touch, step).dot(axis),
                        -other.velocityAt(fault.point, touch, step).dot(axis)};
  beside ? judgeSideBySide(closing, fault) : judgeStrike(closing, fault);
}

}  // namespace

OrientedBox ContactParty::boxAt(double share) const {
  const traffic::VehicleState& from = before ? *before : now;
  const double turn = core::angleDifference(now.heading, from.heading);
  return {from.position + share * (now.position - from.position), from.heading + share * turn,
          dimensions.length, dimensions.width};
}

Eigen::Vector2d ContactParty::velocityAt(const Eigen::Vector2d& point, double share,
                                         double step) const {
  if (!before) return Eigen::Vector2d::Zero();
  const OrientedBox box = boxAt(share);
  const Eigen::Vector2d body = geometry::Pose2d{box.center, box.heading}.toBody(point);
  return (now.pose().toMap(body) - before->pose().toMap(body)) / step;
}

ContactFault judgeContact(const ContactParty& ego, const ContactParty& other, double step,
                          double standing_speed) {
  const double touch = firstTouch(ego, other);
  const OrientedBox ego_box = ego.boxAt(touch);
  const OrientedBox other_box = other.boxAt(touch);
  const Eigen::Vector2d normal = normalOf(ego_box, other_box);
  ContactFault fault;
  fault.ego_side = sideOf(ego_box, normal);
  fault.other_side = sideOf(other_box, -normal);
  fault.point = pointOf(ego_box, other_box);
  if (!ego.before) {
    fault.reason = "the two overlapped when the ego was first seen";
  } else if (!other.before) {
    fault.reason = "the other appeared in the ego's place";
  } else if (ego.now.speed < standing_speed) {
    fault.reason = "the ego stood (" + speedText(ego.now.speed) + ")";
  } else {
    judgeMoving(ego, other, step, touch, fault);
  }
  return fault;
}

void EgoContacts::observe(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  for (const traffic::Contact& contact : snapshot.contacts) {
    if (ego == nullptr) break;
    if (contact.first == ego->id) add(snapshot, *ego, contact.second);
    if (contact.second == ego->id) add(snapshot, *ego, contact.first);
  }
  before_ = snapshot.vehicles;
  time_before_ = snapshot.time;
}

std::string EgoContacts::strikerOf(const traffic::TrafficSnapshot& snapshot,
                                   const std::string& judged, const std::string& other) const {
  const traffic::Vehicle* first = snapshot.find(judged);
  const traffic::Vehicle* second = snapshot.find(other);
  if (!isPlaced(first) || !isPlaced(second)) return {};
  const double step = snapshot.time - time_before_;
  const ContactFault fault = judgeContact(partyOf(*first), partyOf(*second), step, standing_speed_);
  return fault.ego_at_fault ? judged : other;
}

ContactParty EgoContacts::partyOf(const traffic::Vehicle& vehicle) const {
  ContactParty party;
  party.now = vehicle.state;
  party.dimensions = vehicle.dimensions;
  for (const traffic::Vehicle& earlier : before_) {
    if (earlier.id == vehicle.id) party.before = earlier.state;
  }
  if (network_ == nullptr) return party;
  constexpr double kWidestHalf = 10.0;  // [m] no lane is broader to a side
  double least = core::degreesToRadians(90.0);
  for (const map::LaneMatch& match : network_->lanesNear(
           vehicle.state.position, vehicle.state.elevation, kWidestHalf, vehicle.state.heading)) {
    const bool on = match.projection.distance <= 0.5 * network_->lane(match.lane).width;
    if (!on || std::abs(match.heading_difference) >= least) continue;
    least = std::abs(match.heading_difference);
    party.lane_heading = vehicle.state.heading + match.heading_difference;
  }
  return party;
}

void EgoContacts::add(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
                      const std::string& partner) {
  EgoContact contact;
  contact.tick = snapshot.tick;
  contact.seconds = snapshot.time;
  contact.partner = partner;
  contact.ego_speed = ego.state.speed;
  const traffic::Vehicle* other = snapshot.find(partner);
  if (!isPlaced(other) || !isPlaced(&ego)) {
    contact.reason = "the record of that tick lacks a position of the two";
    contacts_.push_back(contact);
    return;
  }
  const double step = snapshot.time - time_before_;
  const ContactFault fault = judgeContact(partyOf(ego), partyOf(*other), step, standing_speed_);
  contact.partner_speed = other->state.speed;
  contact.ego_at_fault = fault.ego_at_fault;
  contact.reason = fault.reason;
  contact.ego_side = fault.ego_side;
  contact.partner_side = fault.other_side;
  contact.x = fault.point.x();
  contact.y = fault.point.y();
  contacts_.push_back(contact);
}

}  // namespace cdiff::metrics
