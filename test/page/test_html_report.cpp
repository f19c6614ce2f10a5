// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/file.h"
#include "metrics/metric_registry.h"
#include "page/html_report.h"
#include "planning/perception_sample.h"
#include "record/logs/cbv_log.h"
#include "record/seen_session.h"

namespace cdiff::page {
namespace {

using traffic::SessionStatus;

/// The page of the sample session under a scenario name.
std::string pageOf(const std::string& name, SessionStatus status = SessionStatus::kTimedOut) {
  const test::TemporaryFolder scratch;
  session::ScenarioOptions options = test::sampleOptions();
  options.name = name;
  const test::SampleSetup sample(options);
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 120, status, {{120, "planner", "</script><b>fault</b>"}});
  writer.finish(2.0);
  return core::readFile(scratch.path() / "report.html", "report");
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  if (from == std::string::npos) return {};
  const std::size_t to = text.find(end, from + begin.size());
  return text.substr(from + begin.size(), to - from - begin.size());
}

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST(HtmlReport, EscapesNamesEverywhere) {
  const std::string page = pageOf("<img src=x onerror=alert(1)>");
  EXPECT_EQ(page.find("<img src"), std::string::npos);
  EXPECT_NE(page.find("<h1>&lt;img src=x onerror=alert(1)&gt;</h1>"), std::string::npos);
  EXPECT_EQ(page.find("<b>fault"), std::string::npos);
  EXPECT_EQ(countOf(page, "</script>"), 3u);
}

TEST(HtmlReport, LabelsOfThePlayerBeginWithACapital) {
  const std::string row = between(pageOf("s"), "<label>", "keys");
  EXPECT_EQ(row.rfind("Pace <select", 0), 0u) << row;
  EXPECT_NE(row.find("id=\"follow\"> Follow the ego</label>"), std::string::npos) << row;
}

TEST(HtmlReport, AVehicleNameCannotEndTheScript) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(0);
  snapshot.vehicles[2].id = "</script><b>";
  snapshot.status = SessionStatus::kTimedOut;
  session::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
  writer.finish(1.0);
  const std::string page = core::readFile(scratch.path() / "report.html", "report");
  EXPECT_EQ(countOf(page, "</script>"), 3u);
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  const auto data = nlohmann::json::parse(between(page, "id=\"playback\">", "</script>"));
  EXPECT_EQ(data["vehicles"][2][0], "</script><b>");
}

/// The page of the session with images, plans and guidance.
std::string seenPage() {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSeenSession(writer, sample.setup);
  writer.finish(2.0);
  return core::readFile(scratch.path() / "report.html", "report");
}

void expectPictures(const std::string& page, std::size_t least) {
  std::size_t pictures = 0;
  for (std::size_t at = page.find("<svg"); at != std::string::npos;
       at = page.find("<svg", at + 1)) {
    const std::string svg = page.substr(at, page.find("</svg>", at) + 6 - at);
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(svg.c_str())) << svg.substr(0, 200);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    ++pictures;
  }
  EXPECT_GT(pictures, least);
}

TEST(HtmlReport, EveryPictureIsWellFormed) {
  expectPictures(pageOf("crossing"), 6u);  // from above, five charts, legends
  expectPictures(seenPage(), 10u);         // and plan from above, speeds, two objectives
}

