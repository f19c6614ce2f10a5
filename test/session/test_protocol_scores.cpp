// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The worked examples of the protocols' driving scores, from snapshots through the session's
/// metrics.
#include <gtest/gtest.h>

#include <functional>

#include "metrics/session_metrics.h"
#include "session/protocol.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::session {
namespace {

/// East along y = 0 for 400 m with a light at x = 200 m (no way through the junction). The ego
/// drives one meter a tick; a background vehicle keeps 10 m/s beside it.
class ProtocolScores : public testing::Test {
 protected:
  /// Changes the tick at which the ego is at x.
  using Event = std::function<void(int x, traffic::TrafficSnapshot& snapshot)>;

  static map::RoadNetwork makeNetwork() {
    return test::NetworkText()
        .edge("a", {"0,0 200,0"}, "w", "j")
        .edge("b", {"200.5,0 400,0"}, "j", "e")
        .edge(":j_0", {"200,0 200.5,0"})
        .connection("a_0", "b_0", ":j_0_0", 's', R"(tl="L" linkIndex="0" state="o")")
        .network();
  }
  static std::vector<Eigen::Vector3d> points() {
    std::vector<Eigen::Vector3d> points;
    for (int x = 0; x <= 400; x += 2) points.emplace_back(x, 0.0, 0.0);
    return points;
  }

  metrics::SessionMeasures drive(const std::string& preset, int to, const Event& event = {}) {
    const ProtocolOptions protocol = loadProtocol(preset);
    metrics::SessionMetricsOptions options;
    options.protocol = protocol.preset;
    options.completion_percent = protocol.completion_percent;
    options.completion_distance = protocol.completion_distance;
    options.infractions = protocol.infractions;
    options.network = &network_;
    metrics::SessionMetrics metrics(options, area_, route_);
    for (int x = 0; x <= to; ++x) {
      auto snapshot = test::snapshotWithEgo(static_cast<std::uint64_t>(x),
                                            {static_cast<double>(x), 0.0, 0.0, 10.0});
      snapshot.vehicles.push_back(test::vehicle("other", {0.0, 8.0, 0.0, 10.0}));
      snapshot.signals = {{"L", "G"}};
      if (event) event(x, snapshot);
      metrics.observe(snapshot, nullptr);
    }
    return metrics.measures();
  }

  static void collide(int x, traffic::TrafficSnapshot& snapshot) {
    if (x == 50) snapshot.contacts.push_back({"ego", "other"});
  }
  static void showRed(int, traffic::TrafficSnapshot& snapshot) {
    snapshot.signals.front().state = "r";
  }
  static void collideAndRunRed(int x, traffic::TrafficSnapshot& snapshot) {
    collide(x, snapshot);
    showRed(x, snapshot);
  }

