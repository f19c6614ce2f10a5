// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <malloc.h>
#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <set>
#include <stdexcept>

#include "core/file.h"
#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"
#include "page/result_writer.h"
#include "record/seen_session.h"

namespace cdiff::page {
namespace {

using Json = nlohmann::ordered_json;
using traffic::SessionStatus;

std::string textOf(const test::TemporaryFolder& scratch, const std::string& name) {
  return core::readFile(scratch.path() / name, name);
}

Json summaryOf(const test::TemporaryFolder& scratch) {
  return Json::parse(textOf(scratch, "summary.json"));
}

std::vector<std::string> keysOf(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

/// A session of 121 ticks (6 s) with this end; answers the exit code.
int runSample(const test::TemporaryFolder& scratch, SessionStatus status,
              const session::ScenarioOptions& options = test::sampleOptions(),
              const std::vector<traffic::Fault>& faults = {}) {
  const test::SampleSetup sample(options);
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 120, status, faults);
  writer.finish(2.0);
  return writer.exitCode();
}

/// Compares the method that summary, report and table of the sample session name.
void expectMethod(const session::ScenarioOptions& options, const std::string& name,
                  const std::string& text) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample(options);
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 120, SessionStatus::kTimedOut, {});
  writer.finish(2.0);
  EXPECT_EQ(summaryOf(scratch)["method"], name);
  EXPECT_EQ(summaryOf(scratch)["method_preset"], "default");
  const std::string page = core::readFile(scratch.path() / "report.html", "report");
  EXPECT_NE(page.find(" · method " + text), std::string::npos);
  EXPECT_NE(writer.table().find("\n  method                  " + text + "\n"), std::string::npos)
      << writer.table();
}

/// A session whose vehicles stand: a CBV is planned for at each decision, and every second another
/// vehicle drives in the background.
class StandingSession {
 public:
  explicit StandingSession(const session::SessionSetup& setup)
      : selection_(test::sampleSelection(100, setup.network())), actions_(1) {
    actions_[0].slot = 0;
    actions_[0].vehicle_id = "bg_1";
    actions_[0].rollout.resize(80);
    actions_[0].candidates = {{std::vector<Eigen::Vector2d>(8), 1.0, true}};
    actions_[0].guidance.objectives = {{"collision_avoidance", 1.0, 2.0, 3.0, 0.0, 0}};
  }
  void show(session::SessionObserver& observer, std::uint64_t ticks) {
    for (const std::uint64_t end = tick_ + ticks; tick_ < end; ++tick_) {
      traffic::TrafficSnapshot snapshot = test::sampleSnapshot(100);
      snapshot.tick = tick_;
      snapshot.time = 0.05 * static_cast<double>(tick_);
      snapshot.decision_tick = tick_ % 2 == 0;
      snapshot.vehicles[2].id = "bg_" + std::to_string(2 + tick_ / 20);
      session::TickRecord record;
      record.snapshot = &snapshot;
      if (snapshot.decision_tick) {
        record.selection = &selection_;
        record.actions = &actions_;
        record.latencies = {{"cbv:diffusion", 1.0}};
      }
      observer.observe(record);
    }
  }

 private:
  cbv::CbvSelection selection_;
  std::vector<planning::PlannedAction> actions_;
  std::uint64_t tick_ = 0;
};

// Each decision adds a plan of some 3 kB, and each frame three poses.
TEST(ResultWriter, ALongSessionGrowsOnTheDiskAlone) {
  constexpr std::uint64_t kTicks = 10000;
  session::ScenarioOptions options = test::sampleOptions();
  options.report.front_view_rate = 0.0;  // of a fixed size
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample(options);
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  StandingSession session(sample.setup);
  session.show(writer, kTicks);
  const std::size_t before = ::mallinfo2().uordblks;
  session.show(writer, kTicks);
  EXPECT_LT(::mallinfo2().uordblks, before + 10 * kTicks);  // [bytes]
}

TEST(ResultWriter, SummaryReportAndTableNameTheMethod) {
  session::ScenarioOptions options = test::sampleOptions();
  options.cbv_planner = "diffusion";
  options.guidance = guidance::loadProfile("naturalistic");
  expectMethod(options, "default", "default");
  options.guidance.find("speed").weight = 7.0;
  expectMethod(options, "custom", "custom (default but for guidance.speed.weight)");
}

