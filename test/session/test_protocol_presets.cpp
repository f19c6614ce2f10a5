// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "e2e_cdiff/core/exceptions.h"
#include "session/session_request.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;

/// What the protocols differ in: ours, and four by their sources.
struct Expected {
  const char* preset;
  double time_limit;
  double time_limit_speed_percent;
  double blocked_time;
  std::int64_t speed_checkpoints;
  bool speed_counts;
  const char* penalty;
};

constexpr Expected kExpected[] = {
    {"any_length", 60.0, 20.0, 60.0, 20, false, "factors"},
    {"bench2drive", 4000 * 0.05, 0.0, 60.0, 20, false, "factors"},
    {"leaderboard_2_0", 300.0, 10.0, 180.0, 4, true, "factors"},
    {"leaderboard_2_1", 300.0, 10.0, 180.0, 4, true, "charges"},
    {"rift_dev10", 40.0, 0.0, 3.0, 20, false, "factors"},
};

TEST(ProtocolPresets, AreTheFiveProtocols) {
  std::vector<std::string> names;
  for (const Expected& expected : kExpected) {
    names.emplace_back(expected.preset);
    const ProtocolOptions options = loadProtocol(expected.preset);
    EXPECT_EQ(options.preset, expected.preset);
    EXPECT_EQ(options.time_limit, expected.time_limit) << expected.preset;
    EXPECT_EQ(options.time_limit_speed_percent, expected.time_limit_speed_percent);
    EXPECT_EQ(options.blocked_time, expected.blocked_time) << expected.preset;
    EXPECT_EQ(options.infractions.speed_checkpoints, expected.speed_checkpoints);
    EXPECT_EQ(options.infractions.speed_counts, expected.speed_counts) << expected.preset;
    EXPECT_EQ(options.infractions.penalty, expected.penalty);
  }
  EXPECT_EQ(shippedProtocols(), names);
}

TEST(ProtocolPresets, OfRiftAreTheDefaults) {
  EXPECT_EQ(core::dumpOptions(loadProtocol("rift_dev10")), core::dumpOptions(ProtocolOptions{}));
}

TEST(ProtocolPresets, UnknownOnesNameTheNearest) {
  try {
    loadProtocol("leaderboard_2_2");
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("the nearest one is 'leaderboard_2_"),
              std::string::npos)
        << error.what();
  }
}

