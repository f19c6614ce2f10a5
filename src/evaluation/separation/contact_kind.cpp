// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/separation/contact_kind.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::evaluation {
namespace {

using record::TraceRow;

constexpr double kLookBack = 1.0;      // for the angle [s]
constexpr double kApproach = 3.0;      // in which it may have come into the way [s]
constexpr double kSameWay = 30.0;      // [deg]
constexpr double kMerging = 60.0;      // [deg]
constexpr double kCrossingTo = 120.0;  // [deg]
constexpr double kInWay = 1.8;         // between the center and the ego's path: two half widths [m]
constexpr double kPathAhead = 20.0;    // straight on beyond the contact [m]

/// Rows of one vehicle up to a tick, by tick.
using Rows = std::map<std::uint64_t, const TraceRow*>;

Rows rowsOf(const std::vector<TraceRow>& trace, const std::string& id, std::uint64_t first,
            std::uint64_t last) {
  Rows rows;
  for (const TraceRow& row : trace) {
    if (row.id == id && row.tick >= first && row.tick <= last) rows.emplace(row.tick, &row);
  }
  if (!rows.empty()) return rows;
  throw core::InputError("the trace has no row of '" + id + "' between tick " +
                         std::to_string(first) + " and " + std::to_string(last));
}

/// Smallest distance from the places that the ego came along and would have come along [m].
double distanceFromPath(const Eigen::Vector2d& point, const Rows& ego) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [tick, row] : ego) least = std::min(least, (point - row->position).norm());
  const TraceRow& last = *ego.rbegin()->second;
  const Eigen::Vector2d along = geometry::direction(last.heading);
  const double ahead = std::clamp(along.dot(point - last.position), 0.0, kPathAhead);
  return std::min(least, (point - last.position - ahead * along).norm());
}

bool cameIntoWay(const Rows& ego, const Rows& partner) {
  return std::any_of(partner.begin(), partner.end(), [&](const auto& row) {
    return distanceFromPath(row.second->position, ego) > kInWay;
  });
}

/// The row of a tick, or the first one after it.
const TraceRow& rowFrom(const Rows& rows, std::uint64_t tick) {
  const auto found = rows.lower_bound(tick);
  return *(found == rows.end() ? rows.rbegin()->second : found->second);
}

Eigen::Vector2d velocityOf(const TraceRow& row) {
  return row.speed * geometry::direction(row.heading);
}

}  // namespace

const char* toText(ContactKind kind) {
  switch (kind) {
    case ContactKind::kCutIn:
      return "cut_in";
    case ContactKind::kMerge:
      return "merge";
    case ContactKind::kCrossing:
      return "crossing";
    case ContactKind::kOncoming:
      return "oncoming";
    case ContactKind::kLead:
      return "lead";
    case ContactKind::kFromBehind:
      break;
  }
  return "from_behind";
}

TracedContact traceContact(const std::vector<TraceRow>& trace, std::uint64_t tick,
                           const std::string& partner, const std::string& ego_side, double step) {
  const auto ticks = [&](double seconds) {
    return static_cast<std::uint64_t>(std::llround(seconds / step));
  };
  const auto back = [&](double seconds) { return tick - std::min(tick, ticks(seconds)); };
  const Rows ego = rowsOf(trace, traffic::kEgoId, back(kApproach), tick);
  const Rows other = rowsOf(trace, partner, back(kApproach), tick);
  const TraceRow& ego_before = rowFrom(ego, back(step));
  const TraceRow& other_before = rowFrom(other, back(step));
  TracedContact contact;
  contact.impact_speed = (velocityOf(ego_before) - velocityOf(other_before)).norm();
  contact.partner_speed = other_before.speed;
  contact.with_cbv = other.rbegin()->second->role == traffic::VehicleRole::kCbv;
  const double angle = core::radiansToDegrees(std::abs(core::angleDifference(
      rowFrom(other, back(kLookBack)).heading, rowFrom(ego, back(kLookBack)).heading)));
  contact.kind = ego_side == "rear"        ? ContactKind::kFromBehind
                 : angle > kCrossingTo     ? ContactKind::kOncoming
                 : angle > kMerging        ? ContactKind::kCrossing
                 : angle > kSameWay        ? ContactKind::kMerge
                 : cameIntoWay(ego, other) ? ContactKind::kCutIn
                                           : ContactKind::kLead;
  return contact;
}

}  // namespace cdiff::evaluation