TEST(ResultWriter, WhatOthersSayIsCutAndSafeToShow) {
  const test::TemporaryFolder scratch;
  runSample(scratch, SessionStatus::kError, test::sampleOptions(),
            {{3, "my\033[31mego", "\007" + std::string(100000, 'x')}});
  const Json fault = summaryOf(scratch)["faults"].back();
  EXPECT_EQ(fault["source"], "my\xEF\xBF\xBD[31mego");
  EXPECT_EQ(fault["text"].get<std::string>().rfind("\xEF\xBF\xBDx", 0), 0U);
  EXPECT_LT(fault["text"].get<std::string>().size(), 1100U);
}

TEST(ResultWriter, ItsTableIsSafeToShow) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample(test::sampleOptions());
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 120, SessionStatus::kTimedOut);
  traffic::TrafficSnapshot snapshot;
  snapshot.status = SessionStatus::kTimedOut;
  session::TickRecord record;
  record.snapshot = &snapshot;
  record.latencies = {{"ego:my\033[31mego", 1.0}};
  writer.observe(record);
  writer.recordFault({3, "recorder", "\033[31m" + std::string(100000, 'x')});
  writer.finish(2.0);
  EXPECT_EQ(writer.table().find('\033'), std::string::npos) << writer.table();
  EXPECT_NE(writer.table().find("ego:my\xEF\xBF\xBD[31mego"), std::string::npos) << writer.table();
  const std::string text = summaryOf(scratch)["faults"][0]["text"];
  EXPECT_EQ(text.rfind("\xEF\xBF\xBD[31mx", 0), 0U);
  EXPECT_LT(text.size(), 1100U);
}

