// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Commands of the user's own nodes for CBVs, and which vehicle each counts for.
#include <gtest/gtest.h>

#include <limits>

#include "node_graph/nodes/external_cbvs.h"

namespace cdiff::node_graph {
namespace {

constexpr double kStep = 0.05;  // [s]

class ExternalCbvsTest : public ::testing::Test {
 protected:
  ExternalCbvsTest() { tick(0); }
  void tick(std::uint64_t tick) {
    msgs::TrafficSnapshot snapshot;
    snapshot.tick = tick;
    snapshot.decision_tick = tick % 2 == 0;
    cbvs_.published(snapshot);
  }
  /// One vehicle a slot, from slot 0 on; empty ids for empty slots.
  void select(std::uint64_t tick, const std::vector<std::string>& ids) {
    msgs::CbvSelection selection;
    selection.tick = tick;
    for (std::size_t slot = 0; slot < ids.size(); ++slot) {
      if (ids[slot].empty()) continue;
      selection.assignments.emplace_back();
      selection.assignments.back().slot = static_cast<int>(slot);
      selection.assignments.back().vehicle_id = ids[slot];
    }
    cbvs_.selected(shared(selection));
  }
  std::string command(std::uint64_t tick, int slot, const std::string& vehicle_id) {
    msgs::ControlAction control;
    control.tick = tick;
    control.vehicle_id = vehicle_id;
    control.throttle = 0.5;
    return cbvs_.take({ChannelId::kCbvControl, slot}, shared(control));
  }
  /// "SLOT VEHICLE TICK BRAKE" of each command that counts.
  std::vector<std::string> given_;
  std::string fault_;  ///< of the newest of them
  double latency_ms_ = std::numeric_limits<double>::quiet_NaN();
  ExternalCbvs cbvs_{kStep, false, [this](const Topic& topic, const AnyMessage& message) {
                       const auto control = messageAs<msgs::ControlAction>(message);
                       EXPECT_EQ(control->slot, topic.slot);
                       EXPECT_EQ(control->planner, "cbv:external");
                       given_.push_back(std::to_string(topic.slot) + " " + control->vehicle_id +
                                        " " + std::to_string(control->tick) + " " +
                                        std::to_string(static_cast<int>(control->brake)));
                       fault_ = control->fault;
                       latency_ms_ = control->planner_latency_ms;
                     }};
};

using Texts = std::vector<std::string>;

TEST_F(ExternalCbvsTest, ACommandCountsOnceTheSelectionIsHere) {
  tick(2);
  EXPECT_EQ(command(2, 1, ""), "");
  EXPECT_EQ(command(2, 0, "car"), "");
  EXPECT_EQ(given_, Texts{});
  select(2, {"car", "truck"});
  EXPECT_EQ(given_, (Texts{"0 car 2 0", "1 truck 2 0"}));
  EXPECT_EQ(fault_, "");
  EXPECT_GE(latency_ms_, 0.0);
  tick(4);
  select(4, {"car", ""});
  EXPECT_EQ(command(4, 0, "car"), "");
  EXPECT_EQ(command(4, 1, "truck"), "") << "the slot is empty";
  EXPECT_EQ(given_.size(), 3U);
}

TEST_F(ExternalCbvsTest, OneForAnotherVehicleBrakesAndSaysSo) {
  tick(2);
  select(2, {"car"});
  EXPECT_EQ(command(2, 0, "cart"), "");
  EXPECT_EQ(given_, Texts{"0 car 2 1"});
  EXPECT_EQ(fault_,
            "cbv_0/control: the command is for vehicle 'cart', and the slot holds 'car'; full "
            "braking instead");
}

TEST_F(ExternalCbvsTest, OneOfAFutureTickOrOfNoneIsRefused) {
  tick(2);
  select(2, {"car"});
  EXPECT_NE(command(4, 0, "car").find("answers tick 4, which has not been"), std::string::npos);
  EXPECT_NE(command(0, 0, "car").find("neither tick nor stamp"), std::string::npos);
  EXPECT_EQ(given_, Texts{});
}

TEST(ExternalCbvsPaced, OneWithoutTickAnswersTheNewestDecision) {
  std::uint64_t answered = 0;
  ExternalCbvs cbvs(kStep, true, [&](const Topic&, const AnyMessage& message) {
    answered = messageAs<msgs::ControlAction>(message)->tick;
  });
  msgs::TrafficSnapshot snapshot;
  snapshot.tick = 6;
  snapshot.decision_tick = true;
  cbvs.published(snapshot);
  snapshot.tick = 7;
  snapshot.decision_tick = false;
  cbvs.published(snapshot);
  msgs::CbvSelection selection;
  selection.tick = 6;
  selection.assignments.emplace_back();
  selection.assignments.back().vehicle_id = "car";
  cbvs.selected(shared(selection));
  EXPECT_EQ(cbvs.take({ChannelId::kCbvControl, 0}, shared(msgs::ControlAction())), "");
  EXPECT_EQ(answered, 6U);
}

}  // namespace
}  // namespace cdiff::node_graph
