// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <map>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/ppo/ppo_weights.h"
#include "session/closed_loop.h"
#include "session/session_request.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

/// Actions of the CBVs by tick and vehicle, and the faults.
class ActionRecorder : public SessionObserver {
 public:
  void observe(const TickRecord& record) override {
    for (const traffic::Fault& fault : record.snapshot->faults) faults.push_back(fault.text);
    if (record.actions == nullptr) return;
    for (const planning::PlannedAction& action : *record.actions) {
      if (action.slot >= 0) actions[{record.snapshot->tick, action.vehicle_id}] = action.action;
    }
  }

  std::map<std::pair<std::uint64_t, std::string>, traffic::ControlAction> actions;
  std::vector<std::string> faults;
};

ScenarioOptions scenarioWith(const std::vector<std::string>& set) {
  SessionRequest request;
  request.scenario = "crossing_straight";
  request.set = set;
  return resolveRequest(request);
}

ActionRecorder drive(const ScenarioOptions& options) {
  const SessionSetup setup(options);
  ClosedLoop loop(setup);
  ActionRecorder recorder;
  loop.addObserver(recorder);
  const std::atomic<bool> never{false};
  EXPECT_NE(loop.run(never), traffic::SessionStatus::kError);
  return recorder;
}

// With SUMO. The constant network accelerates with 3 tanh(0.4) m/s^2 and does not steer; PDM-Lite,
// which takes over at the goal, knows no such throttle.
TEST(PpoSession, DrivesTheCbvsOfASessionTheSameEachTime) {
  const test::TemporaryFolder folder;
  test::writePpo(folder.path(), test::constantPpo(0.4F, 0.0F));
  const ScenarioOptions options = scenarioWith(
      {"cbv_planner=ppo", "ppo.weights=" + folder.path().string(), "protocol.time_limit=15"});
  const ActionRecorder first = drive(options);
  EXPECT_EQ(first.faults, std::vector<std::string>());
  ASSERT_GT(first.actions.size(), 20U);
  const auto by_network =
      std::count_if(first.actions.begin(), first.actions.end(), [](const auto& entry) {
        return std::abs(entry.second.throttle - std::tanh(0.4)) < 1e-6 && entry.second.steer == 0.0;
      });
  EXPECT_GT(by_network, 20);
  EXPECT_EQ(drive(options).actions, first.actions);
}

TEST(PpoSession, DoesNotDriveTheEgo) {
  try {
    scenarioWith({"ego_planner=ppo"}).validate();
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'ppo', a planner that does not drive the ego"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cdiff::session