TEST(ResultWriter, SummaryHasTheAgreedKeysInOrder) {
  const test::TemporaryFolder scratch;
  EXPECT_EQ(runSample(scratch, SessionStatus::kTimedOut), 0);
  const Json summary = summaryOf(scratch);
  using Keys = std::vector<std::string>;
  EXPECT_EQ(keysOf(summary), Keys({"schema_version",
                                   "scenario",
                                   "seed",
                                   "mode",
                                   "method",
                                   "method_preset",
                                   "method_changes",
                                   "ego_planner",
                                   "cbv_planner",
                                   "status",
                                   "simulated_seconds",
                                   "wall_seconds",
                                   "real_time_factor",
                                   "trace_sha256",
                                   "ego",
                                   "hold_up",
                                   "cbv",
                                   "guidance",
                                   "guidance_trust_region_share",
                                   "metrics",
                                   "planner_latency_ms",
                                   "late_answers",
                                   "steering",
                                   "faults",
                                   "verdict"}));
  EXPECT_EQ(keysOf(summary["ego"]), Keys({"route_completion_percent",
                                          "driving_score",
                                          "protocol",
                                          "driving_score_under_attack",
                                          "driving_score_under_attack_reason",
                                          "penalty",
                                          "infractions",
                                          "infractions_n",
                                          "blocked",
                                          "collisions",
                                          "contacts_at_fault",
                                          "contacts",
                                          "collisions_per_km",
                                          "struck_cbvs",
                                          "struck_cbvs_per_km",
                                          "struck_by_cbvs",
                                          "struck_by_cbvs_per_km",
                                          "struck_background",
                                          "struck_background_per_km",
                                          "struck_by_background",
                                          "struck_by_background_per_km",
                                          "struck_standing",
                                          "struck_standing_per_km",
                                          "contacts_braking_avoids",
                                          "contacts_braking_avoids_per_km",
                                          "near_misses",
                                          "near_misses_per_km",
                                          "off_road_percent",
                                          "distance_m"}));
  EXPECT_EQ(keysOf(summary["cbv"]), Keys({"count",
                                          "decisions",
                                          "off_road_rate_percent",
                                          "corner_off_road_rate_percent",
                                          "wrong_way_percent",
                                          "collisions",
                                          "collisions_with_ego",
                                          "collisions_with_moving_ego",
                                          "collisions_per_km",
                                          "collisions_with_ego_per_km",
                                          "struck_background",
                                          "struck_background_per_km",
                                          "struck_by_background",
                                          "struck_by_background_per_km",
                                          "contacts_with_cbvs",
                                          "contacts_with_cbvs_per_km",
                                          "standing_on_free_road",
                                          "standing_on_free_road_per_km",
                                          "standing_on_free_road_percent",
                                          "uncomfortable_rate_percent",
                                          "speed_error_mps",
                                          "closest_distance_m",
                                          "minimum_distance_m",
                                          "distance_m",
                                          "post_encroachments",
                                          "selections",
                                          "rejected",
                                          "faults",
                                          "plan"}));
  EXPECT_EQ(keysOf(summary["cbv"]["selections"][0]),
            Keys({"slot", "planner", "vehicle_id", "selected_tick", "selected_seconds",
                  "interaction_score", "conflict_point", "decisions_driven", "released_tick",
                  "release_reason", "contact_with", "route_length_m", "route_completion_percent",
                  "conflict_point_passed", "route_completed"}));
  EXPECT_EQ(
      keysOf(summary["cbv"]["selections"][0]["conflict_point"]),
      Keys({"x", "y", "z", "ego_distance_m", "cbv_distance_m", "ego_arrival_s", "cbv_arrival_s",
            "arrival_time_gap_s", "ego_arc_length_m", "in_junction_or_beyond"}));
  EXPECT_EQ(keysOf(summary["metrics"]), Keys({"ttc_2d_s",
                                              "ttc_2d_defined_percent",
                                              "ttc_2d_cbv_s",
                                              "ttc_2d_cbv_defined_percent",
                                              "ttc_following_percent",
                                              "ttc_following_cbv_percent",
                                              "ttc_cbv_share_percent",
                                              "ttc_background_share_percent",
                                              "ttc_following_mean_s",
                                              "ttc_cbv_set_mean_s",
                                              "ttc_background_set_mean_s",
                                              "ttc_lon_lat_s",
                                              "ttc_lon_lat_defined_percent",
                                              "post_encroachment_s",
                                              "cbv_edge_distance_m",
                                              "speed_mps",
                                              "acceleration_mps2",
                                              "jerk_mps3",
                                              "speed_shapiro_wilk",
                                              "speed_shapiro_wilk_p",
                                              "acceleration_shapiro_wilk",
                                              "acceleration_shapiro_wilk_p",
                                              "speed_wasserstein_mps",
                                              "rift_compat"}));
}

/// Places of all numbers (and nulls) of measures below `object`, whose own place is `place`.
void addPlaces(const Json& object, const std::string& place, std::set<std::string>& places) {
  for (const auto& [key, value] : object.items()) {
    const std::string here = place + "/" + key;
    const bool list = value.is_array();
    const bool other = key == "n" || here == "/ego/infractions_n" || here == "/cbv/plan" ||
                       here == "/cbv/rejected" || here == "/cbv/faults";
    if (list || other) continue;
    if (value.is_object()) addPlaces(value, here, places);
    if (value.is_number() || value.is_boolean() || value.is_null()) places.insert(here);
  }
}

TEST(ResultWriter, EveryMeasureOfTheSummaryIsDefinedAndInItsPlace) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 120, SessionStatus::kTimedOut);
  writer.finish(2.0);
  const Json summary = summaryOf(scratch);
  std::set<std::string> places;
  for (const char* section : {"ego", "cbv", "metrics"})
    addPlaces(summary[section], "/" + std::string(section), places);
  std::set<std::string> defined;
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
    defined.insert(definition.place);
    const Json& there = summary.at(Json::json_pointer(definition.place));
    const metrics::Measure measure = writer.result().measures.at(definition);
    if (measure.value) {
      const double number = there.is_boolean() ? there.get<bool>() : there.get<double>();
      EXPECT_EQ(number, *measure.value) << definition.place;
    } else {
      EXPECT_TRUE(there.is_null()) << definition.place;
    }
    EXPECT_EQ(measure.unit, definition.unit) << definition.name;
  }
  EXPECT_EQ(places, defined);
}