TEST(HtmlReport, ShowsWhatTheCbvSawAndPlanned) {
  const std::string page = seenPage();
  const std::string article = between(page, "<article class=\"approach cbv c0\">", "</article>");
  // Ego at (5 + 8 t, -2), CBV at (102, -60 + 6 t): they approach until the end at 6 s, when dx = 49
  // and dy = 22: 53.7 m.
  EXPECT_NE(article.find("<h3>bg_1 at <a class=\"time\" href=\"#t=6.00\">6.00</a> s"),
            std::string::npos)
      << article.substr(0, 300);
  EXPECT_NE(article.find("53.7 m between centers; CBV 6.0 m/s, ego 8.0 m/s"), std::string::npos);
  EXPECT_EQ(countOf(article, "width=\"640\" height=\"384\""), 2u);  // from the CBV and the ego
  EXPECT_EQ(countOf(article, "width=\"160\" height=\"96\""), 1u);   // only the CBV's planner sees
  EXPECT_NE(article.find(record::pngDataUri(test::redAndBlue(120))), std::string::npos);
  // 3 s before is tick 60, driven for 3 s only; the last plan with 3.2 s is that of tick 56.
  EXPECT_NE(article.find("decision at 2.80 s against what was driven in the next 3.2 s: 0.80 m"),
            std::string::npos);
  EXPECT_NE(page.find("speed: value of the chosen plan"), std::string::npos);
  EXPECT_LT(page.size(), 3'000'000u);
}

// Four plans were weighed: three are emphasized, the one of the lowest score is not.
TEST(HtmlReport, ShowsWhatThePlannerWeighed) {
  const std::string article =
      between(seenPage(), "<article class=\"approach cbv c0\">", "</article>");
  const std::string view = between(article, "<figure class=\"plan-view\">", "</figure>");
  EXPECT_EQ(countOf(view, "class=\"candidate best\""), 3u) << view.substr(0, 500);
  EXPECT_EQ(countOf(view, "class=\"candidate\""), 1u);
  for (const char* score : {"0.100", "0.200", "0.300", "0.400"})
    EXPECT_EQ(countOf(view, std::string("weighed with score ") + score), 1u) << score;
  EXPECT_NE(article.find("weighed, the three of the largest scores"), std::string::npos);
}

// At 0, 0.2 and 0.4 s; of the last frame the picture itself shows cells, an edge, a way and a box.
TEST(HtmlReport, DrawsWhatTheEgoPlannerBelievesToSee) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  std::vector<planning::PlannedAction> actions = {{traffic::kEgoSlot, "ego", {}, {}}};
  actions[0].perception = test::samplePerception();
  for (std::uint64_t tick = 0; tick <= 8; ++tick) {
    const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    session::TickRecord record;
    record.snapshot = &snapshot;
    if (snapshot.decision_tick) record.actions = &actions;
    writer.observe(record);
  }
  writer.finish(1.0);
  const std::string page = core::readFile(scratch.path() / "report.html", "report");
  const std::string view = between(page, "<g id=\"perceived\">", "</g>");
  for (const char* style : {"occupied", "edge-seen", "forecast", "vehicle-seen"})
    EXPECT_EQ(countOf(view, std::string("class=\"perceived ") + style + "\""), 1u) << style;
  EXPECT_NE(view.find("--opacity:0.75"), std::string::npos) << "the vehicle's score";
  EXPECT_NE(page.find("vehicle that the planner believes to see"), std::string::npos);
  const auto data = nlohmann::json::parse(between(page, "id=\"playback\">", "</script>"));
  ASSERT_EQ(data["perceived"].size(), 3u);
  ASSERT_EQ(data["perceived"][1].size(), 12u);  // four paths of class, opacity and data
  EXPECT_EQ(data["perceived"][1][9], "vehicle-seen");
  EXPECT_EQ(data["perceived"][1][10], 75);
  EXPECT_EQ(countOf(seenPage(), "id=\"perceived\""), 0u) << "of planners that do not say";
}

