// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Searches whose sessions a function plays: what they propose, rate, keep and show.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/search/search_page.h"
#include "evaluation/worker.h"
#include "metrics/known_measures.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

/// "key=value" as a number.
double numberOf(const std::string& assignment) {
  return *core::parseNumber(assignment.substr(assignment.find('=') + 1));
}

/// Value of a key in a resolved scenario.
double keyOf(const PlannedRun& run, const std::string& key) {
  const std::size_t place = run.scenario_text.find("\n" + key + ": ") + key.size() + 3;
  return *core::parseNumber(
      run.scenario_text.substr(place, run.scenario_text.find('\n', place) - place));
}

class SearchTest : public testing::Test {
 protected:
  SearchTest() {
    request_.scenario = "crossing_left_turn";
    request_.options.keys = {"target_speed: 5.0 .. 10.0", "max_cbv: 1 .. 4",
                             "cbv.ranking: score | nearest"};
    request_.options.batch = 4;
    request_.options.draws = 8;
    request_.budget = 24;
  }
  /// The ego is hit faster the nearer the target speed is to 10 m/s; a careful driver is hit
  /// wherever `hits_careful_` says so.
  RunRecord play(const PlannedRun& run) {
    played_.push_back(run.id);
    RunRecord record;
    record.id = run.id;
    record.factors = run.factors;
    record.status = run.id == broken_ ? "error" : run.id == cut_ ? "interrupted" : "completed";
    const double speed = keyOf(run, "target_speed");
    const bool careful = run.factors.at("ego_planner") == "careful_driver";
    const bool hit = careful ? hits_careful_ : speed > 6.0;
    const std::string contact =
        R"({"seconds": 3, "with": "bg_1", "ego_at_fault": false, "why": "w", "ego_speed_mps": )" +
        core::formatNumber(speed) + R"(, "other_speed_mps": 1})";
    fs::create_directories(runFolder(results_.path(), run.id));
    std::ofstream(runFolder(results_.path(), run.id) / "scenario.yaml") << run.scenario_text;
    std::ofstream(runFolder(results_.path(), run.id) / "summary.json")
        << R"({"trace_sha256": "abc", "ego": {"contacts": [)" << (hit ? contact : "") << "]}}";
    record.measures[metrics::known::kTtcMinimum.name] = 1.0;
    return record;
  }
  Search::Runner runner() {
    return [this](const std::vector<PlannedRun>& plan) {
      std::vector<RunRecord> records;
      for (const PlannedRun& run : plan) records.push_back(play(run));
      return records;
    };
  }
  std::vector<SearchCase> casesOf(const SearchRequest& request) {
    Search search(request);
    while (search.advance(results_.path(), runner())) {
    }
    return search.cases();
  }
  static double worst(const std::vector<SearchCase>& cases) {
    return worstFirst(cases).front()->worth();
  }
  test::TemporaryFolder results_;
  SearchRequest request_;
  std::vector<std::string> played_;
  std::string broken_;
  std::string cut_;
  bool hits_careful_ = false;
};

TEST(SearchKey, HasValuesOfARangeOrOfLevels) {
  const SearchKey range = searchKeyOf("a.b: 1.0 .. 3", "x");
  EXPECT_EQ(range.valueAt(0.0), "1");
  EXPECT_EQ(range.valueAt(0.5), "2");
  EXPECT_EQ(range.valueAt(0.9999), "3");
  const SearchKey whole = searchKeyOf("n: 1 .. 3", "x");
  EXPECT_EQ(whole.valueAt(0.34), "2");
  EXPECT_EQ(whole.valueAt(0.9999), "3");
  const SearchKey seeds = searchKeyOf("seed: 100000 .. 1000000000", "x");
  EXPECT_EQ(seeds.valueAt(0.0), "100000") << "with all of its digits";
  EXPECT_EQ(seeds.valueAt(1.0 - 1e-12), "1000000000");
  const SearchKey levels = searchKeyOf("c: one | two", "x");
  EXPECT_EQ(levels.valueAt(0.49), "one");
  EXPECT_EQ(levels.valueAt(0.5), "two");
}

TEST(SearchKey, RefusesAnythingElse) {
  for (const char* text : {"", "a", "a:", "a: 1", "a: 3 .. 1", "a: 1 .. 1", "a: 1 .. x", ": 1 .. 2",
                           "a: one", "a: one |", "a: one | one", "a: one two", "a: 1 .. 2 .. 3"})
    EXPECT_THROW(searchKeyOf(text, "x"), core::InputError) << text;
}