TEST(ResultWriter, SummaryNamesWhatSpeedsAreComparedWith) {
  session::ScenarioOptions options = test::sampleOptions();
  options.metrics.speed_target = "normal";
  const test::TemporaryFolder scratch;
  runSample(scratch, SessionStatus::kTimedOut, options);
  const Json summary = summaryOf(scratch);
  EXPECT_EQ(summary["metrics"]["speed_wasserstein_mps"]["target"],
            "normal distribution of mean 8 m/s and standard deviation 2 m/s");
  EXPECT_NE(textOf(scratch, "report.html")
                .find("against normal distribution of mean 8 m/s and standard deviation 2 m/s"),
            std::string::npos);
  const Json& encroachments = summary["cbv"]["post_encroachments"];
  ASSERT_EQ(encroachments.size(), 1U);
  EXPECT_EQ(encroachments[0]["vehicle_id"], "bg_1");
  EXPECT_EQ(encroachments[0].contains("reason"), encroachments[0]["seconds"].is_null());
}

TEST(ResultWriter, SummaryNamesADrawnTargetSpeed) {
  session::ScenarioOptions options = test::sampleOptions();
  options.cbv_target_speed.distribution = "normal";
  const test::TemporaryFolder scratch;
  runSample(scratch, SessionStatus::kTimedOut, options);
  const Json summary = summaryOf(scratch);
  EXPECT_EQ(summary["cbv"]["selections"][0]["target_speed_mps"],
            session::cbvTargetSpeed(options.cbv_target_speed, 8.0, 7, "bg_1"));  // seed 7
}

TEST(ResultWriter, SummaryReportsWhatHappened) {
  const test::TemporaryFolder scratch;
  runSample(scratch, SessionStatus::kTimedOut);
  const Json summary = summaryOf(scratch);
  EXPECT_EQ(summary["schema_version"], 1);
  EXPECT_EQ(summary["scenario"], "crossing");
  EXPECT_EQ(summary["seed"], 7);
  EXPECT_EQ(summary["status"], "timed_out");
  EXPECT_DOUBLE_EQ(summary["simulated_seconds"], 6.0);
  EXPECT_DOUBLE_EQ(summary["real_time_factor"], 3.0);  // 6 s in 2 s
  // The ego drives 48 m of 190 m.
  EXPECT_NEAR(summary["ego"]["route_completion_percent"].get<double>(), 100.0 * 48.0 / 190.0, 1e-6);
  EXPECT_EQ(summary["cbv"]["rejected"],
            Json::parse(R"({"no_way": 61})"));  // ticks 0, 2 ... 120
  const Json& selection = summary["cbv"]["selections"][0];
  EXPECT_EQ(selection["vehicle_id"], "bg_1");
  EXPECT_DOUBLE_EQ(selection["selected_seconds"], 2.6);
  EXPECT_EQ(selection["decisions_driven"], 34);  // ticks 54, 56 ... 120
  EXPECT_EQ(summary["cbv"]["decisions"], 34);
  EXPECT_TRUE(selection["released_tick"].is_null());
  EXPECT_EQ(selection["release_reason"], "session_end");
  EXPECT_DOUBLE_EQ(selection["conflict_point"]["ego_distance_m"], 97.0 - 0.4 * 52.0);
  EXPECT_DOUBLE_EQ(selection["conflict_point"]["arrival_time_gap_s"], -0.5);
  EXPECT_EQ(selection["conflict_point"]["in_junction_or_beyond"], true);  // 97 m >= 85 m
  EXPECT_NEAR(selection["route_length_m"].get<double>(), 104.0, 1e-9);
  // It was selected at y = -44 and is at y = -24.
  EXPECT_NEAR(selection["route_completion_percent"].get<double>(), 100.0 * 20.0 / 104.0, 1e-9);
  EXPECT_EQ(selection["conflict_point_passed"], false);
  EXPECT_EQ(selection["route_completed"], false);
  EXPECT_TRUE(selection["contact_with"].is_null());
  EXPECT_TRUE(summary["cbv"]["plan"].is_null());  // no rollouts
  EXPECT_TRUE(summary["guidance"].is_null());
  EXPECT_TRUE(summary["guidance_trust_region_share"].is_null());
  // 61 decisions, 1 ms + 0.01 ms x tick: rank 31 is tick 60, rank ceil(57.95) = 58 is tick 114.
  const Json& latency = summary["planner_latency_ms"]["ego:pdm_lite"];
  EXPECT_DOUBLE_EQ(latency["p50"], 1.6);
  EXPECT_DOUBLE_EQ(latency["p95"], 2.14);
  EXPECT_DOUBLE_EQ(latency["max"], 2.2);
  EXPECT_EQ(latency["n"], 61);
  EXPECT_EQ(summary["verdict"], Json::parse(R"json({"outcome": "not_judged",
                            "reasons": ["the scenario has no rules (group 'verdict'): the session cannot fail, whatever the ego does"],
                            "decided_by": [],
                            "rules": [{"rule": "session", "outcome": "passed",
                                       "found": "the session ended with status 'timed_out'"}]
})json"));
}