TEST(HtmlReport, PlaysBackFrontViewsAndCommands) {
  const auto data =
      nlohmann::json::parse(between(pageOf("crossing"), "id=\"playback\">", "</script>"));
  // bg_1 is a CBV after tick 52; every 8th tick to 120: 56, 64 ... 120.
  ASSERT_EQ(data["views"].size(), 1u);
  const auto& views = data["views"]["0"];
  ASSERT_EQ(views.size(), 9u);
  EXPECT_DOUBLE_EQ(views[0][0], 2.8);
  EXPECT_EQ(data["vehicles"][views[0][1].get<std::size_t>()][0], "bg_1");
  EXPECT_EQ(views[0][2].get<std::string>().substr(0, 4), "/9j/");  // JPEG starts with FF D8 FF
  EXPECT_DOUBLE_EQ(data["period"], 0.4);
  // The ego alone, then the ego and bg_1: index, slot, throttle, brake, steer, gap, 2D-TTC.
  ASSERT_EQ(data["moments"].size(), 31u);
  ASSERT_EQ(data["moments"][0].size(), 7u);
  ASSERT_EQ(data["moments"][30].size(), 14u);
  const auto moment = data["moments"][30].get<std::vector<int>>();
  EXPECT_EQ(moment[1], -1);
  EXPECT_EQ(moment[2], 25);
  EXPECT_EQ(moment[8], 0);
  EXPECT_EQ(moment[12], 4957);   // sqrt((49 - 3.15)^2 + (22 - 3.15)^2) m
  EXPECT_EQ(data["start"], 30);  // they approach until the end
}

TEST(HtmlReport, ACbvBetweenTwoFramesDoesNoHarm) {
  const test::TemporaryFolder scratch;
  session::ScenarioOptions options = test::sampleOptions();
  options.report.front_view_rate = 10.0;
  const test::SampleSetup sample(options);
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  for (std::uint64_t tick = 0; tick <= 4; ++tick) {  // frames at 0 and 4, a view at 2
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    snapshot.vehicles[1].role = traffic::VehicleRole::kCbv;
    snapshot.vehicles[1].cbv_slot = 0;
    if (tick != 2) snapshot.vehicles.erase(snapshot.vehicles.begin() + 1);
    if (tick == 4) snapshot.status = SessionStatus::kTimedOut;
    session::TickRecord record;
    record.snapshot = &snapshot;
    writer.observe(record);
  }
  EXPECT_EQ(writer.result().front_views.views().size(), 1u);
  writer.finish(1.0);
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "report.html"));
}

TEST(HtmlReport, SaysWhyThereIsNoFrontView) {
  EXPECT_NE(seenPage().find("in more pixels than its planner gets"), std::string::npos);
  const test::TemporaryFolder scratch;
  session::ScenarioOptions options = test::sampleOptions();
  options.cbv_planner = "pdm_lite";
  const test::SampleSetup sample(options);
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 60, SessionStatus::kTimedOut);
  writer.finish(1.0);
  const std::string page = core::readFile(scratch.path() / "report.html", "report");
  EXPECT_NE(page.find("its planner pdm_lite sees no images"), std::string::npos);
}