TEST_F(SearchTest, RefusesUnknownKeysAndBoundsThatNoScenarioAllows) {
  for (const char* key : {"no_such_key: 1 .. 2", "max_cbv: 1 .. 1000", "cbv.ranking: score | luck",
                          "target_speed: 6.0 .. 7.0"}) {
    SearchRequest request = request_;
    request.options.keys.emplace_back(key);
    EXPECT_THROW(Search{request}, core::InputError) << key;
  }
  request_.ego = "key=value";
  EXPECT_THROW(Search{request_}, core::InputError);
}

TEST_F(SearchTest, LeavesOutWhatDoesNotActOnItsDemand) {
  request_.options.keys = {"traffic.density: 6 .. 30", "begin_time: 0.0 .. 9.0"};
  EXPECT_EQ(Search(request_).space().leftOut(), std::vector<std::string>{"begin_time"});
  request_.scenario = "roundabout_cross";  // with a demand file
  EXPECT_EQ(Search(request_).space().leftOut(), std::vector<std::string>{"traffic.density"});
  request_.options.keys.pop_back();
  EXPECT_THROW(Search{request_}, core::InputError);
}

TEST_F(SearchTest, VariesAttackKeysWhereTheCbvsAttack) {
  request_.options.attack_keys = {"guidance.speed.factor: 0.5 .. 1.5"};
  EXPECT_EQ(Search(request_).space().keys().size(), 3U);
  request_.mode = "safety_critical";
  EXPECT_EQ(Search(request_).space().keys().size(), 4U);
}

TEST_F(SearchTest, FindsAWorseCaseThanDrawsOfTheSameBudget) {
  const double evolution = worst(casesOf(request_));
  request_.options.method = "random";
  EXPECT_GT(evolution, worst(casesOf(request_)));
  EXPECT_LE(evolution, 1.5) << "1 + 10 / (10 + 10) at the upper bound of the speed";
}

TEST_F(SearchTest, ProposesNoCaseTwice) {
  std::set<std::vector<std::string>> seen;
  for (const SearchCase& one : casesOf(request_)) EXPECT_TRUE(seen.insert(one.set).second);
  EXPECT_EQ(seen.size(), request_.budget);
  request_.options.keys = {"max_cbv: 1 .. 4"};
  request_.budget = 9;  // more than the space has
  std::set<double> values;
  for (const SearchCase& one : casesOf(request_)) values.insert(numberOf(one.set.front()));
  EXPECT_EQ(values, (std::set<double>{1.0, 2.0, 3.0, 4.0})) << "all that the space has";
  Search search(request_);
  while (search.advance(results_.path(), runner())) {
  }
  EXPECT_EQ(search.cases().size(), 4U) << "none twice";
  EXPECT_TRUE(search.isExhausted());
}

TEST_F(SearchTest, IsTheBeginningOfALongerSearchOfTheSameSeedAlone) {
  const auto longer = casesOf(request_);
  request_.budget = 10;  // the third batch is cut
  const auto shorter = casesOf(request_);
  ASSERT_EQ(shorter.size(), 10U);
  for (std::size_t i = 0; i < shorter.size(); ++i) EXPECT_EQ(shorter[i].set, longer[i].set) << i;
  request_.seed = 2;
  EXPECT_NE(casesOf(request_).front().set, longer.front().set);
}

TEST_F(SearchTest, StopsAtABatchThatWasCutOff) {
  cut_ = "case_0006";
  Search search(request_);
  EXPECT_TRUE(search.advance(results_.path(), runner()));
  EXPECT_FALSE(search.advance(results_.path(), runner()));
  EXPECT_EQ(search.cases().size(), 4U);
}

TEST_F(SearchTest, ABrokenSessionCountsNothingAndTheSearchGoesOn) {
  broken_ = "case_0002";
  const auto cases = casesOf(request_);
  ASSERT_EQ(cases.size(), request_.budget);
  EXPECT_EQ(cases[1].worth(), 0.0);
  EXPECT_TRUE(cases[1].record.failed());
}

TEST_F(SearchTest, AsksACarefulDriverAboutContactsInModeChallenging) {
  request_.mode = "challenging";
  request_.budget = 4;
  const auto survived = casesOf(request_);
  const auto found = [](const auto& cases) {
    return std::count_if(cases.begin(), cases.end(), [](const auto& one) { return one.isFound(); });
  };
  EXPECT_GT(found(survived), 0);
  for (const SearchCase& one : survived) {
    const bool hit = one.score.isFound();
    EXPECT_EQ(one.careful_survives.has_value(), hit);
    EXPECT_EQ(std::count(played_.begin(), played_.end(), one.id + "_careful"), hit ? 1 : 0);
  }
  hits_careful_ = true;
  const auto hit = casesOf(request_);
  EXPECT_EQ(found(hit), 0);
  for (const SearchCase& one : hit) {
    EXPECT_EQ(one.worth(), one.score.isFound() ? 0.0 : one.score.value) << "nobody avoids it";
  }
}

