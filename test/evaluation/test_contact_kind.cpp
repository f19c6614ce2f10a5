// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Kinds of contact, by how the other vehicle came: an ego along x at 8 m/s, contact at 3 s.
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "evaluation/separation/contact_kind.h"

namespace cdiff::evaluation {
namespace {

constexpr double kStep = 0.05;              // [s]
constexpr std::uint64_t kContactTick = 60;  // 3 s

/// Ego and other at constant velocity; the other is at `at` (relative to the ego) at the contact.
std::vector<record::TraceRow> traceOf(const Eigen::Vector2d& at, double heading_deg, double speed) {
  const double heading = core::degreesToRadians(heading_deg);
  std::vector<record::TraceRow> trace;
  for (std::uint64_t tick = 0; tick <= kContactTick; ++tick) {
    const double left = kStep * static_cast<double>(kContactTick - tick);
    trace.push_back({tick, "ego", traffic::VehicleRole::kEgo, {-8.0 * left, 0.0}, 0.0, 8.0, {}});
    trace.push_back({tick,
                     "other",
                     traffic::VehicleRole::kCbv,
                     at - left * speed * geometry::direction(heading),
                     heading,
                     speed,
                     {}});
  }
  return trace;
}

ContactKind kindOf(const Eigen::Vector2d& at, double heading_deg, double speed,
                   const std::string& side = "front") {
  return traceContact(traceOf(at, heading_deg, speed), kContactTick, "other", side, kStep).kind;
}

TEST(ContactKind, IsWhereTheOtherCameFrom) {
  EXPECT_EQ(kindOf({4.4, 0.0}, 0.0, 5.0), ContactKind::kLead);
  // 10 degrees at 8 m/s: 4.2 m to the left 3 s before, beyond two half widths of 0.9 m.
  EXPECT_EQ(kindOf({4.0, 1.0}, -10.0, 8.0), ContactKind::kCutIn);
  EXPECT_EQ(kindOf({4.0, 1.0}, -45.0, 6.0), ContactKind::kMerge);
  EXPECT_EQ(kindOf({4.0, 1.0}, -90.0, 6.0), ContactKind::kCrossing);
  EXPECT_EQ(kindOf({4.4, 0.0}, 180.0, 6.0), ContactKind::kOncoming);
  EXPECT_EQ(kindOf({-4.4, 0.0}, 0.0, 12.0, "rear"), ContactKind::kFromBehind);
}

TEST(ContactKind, AnglesDivideTheKinds) {
  const std::pair<double, ContactKind> cases[] = {
      {29.0, ContactKind::kCutIn},     {31.0, ContactKind::kMerge},
      {59.0, ContactKind::kMerge},     {61.0, ContactKind::kCrossing},
      {119.0, ContactKind::kCrossing}, {121.0, ContactKind::kOncoming}};
  for (const auto& [angle, kind] : cases) {
    EXPECT_EQ(kindOf({4.0, 1.0}, -angle, 8.0), kind) << angle;
    EXPECT_EQ(kindOf({4.0, -1.0}, angle, 8.0), kind) << angle;
  }
}

TEST(ContactKind, TheImpactIsTheRelativeSpeed) {
  // 8 m/s along x and 6 m/s along -y: sqrt(64 + 36) = 10.
  const TracedContact contact =
      traceContact(traceOf({4.0, 1.0}, -90.0, 6.0), kContactTick, "other", "front", kStep);
  EXPECT_NEAR(contact.impact_speed, 10.0, 1e-9);
  EXPECT_EQ(contact.partner_speed, 6.0);
  EXPECT_TRUE(contact.with_cbv);
}

TEST(ContactKind, WhoIsNotInTheTraceIsNamed) {
  EXPECT_THROW(traceContact(traceOf({4.0, 0.0}, 0.0, 5.0), kContactTick, "nobody", "front", kStep),
               core::InputError);
}

}  // namespace
}  // namespace cdiff::evaluation
