// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "planners/course.h"
#include "planners/ppo/ppo_weights.h"
#include "planners/ppo/training/episodes.h"
#include "support/snapshot_builder.h"

namespace cdiff::planners {
namespace {

/// An ego that stands at (10, 0), so that the goal is (16.5, 0), and a CBV that the test puts where
/// it likes; decisions every second tick.
class PpoEpisodes : public ::testing::Test {
 protected:
  explicit PpoEpisodes(bool explores = false)
      : policy_{actor_, explores, core::RandomStream(5, "test")}, log_(policy_, route_) {}

  traffic::TrafficSnapshot at(std::uint64_t tick, double x, double y) const {
    traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(tick, {10.0, 0.0, 0.0, 0.0});
    snapshot.vehicles.push_back(test::vehicle("a", {x, y, 0.0, 5.0}, traffic::VehicleRole::kCbv));
    return snapshot;
  }
  static cbv::CbvSelection selecting(const std::string& id) {
    cbv::CbvSelection selection;
    selection.assignments.emplace_back();
    selection.assignments.back().vehicle_id = id;
    return selection;
  }
  planning::PlannedAction decide(const traffic::TrafficSnapshot& snapshot) {
    log_.look(snapshot);
    log_.settle(snapshot, selecting("a"));
    if (log_.arrived("a")) return {};
    return log_.act(snapshot, {0, snapshot.find("a"), &route_});
  }
  std::vector<double> rewards(const PpoEpisode& episode) const {
    std::vector<double> rewards;
    for (const PpoStep& step : episode.steps) rewards.push_back(step.reward);
    return rewards;
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 200.0, 0.0)}});
  map::Route route_ = testing::routeAlong(network_, {"road"});
  PpoActor actor_{test::constantPpo(0.5F, -0.25F)};
  PpoPolicy policy_;
  PpoEpisodeLog log_;
};

// Along y toward the goal: 12, 11.5, 10 (clipped), then within 4 m: 6.5 - 3.5 clipped to 1, + 15.
TEST_F(PpoEpisodes, EndsAtTheGoal) {
  decide(at(0, 16.5, 12.0));
  log_.look(at(1, 16.5, 11.8));
  decide(at(2, 16.5, 11.5));
  decide(at(4, 16.5, 10.0));
  decide(at(6, 16.5, 3.5));
  EXPECT_TRUE(log_.arrived("a"));
  EXPECT_EQ(log_.steps(), 3U);
  const std::vector<PpoEpisode> episodes = log_.finish();
  ASSERT_EQ(episodes.size(), 1U);
  EXPECT_EQ(episodes[0].end, PpoEnd::kGoal);
  EXPECT_EQ(rewards(episodes[0]), (std::vector<double>{0.5, 1.0, 16.0}));
  EXPECT_DOUBLE_EQ(episodes[0].total(), 17.5);
  // Row of the goal of the second decision: the CBV looks along +x, the goal is 11.5 m to its
  // right.
  EXPECT_NEAR(episodes[0].steps[1].observation[kPpoGoal * kPpoColumns + 1], -11.5F, 1e-5F);
}

// Contact between two decisions: 12 - 11.75, and 15 less unless the other is the ego.
TEST_F(PpoEpisodes, ContactsEndAnEpisodeAtTheirTick) {
  for (const char* other : {"bg_1", "ego"}) {
    PpoEpisodeLog log(policy_, route_);
    traffic::TrafficSnapshot begin = at(0, 16.5, 12.0);
    log.look(begin);
    log.act(begin, {0, begin.find("a"), &route_});
    traffic::TrafficSnapshot touch = at(1, 16.5, 11.75);
    touch.contacts = {{"a", other}};
    log.look(touch);
    log.look(at(2, 16.5, 11.0));  // nothing more is rewarded
    const std::vector<PpoEpisode> episodes = log.finish();
    ASSERT_EQ(episodes.size(), 1U) << other;
    const bool ego = std::string(other) == "ego";
    EXPECT_EQ(episodes[0].end, ego ? PpoEnd::kEgoContact : PpoEnd::kOtherContact) << other;
    EXPECT_DOUBLE_EQ(episodes[0].total(), ego ? 0.25 : -14.75) << other;
  }
}

