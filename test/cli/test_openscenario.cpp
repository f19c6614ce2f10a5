// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// `cdiff run FILE.xosc`: the shipped example, the same with a planner's controller, files that
// cannot be.
#include <nlohmann/json.hpp>

#include "cli/cdiff_command.h"
#include "record/result_folder.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using record::TraceRow;

constexpr int kPassed = 0;
constexpr int kFailed = 1;
constexpr int kBadInput = 3;

class OpenScenario : public test::CdiffCommand {
 protected:
  void SetUp() override {
    fs::copy(core::shareFolder() / "config/openscenario", path("files"),
             fs::copy_options::recursive);
  }
  /// Replaces a text of the example.
  void change(const std::string& from, const std::string& to) const {
    std::string text = core::readFile(path("files/" + file_), "example");
    const std::size_t place = text.find(from);
    ASSERT_NE(place, std::string::npos) << from;
    core::writeFileAtomically(path("files/" + file_), text.replace(place, from.size(), to));
  }
  int drive(const std::string& results, const std::vector<std::string>& more = {},
            const std::string& ego = "pdm_lite") const {
    std::vector<std::string> words = {
        "run",   path("files/" + file_),     "--ego-planner", ego,          "--quiet",
        "--set", "report.front_view_rate=0", "--results",     path(results)};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  }
  nlohmann::json summary(const std::string& results) const {
    return nlohmann::json::parse(core::readFile(path(results + "/summary.json"), "summary"));
  }
  std::vector<TraceRow> rows(const std::string& results, const std::string& id) const {
    std::vector<TraceRow> rows;
    for (const TraceRow& row : record::readTrace(path(results + "/trace.csv")))
      if (row.id == id) rows.push_back(row);
    return rows;
  }
  std::string file_ = "cut_in.xosc";
};

TEST_F(OpenScenario, TheExampleCutsInAndEndsWithItsTrigger) {
  ASSERT_EQ(drive("first"), kPassed) << output();
  const auto overtaker = rows("first", "overtaker");
  const auto ego = rows("first", "ego");
  ASSERT_FALSE(overtaker.empty());
  // Reference points: the ego at s = 50 m on lane -2, the other 20 m behind it on lane -1.
  EXPECT_NEAR(ego.front().position.x(), 51.4, 0.5);
  EXPECT_NEAR(ego.front().position.y(), -5.25, 0.1);
  EXPECT_NEAR(overtaker.front().position.x(), 31.4, 0.5);
  EXPECT_NEAR(overtaker.front().position.y(), -1.75, 0.1);
  EXPECT_NEAR(overtaker.front().speed, 15.0, 1e-9);
  EXPECT_NEAR(overtaker.back().position.y(), -5.25, 0.1);
  EXPECT_NEAR(overtaker.back().speed, 6.0, 1e-9);
  EXPECT_GT(overtaker.back().position.x(), ego.back().position.x());
  EXPECT_NEAR(static_cast<double>(ego.back().tick) * 0.05, 20.0, 0.1);
  EXPECT_EQ(summary("first").at("status"), "completed");
}

TEST_F(OpenScenario, TheSameFileAndSeedGiveTheSameBytes) {
  ASSERT_EQ(drive("first"), kPassed) << output();
  ASSERT_EQ(drive("second"), kPassed) << output();
  EXPECT_EQ(summary("first").at("trace_sha256"), summary("second").at("trace_sha256"));
}

TEST_F(OpenScenario, AControllersNameMakesAVehicleACbv) {
  const std::string entity =
      "<ScenarioObject name=\"overtaker\">\n      <CatalogReference "
      "catalogName=\"vehicles\" entryName=\"car\"/>";
  change(entity, entity + "<ObjectController><Controller name=\"pdm_lite\"/></ObjectController>");
  ASSERT_LE(drive("attacked"), 1) << output();
  const std::vector<TraceRow> rows = this->rows("attacked", "overtaker");
  EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [](const TraceRow& row) {
    return row.role == traffic::VehicleRole::kCbv;
  }));
}