TEST(HtmlReport, ASessionWithoutTicksHasAPage) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  writer.finish(0.0);
  const std::string page = core::readFile(scratch.path() / "report.html", "report");
  EXPECT_NE(page.find("class=\"banner error\""), std::string::npos);
  EXPECT_NE(page.find("The session ended before its first tick."), std::string::npos);
  EXPECT_NE(page.find("No vehicle was selected as CBV: no front view."), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST(HtmlReport, ReportsWhatHappenedUnderTheVerdict) {
  const std::string banner =
      between(pageOf("crossing"), "class=\"banner not_judged\"", "</header>");
  EXPECT_NE(banner.find("bg_1 was the only CBV"), std::string::npos);
  EXPECT_NE(banner.find("No vehicle touched the ego."), std::string::npos);
}

TEST(HtmlReport, EqualSessionsGiveEqualPages) { EXPECT_EQ(seenPage(), seenPage()); }

TEST(HtmlReport, ShowsViewsWithoutImagesAndPlans) {
  const std::string page = pageOf("crossing");
  const std::string article = between(page, "<article class=\"approach cbv c0\">", "</article>");
  EXPECT_EQ(countOf(article, "<img "), 2u);
  EXPECT_EQ(article.find("Plan of the decision"), std::string::npos);
  EXPECT_NE(page.find("No plan of a CBV was guided."), std::string::npos);
}

TEST(HtmlReport, NeedsNothingFromOutside) {
  const std::string page = pageOf("crossing");
  EXPECT_EQ(countOf(page, "http"), countOf(page, "http://www.w3.org/2000/svg"));
  EXPECT_EQ(countOf(page, "src="), countOf(page, "src=\"data:image/png;base64,"));
  for (const char* loader :
       {"@import", "url(", "<link", "<iframe", "fetch(", "XMLHttp", "import("}) {
    EXPECT_EQ(page.find(loader), std::string::npos) << loader;
  }
}

TEST(HtmlReport, ShowsTheInfractionsWithTheirProtocol) {
  const std::string page = pageOf("crossing");
  EXPECT_NE(page.find("Infraction by rift_dev10"), std::string::npos);
  EXPECT_NE(page.find("of 100, by rift_dev10"), std::string::npos);
  EXPECT_NE(page.find("<td>vehicle_collisions</td><td class=\"number\">0.000</td>"),
            std::string::npos);
  EXPECT_NE(page.find("contacts with pedestrians are not told apart"), std::string::npos);
}

TEST(HtmlReport, ShowsTheVerdictFirst) {
  const std::string page = pageOf("crossing");
  const std::size_t banner = page.find("class=\"banner not_judged\"");
  ASSERT_NE(banner, std::string::npos);
  EXPECT_LT(banner, page.find("class=\"figures\""));
  EXPECT_NE(pageOf("crossing", SessionStatus::kError).find("class=\"banner error\""),
            std::string::npos);
}

TEST(HtmlReport, PlaysBackEveryFrame) {
  const std::string page = pageOf("crossing");
  const auto data = nlohmann::json::parse(between(page, "id=\"playback\">", "</script>"));
  // 0 to 6 s every 0.2 s.
  ASSERT_EQ(data["times"].size(), 31u);
  ASSERT_EQ(data["frames"].size(), 31u);
  EXPECT_DOUBLE_EQ(data["times"][30], 6.0);
  EXPECT_EQ(data["vehicles"].size(), 3u);
  const auto& last = data["frames"][30];
  ASSERT_EQ(last.size(), 18u);  // three vehicles of six numbers, the ego last: on top
  EXPECT_EQ(last[12], 0);
  EXPECT_EQ(last[13], 0);
  EXPECT_EQ(last[16], 0);       // heading [deg]
  EXPECT_EQ(last[17], 80);      // 8 m/s
  EXPECT_EQ(last[6 + 4], -90);  // northbound: SVG turns clockwise
  EXPECT_EQ(data["styles"][last[6 + 1].get<std::size_t>()], "cbv c0");
}

TEST(HtmlReport, ShowsRoadTrailsAndConflict) {
  const std::string view = between(pageOf("crossing"), "id=\"top-view\"", "</svg>");
  EXPECT_EQ(countOf(view, "class=\"road\""), 1u);
  EXPECT_EQ(countOf(view, "class=\"trail ego\""), 1u);
  EXPECT_EQ(countOf(view, "class=\"trail cbv c0\""), 1u);
  EXPECT_EQ(countOf(view, "class=\"trail bg\""), 2u);  // bg_2, and bg_1 before its selection
  EXPECT_EQ(countOf(view, "class=\"planned cbv c0\""), 1u);
  EXPECT_EQ(countOf(view, "class=\"conflict\""), 1u);
  EXPECT_NE(view.find(">bg_1</text>"), std::string::npos);
}

TEST(HtmlReport, CallsAVehicleByOneName) {
  const std::string page = seenPage();
  for (const char* other : {"C1 bg_1", ">C1<", "Slot 0", "slot 0"})
    EXPECT_EQ(page.find(other), std::string::npos) << other;
}

TEST(HtmlReport, ListsItsContentsAsLinks) {
  const std::string page = pageOf("crossing");
  const std::string contents = between(page, "<nav class=\"contents\"", "</nav>");
  EXPECT_EQ(countOf(contents, "<a href=\"#"), countOf(page, "<section id=\""));
  EXPECT_NE(contents.find("<a href=\"#what-happened\">What happened</a>"), std::string::npos);
  EXPECT_EQ(countOf(page, "<section id=\"what-happened\">"), 1u);
}

/// The page of a session in which a vehicle touches the ego at tick 113, between two frames, and
/// is gone then.
std::string struckPage(const std::string& by = "bg_1") {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  for (std::uint64_t tick = 100; tick <= 116; ++tick) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    if (tick == 113) snapshot.contacts = {{"ego", by}};
    if (tick > 113) snapshot.vehicles.erase(snapshot.vehicles.begin() + (by == "bg_1" ? 1 : 2));
    if (tick == 116) snapshot.status = SessionStatus::kTimedOut;
    session::TickRecord record;
    record.snapshot = &snapshot;
    writer.observe(record);
  }
  writer.finish(1.0);
  return core::readFile(scratch.path() / "report.html", "report");
}