// Not assigned any more at the second decision: rewarded, and cut with what it sees then.
TEST_F(PpoEpisodes, LosingItsSlotCutsAnEpisode) {
  decide(at(0, 16.5, 12.0));
  const traffic::TrafficSnapshot later = at(2, 16.5, 11.5);
  log_.look(later);
  log_.settle(later, {});
  const std::vector<PpoEpisode> episodes = log_.finish();
  ASSERT_EQ(episodes.size(), 1U);
  EXPECT_EQ(episodes[0].end, PpoEnd::kCut);
  EXPECT_EQ(rewards(episodes[0]), std::vector<double>{0.5});
  EXPECT_NEAR(episodes[0].last[kPpoGoal * kPpoColumns + 5], 11.5F, 1e-5F);
}

// A vehicle that is gone, and one that still drives at the end: the decision that waits is dropped,
// and what it saw is the last observation.
TEST_F(PpoEpisodes, DecisionsWithoutOutcomeAreDropped) {
  decide(at(0, 16.5, 12.0));
  decide(at(2, 16.5, 11.5));
  const traffic::TrafficSnapshot gone = test::snapshotWithEgo(4, {10.0, 0.0, 0.0, 0.0});
  log_.look(gone);
  log_.settle(gone, {});
  PpoEpisodeLog other(policy_, route_);
  for (const auto& snapshot : {at(0, 16.5, 12.0), at(2, 16.5, 11.5)}) {
    other.look(snapshot);
    other.settle(snapshot, selecting("a"));
    other.act(snapshot, {0, snapshot.find("a"), &route_});
  }
  for (const std::vector<PpoEpisode>& episodes : {log_.finish(), other.finish()}) {
    ASSERT_EQ(episodes.size(), 1U);
    EXPECT_EQ(rewards(episodes[0]), std::vector<double>{0.5});
    EXPECT_NEAR(episodes[0].last[kPpoGoal * kPpoColumns + 5], 11.5F, 1e-5F);
  }
}

TEST_F(PpoEpisodes, JudgedActionsAreTanhOfTheMean) {
  const planning::PlannedAction planned = decide(at(0, 16.5, 12.0));
  EXPECT_NEAR(planned.action.throttle, std::tanh(0.5), 1e-6);
  EXPECT_NEAR(planned.action.steer, -0.3 * std::tanh(0.25), 1e-6);
}

class PpoExploring : public PpoEpisodes {
 protected:
  PpoExploring() : PpoEpisodes(true) {}
};

// Deviations are exp(0) = 1: over 2000 decisions the mean is that of the network within four
// standard errors (4 / sqrt(2000) = 0.09), and so is the deviation (4 / sqrt(4000) = 0.064); what
// is recorded is the raw draw, what is driven the clipped one.
TEST_F(PpoExploring, SamplesTheGaussian) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint64_t i = 0; i < 2000; ++i) decide(at(2 * i, 16.5, 12.0));
  const std::vector<PpoEpisode> episodes = log_.finish();
  ASSERT_EQ(episodes.at(0).steps.size(), 1999U);
  for (const PpoStep& step : episodes[0].steps) {
    sum += step.action[0];
    squares += (step.action[0] - 0.5) * (step.action[0] - 0.5);
  }
  EXPECT_NEAR(sum / 1999.0, 0.5, 0.09);
  EXPECT_NEAR(std::sqrt(squares / 1999.0), 1.0, 0.064);
}

/// Selects "a" at every decision, and releases nothing.
class AlwaysA : public cbv::VehicleSelector {
 public:
  explicit AlwaysA(cbv::CbvSelection selection) : selection_(std::move(selection)) {}
  void observe(const traffic::TrafficSnapshot&) override {}
  cbv::CbvSelection update(const traffic::TrafficSnapshot&) override { return selection_; }

 private:
  cbv::CbvSelection selection_;
};

TEST_F(PpoEpisodes, WhoArrivedIsGivenBackOnce) {
  PpoEpisodeSelector selector(std::make_unique<AlwaysA>(selecting("a")), log_);
  const traffic::TrafficSnapshot far = at(0, 16.5, 12.0);
  EXPECT_EQ(selector.update(far).assignments.size(), 1U);
  log_.act(far, {0, far.find("a"), &route_});
  selector.observe(at(1, 16.5, 8.0));
  const cbv::CbvSelection arrived = selector.update(at(2, 16.5, 3.0));
  EXPECT_TRUE(arrived.assignments.empty());
  ASSERT_EQ(arrived.released.size(), 1U);
  EXPECT_EQ(arrived.released[0].vehicle_id, "a");
  EXPECT_EQ(arrived.released[0].reason, "goal_reached");
  EXPECT_TRUE(selector.update(at(4, 16.5, 2.0)).released.empty());
}

}  // namespace
}  // namespace cdiff::planners
