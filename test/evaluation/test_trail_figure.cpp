// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <sstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/batch_report.h"
#include "evaluation/run_records.h"
#include "evaluation/trail_figure.h"
#include "evaluation/trail_scene.h"
#include "page/outside_texts.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Ticks 0 to 23 of 0.05 s: the ego drives east from (0, 0), a meter a tick. "bg_1" drives north
/// along x = 10 from y = -20, is a CBV at ticks 8 to 15 and gone then; "bg_2" stands at (12, -5).
std::string traceText(bool with_cbv) {
  std::ostringstream text;
  text << record::kTraceHeader;
  for (int tick = 0; tick < 24; ++tick) {
    text << tick << ",ego,ego," << tick << ",0,0,20,0.5,0,0\n";
    if (with_cbv && tick < 16)
      text << tick << ",bg_1," << (tick < 8 ? "background" : "cbv") << ",10," << tick - 20
           << ",1.5,20,,,\n";
    if (tick < 16) text << tick << ",bg_2,background,12,-5,0,0,,,\n";
  }
  return text.str();
}

constexpr const char* kTouching = R"({"ego": {"contacts": [
    {"tick": 20, "with": "bg_3", "x": 20.0, "y": 0.0}]}, "cbv": {"selections": [
    {"vehicle_id": "bg_1", "selected_tick": 8, "released_tick": 16, "contact_with": "bg_2"},
    {"vehicle_id": "bg_4", "selected_tick": 9, "released_tick": null, "contact_with": "ego"},
    {"vehicle_id": "bg_5", "selected_tick": 9, "released_tick": null, "contact_with": null}]}})";
constexpr const char* kAlone = R"({"ego": {"contacts": []}, "cbv": {"selections": []}})";

class TrailFigure : public testing::Test {
 protected:
  /// A complete run; without a distance no CBV was driven.
  void add(const std::string& scenario, const std::string& planner,
           std::optional<double> distance) {
    BatchRun run;
    run.record = test::recordWith({scenario}, 1.0);
    run.record.factors["cbv_planner"] = planner;
    run.folder = scratch_.path() / (scenario + planner);
    fs::create_directories(run.folder);
    core::writeFileAtomically(run.folder / "scenario.yaml", "network: nowhere.net.xml\n");
    core::writeFileAtomically(run.folder / "trace.csv", traceText(distance.has_value()));
    core::writeFileAtomically(run.folder / "summary.json", distance ? kTouching : kAlone);
    if (distance) {
      run.numbers = {{"/cbv/minimum_distance_m", *distance},
                     {"/ego/collisions", 3.0},
                     {"/cbv/collisions", 2.0},
                     {"/cbv/collisions_with_ego", 1.0}};
    }
    runs_.push_back(run);
  }
  /// A complete run of another ego among CBVs of PDM-Lite.
  void addEgo(const std::string& scenario, const std::string& planner, double score) {
    add(scenario + "_" + planner, "pdm_lite", 4.0);
    runs_.back().record.factors["scenario"] = scenario;
    runs_.back().record.factors["ego_planner"] = planner;
    runs_.back().numbers["/ego/driving_score"] = score;
    runs_.back().numbers["/ego/route_completion_percent"] = 98.25;
    runs_.back().numbers["/ego/collisions"] = 1.0;
    runs_.back().numbers["/ego/off_road_percent"] = 8.0;
  }
  std::string svg() const { return page::sheetFile(trailFigure(runs_, TrailsOf::kCbvs)->sheet); }

  test::TemporaryFolder scratch_;
  std::vector<BatchRun> runs_;
};

TEST_F(TrailFigure, ThereIsNoneWithoutTwoPlannersOnOneScene) {
  EXPECT_FALSE(trailFigure(runs_, TrailsOf::kCbvs));
  add("s", "pdm_lite", 4.0);
  add("t", "ppo", 4.0);
  EXPECT_FALSE(trailFigure(runs_, TrailsOf::kCbvs));
  add("s", "ppo", 4.0);
  runs_.back().record.status = "error";
  EXPECT_FALSE(trailFigure(runs_, TrailsOf::kCbvs));
  runs_.back().record.status = "completed";
  EXPECT_TRUE(trailFigure(runs_, TrailsOf::kCbvs));
}