// The struck CBV is gone at the next frame of 0.2 s, so the contact has a frame and a view.
TEST(HtmlReport, ShowsTheMomentOfAContact) {
  const std::string page = struckPage();
  const auto data = nlohmann::json::parse(between(page, "id=\"playback\">", "</script>"));
  EXPECT_EQ(data["times"], nlohmann::json({5.0, 5.2, 5.4, 5.6, 5.65, 5.8}));
  EXPECT_EQ(data["frames"][4].size(), 18u);  // three vehicles
  EXPECT_EQ(data["frames"][5].size(), 12u);
  EXPECT_DOUBLE_EQ(data["views"]["0"].back()[0], 5.65);
  const std::string moments = between(page, "<p class=\"moments\">", "</p>");
  EXPECT_NE(moments.find("href=\"#t=5.65\">5.65</a> s: ego and bg_1 touch"), std::string::npos)
      << moments;
  const std::string row = between(page, "<section id=\"contacts\">", "</section>");
  EXPECT_NE(row.find("<a class=\"time\" href=\"#t=5.65\">"), std::string::npos) << row;
}

// bg_1, the CBV, comes nearest at the end; bg_2 is background traffic.
TEST(HtmlReport, OpensAtTheContactOfTheEgo) {
  const std::string page = struckPage("bg_2");
  const auto data = nlohmann::json::parse(between(page, "id=\"playback\">", "</script>"));
  EXPECT_EQ(data["start"], 4);
  ASSERT_EQ(data["touched"].size(), data["times"].size());
  EXPECT_EQ(data["vehicles"][data["touched"][4].get<std::size_t>()][0], "bg_2");
  EXPECT_EQ(data["touched"][3], -1);
  const std::string banner = between(page, "class=\"banner", "</header>");
  EXPECT_NE(banner.find("background vehicle bg_2"), std::string::npos) << banner;
  const std::string tiles = between(page, "class=\"figures\"", "<nav");
  EXPECT_NE(tiles.find("0 with CBVs + 1 with background"), std::string::npos) << tiles;
}

TEST(HtmlReport, FoldsManyContacts) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  for (std::uint64_t tick = 0; tick <= 10; ++tick) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    if (tick < 5) snapshot.contacts = {{"ego", "bg_" + std::to_string(10 + tick)}};
    if (tick == 10) snapshot.status = SessionStatus::kTimedOut;
    session::TickRecord record;
    record.snapshot = &snapshot;
    writer.observe(record);
  }
  writer.finish(1.0);
  const std::string page = core::readFile(scratch.path() / "report.html", "report");
  const std::string banner = between(page, "class=\"banner", "</header>");
  const std::string shown = banner.substr(0, banner.find("<details"));
  EXPECT_NE(shown.find("; and 2 more"), std::string::npos) << shown;
  EXPECT_EQ(shown.find("bg_13"), std::string::npos);
  const std::string folded = between(banner, "<summary>All 5 contacts of the ego", "</details>");
  EXPECT_EQ(countOf(folded, "<li>"), 5u);
  EXPECT_NE(folded.find("bg_14"), std::string::npos);
  EXPECT_EQ(countOf(struckPage(), "contacts of the ego</summary>"), 0u);
}