TEST(ResultWriter, SummaryReportsTheEgosInfractions) {
  const test::TemporaryFolder scratch;
  runSample(scratch, SessionStatus::kBlocked);
  const Json ego = summaryOf(scratch)["ego"];
  EXPECT_EQ(ego["protocol"], "rift_dev10");
  EXPECT_EQ(ego["penalty"], 1.0);
  EXPECT_EQ(ego["driving_score"], ego["route_completion_percent"]);
  EXPECT_EQ(ego["blocked"], true);
  const Json& found = ego["infractions"];
  for (const char* name :
       {"vehicle_collisions", "red_lights", "stop_signs", "outside_lanes_percent"})
    EXPECT_EQ(found[name], 0.0) << name;
  // 48 of 190 m: five of 20 stretches (9.5 m, 24 ticks). The background drives 6 and 10 m/s, from
  // tick 53 on (the 5th of the third stretch) 10 m/s; the ego 8 m/s: 100, 100, 8 x 24 / (4 x 8 + 20
  // x 10), 80 and 80 %.
  EXPECT_EQ(found["minimum_speed_missed"], 3.0);
  EXPECT_NEAR(found["minimum_speed_percent"].get<double>(), (360.0 + 19200.0 / 232.0) / 5.0, 1e-9);
  EXPECT_EQ(ego["infractions_n"]["minimum_speed_missed"], 5);
  EXPECT_EQ(ego["infractions_n"]["outside_lanes_percent"], 121);
  EXPECT_EQ(ego["infractions_n"]["pedestrian_collisions"], 0);
  EXPECT_TRUE(found["pedestrian_collisions"].is_null());
  EXPECT_EQ(found["pedestrian_collisions_reason"], "contacts with pedestrians are not told apart");
}

TEST(ResultWriter, SummaryReportsWhatWasPlannedAndGuided) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSeenSession(writer, sample.setup);
  writer.finish(2.0);
  const Json summary = summaryOf(scratch);
  const Json& plan = summary["cbv"]["plan"];
  // The plan drifts by 0.25 m/s. Decisions at ticks 52, 54 ... 120; driven until tick 120, so 25,
  // 15 and 5 of them were followed for 20, 40 and 60 ticks.
  const std::size_t followed[] = {25, 15, 5};
  for (int seconds = 1; seconds <= 3; ++seconds) {
    const Json& displacement = plan["displacement_" + std::to_string(seconds) + "s_m"];
    EXPECT_NEAR(displacement["mean"].get<double>(), 0.25 * seconds, 1e-9);
    EXPECT_NEAR(displacement["p95"].get<double>(), 0.25 * seconds, 1e-9);
    EXPECT_EQ(displacement["n"], followed[seconds - 1]);
  }
  // 0.5 m once, 0.1 m 34 times; rank ceil(0.95 x 35) = 34.
  EXPECT_NEAR(plan["state_mismatch_m"]["mean"].get<double>(), (0.5 + 34 * 0.1) / 35.0, 1e-12);
  EXPECT_DOUBLE_EQ(plan["state_mismatch_m"]["p95"], 0.1);
  EXPECT_DOUBLE_EQ(plan["state_mismatch_m"]["max"], 0.5);
  EXPECT_EQ(plan["state_mismatch_m"]["n"], 35);
  EXPECT_EQ(summary["guidance"],
            Json::parse(R"({"speed": {"weight": 1.5, "value": 2.0, "gradient_norm": 0.5,
                                      "capped_share": 0.25, "dropped": 35, "n": 35},
                            "comfort": {"weight": 1.0, "value": null, "gradient_norm": null,
                                        "capped_share": 0.0, "dropped": 0, "n": 35}})"));
  EXPECT_DOUBLE_EQ(summary["guidance_trust_region_share"], 0.125);
  EXPECT_EQ(summary["cbv"]["faults"], Json::parse(R"({"cbv:diffusion": 1})"));
}

