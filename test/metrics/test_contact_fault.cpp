// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "metrics/formulas/contact_fault.h"
#include "metrics/straight_road.h"
#include "support/snapshot_builder.h"

namespace cdiff::metrics {
namespace {

constexpr double kStep = 0.05;     // [s]
constexpr double kStanding = 0.1;  // [m/s]

/// A vehicle of 4.5 m x 1.8 m that is there at the overlap and came straight along its heading.
ContactParty party(const test::Motion& now) {
  ContactParty party;
  const traffic::Vehicle vehicle = test::vehicle("v", now);
  party.now = vehicle.state;
  party.dimensions = vehicle.dimensions;
  party.before = vehicle.state;
  party.before->position -= kStep * vehicle.state.velocity();
  return party;
}

ContactFault judge(const ContactParty& ego, const ContactParty& other) {
  return judgeContact(ego, other, kStep, kStanding);
}

// Boxes of one length that follow each other touch at 4.5 m between their centers.
TEST(ContactFault, AStrikerFromBehindIsAtFault) {
  // 4.45 m now, and before 4.45 + 0.05 (5 - 2) = 4.6: they meet after 2 / 3 of the tick, where the
  // ego's front is at 2.25 - 5 x 0.05 / 3 = 2.1667.
  const ContactFault fault = judge(party({0, 0, 0, 5}), party({4.45, 0, 0, 2}));
  EXPECT_TRUE(fault.ego_at_fault);
  EXPECT_EQ(fault.reason,
            "the ego's front struck the other's rear at 3.00 m/s: ego 5.00 m/s toward, other 2.00 "
            "m/s away");
  EXPECT_EQ(fault.ego_side, "front");
  EXPECT_EQ(fault.other_side, "rear");
  EXPECT_NEAR(fault.point.x(), 2.1667, 1e-3);
  EXPECT_NEAR(fault.point.y(), 0.0, 1e-6);
}

TEST(ContactFault, AnEgoStruckInTheRearIsNot) {
  const ContactFault fault = judge(party({0, 0, 0, 0.6}), party({-4.45, 0, 0, 3.8}));
  EXPECT_FALSE(fault.ego_at_fault);
  EXPECT_EQ(fault.reason,
            "the other's front struck the ego's rear at 3.20 m/s: ego 0.60 m/s away, other 3.80 "
            "m/s toward");
}

TEST(ContactFault, BoxesThatOverlappedBeforeMayMoveApart) {
  // 4.2 m and 4.25 m: they overlap all the time, the one ahead is faster by 1 m/s.
  EXPECT_EQ(judge(party({0, 0, 0, 2}), party({4.25, 0, 0, 3})).reason,
            "the ego's front struck the other's rear while moving apart at 1.00 m/s: ego 2.00 m/s "
            "toward, other 3.00 m/s away");
}

TEST(ContactFault, AFastStrikeIsJudgedWhereItBegan) {
  // 20 m/s is 1 m a tick, and they overlap by 0.1 m across: least overlap at the tick is sideways,
  // at first touch lengthwise.
  const ContactFault fault = judge(party({0, 0, 0, 20}), party({3.8, 1.7, 0, 0}));
  EXPECT_TRUE(fault.ego_at_fault);
  EXPECT_EQ(fault.ego_side, "front");
  EXPECT_EQ(fault.other_side, "rear");
  // The two edges share y = 0.8 to 0.9.
  EXPECT_NEAR(fault.point.y(), 0.85, 1e-3);
}

TEST(ContactFault, AStandingEgoIsNeverAtFault) {
  // What touches a standing ego at its front is the other's doing; 0.1 m/s and more is driving.
  const ContactParty oncoming = party({4.45, 0, 180, 3});
  EXPECT_FALSE(judge(party({0, 0, 0, 0.0}), oncoming).ego_at_fault);
  EXPECT_EQ(judge(party({0, 0, 0, 0.09}), party({4.49, 0, 0, 0})).reason,
            "the ego stood (0.09 m/s)");
  EXPECT_FALSE(judge(party({0, 0, 0, 0.09}), party({4.499, 0, 0, 0})).ego_at_fault);
  EXPECT_TRUE(judge(party({0, 0, 0, 0.1}), party({4.499, 0, 0, 0})).ego_at_fault);
}

TEST(ContactFault, TheFrontThatRunsIntoAFlankIsAtFault) {
  // Half a length and half a width are 3.15 m. The other drives north.
  const ContactFault own = judge(party({0, 0, 0, 8}), party({3.0, 0.5, 90, 6}));
  EXPECT_TRUE(own.ego_at_fault);
  EXPECT_EQ(own.reason,
            "the ego's front struck the other's left side at 8.00 m/s: ego 8.00 m/s toward, other "
            "0.00 m/s");
  const ContactFault others = judge(party({0, 0, 0, 8}), party({0.5, -3.0, 90, 6}));
  EXPECT_FALSE(others.ego_at_fault);
  EXPECT_EQ(others.reason,
            "the other's front struck the ego's right side at 6.00 m/s: ego 0.00 m/s, other "
            "6.00 m/s toward");
}

TEST(ContactFault, TwoCornersThatMeetAtOnceAreTheEgosFault) {
  // Mirrored in the diagonal: both enter the other's way at the same instant, at the same speed.
  const ContactFault fault = judge(party({-3.0, 0, 0, 8}), party({0, -3.0, 90, 8}));
  EXPECT_TRUE(fault.ego_at_fault);
}

TEST(ContactFault, HeadOnTheFasterOneIsAtFaultAndATieIsTheEgos) {
  const auto fault_at = [](double ego, double other) {
    return judge(party({0, 0, 0, ego}), party({4.4, 0, 180, other})).ego_at_fault;
  };
  EXPECT_TRUE(fault_at(8, 5));
  EXPECT_FALSE(fault_at(5, 8));
  EXPECT_TRUE(fault_at(6, 6));
}

TEST(ContactFault, HeadOnTheOneOffItsLanesIsAtFault) {
  ContactParty ego = party({0, 0, 0, 8});
  ContactParty other = party({4.4, 0.3, 180, 5});
  ego.lane_heading = 0.0;
  EXPECT_FALSE(judge(ego, other).ego_at_fault);  // the faster one, but on its lane
  EXPECT_EQ(judge(ego, other).reason,
            "head-on, and only the other was on no lane of its direction");
  other.lane_heading = core::kPi;
  EXPECT_TRUE(judge(ego, other).ego_at_fault);  // both on lanes: the faster one
  ego.lane_heading.reset();
  ego.now.speed = 2.0;
  ego.before->position.x() = -0.1;
  EXPECT_TRUE(judge(ego, other).ego_at_fault);
}

/// Heading -10 degrees, beside the ego on its left: the ego's front left corner (2.25, 0.9) is 0.25
/// behind and 0.948 right of its center, so 0.890 m off its axis (0.9 m is its flank), and was
/// 0.960 m at the tick before.
ContactParty cuttingIn() { return party({2.0, 1.848, -10, 8}); }

TEST(ContactFault, SideBySideTheOneThatMovesAcrossTheLaneIsAtFault) {
  ContactParty ego = party({0, 0, 0, 8});
  ego.lane_heading = 0.0;
  const ContactFault fault = judge(ego, cuttingIn());
  EXPECT_FALSE(fault.ego_at_fault);
  // 8 sin(10 deg) = 1.389.
  EXPECT_EQ(fault.reason,
            "side by side, the other moved toward the ego across the lane at 1.39 m/s: ego 0.00 "
            "m/s, other 1.39 m/s toward");
  EXPECT_EQ(fault.ego_side, "left side");
  EXPECT_EQ(fault.other_side, "right side");
  EXPECT_NEAR(fault.point.y(), 0.9, 1e-6);
}

TEST(ContactFault, SideBySideADriftingEgoIsAtFault) {
  // The same turned by 10 degrees and mirrored: the ego drifts right into one that keeps its lane.
  ContactParty ego = cuttingIn();
  ego.lane_heading = 0.0;
  EXPECT_TRUE(judge(ego, party({0, 0, 0, 8})).ego_at_fault);
}

TEST(ContactFault, WithoutALaneTheFlankThatIsTouchedDecides) {
  // Along the normal of the other's flank, (sin 10, cos 10): the ego 8 sin(10 deg), the other 0.
  EXPECT_TRUE(judge(party({0, 0, 0, 8}), cuttingIn()).ego_at_fault);
}

TEST(ContactFault, AJumpSidewaysIsMotion) {
  // SUMO moves a vehicle from one lane to the next in one step; its heading and speed say nothing.
  ContactParty other = party({0, 1.7, 0, 8});
  other.before->position.y() = 4.9;
  EXPECT_FALSE(judge(party({0, 0, 0, 8}), other).ego_at_fault);
}

TEST(ContactFault, AVehicleThatAppearsIsAtFault) {
  ContactParty other = party({3.0, 0, 0, 0});
  other.before.reset();
  EXPECT_EQ(judge(party({0, 0, 0, 8}), other).reason, "the other appeared in the ego's place");
  EXPECT_FALSE(judge(party({0, 0, 0, 8}), other).ego_at_fault);
  ContactParty ego = party({0, 0, 0, 8});
  ego.before.reset();
  EXPECT_FALSE(judge(ego, party({3.0, 0, 0, 0})).ego_at_fault);
}

class EgoContactsTest : public ::testing::Test {
 protected:
  /// Ticks 7 and 8: the ego (4.8 m long) at 8 m/s behind `other`, which stands.
  EgoContact contactWith(const traffic::Vehicle& other, const traffic::Contact& contact) {
    contacts_.observe(test::snapshot(7, {test::ego(10.0, 0, 8), other}));
    traffic::TrafficSnapshot last = test::snapshot(8, {test::ego(10.4, 0, 8), other});
    last.contacts = {contact};
    contacts_.observe(last);
    return contacts_.contacts().at(0);
  }
  test::StraightRoad road_;
  EgoContacts contacts_{&road_.network, kStanding};
};

TEST_F(EgoContactsTest, AreRecordedWithTickPartnerFaultSpeedsAndPlace) {
  const EgoContact contact = contactWith(test::background("z", 15.0, 0, 0), {"ego", "z"});
  EXPECT_EQ(contact.tick, 8U);
  EXPECT_DOUBLE_EQ(contact.seconds, 0.4);
  EXPECT_EQ(contact.partner, "z");
  EXPECT_TRUE(contact.ego_at_fault);
  EXPECT_DOUBLE_EQ(contact.ego_speed, 8.0);
  EXPECT_DOUBLE_EQ(contact.partner_speed, 0.0);
  EXPECT_EQ(contact.ego_side, "front");
  EXPECT_EQ(contact.partner_side, "rear");
  EXPECT_NEAR(contact.x, 12.6, 1e-3);  // the rear of z
}

TEST_F(EgoContactsTest, FindThePartnerInEitherPlace) {
  EXPECT_EQ(contactWith(test::background("b", 15.0, 0, 0), {"b", "ego"}).partner, "b");
}

TEST_F(EgoContactsTest, KnowTheLaneOfADirection) {
  // An oncoming vehicle on the eastbound lane is on no lane of its direction.
  traffic::Vehicle oncoming = test::cbv("c", 15.0, 0, 1);
  oncoming.state.heading = core::kPi;
  const EgoContact contact = contactWith(oncoming, {"c", "ego"});
  EXPECT_FALSE(contact.ego_at_fault);
  EXPECT_EQ(contact.reason, "head-on, and only the other was on no lane of its direction");
}

TEST_F(EgoContactsTest, OfOthersAreLeftOut) {
  traffic::TrafficSnapshot snapshot = test::snapshot(1, {test::ego(10, 0, 8)});
  snapshot.contacts = {{"a", "b"}};
  contacts_.observe(snapshot);
  EXPECT_TRUE(contacts_.contacts().empty());
}

// Any of place and heading of the two may be missing, each by itself.
TEST_F(EgoContactsTest, AreNotJudgedWithoutThePlacesOfBoth) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int missing = 0; missing < 4; ++missing) {
    traffic::Vehicle ego = test::ego(10, 0, 8);
    traffic::Vehicle other = test::background("z", 14, 0, 0);
    if (missing == 0) other.state.position.y() = nan;
    if (missing == 1) other.state.heading = nan;
    if (missing == 2) ego.state.position.x() = nan;
    if (missing == 3) ego.state.heading = nan;
    traffic::TrafficSnapshot snapshot = test::snapshot(7, {ego, other});
    snapshot.contacts = {{"ego", "z"}};
    EgoContacts contacts(&road_.network, kStanding);
    contacts.observe(snapshot);
    EXPECT_EQ(contacts.contacts().at(0).reason,
              "the record of that tick lacks a position of the two")
        << missing;
    EXPECT_DOUBLE_EQ(contacts.contacts().at(0).ego_speed, 8.0);
  }
}

TEST_F(EgoContactsTest, APartnerWithoutAPlaceIsNotBlamedOnTheEgo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(contactWith(test::background("z", nan, 0, 0), {"ego", "z"}).ego_at_fault);
  traffic::TrafficSnapshot gone = test::snapshot(9, {test::ego(10.8, 0, 8)});
  gone.contacts = {{"ego", "nobody"}};
  contacts_.observe(gone);
  EXPECT_EQ(contacts_.contacts().at(1).partner, "nobody");
  EXPECT_FALSE(contacts_.contacts().at(1).ego_at_fault);
}

}  // namespace
}  // namespace cdiff::metrics
