// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/known_measures.h"
#include "record/verdict_cases.h"

namespace cdiff::record {
namespace {

namespace known = metrics::known;
using traffic::SessionStatus;

metrics::SessionMeasures someMeasures() {
  metrics::SessionMeasures measures;
  measures.set(known::kRouteCompletion, {80.0, 1, "", ""});
  measures.protocol = "bench2drive";
  measures.set(known::kDrivingScore, {33.6, 1, "", ""});
  measures.set(known::kEgoDistance, {250.0, 400, "m", ""});
  measures.set(known::kEgoCollisions, {1.0, 1, "", ""});
  measures.set(known::kRedLights, {1.0, 3, "", ""});
  measures.set(known::kStopSigns, {2.0, 2, "", ""});
  measures.set(known::kOutsideLanes, {1.25, 400, "%", ""});
  measures.set(known::kCbvOffRoad, {5.0, 100, "%", ""});
  measures.ego_contacts = {
      {117, 5.85, "bg_1", true, "it did", 5.0, 2.0, "front", "rear", 1, 2, false, true}};
  return measures;
}

Verdict judged(const session::VerdictOptions& rules, SessionStatus status,
               const metrics::SessionMeasures& measures = someMeasures(),
               const std::vector<traffic::Fault>& faults = {}) {
  session::ScenarioOptions options;
  options.verdict = rules;
  return judge(options, status, measures, faults);
}

TEST(Verdict, WhatWasSteeredByHandIsNotJudgedAndByTheScenarioIs) {
  session::ScenarioOptions options;
  options.verdict = session::VerdictOptions::standard();
  const auto judgedWith = [&](const std::string& by) {
    return judge(options, SessionStatus::kCompleted, someMeasures(), {},
                 {{40, {by, "profile", "none", "naturalistic"}, ""}});
  };
  EXPECT_EQ(judgedWith(traffic::kSteeredByScenario).outcome, Outcome::kFailed);
  const Verdict by_hand = judgedWith("node /panel");
  EXPECT_EQ(by_hand.outcome, Outcome::kNotJudged);
  EXPECT_EQ(by_hand.checks.size(), 1u);
  EXPECT_NE(by_hand.reasons.front().find("by hand in 1 change;"), std::string::npos)
      << by_hand.reasons.front();
}

TEST(Verdict, AScenarioThatTurnsToAttackIsJudgedAsOne) {
  metrics::SessionMeasures measures = someMeasures();
  measures.set(known::kRouteCompletion, {95.0, 1, "", ""});
  measures.ego_contacts[0].ego_at_fault = false;
  session::ScenarioOptions options;
  options.verdict = session::VerdictOptions::standard();
  EXPECT_EQ(judge(options, SessionStatus::kCompleted, measures, {}).outcome, Outcome::kFailed);
  options.steering.resize(1);
  options.steering[0].mode = "safety_critical";
  EXPECT_EQ(judge(options, SessionStatus::kCompleted, measures, {}).outcome, Outcome::kStruck);
}

TEST(Verdict, WithoutAnyRuleEverythingThatEndedByItselfIsNotJudged) {
  for (const SessionStatus status :
       {SessionStatus::kCompleted, SessionStatus::kBlocked, SessionStatus::kDeviated,
        SessionStatus::kTimedOut, SessionStatus::kCollided}) {
    const Verdict verdict = judged({}, status);
    EXPECT_EQ(verdict.outcome, Outcome::kNotJudged) << traffic::toText(status);
    EXPECT_EQ(verdict.checks.size(), 1u);
  }
}

TEST(Verdict, ContactsAreReportedWhereNothingIsJudged) {
  metrics::SessionMeasures measures = someMeasures();
  measures.ego_contacts.push_back(
      {118, 5.9, "bg_2", false, "it did not", 5.0, 2.0, "rear", "front", 1, 2});
  session::VerdictOptions rules = session::VerdictOptions::standard();
  rules.judge = false;
  const Verdict verdict = judged(rules, SessionStatus::kCompleted, measures);
  EXPECT_EQ(verdict.outcome, Outcome::kNotJudged);
  EXPECT_EQ(verdict.reasons,
            std::vector<std::string>(
                {"the scenario is not to be judged (verdict.judge is false)",
                 "the ego was at fault in 1 contact: with CBV bg_1 at 5.85 s (it did)",
                 "the ego was struck without fault in 1 contact, by background vehicle bg_2 at "
                 "5.90 s (it did not)"}));
  EXPECT_TRUE(verdict.decided_by.empty());
}

TEST(Verdict, LimitsCountAsMetAtTheLimit) {
  session::VerdictOptions rules;
  rules.minimum_route_completion = 80.0;
  rules.minimum_driving_score = 33.6;
  rules.minimum_ego_distance = 250.0;
  rules.maximum_contacts_at_fault = 1.0;
  rules.maximum_ego_collisions = 1.0;
  rules.maximum_red_lights = 1.0;
  rules.maximum_stop_signs = 2.0;
  rules.maximum_outside_lanes_percent = 1.25;
  rules.maximum_cbv_off_road_percent = 5.0;
  rules.statuses = {"completed", "blocked"};
  const Verdict verdict = judged(rules, SessionStatus::kBlocked);
  EXPECT_EQ(verdict.outcome, Outcome::kPassed);
  EXPECT_EQ(verdict.checks.size(), 11u);  // the session and ten rules
  EXPECT_TRUE(verdict.reasons.empty());
}

TEST(Verdict, NamesEveryRuleThatIsNotMet) {
  session::VerdictOptions rules;
  rules.minimum_route_completion = 90.0;
  rules.minimum_ego_distance = 300.0;
  rules.minimum_driving_score = 50.0;
  rules.maximum_contacts_at_fault = 0.0;
  rules.maximum_ego_collisions = 0.0;
  rules.maximum_red_lights = 0.0;
  rules.maximum_stop_signs = 1.0;
  rules.maximum_outside_lanes_percent = 1.0;
  rules.maximum_cbv_off_road_percent = 4.0;
  rules.statuses = {"completed"};
  const Verdict verdict = judged(rules, SessionStatus::kTimedOut);
  EXPECT_EQ(verdict.outcome, Outcome::kFailed);
  EXPECT_EQ(
      verdict.reasons,
      std::vector<std::string>(
          {"the session ended with status 'timed_out'; allowed: completed",
           "the ego completed 80.0 % of its route; at least 90 % is asked",
           "the ego drove 250.0 m; at least 300 m is asked",
           "the ego was at fault in 1 contact; at most 0 allowed: with CBV bg_1 at 5.85 s (it did)",
           "the ego's driving score by bench2drive was 33.6 %; at least 50 % is asked",
           "the ego had 1 collision; at most 0 allowed",
           "red lights that the ego ran: 1; at most 0 allowed",
           "stop signs that the ego did not obey: 2; at most 1 allowed",
           "share of its route that the ego drove outside the lanes: 1.25 %; at most 1 % allowed",
           "the CBVs were off the road 5.00 % of their time; at most 4 % allowed"}));
  EXPECT_EQ(
      verdict.decided_by,
      std::vector<std::string>({"status", "route_completion", "ego_distance", "contacts_at_fault",
                                "driving_score", "ego_collisions", "red_lights", "stop_signs",
                                "outside_lanes_percent", "cbv_off_road"}));
}

TEST(Verdict, WhatAContactWithoutFaultMeansIsTheScenarios) {
  metrics::SessionMeasures measures = someMeasures();
  measures.ego_contacts[0].ego_at_fault = false;
  session::VerdictOptions rules;
  rules.minimum_route_completion = 50.0;
  const auto outcome = [&](const char* meaning) {
    rules.contact_without_fault = meaning;
    return judged(rules, SessionStatus::kCompleted, measures).outcome;
  };
  EXPECT_EQ(outcome("allowed"), Outcome::kPassed);
  EXPECT_EQ(outcome("struck"), Outcome::kStruck);
  EXPECT_EQ(outcome("failed"), Outcome::kFailed);
  EXPECT_EQ(outcome("by_mode"), Outcome::kFailed);  // naturalistic
}

metrics::EgoContact contactOf(const std::string& partner, bool at_fault, bool braking_avoids) {
  metrics::EgoContact contact;
  contact.partner = partner;
  contact.ego_at_fault = at_fault;
  contact.braking_avoids = braking_avoids;
  return contact;
}

TEST(Verdict, AContactThatNoBrakingAvoidsIsExcusedWhereTheRulesSaySo) {
  metrics::SessionMeasures measures = someMeasures();
  measures.ego_contacts = {contactOf("cbv_1", true, false)};
  session::ScenarioOptions options;
  options.verdict = session::VerdictOptions::standard();
  options.verdict.minimum_route_completion = 0.0;
  const auto outcome = [&](const char* excuse, const char* mode) {
    options.verdict.excuse_unavoidable = excuse;
    options.mode = mode;
    return judge(options, SessionStatus::kCompleted, measures, {}).outcome;
  };
  EXPECT_EQ(outcome("by_mode", "safety_critical"), Outcome::kStruck);
  EXPECT_EQ(outcome("by_mode", "naturalistic"), Outcome::kFailed);
  EXPECT_EQ(outcome("false", "safety_critical"), Outcome::kFailed);
  EXPECT_EQ(outcome("true", "naturalistic"), Outcome::kFailed) << "as any contact fails there";
  EXPECT_EQ(judge(options, SessionStatus::kCompleted, measures, {}).decided_by,
            std::vector<std::string>{"contact_without_fault"});
  measures.ego_contacts = {contactOf("cbv_1", true, true)};
  EXPECT_EQ(outcome("by_mode", "safety_critical"), Outcome::kFailed);
}

TEST(Verdict, AReasonNamesThreeContactsAndCountsTheRest) {
  metrics::SessionMeasures measures = someMeasures();
  measures.ego_contacts.clear();
  for (int i = 0; i < 23; ++i)
    measures.ego_contacts.push_back(contactOf("bg_" + std::to_string(i), false, true));
  session::VerdictOptions rules;
  rules.contact_without_fault = "failed";
  const std::string reason = judged(rules, SessionStatus::kCompleted, measures).reasons.at(0);
  EXPECT_EQ(reason.rfind("the ego was struck without fault in 23 contacts, by background", 0), 0U);
  EXPECT_NE(reason.find("; by background vehicle bg_2 at 0.00 s (); and 20 more"),
            std::string::npos)
      << reason;
  EXPECT_EQ(reason.find("bg_3"), std::string::npos);
}

TEST(Verdict, TurnsOnTheFirstContactOfTheKindThatDecidedIt) {
  metrics::SessionMeasures measures = someMeasures();
  measures.ego_contacts = {contactOf("struck", false, true), contactOf("fault", true, true)};
  session::ScenarioOptions options;
  const auto decider = [&] {
    const Verdict verdict = judge(options, SessionStatus::kCompleted, measures, {});
    return decidingContact(options, verdict, measures.ego_contacts)->partner;
  };
  EXPECT_EQ(decider(), "fault") << "nothing is judged";
  options.verdict.contact_without_fault = "struck";
  EXPECT_EQ(decider(), "struck");
  options.verdict.maximum_contacts_at_fault = 0.0;
  EXPECT_EQ(decider(), "fault");
  measures.ego_contacts.pop_back();
  EXPECT_EQ(decider(), "struck");
  EXPECT_EQ(decidingContact(options, {}, {}), nullptr);
}

// Whatever the ego's contacts were, the verdict's reasons and the story count them alike.
TEST(Verdict, TheStoryNeverContradictsTheReasons) {
  session::ScenarioOptions options;
  options.verdict = session::VerdictOptions::standard();
  options.verdict.minimum_route_completion = 0.0;
  for (const char* mode : {"naturalistic", "safety_critical"}) {
    options.mode = mode;
    for (int kinds = 0; kinds < 64; ++kinds) {
      metrics::SessionMeasures measures = someMeasures();
      measures.ego_contacts.clear();
      for (int i = 0; i < 1 + kinds / 16; ++i) {
        const int kind = kinds >> i;
        measures.ego_contacts.push_back(
            contactOf("cbv_" + std::to_string(i), kind % 2 == 1, kind / 2 % 2 == 1));
      }
      const Verdict verdict = judge(options, SessionStatus::kCompleted, measures, {});
      const std::string story = faultText(options, measures.ego_contacts);
      const bool fault =
          verdict.outcome == Outcome::kFailed && verdict.decided_by.front() == "contacts_at_fault";
      const bool told =
          story == "the ego was at fault" || (story.find("at fault in ") != std::string::npos &&
                                              story.find("at fault in none") == std::string::npos);
      EXPECT_EQ(told, fault) << story << kinds;
      bool excused = false;
      for (const std::string& reason : verdict.reasons)
        excused = excused || reason.find("which excuses it") != std::string::npos;
      EXPECT_EQ(story.find("excused") != std::string::npos, excused) << story << kinds;
    }
  }
}

TEST(Verdict, AnAbsentInfractionIsSkippedWithItsReason) {
  metrics::SessionMeasures measures = someMeasures();
  measures.set(known::kRedLights, {std::nullopt, 0, "", "no road network was given"});
  session::VerdictOptions rules;
  rules.maximum_red_lights = 0.0;
  const Verdict verdict = judged(rules, SessionStatus::kCompleted, measures);
  ASSERT_EQ(verdict.checks.size(), 2u);
  EXPECT_EQ(verdict.checks[1].outcome, CheckOutcome::kSkipped);
  EXPECT_EQ(verdict.checks[1].text, "red_lights is not defined: no road network was given");
  for (const auto* definition : {&known::kRouteCompletion, &known::kEgoDistance,
                                 &known::kDrivingScore, &known::kEgoCollisions})
    measures.set(*definition, {std::nullopt, 0, "", "the metric threw"});
  session::VerdictOptions absent;
  absent.minimum_route_completion = absent.minimum_driving_score = 50.0;
  absent.minimum_ego_distance = 10.0;
  absent.maximum_ego_collisions = 0.0;
  const Verdict skipped = judged(absent, SessionStatus::kCompleted, measures);
  ASSERT_EQ(skipped.checks.size(), 5u);
  for (std::size_t i = 1; i < 5; ++i)
    EXPECT_EQ(skipped.checks[i].outcome, CheckOutcome::kSkipped) << skipped.checks[i].text;
  measures.set(known::kCbvOffRoad, {std::nullopt, 0, "%", "no CBV was driven"});
  rules.maximum_cbv_off_road_percent = 0.0;
  EXPECT_EQ(judged(rules, SessionStatus::kCompleted, measures).checks[2].outcome,
            CheckOutcome::kSkipped);
}

TEST(Verdict, ABrokenSessionIsAnErrorAndItsRulesAreNotJudged) {
  session::VerdictOptions rules;
  rules.minimum_route_completion = 100.0;
  for (const SessionStatus status : {SessionStatus::kError, SessionStatus::kRunning})
    EXPECT_EQ(judged(rules, status).outcome, Outcome::kError);
  EXPECT_EQ(judged(rules, SessionStatus::kInterrupted).outcome, Outcome::kInterrupted);
  const Verdict verdict =
      judged(rules, SessionStatus::kError, someMeasures(), {{3, "simulator", "SUMO was lost"}});
  EXPECT_EQ(verdict.checks[1].outcome, CheckOutcome::kSkipped);
  EXPECT_EQ(verdict.reasons,
            std::vector<std::string>(
                {"the session ended with status 'error': simulator: SUMO was lost"}));
}

TEST(Verdict, OutcomesReadBackFromTheirText) {
  for (const Outcome outcome : {Outcome::kPassed, Outcome::kStruck, Outcome::kFailed,
                                Outcome::kNotJudged, Outcome::kError, Outcome::kInterrupted})
    EXPECT_EQ(outcomeOf(toText(outcome)), outcome);
  EXPECT_THROW(outcomeOf("true"), core::InputError);
  EXPECT_EQ(capitalsOf(Outcome::kNotJudged), "NOT JUDGED");
}

class EveryReader : public testing::TestWithParam<test::VerdictCase> {
 protected:
  EveryReader() {
    writer_.emplace(sample_.setup, test::sampleFacts(), scratch_.path());
    test::playCase(*writer_, GetParam());
    writer_->finish(2.0);
  }
  std::string textOf(const char* name) const {
    return core::readFile(scratch_.path() / name, name);
  }
  std::string word() const { return toText(GetParam().outcome); }
  void expectResult(const test::VerdictCase& wanted) const;
  void expectJunit(const test::VerdictCase& wanted) const;
  void expectContacts(test::Touch touch) const;