TEST(ResultWriter, TraceHashIsThatOfTheFileAndTheSameForTheSameSession) {
  const test::TemporaryFolder first;
  const test::TemporaryFolder second;
  runSample(first, SessionStatus::kTimedOut);
  session::ScenarioOptions renamed = test::sampleOptions();
  renamed.name = "another name";
  renamed.seed = 8;
  runSample(second, SessionStatus::kTimedOut, renamed);
  EXPECT_EQ(summaryOf(first)["trace_sha256"], core::sha256(textOf(first, "trace.csv")));
  EXPECT_EQ(textOf(first, "trace.csv"), textOf(second, "trace.csv"));
  const std::string trace = textOf(first, "trace.csv");
  EXPECT_EQ(std::count(trace.begin(), trace.end(), '\n'), 1 + 121 * 3);
}

TEST(ResultWriter, AbsentMeasuresAreNullBesideAReason) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 10, SessionStatus::kBlocked);  // over before any CBV
  writer.finish(0.0);
  const Json summary = summaryOf(scratch);
  EXPECT_TRUE(summary["real_time_factor"].is_null());
  EXPECT_EQ(summary["real_time_factor_reason"], "no wall time was measured");
  EXPECT_TRUE(summary["cbv"]["off_road_rate_percent"].is_null());
  EXPECT_FALSE(summary["cbv"]["off_road_rate_percent_reason"].get<std::string>().empty());
  EXPECT_TRUE(summary["cbv"]["collisions_per_km"].is_null());
  EXPECT_FALSE(summary["cbv"]["collisions_per_km_reason"].get<std::string>().empty());
  EXPECT_TRUE(summary["metrics"]["speed_shapiro_wilk"]["value"].is_null());
  EXPECT_EQ(summary["metrics"]["speed_shapiro_wilk"]["n"], 0);
  EXPECT_FALSE(summary["metrics"]["speed_shapiro_wilk"]["reason"].get<std::string>().empty());
  EXPECT_EQ(summary["cbv"]["selections"], Json::array());
}

TEST(ResultWriter, ExitCodesFollowStatusAndVerdict) {
  session::ScenarioOptions strict = test::sampleOptions();
  strict.verdict.minimum_route_completion = 90.0;
  const test::TemporaryFolder scratch;
  EXPECT_EQ(runSample(scratch, SessionStatus::kCompleted), 0);
  EXPECT_EQ(runSample(scratch, SessionStatus::kTimedOut, strict), 1);
  EXPECT_EQ(runSample(scratch, SessionStatus::kError, strict), 2);
  EXPECT_EQ(runSample(scratch, SessionStatus::kInterrupted, strict), 130);
}