TEST_F(TrailFigure, ShowsTheSceneInWhichMostPlannersDroveACbvAndCameNearest) {
  const auto scene = [this] {
    return chosenScene(runs_, TrailsOf::kCbvs).front().run->record.factors.at("scenario");
  };
  for (const char* planner : {"pdm_lite", "ppo", "rift"}) add("r", planner, std::nullopt);
  add("s", "pdm_lite", 6.0);
  add("s", "ppo", std::nullopt);
  EXPECT_EQ(scene(), "s");
  add("t", "pdm_lite", 9.0);
  add("t", "ppo", 8.0);
  EXPECT_EQ(scene(), "t");
  add("u", "pdm_lite", 9.0);
  add("u", "ppo", 7.5);
  EXPECT_EQ(scene(), "u");
  EXPECT_TRUE(has(svg(), "scenario u")) << svg();
}

// Shown are x from 0 to 23 and y from -12 to 0 with 12 m around them: 47 m x 36 m in 560 x 420
// pixels. So 420 / 36 = 11.667 pixels are a meter, and (11.5, -6) lies at (280, 210).
TEST_F(TrailFigure, TrailsDarkenAndContactsAreMarkedWhereTheyWere) {
  add("s", "pdm_lite", 4.44);
  add("s", "ppo", std::nullopt);
  const std::string text = svg();
  EXPECT_GT(test::xmlElementsOf(text).size(), 1U) << test::xmlElementsOf(text).front();
  // A shade is 4 of 24 ticks: the first from x = 0 to x = 4.
  EXPECT_TRUE(has(text, "class=\"trail ego t0\" d=\"M145.8 140L192.5 140\"")) << text;
  EXPECT_TRUE(has(text, "class=\"trail ego t5\"")) << text;
  // As a CBV from y = -12 on: ticks 8 to 12 are the third shade, 12 to 15 the fourth.
  EXPECT_TRUE(has(text, "class=\"trail cbv t2\" d=\"M262.5 280L262.5 233.3\"")) << text;
  EXPECT_TRUE(has(text, "class=\"trail cbv t3\" d=\"M262.5 233.3L262.5 198.3\"")) << text;
  EXPECT_FALSE(has(text, "class=\"trail cbv t1\""));
  EXPECT_FALSE(has(text, "class=\"trail cbv t4\""));
  // At tick 15 between (10, -5) and (12, -5); that of the ego at (20, 0).
  EXPECT_TRUE(has(text, "cx=\"274.2\" cy=\"198.3\"")) << text;
  EXPECT_TRUE(has(text, "contact of bg_1 and bg_2 at 0.75 s")) << text;
  EXPECT_TRUE(has(text, "cx=\"379.2\" cy=\"140\"")) << text;
  EXPECT_FALSE(has(text, "bg_4"));  // its contact is the ego's
  EXPECT_TRUE(has(text, ">pdm_lite</text>")) << text;
  EXPECT_TRUE(
      has(text,
          ">3 contacts of the ego (1 with CBVs + 2 with background), 1 contact of CBVs with "
          "others, nearest CBV 4.4 m</text>"))
      << text;
  EXPECT_TRUE(has(text, ">ppo</text>")) << text;
  EXPECT_TRUE(has(text, ">no contact, no CBV was driven</text>")) << text;
  EXPECT_TRUE(has(text, "Roads are not drawn")) << text;
}

TEST_F(TrailFigure, TheCsvFileHasPlacesEveryHalfSecondAndContacts) {
  add("s", "pdm_lite", 4.0);
  add("s", "ppo", std::nullopt);
  EXPECT_EQ(trailFigure(runs_, TrailsOf::kCbvs)->csv,
            "cbv_planner,tick,seconds,vehicle_id,role,x,y,contact_with\n"
            "pdm_lite,0,0.00,ego,ego,0,0,\n"
            "pdm_lite,10,0.50,ego,ego,10,0,\n"
            "pdm_lite,10,0.50,bg_1,cbv,10,-10,\n"
            "pdm_lite,20,1.00,ego,ego,20,0,\n"
            "pdm_lite,20,1.00,ego,contact,20,0,bg_3\n"
            "pdm_lite,15,0.75,bg_1,contact,11,-5,bg_2\n"
            "ppo,0,0.00,ego,ego,0,0,\n"
            "ppo,10,0.50,ego,ego,10,0,\n"
            "ppo,20,1.00,ego,ego,20,0,\n");
}