TEST_F(SearchTest, ABrokenAnswerOfTheCarefulDriverIsNoAnswer) {
  request_.mode = "challenging";
  request_.budget = 4;
  for (const SearchCase& one : casesOf(request_)) {
    if (one.isFound()) broken_ = one.id + "_careful";
  }
  ASSERT_FALSE(broken_.empty());
  for (const SearchCase& one : casesOf(request_)) {
    if (one.id + "_careful" != broken_) continue;
    EXPECT_FALSE(one.careful_survives.has_value());
    EXPECT_TRUE(one.careful_broke);
    EXPECT_FALSE(one.isFound());
    EXPECT_EQ(one.worth(), 0.0);
  }
}

// The scenario takes both keys' bounds, but no minimum_distance above search_radius.
TEST_F(SearchTest, ProposesNothingThatTheScenarioRefusesTogether) {
  request_.options.keys = {"cbv.minimum_distance: 1.0 .. 50.0", "cbv.search_radius: 20.0 .. 60.0",
                           "target_speed: 5.0 .. 10.0"};
  const auto cases = casesOf(request_);
  EXPECT_EQ(cases.size(), request_.budget);
  for (const SearchCase& one : cases) EXPECT_LT(numberOf(one.set[0]), numberOf(one.set[1]));
}

TEST_F(SearchTest, WritesFoundScenariosTableAndPage) {
  Search search(request_);
  while (search.advance(results_.path(), runner())) {
  }
  writeSearchFiles(search, request_, results_.path());
  const auto rows = core::splitText(core::readFile(results_.path() / "cases.csv", "cases"), '\n');
  ASSERT_EQ(rows.size(), request_.budget + 1);
  EXPECT_EQ(rows.front(),
            "id,batch,score,found,contact,careful_survives,trace_sha256,target_speed,max_cbv,"
            "cbv.ranking");
  EXPECT_EQ(rows[5].rfind("case_0005,2,", 0), 0U) << "the second batch of four";
  const std::string page = core::readFile(results_.path() / "index.html", "page");
  std::size_t place = 0;
  for (const SearchCase* one : worstFirst(search.cases())) {
    const std::size_t next = page.find("runs/" + one->id + "/report.html");
    EXPECT_GT(next, place) << "sorted";
    place = next;
    EXPECT_EQ(fs::exists(results_.path() / "found" / (one->id + ".yaml")), one->isFound());
  }
}

RunContact contactAt(double ego_speed, double other_speed, bool at_fault) {
  RunContact contact;
  contact.partner = "bg_1";
  contact.ego_at_fault = at_fault;
  contact.ego_speed = ego_speed;
  contact.other_speed = other_speed;
  return contact;
}

TEST(SearchScore, RanksFaultAboveSpeedAboveNearness) {
  RunRecord record;
  record.status = "completed";
  EXPECT_DOUBLE_EQ(searchScoreOf(record, {contactAt(10.0, 0.0, true)}).value, 2.5);
  EXPECT_DOUBLE_EQ(searchScoreOf(record, {contactAt(1.0, 30.0, false)}).value, 1.75);
  EXPECT_DOUBLE_EQ(
      searchScoreOf(record, {contactAt(1.0, 30.0, false), contactAt(10.0, 0.0, true)}).value, 2.5);
  record.measures[metrics::known::kTtcMinimum.name] = 1.0;           // half of it
  record.measures[metrics::known::kCbvMinimumDistance.name] = 15.0;  // 5 / (5 + 15)
  EXPECT_DOUBLE_EQ(searchScoreOf(record, {}).value, (0.5 + 0.25) / 2.0);
  EXPECT_DOUBLE_EQ(searchScoreOf(record, {contactAt(0.0, 9.0, false)}).value, (0.5 + 0.25) / 2.0)
      << "a standing ego did nothing wrong";
  record.status = "error";
  EXPECT_DOUBLE_EQ(searchScoreOf(record, {contactAt(10.0, 0.0, true)}).value, 0.0);
}

TEST(SearchOptions, ShippedOnesFitEveryShippedScenario) {
  ASSERT_FALSE(shippedSearchOptions().empty());
  for (const std::string& name : shippedSearchOptions()) {
    for (const std::string& scenario : session::shippedScenarios()) {
      SearchRequest request;
      request.scenario = scenario;
      request.mode = "challenging";
      request.options = loadSearchOptions(name);
      EXPECT_NO_THROW(Search{request}) << name << ", " << scenario;
    }
  }
}

}  // namespace
}  // namespace cdiff::evaluation