TEST(ResultWriter, JunitDistinguishesFailureFromError) {
  session::ScenarioOptions options = test::sampleOptions();
  options.name = "a <b> & \"c\"";
  options.verdict.minimum_route_completion = 90.0;
  const test::TemporaryFolder scratch;
  runSample(scratch, SessionStatus::kTimedOut, options);
  pugi::xml_document junit;
  ASSERT_TRUE(junit.load_string(textOf(scratch, "junit.xml").c_str()));
  pugi::xml_node suite = junit.child("testsuites").child("testsuite");
  EXPECT_STREQ(suite.attribute("name").value(), "a <b> & \"c\"");
  EXPECT_EQ(suite.attribute("tests").as_int(), 2);
  EXPECT_EQ(suite.attribute("failures").as_int(), 1);
  EXPECT_EQ(suite.attribute("errors").as_int(), 0);
  const pugi::xml_node failed =
      suite.find_child_by_attribute("testcase", "name", "route_completion");
  EXPECT_FALSE(failed.child("failure").empty());

  runSample(scratch, SessionStatus::kError, options, {{120, "simulator", "SUMO <died>"}});
  ASSERT_TRUE(junit.load_string(textOf(scratch, "junit.xml").c_str()));
  suite = junit.child("testsuites").child("testsuite");
  EXPECT_EQ(suite.attribute("failures").as_int(), 0);
  EXPECT_EQ(suite.attribute("errors").as_int(), 1);
  EXPECT_EQ(suite.attribute("skipped").as_int(), 1);
  const pugi::xml_node session = suite.find_child_by_attribute("testcase", "name", "session");
  EXPECT_NE(std::string(session.child("error").attribute("message").value()).find("SUMO <died>"),
            std::string::npos);
}

TEST(ResultWriter, ARecordThatStopsWhileRunningIsAnError) {
  const test::TemporaryFolder scratch;
  EXPECT_EQ(runSample(scratch, SessionStatus::kRunning), 2);
  const Json summary = summaryOf(scratch);
  EXPECT_EQ(summary["status"], "error");
  EXPECT_EQ(summary["faults"][0]["source"], "session");
}

TEST(ResultWriter, ASessionThatNeverBeganStillHasItsFiles) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path() / "new" / "folder");
  traffic::TrafficSnapshot snapshot;
  snapshot.status = SessionStatus::kError;
  snapshot.faults = {{0, "simulator", "SUMO did not start"}};
  session::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
  EXPECT_EQ(writer.finish(1.0).outcome, record::Outcome::kError);
  EXPECT_EQ(writer.exitCode(), 2);
  for (const char* name :
       {"session.yaml", "trace.csv", "summary.json", "junit.xml", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "new" / "folder" / name)) << name;
  }
  EXPECT_NE(writer.table().find("SUMO did not start"), std::string::npos) << writer.table();
}

TEST(ResultWriter, TheSameTickAgainChangesTheStatusOnly) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(0);
  session::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
  snapshot.status = SessionStatus::kInterrupted;
  writer.observe(record);
  writer.finish(1.0);
  EXPECT_EQ(writer.exitCode(), 130);
  const std::string trace = textOf(scratch, "trace.csv");
  EXPECT_EQ(std::count(trace.begin(), trace.end(), '\n'), 4);
}

TEST(ResultWriter, TakesAwayWhatAnEarlierSessionLeft) {
  const test::TemporaryFolder scratch;
  core::writeOwnFile(scratch.path() / "summary.json", "old");
  core::writeFileAtomically(scratch.path() / "notes.txt", "mine");
  {
    const test::SampleSetup sample;
    const ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  }  // a session that died
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "summary.json"));
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "trace.csv"));
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "session.yaml"));
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "notes.txt"));
}

TEST(ResultWriter, SessionYamlHoldsTheScenarioItWasRunWith) {
  session::ScenarioOptions options = test::sampleOptions();
  options.name = "colon: \"quote\" # hash";
  options.target_speed = 7.25;
  options.verdict.statuses = {"completed"};
  const test::TemporaryFolder scratch;
  runSample(scratch, SessionStatus::kTimedOut, options);
  const YAML::Node session = YAML::Load(textOf(scratch, "session.yaml"));
  EXPECT_EQ(session["schema_version"].as<int>(), 1);
  EXPECT_EQ(session["deployment"].as<std::string>(), "cdiff run");
  EXPECT_EQ(session["simulator"]["version"].as<std::string>(), "SUMO 1.15.0");
  EXPECT_EQ(session["seeds"]["root"].as<int>(), 7);
  EXPECT_EQ(session["network"]["source_sha256"].as<std::string>(), std::string(64, 'a'));
  EXPECT_EQ(session["network"]["changes"][0].as<std::string>(), test::crossingImport().changes[0]);
  EXPECT_TRUE(session["deterministic"].as<bool>());
  for (const char* name : {"eigen", "yaml_cpp", "nlohmann_json", "compiler"}) {
    const std::string version = session["libraries"][name].as<std::string>("");
    EXPECT_NE(version.find_first_of("0123456789"), std::string::npos) << name << ": " << version;
  }
  session::ScenarioOptions loaded;
  YAML::Emitter scenario_text;
  scenario_text << session["scenario"];
  core::loadOptions({"session.yaml", scenario_text.c_str()}, loaded);
  EXPECT_EQ(core::dumpOptions(loaded), core::dumpOptions(options));
}