TEST_F(TrailFigure, NamesPlannersWhoseRunsBroke) {
  add("s", "pdm_lite", 4.0);
  add("s", "ppo", 4.0);
  add("s", "rift", 4.0);
  runs_.back().record.status = "error";
  runs_.back().record.cause = "SUMO died";
  EXPECT_TRUE(has(svg(), "rift: error, SUMO died")) << svg();
  EXPECT_EQ(chosenScene(runs_, TrailsOf::kCbvs).size(), 2U);
}

TEST_F(TrailFigure, ShowsTheSceneInWhichEgosScoredLeast) {
  const auto scene = [this] {
    return chosenScene(runs_, TrailsOf::kEgo).front().run->record.factors.at("scenario");
  };
  addEgo("s", "pdm_lite", 100.0);
  EXPECT_FALSE(trailFigure(runs_, TrailsOf::kEgo));
  addEgo("s", "plant", 90.0);
  addEgo("t", "pdm_lite", 95.0);
  addEgo("t", "plant", 80.0);
  EXPECT_EQ(scene(), "t");
  addEgo("s", "vad_mini", 90.0);  // worse on the average, and a planner more
  EXPECT_EQ(scene(), "s");
  EXPECT_FALSE(trailFigure(runs_, TrailsOf::kCbvs));  // no two differ in the planner of CBVs alone
}

TEST_F(TrailFigure, SaysWhatBecameOfEachEgo) {
  addEgo("s", "pdm_lite", 68.72);
  addEgo("s", "plant", 90.0);
  const Figure figure = *trailFigure(runs_, TrailsOf::kEgo);
  EXPECT_EQ(figure.id, "ego_trails");
  EXPECT_EQ(figure.csv.substr(0, 17), "ego_planner,tick,");
  const std::string text = page::sheetFile(figure.sheet);
  EXPECT_TRUE(has(text, ">One scene, driven by each ego planner<")) << text;
  EXPECT_TRUE(has(text, ">plant</text>")) << text;
  EXPECT_TRUE(
      has(text, ">98.2 % of the route, driving score 68.7, 1 contact, 8.0 % off the road</text>"))
      << text;
  EXPECT_TRUE(has(text, "cbv_planner pdm_lite")) << text;
  runs_.back().numbers.erase("/ego/off_road_percent");
  EXPECT_TRUE(has(page::sheetFile(trailFigure(runs_, TrailsOf::kEgo)->sheet),
                  "driving score 90.0, 1 contact, ? % off the road</text>"));
}

TEST_F(TrailFigure, ADamagedSummaryIsNamed) {
  add("s", "pdm_lite", 4.0);
  add("s", "ppo", 4.0);
  core::writeFileAtomically(runs_[1].folder / "summary.json", "{\"ego\": {}}");
  try {
    trailFigure(runs_, TrailsOf::kCbvs);
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_TRUE(has(error.what(), "sppo/summary.json' is no summary of a session")) << error.what();
  }
}

/// A batch of two planners that each drove the session of test::writeNamedSession.
TEST_F(TrailFigure, TheReportOfABatchShowsIt) {
  for (const char* planner : {"pdm_lite", "ppo"}) {
    RunRecord record = test::recordWith({"s"}, 1.0);
    record.factors["cbv_planner"] = planner;
    record.id = planner;
    const fs::path folder = scratch_.path() / "runs" / record.id;
    fs::create_directories(folder);
    test::writeNamedSession(folder, "");
    core::writeFileAtomically(folder / "scenario.yaml", core::dumpOptions(test::namedOptions("")));
    core::writeFileAtomically(folder / "record.json", recordJson(record));
  }
  writeBatchReport(scratch_.path(), "two planners");
  const std::string page = core::readFile(scratch_.path() / "index.html", "page");
  EXPECT_TRUE(has(page, "<h2>One scene, driven by each CBV planner</h2>"));
  EXPECT_FALSE(has(page, "id=\"table-1"));
  EXPECT_TRUE(fs::exists(scratch_.path() / "tables" / "table_1.csv"));
  writeBatchReport(scratch_.path(), "paper_tables");  // whose page alone shows the paper's tables
  EXPECT_TRUE(has(core::readFile(scratch_.path() / "index.html", "page"), "id=\"table-1"));
  EXPECT_TRUE(has(core::readFile(scratch_.path() / "figures" / "trails.svg", "figure"),
                  "class=\"trail cbv"));
  EXPECT_TRUE(has(core::readFile(scratch_.path() / "figures" / "trails.csv", "figure"),
                  "\nppo,0,0.00,ego,ego,5,-2,\n"));
}

}  // namespace
}  // namespace cdiff::evaluation
