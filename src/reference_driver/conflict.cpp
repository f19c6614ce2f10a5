// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "reference_driver/conflict.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::reference_driver {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kStill = 1e-3;  // [m/s]

/// When |place + speed t| < reach, for t >= 0.
TimeSpan within(double place, double speed, double reach) {
  if (std::abs(speed) < kStill) {
    return std::abs(place) < reach ? TimeSpan{0.0, kForever} : TimeSpan{};
  }
  const double first = (-reach - place) / speed;
  const double second = (reach - place) / speed;
  return {std::max(0.0, std::min(first, second)), std::max(first, second)};
}

ConflictKind kindOf(const SeenVehicle& other, bool inside) {
  const double angle = std::abs(std::atan2(other.across_speed, other.along_speed));
  const bool stands = std::hypot(other.across_speed, other.along_speed) < kStill;
  if (!stands && angle > core::degreesToRadians(120.0)) return ConflictKind::kOncoming;
  if (inside) return ConflictKind::kLead;
  if (stands || angle < core::degreesToRadians(30.0)) return ConflictKind::kCutIn;
  return angle < core::degreesToRadians(60.0) ? ConflictKind::kMerge : ConflictKind::kCrossing;
}

}  // namespace

const char* toText(ConflictKind kind) {
  constexpr const char* kTexts[] = {"lead", "cut_in", "merge", "crossing", "oncoming"};
  return kTexts[static_cast<std::size_t>(kind)];
}

Conflict conflictOf(const OwnMotion& own, double speed, const SeenVehicle& other) {
  const double offset = other.offset - own.offset;
  const double across = 0.5 * own.dimensions.width + other.half_across;
  const double along = 0.5 * own.dimensions.length + other.half_along;
  const double ahead = other.arc_length - own.arc_length;
  Conflict conflict;
  conflict.ahead = ahead > 0.0;
  conflict.to_corridor = std::abs(offset) - across;
  conflict.kind = kindOf(other, conflict.to_corridor < 0.0);
  conflict.in_corridor = within(offset, other.across_speed, across);
  conflict.beside = within(ahead, other.along_speed - speed, along);
  conflict.gap = ahead > 0.0 ? std::max(0.0, ahead - along) : std::min(0.0, ahead + along);
  const bool stays = conflict.kind == ConflictKind::kCutIn || conflict.kind == ConflictKind::kMerge;
  if (stays && !conflict.in_corridor.empty()) conflict.in_corridor.end = kForever;
  if (conflict.to_corridor > 0.0) {
    conflict.stops_before = other.across_speed * std::hypot(other.across_speed, other.along_speed) /
                            (2.0 * conflict.to_corridor);
    conflict.stops_before = std::abs(conflict.stops_before);
  }
  return conflict;
}

bool meets(const Conflict& conflict, double horizon, double arrival_gap) {
  const TimeSpan& first = conflict.in_corridor;
  const TimeSpan& second = conflict.beside;
  if (first.empty() || second.empty()) return false;
  if (first.begin > horizon || second.begin > horizon) return false;
  return first.begin < second.end + arrival_gap && second.begin < first.end + arrival_gap;
}

}  // namespace cdiff::reference_driver