/// A scenario file of its own for a test.
class ProtocolOfAScenario : public testing::Test {
 protected:
  ProtocolOfAScenario() { request_.scenario = (folder_.path() / "scenario.yaml").string(); }
  ProtocolOptions resolved(const std::string& protocol) {
    std::ofstream(request_.scenario) << "network: roundabout\nroute: {edges: [a]}\n" << protocol;
    return resolveRequest(request_).protocol;
  }
  std::string errorOf(const std::string& protocol) {
    try {
      resolved(protocol);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  }
  test::TemporaryFolder folder_;
  SessionRequest request_;
};

TEST_F(ProtocolOfAScenario, FitsARouteOfAnyLengthWithoutAKey) {
  EXPECT_EQ(core::dumpOptions(resolved("")), core::dumpOptions(loadProtocol("any_length")));
}

TEST_F(ProtocolOfAScenario, IsRiftsForARouteOfBench2Drive) {
  request_ = {};
  request_.bench2drive = "routes.xml";
  request_.route = "1";
  request_.network = "roundabout";
  EXPECT_EQ(core::dumpOptions(resolveRequest(request_).protocol),
            core::dumpOptions(loadProtocol("rift_dev10")));
  request_.set = {"protocol.preset=any_length"};
  EXPECT_EQ(core::dumpOptions(resolveRequest(request_).protocol),
            core::dumpOptions(loadProtocol("any_length")));
}

TEST_F(ProtocolOfAScenario, LiesBelowItsOwnKeys) {
  const ProtocolOptions options =
      resolved("protocol:\n  blocked_time: 7\n  preset: leaderboard_2_1\n  penalty: factors\n");
  EXPECT_EQ(options.preset, "leaderboard_2_1");
  EXPECT_EQ(options.blocked_time, 7.0);
  EXPECT_EQ(options.infractions.penalty, "factors");
  EXPECT_EQ(options.time_limit, 300.0);
  EXPECT_EQ(options.infractions.speed_checkpoints, 4);
}

TEST_F(ProtocolOfAScenario, HoldsATimeLimitThatIsGivenAlone) {
  const ProtocolOptions given = resolved("protocol:\n  preset: any_length\n  time_limit: 20\n");
  EXPECT_EQ(given.time_limit, 20.0);
  EXPECT_EQ(given.time_limit_speed_percent, 0.0);
  const ProtocolOptions same = resolved("protocol:\n  time_limit: 60\n");  // the preset's value
  EXPECT_EQ(same.time_limit_speed_percent, 0.0);
  const ProtocolOptions both =
      resolved("protocol:\n  time_limit: 20\n  time_limit_speed_percent: 20\n");
  EXPECT_EQ(both.time_limit_speed_percent, 20.0);
  const ProtocolOptions none = resolved("protocol:\n  blocked_time: 7\n");
  EXPECT_EQ(none.time_limit, 60.0);
  EXPECT_EQ(none.time_limit_speed_percent, 20.0);
  request_.set = {"protocol.time_limit=30"};
  EXPECT_EQ(resolved("protocol:\n  preset: leaderboard_2_0\n").time_limit_speed_percent, 0.0);
}

TEST_F(ProtocolOfAScenario, IsChosenByAnOverrideBelowTheFilesKeys) {
  request_.set = {"protocol.preset=bench2drive", "protocol.deviation_percent=12"};
  const ProtocolOptions options = resolved("protocol:\n  blocked_time: 7\n");
  EXPECT_EQ(options.preset, "bench2drive");
  EXPECT_EQ(options.time_limit, 200.0);
  EXPECT_EQ(options.blocked_time, 7.0);
  EXPECT_EQ(options.deviation_percent, 12.0);
}

TEST_F(ProtocolOfAScenario, ReadsBackResolved) {
  request_.set = {"protocol.preset=leaderboard_2_0"};
  resolved("");
  const ScenarioOptions options = resolveRequest(request_);
  ScenarioOptions again;  // as session.yaml and a bag hold it: no preset is looked up
  core::loadOptions({"dump", core::dumpOptions(options)}, again);
  EXPECT_EQ(again.protocol.blocked_time, 180.0);
  EXPECT_EQ(core::dumpOptions(again), core::dumpOptions(options));
}

TEST_F(ProtocolOfAScenario, ThatIsUnknownNamesLineAndNearest) {
  const std::string error = errorOf("protocol:\n  preset: bench2drives\n");
  EXPECT_NE(error.find(request_.scenario + ":4"), std::string::npos) << error;
  EXPECT_NE(error.find("did you mean 'bench2drive'?"), std::string::npos) << error;
}

TEST_F(ProtocolOfAScenario, WithBadValuesNamesLineKeyAndRange) {
  const std::string negative = errorOf("protocol:\n  collision_repeat_time: -1\n");
  EXPECT_NE(negative.find(":4"), std::string::npos) << negative;
  EXPECT_NE(negative.find("collision_repeat_time"), std::string::npos) << negative;
  EXPECT_NE(negative.find("[0, 86400]"), std::string::npos) << negative;
  const std::string penalty = errorOf("protocol:\n  penalty: charge\n");
  EXPECT_NE(penalty.find("did you mean 'charges'?"), std::string::npos) << penalty;
  const std::string verdict = errorOf("verdict:\n  minimum_driving_score: 101\n");
  EXPECT_NE(verdict.find("[0, 100]"), std::string::npos) << verdict;
  const std::string unknown = errorOf("protocol:\n  speed_checkpoint: 4\n");
  EXPECT_NE(unknown.find("'speed_checkpoints'"), std::string::npos) << unknown;
}

}  // namespace
}  // namespace cdiff::session