TEST(HtmlReport, DrawsPlansAboveVehicles) {
  const std::string page = seenPage();
  EXPECT_LT(page.find("<g id=\"vehicles\">"), page.find("<g id=\"plans\">"));
}

TEST(HtmlReport, DrawsThePlanOfEachMoment) {
  const auto data = nlohmann::json::parse(between(seenPage(), "id=\"playback\">", "</script>"));
  ASSERT_EQ(data["plans"].size(), data["times"].size());
  EXPECT_TRUE(data["plans"][0].empty());  // no CBV yet
  const auto& last = data["plans"].back();
  ASSERT_EQ(last.size(), 2u);
  EXPECT_EQ(data["vehicles"][last[0].get<std::size_t>()][0], "bg_1");
  EXPECT_EQ(last[1].get<std::string>().front(), 'M');
  EXPECT_EQ(countOf(seenPage(), "<g id=\"plans\">"), 1u);
}

TEST(HtmlReport, GroupsMetricsAndFoldsTheirDefinitions) {
  const std::string page = pageOf("crossing");
  const std::string metrics = between(page, "<section id=\"metrics\">", "</section>");
  for (const char* group : {"<h3>The ego</h3>", "<h3>CBVs</h3>", "<h3>The ego and others</h3>"})
    EXPECT_EQ(countOf(metrics, group), 1u) << group;
  EXPECT_EQ(countOf(metrics, "<details class=\"definition\">"),
            metrics::measureDefinitions().size());
  EXPECT_NE(metrics.find("cbv_minimum_distance_m: The smallest distance of centers"),
            std::string::npos);
}

TEST(HtmlReport, HeadsWithTheTimeToCollisionToCbvs) {
  const std::string tiles = between(pageOf("crossing"), "class=\"figures\"", "<nav");
  const std::size_t to_cbvs = tiles.find(">2D-TTC to CBVs, minimum<");
  EXPECT_NE(to_cbvs, std::string::npos);
  EXPECT_EQ(tiles.find(">2D-TTC, minimum<"), std::string::npos);
  EXPECT_NE(tiles.find("with all traffic ", to_cbvs), std::string::npos);
}

TEST(HtmlReport, KeepsALongSessionSmall) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  // 60 vehicles that wobble for 1500 s: 450 000 poses, and 3750 front views.
  constexpr std::uint64_t kLast = 30000;
  for (std::uint64_t tick = 0; tick <= kLast; tick += 4) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(0);
    snapshot.tick = tick;
    snapshot.time = 0.05 * static_cast<double>(tick);
    snapshot.status = tick == kLast ? SessionStatus::kTimedOut : SessionStatus::kRunning;
    snapshot.vehicles[1].role = traffic::VehicleRole::kCbv;
    snapshot.vehicles[1].cbv_slot = 0;
    snapshot.vehicles[1].state.position.y() = -60.0 + 0.003 * static_cast<double>(tick);
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector2d position(20.0 + 2.5 * i + std::sin(0.3 * static_cast<double>(tick)),
                                     2.0);
      snapshot.vehicles.push_back(test::sampleVehicle(
          "bg_" + std::to_string(100 + i), traffic::VehicleRole::kBackground, position, 0.0, 1.0));
    }
    session::TickRecord record;
    record.snapshot = &snapshot;
    writer.observe(record);
  }
  writer.finish(1.0);
  EXPECT_LT(std::filesystem::file_size(scratch.path() / "report.html"), 6'000'000u);
}

}  // namespace
}  // namespace cdiff::page