  test::TemporaryFolder scratch_;
  test::SampleSetup sample_{test::optionsOf(GetParam())};
  std::optional<page::ResultWriter> writer_;
};

TEST_P(EveryReader, GivesTheSameVerdict) {
  expectResult(GetParam());
  expectJunit(GetParam());
  expectContacts(GetParam().touch);
}

void EveryReader::expectResult(const test::VerdictCase& wanted) const {
  EXPECT_EQ(writer_->result().verdict.outcome, wanted.outcome);
  EXPECT_EQ(writer_->exitCode(), wanted.exit_code);
  const auto summary = nlohmann::json::parse(textOf("summary.json"));
  EXPECT_EQ(summary["verdict"]["outcome"], word());
  const std::string reasons = summary["verdict"]["reasons"].dump();
  EXPECT_NE(reasons.find(wanted.reason), std::string::npos) << reasons;
  EXPECT_EQ(summary["verdict"]["reasons"].empty(), wanted.reason.empty()) << reasons;
  const std::string page = textOf("report.html");
  EXPECT_NE(page.find("class=\"banner " + word() + "\""), std::string::npos);
  EXPECT_NE(page.find(wanted.reason.substr(0, wanted.reason.find('\''))), std::string::npos);
  const std::string table = writer_->table();
  EXPECT_NE(table.find(capitalsOf(wanted.outcome)), std::string::npos) << table;
  EXPECT_NE(table.find(wanted.reason), std::string::npos) << table;
}

void EveryReader::expectJunit(const test::VerdictCase& wanted) const {
  pugi::xml_document junit;
  ASSERT_TRUE(junit.load_string(textOf("junit.xml").c_str()));
  const pugi::xml_node suite = junit.child("testsuites").child("testsuite");
  EXPECT_EQ(suite.attribute("failures").as_int() > 0, wanted.outcome == Outcome::kFailed);
  const bool broke = wanted.outcome == Outcome::kError || wanted.outcome == Outcome::kInterrupted;
  EXPECT_EQ(suite.attribute("errors").as_int(), broke ? 1 : 0);
  EXPECT_EQ(
      suite.select_node("properties/property[@name='verdict']").node().attribute("value").value(),
      word());
  std::string notes;
  for (const auto& note : suite.select_nodes("testcase/system-out"))
    notes += note.node().text().get();
  const bool noted = wanted.outcome == Outcome::kStruck || wanted.outcome == Outcome::kNotJudged;
  EXPECT_EQ(notes.rfind(wordOf(wanted.outcome) + ": ", 0) == 0, noted) << notes;
  const bool touched = noted && wanted.touch != test::Touch::kNone;
  EXPECT_EQ(notes.find("bg_9 at 5.00 s") != std::string::npos, touched) << notes;
  if (wanted.outcome == Outcome::kFailed || broke) {
    const char* path = broke ? "testcase/error" : "testcase/failure";
    const std::string message = suite.select_node(path).node().attribute("message").value();
    EXPECT_NE(message.find(wanted.reason), std::string::npos) << message;
  }
}

void EveryReader::expectContacts(test::Touch touch) const {
  const auto ego = nlohmann::json::parse(textOf("summary.json"))["ego"];
  const bool at_fault = touch == test::Touch::kEgoAtFault || touch == test::Touch::kUnavoidable;
  EXPECT_EQ(ego["contacts_at_fault"], at_fault ? 1 : 0);
  if (touch == test::Touch::kNone) {
    EXPECT_TRUE(ego["contacts"].empty());
    return;
  }
  const auto& contact = ego["contacts"][0];
  EXPECT_EQ(contact["tick"], 100);
  EXPECT_EQ(contact["with"], "bg_9");
  EXPECT_EQ(contact["ego_at_fault"], at_fault);
  EXPECT_EQ(contact["ego_side"], at_fault ? "front" : "rear");
  EXPECT_EQ(contact["ego_speed_mps"], 8.0);
  EXPECT_EQ(contact["other_speed_mps"], at_fault ? 0.0 : 12.0);
  const std::string page = textOf("report.html");
  EXPECT_NE(page.find(std::string("<td>bg_9</td><td>ego</td><td>") + (at_fault ? "yes" : "no")),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, EveryReader, testing::ValuesIn(test::verdictCases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace cdiff::record
