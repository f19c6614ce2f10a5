// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>

#include "e2e_cdiff/core/exceptions.h"
#include "exchange/recorded_scene.h"
#include "exchange/recorded_session.h"

namespace cdiff::exchange {
namespace {

class RecordedSceneTest : public testing::Test {
 protected:
  std::string errorOf(const SceneOptions& options = {}) const {
    try {
      readScene(session_.folder(), options);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  }
  void append(const std::string& name, const std::string& text) const {
    std::ofstream(session_.path(name), std::ios::app) << text;
  }
  test::RecordedSession session_;
};

void expectPart(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\nin\n" << text;
}

TEST_F(RecordedSceneTest, SizesAndFactsAreTheSessions) {
  const RecordedScene scene = readScene(session_.folder(), {0.0, {}, "all"});
  EXPECT_TRUE(scene.sizes_known);
  ASSERT_EQ(scene.vehicles.size(), 3U);
  EXPECT_EQ(scene.vehicles[0].id, "ego");
  EXPECT_EQ(scene.vehicles[0].dimensions.length, 4.5);
  EXPECT_EQ(scene.vehicles[1].role, traffic::VehicleRole::kCbv);
  EXPECT_EQ(scene.facts.scenario, "crossing");
  EXPECT_EQ(scene.facts.seed, 7);
  EXPECT_EQ(scene.facts.status, "timed_out");
  EXPECT_NEAR(scene.duration(), 5.0, 1e-9);
}

TEST_F(RecordedSceneTest, AResultWithoutSizesSaysSo) {
  std::filesystem::remove(session_.folder() / "vehicles.csv");
  const RecordedScene scene = readScene(session_.folder(), {});
  EXPECT_FALSE(scene.sizes_known);
  EXPECT_EQ(scene.vehicles[0].dimensions.length, 4.5);
}

TEST_F(RecordedSceneTest, OptionsThatCannotBeAreRefused) {
  expectPart(errorOf({-1.0, {}, "all"}), "expected 0 <= from < to");
  expectPart(errorOf({2.0, 1.0, "all"}), "expected 0 <= from < to");
  expectPart(errorOf({0.0, 9.0, "all"}), "lasts 5 s");
  expectPart(errorOf({5.0, {}, "all"}), "lasts 5 s");
  expectPart(errorOf({0.0, {}, "bus"}), "expected 'all', or some of ego, cbv, near");
  expectPart(errorOf({0.0, {}, "all,ego"}), "expected 'all', or some of ego, cbv, near");
  expectPart(errorOf({0.0, {}, ","}), "--vehicles is empty");
}

TEST_F(RecordedSceneTest, AChangedTraceIsRefused) {
  append("result/trace.csv", "101,ego,ego,1,2,0,3,,,\n");
  expectPart(errorOf(), "is not the trace that summary.json names");
}

TEST_F(RecordedSceneTest, AnotherNetworkIsRefused) {
  append("crossing.net.xml", "<!-- changed -->\n");
  expectPart(errorOf(), "put back what the session ran with");
}

TEST_F(RecordedSceneTest, BrokenSizesAreNamedByTheirLine) {
  append("result/vehicles.csv", "x,0,1,1\n");
  expectPart(errorOf(), "vehicles.csv:5: no size of a vehicle");
}

}  // namespace
}  // namespace cdiff::exchange