  map::RoadNetwork network_ = makeNetwork();
  map::DrivableArea area_{network_};
  map::Route route_ = map::matchRoute(network_, points());
};

TEST_F(ProtocolScores, WithoutInfractionsAreTheCompletion) {
  for (const std::string& preset : shippedProtocols()) {
    const metrics::SessionMeasures measures = drive(preset, 400);
    EXPECT_NEAR(*measures.at("ego_driving_score").value, 100.0, 1e-9) << preset;
    EXPECT_EQ(measures.protocol, preset);
    EXPECT_EQ(*measures.at("ego_penalty").value, 1.0);
    EXPECT_EQ(*measures.at("ego_infraction_red_lights").value, 0.0);
    EXPECT_EQ(measures.at("ego_infraction_red_lights").n, 1U);  // one light passed on green
    EXPECT_EQ(*measures.at("ego_blocked").value, 0.0);
  }
}

TEST_F(ProtocolScores, OneVehicleCollisionLeavesSixty) {
  for (const char* preset : {"rift_dev10", "bench2drive", "leaderboard_2_0"})
    EXPECT_NEAR(*drive(preset, 400, collide).at("ego_driving_score").value, 60.0, 1e-9) << preset;
  EXPECT_NEAR(*drive("leaderboard_2_1", 400, collide).at("ego_driving_score").value, 100.0 / 1.7,
              1e-9);
}

TEST_F(ProtocolScores, CollisionAndRedLightMultiplyOnEightyPercent) {
  // 320 of 400 m, 0.6 x 0.7.
  const metrics::SessionMeasures measures = drive("leaderboard_2_0", 320, collideAndRunRed);
  EXPECT_NEAR(*measures.at("ego_completion_percent").value, 80.0, 1e-9);
  EXPECT_NEAR(*measures.at("ego_penalty").value, 0.42, 1e-12);
  EXPECT_NEAR(*measures.at("ego_driving_score").value, 33.6, 1e-9);
}

TEST_F(ProtocolScores, CollisionAndRedLightAddUpInVersion21) {
  const metrics::SessionMeasures measures = drive("leaderboard_2_1", 400, collideAndRunRed);
  EXPECT_NEAR(*measures.at("ego_driving_score").value, 47.62, 5e-3);  // 100 / (1 + 0.7 + 0.4)
  EXPECT_EQ(*measures.at("ego_infraction_vehicle_collisions").value, 1.0);
  EXPECT_EQ(*measures.at("ego_infraction_red_lights").value, 1.0);
}

TEST_F(ProtocolScores, ATenthOutsideTheLanesLeavesNinety) {
  // Half of 4 m and 0.5 m: outside beyond y = 2.5 m. 40 of 400 m.
  const Event outside = [](int x, traffic::TrafficSnapshot& snapshot) {
    if (x > 100 && x <= 140) snapshot.vehicles.front().state.position.y() = 2.6;
  };
  for (const std::string& preset : shippedProtocols()) {
    const metrics::SessionMeasures measures = drive(preset, 400, outside);
    EXPECT_NEAR(*measures.at("ego_infraction_outside_lanes_percent").value, 10.0, 1e-9);
    EXPECT_NEAR(*measures.at("ego_driving_score").value, 90.0, 1e-9) << preset;
  }
}

TEST_F(ProtocolScores, MinimumSpeedIsChargedByTheLeaderboardAlone) {
  // Speed 5, 10, 10, 8 against 10 m/s on the four quarters: 50, 100, 100 and 80 %.
  const Event slow = [](int x, traffic::TrafficSnapshot& snapshot) {
    snapshot.vehicles.front().state.speed = x <= 100 ? 5.0 : x <= 300 ? 10.0 : 8.0;
  };
  const metrics::SessionMeasures measures = drive("leaderboard_2_0", 400, slow);
  EXPECT_NEAR(*measures.at("ego_driving_score").value, 79.9, 1e-9);  // 0.85 x 0.94
  EXPECT_EQ(*measures.at("ego_infraction_minimum_speed_missed").value, 2.0);
  EXPECT_EQ(measures.at("ego_infraction_minimum_speed_missed").n, 4U);
  EXPECT_NEAR(*measures.at("ego_infraction_minimum_speed_percent").value, 82.5, 1e-9);
  EXPECT_NEAR(*drive("leaderboard_2_1", 400, slow).at("ego_driving_score").value, 100.0 / 1.28,
              1e-9);
  for (const char* preset : {"rift_dev10", "bench2drive"}) {
    const metrics::SessionMeasures measured = drive(preset, 400, slow);
    EXPECT_NEAR(*measured.at("ego_driving_score").value, 100.0, 1e-9) << preset;
    // 5 + 5 of 20 stretches are slow; their mean is the same.
    EXPECT_EQ(*measured.at("ego_infraction_minimum_speed_missed").value, 10.0);
    EXPECT_NEAR(*measured.at("ego_infraction_minimum_speed_percent").value, 82.5, 1e-9);
  }
}

TEST_F(ProtocolScores, AContactOfAStandingEgoIsSeenAndNotCharged) {
  const metrics::SessionMeasures measures =
      drive("rift_dev10", 400, [](int x, traffic::TrafficSnapshot& snapshot) {
        collide(x, snapshot);
        if (x == 50) snapshot.vehicles.front().state.speed = 0.0;
      });
  EXPECT_EQ(*measures.at("ego_collisions").value, 1U);
  EXPECT_EQ(*measures.at("ego_infraction_vehicle_collisions").value, 0.0);
  EXPECT_EQ(measures.at("ego_infraction_vehicle_collisions").n, 1U);
  EXPECT_NEAR(*measures.at("ego_driving_score").value, 100.0, 1e-9);
}

TEST_F(ProtocolScores, SayWhenTheEgoWasBlocked) {
  const metrics::SessionMeasures measures =
      drive("rift_dev10", 100, [](int x, traffic::TrafficSnapshot& snapshot) {
        if (x == 100) snapshot.status = traffic::SessionStatus::kBlocked;
      });
  EXPECT_EQ(*measures.at("ego_blocked").value, 1.0);
}

}  // namespace
}  // namespace cdiff::session
