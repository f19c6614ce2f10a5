// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <set>

#include "core/file.h"
#include "e2e_cdiff/core/angle.h"
#include "metrics/session_metrics.h"
#include "session/closed_loop.h"
#include "session/session_request.h"
#include "suite/suite_generator.h"
#include "support/temporary_folder.h"

namespace cdiff::suite {
namespace {

namespace fs = std::filesystem;

std::vector<SuiteRoute> developmentRoutes() { return loadSuite("development").routes; }

session::ScenarioOptions scenarioOf(const SuiteRoute& route, const std::vector<std::string>& set) {
  session::SessionRequest request;
  request.scenario = loadSuite("development").scenarioFile(route).string();
  request.cbv_planner = "pdm_lite";
  request.set = set;
  return session::resolveRequest(request);
}

TEST(DevelopmentSuite, HasTheTenRoutesOnSevenNetworks) {
  std::map<std::string, int> counts;
  std::set<std::string> networks;
  std::set<std::string> densities;
  for (const SuiteRoute& route : developmentRoutes()) {
    ++counts[route.manoeuvre];
    networks.insert(route.network);
    densities.insert(route.density);
  }
  const std::map<std::string, int> expected = {
      {"left", 3}, {"right", 3}, {"straight", 2}, {"roundabout", 1}, {"merge", 1}};
  EXPECT_EQ(counts, expected);
  EXPECT_EQ(networks.size(), 7U);
  EXPECT_EQ(densities.size(), 3U);
}

/// Fixed: the sources and routes are those that the command makes (the networks' bytes depend on
/// SUMO's version too).
TEST(DevelopmentSuite, IsWhatTheCommandMakes) {
  const test::TemporaryFolder folder;
  const Suite shipped = loadSuite("development");
  const Suite made = generateSuite("development", shipped.seed, folder.path() / "made");
  EXPECT_EQ(shipped.seed, defaultSeed("development"));
  EXPECT_EQ(manifestText(made), core::readFile(shipped.folder / "suite.yaml", "suite"));
  for (const auto& entry : fs::recursive_directory_iterator(made.folder)) {
    const fs::path path = fs::relative(entry.path(), made.folder);
    if (!entry.is_regular_file() || path.string().find(".net.xml") != std::string::npos) continue;
    EXPECT_EQ(core::readFile(entry.path(), "made"), core::readFile(shipped.folder / path, "kept"))
        << path;
  }
}

class DevelopmentRoute : public testing::TestWithParam<SuiteRoute> {};

TEST_P(DevelopmentRoute, CarriesTheStandardRules) {
  const session::ScenarioOptions options = scenarioOf(GetParam(), {});
  EXPECT_EQ(core::dumpOptions(options.verdict),
            core::dumpOptions(session::VerdictOptions::standard()));
  EXPECT_EQ(core::dumpOptions(options.protocol),
            core::dumpOptions(session::ProtocolOptions{}));  // rift_dev10, 40 s
}

/// From the route's own points, independent of what the manifest says.
TEST_P(DevelopmentRoute, TurnsAsItsManoeuvreSays) {
  const SuiteRoute& planned = GetParam();
  const session::SessionSetup setup(scenarioOf(planned, {}));
  const map::Route& route = setup.egoRoute();
  EXPECT_GE(route.length(), 80.0);
  EXPECT_LE(route.length(), 200.0);
  ASSERT_FALSE(route.junctionStretches().empty());
  const double begin = route.junctionStretches().front().first;
  const double end = route.junctionStretches().back().second;
  const double turn = core::radiansToDegrees(
      core::wrapAngle(route.path().headingAt(end + 3.0) - route.path().headingAt(begin - 3.0)));
  if (planned.manoeuvre == "left") {
    EXPECT_NEAR(turn, 90.0, 45.0);
  }
  if (planned.manoeuvre == "right") {
    EXPECT_NEAR(turn, -90.0, 45.0);
  }
  if (planned.manoeuvre == "straight") {
    EXPECT_NEAR(turn, 0.0, 25.0);
  }
  if (planned.manoeuvre == "roundabout") {
    EXPECT_GE(route.junctionStretches().size(), 2U);
  }
  if (planned.manoeuvre == "merge") {
    EXPECT_NE(route.edges().front().find("ramp"), std::string::npos);
  }
}

/// Alone on the road PDM-Lite drives all of it, on the road.
TEST_P(DevelopmentRoute, IsDrivenWholeByPdmLiteAlone) {
  const session::SessionSetup setup(scenarioOf(GetParam(), {"demand=none"}));
  struct OffRoad : session::SessionObserver {
    explicit OffRoad(const session::SessionSetup& setup)
        : metrics({}, setup.drivableArea(), setup.egoRoute()) {}
    void observe(const session::TickRecord& record) override {
      const auto measures = metrics.observe(*record.snapshot, record.selection);
      outside += measures.ego_off_road;
      completion = measures.route_completion_percent;
      ++ticks;
    }
    metrics::SessionMetrics metrics;
    double completion = 0.0;
    int ticks = 0;
    int outside = 0;
  } off_road(setup);
  const std::atomic<bool> stop{false};
  session::ClosedLoop loop(setup);
  loop.addObserver(off_road);
  EXPECT_EQ(loop.run(stop), traffic::SessionStatus::kCompleted);
  EXPECT_GT(off_road.ticks, 100);
  EXPECT_EQ(off_road.completion, 100.0);
  EXPECT_EQ(off_road.outside, 0);
}

INSTANTIATE_TEST_SUITE_P(All, DevelopmentRoute, testing::ValuesIn(developmentRoutes()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace cdiff::suite