TEST_F(OpenScenario, TheEgoBrakesForThePedestrian) {
  file_ = "crossing_pedestrian.xosc";
  ASSERT_EQ(drive("braked"), kPassed) << output();
  EXPECT_EQ(summary("braked").at("ego").at("collisions"), 0);
  const std::vector<TraceRow> ego = rows("braked", "ego");
  const auto slowest = std::min_element(
      ego.begin(), ego.end(),
      [](const TraceRow& left, const TraceRow& right) { return left.speed < right.speed; });
  EXPECT_LT(slowest->speed, 4.0);             // 8 m/s before it
  EXPECT_LT(slowest->position.x(), 150.0);    // ahead of the pedestrian
  EXPECT_GT(ego.back().position.x(), 160.0);  // and then it goes on
  EXPECT_EQ(rows("braked", "bin").back().position.x(), 120.0);
  EXPECT_GT(rows("braked", "walker").back().position.y(), 0.0);
}

TEST_F(OpenScenario, AContactWithThePedestrianCountsAndACarefulDriverAvoidsIt) {
  file_ = "crossing_pedestrian.xosc";
  ASSERT_EQ(drive("hit", {}, "constant"), kFailed) << output();
  EXPECT_EQ(summary("hit").at("ego").at("collisions"), 1);
  ASSERT_EQ(cdiff({"what_if", path("hit"), "--contact", "1", "--without-latest"}), 0) << output();
  const auto found = nlohmann::json::parse(
      core::readFile(path("hit/what_if/contact_1_careful_driver.json"), "answer"));
  EXPECT_EQ(found.at("contact").at("with"), "walker");
  EXPECT_TRUE(found.at("closed").at("avoids").get<bool>()) << found.dump(2);
}

// Twenty entities with the controller of a planner; each may be a CBV.
TEST_F(OpenScenario, MayHaveManyCbvs) {
  std::string entities;
  std::string places;
  for (int i = 0; i < 20; ++i) {
    const std::string name = "car_" + std::to_string(i);
    entities += "<ScenarioObject name=\"" + name +
                "\"><CatalogReference catalogName=\"vehicles\" entryName=\"car\"/>"
                "<ObjectController><Controller name=\"pdm_lite\"/></ObjectController>"
                "</ScenarioObject>";
    places += "<Private entityRef=\"" + name +
              "\"><PrivateAction><TeleportAction><Position><LanePosition roadId=\"1\" laneId=\"" +
              (i % 2 == 0 ? "-1" : "-2") + "\" s=\"" + std::to_string(80 + 12 * i) +
              "\"/></Position></TeleportAction></PrivateAction></Private>";
  }
  change("</Entities>", entities + "</Entities>");
  change("<Private entityRef=\"overtaker\">", places + "<Private entityRef=\"overtaker\">");
  ASSERT_LE(drive("many", {"--set", "protocol.time_limit=5"}), kFailed) << output();
  EXPECT_EQ(rows("many", "car_19").front().role, traffic::VehicleRole::kBackground);
  const std::string keys = core::readFile(path("many/session.yaml"), "session");
  EXPECT_NE(keys.find("max_cbv: 20"), std::string::npos);
}

TEST_F(OpenScenario, WhatIsNotSupportedIsRefusedOrListedInTheSummary) {
  change("<LaneChangeAction>", "<TrailerAction>");
  change("</LaneChangeAction>", "</TrailerAction>");
  EXPECT_EQ(drive("refused"), kBadInput);
  expectOutput("cut_in.xosc:84: <TrailerAction>: this action is not supported");
  EXPECT_FALSE(fs::exists(path("refused")));
  ASSERT_EQ(drive("ignored", {"--ignore-unsupported"}), kPassed) << output();
  const std::string faults = summary("ignored").at("faults").dump();
  EXPECT_NE(faults.find("TrailerAction"), std::string::npos) << faults;
}

TEST_F(OpenScenario, ARoadThatIsNotThereIsBadInput) {
  change("roadId=\"1\"", "roadId=\"7\"");
  EXPECT_EQ(drive("nowhere"), kBadInput);
  expectOutput("cut_in.xosc:37: the network");
  expectOutput("has no road '7'");
  EXPECT_FALSE(fs::exists(path("nowhere")));
}

TEST_F(OpenScenario, ANetworkThatIsNotThereIsBadInput) {
  change("straight_road.xodr", "other.xodr");
  EXPECT_EQ(drive("nowhere"), kBadInput);
  expectOutput("cut_in.xosc:15: there is no network file");
  EXPECT_FALSE(fs::exists(path("nowhere")));
}

}  // namespace
}  // namespace cdiff::cli