TEST(ResultWriter, TableNamesMeasuresVerdictAndPaths) {
  session::ScenarioOptions options = test::sampleOptions();
  options.verdict.minimum_route_completion = 90.0;
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample(options);
  ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 120, SessionStatus::kTimedOut);
  writer.finish(2.0);
  const std::string table = writer.table();
  for (const std::string part :
       {"timed_out", "25.3 %", "FAILED", "at least 90 %", "3.0 times real time"}) {
    EXPECT_NE(table.find(part), std::string::npos) << part << "\n" << table;
  }
  EXPECT_NE(table.find((scratch.path() / "report.html").string()), std::string::npos);
}

TEST(ResultWriter, RefusesAFolderThatIsAFile) {
  const test::TemporaryFolder scratch;
  core::writeFileAtomically(scratch.path() / "file", "");
  const test::SampleSetup sample;
  EXPECT_THROW(ResultWriter(sample.setup, test::sampleFacts(), scratch.path() / "file" / "results"),
               core::InputError);
}

constexpr metrics::MeasureDefinition kBroken = {
    "broken_measure",
    "",
    "Broken measure",
    "m",
    metrics::Direction::kNeither,
    metrics::Subject::kEgo,
    "Has no value.",
    "",
    0,
};

/// Metric of a plug-in that throws at its tenth tick.
class BrokenMetric final : public metrics::Metric {
 public:
  void observe(const metrics::MetricTick&) override {
    if (++ticks_ == 10) throw std::runtime_error("division by zero");
  }
  void report(metrics::MetricSink&) const override {}

 private:
  int ticks_ = 0;
};

// Last: the registration stays for the program's life.
TEST(ResultWriter, KeepsAllElseWhereAMetricOfAPluginThrows) {
  const test::TemporaryFolder scratch;
  EXPECT_EQ(runSample(scratch, SessionStatus::kTimedOut), 0);
  const Json before = summaryOf(scratch);
  const std::string trace = textOf(scratch, "trace.csv");
  metrics::registerMetric(
      {"broken",
       "Throws.",
       {kBroken},
       [](const metrics::MetricContext&) { return std::make_unique<BrokenMetric>(); },
       "broken_plugin.so"});
  const test::TemporaryFolder with_plugin;
  const test::SampleSetup sample(test::sampleOptions());
  ResultWriter writer(sample.setup, test::sampleFacts(), with_plugin.path());
  test::playSession(writer, sample.setup, 120, SessionStatus::kTimedOut);
  writer.finish(2.0);
  EXPECT_EQ(writer.exitCode(), 0);
  EXPECT_EQ(textOf(with_plugin, "trace.csv"), trace);
  Json summary = summaryOf(with_plugin);
  ASSERT_EQ(summary["faults"].size(), 1U);
  EXPECT_EQ(summary["faults"][0]["tick"], 9);
  EXPECT_EQ(summary["faults"][0]["source"], "metric:broken");
  const std::string text = summary["faults"][0]["text"];
  EXPECT_EQ(
      text.rfind("observe() of metric 'broken' of broken_plugin.so threw: division by zero", 0), 0U)
      << text;
  EXPECT_NE(writer.table().find("- metric:broken: " + text + "\n"), std::string::npos)
      << writer.table();
  for (const char* part : {"ego", "cbv"}) EXPECT_EQ(summary[part], before[part]);
  EXPECT_TRUE(summary["metrics"]["broken_measure"]["value"].is_null());
  for (const auto& item : before["metrics"].items())
    EXPECT_EQ(summary["metrics"][item.key()], item.value()) << item.key();
}

}  // namespace
}  // namespace cdiff::page
