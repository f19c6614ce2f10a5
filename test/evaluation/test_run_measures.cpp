// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_record.h"
#include "support/error_text.h"

namespace cdiff::evaluation {
namespace {

TEST(RunMeasures, OfASummary) {
  // Two of three CBVs passed their conflict point; they drove 50 % and 100 % of their routes.
  const SummaryFacts facts = readSummary(R"({
    "status": "completed", "simulated_seconds": 12.5, "real_time_factor": null,
    "ego": {"route_completion_percent": 80, "collisions": 0},
    "cbv": {"off_road_rate_percent": null,
      "post_encroachments": [{"seconds": 2.9}, {"seconds": 3.1}, {"seconds": null}], "selections": [
      {"conflict_point_passed": true, "route_completion_percent": 50.0},
      {"conflict_point_passed": true, "route_completion_percent": 100.0},
      {"conflict_point_passed": false}]},
    "faults": [{"tick": 1, "source": "a", "text": "first"},
               {"tick": 2, "source": "a", "text": "last"}],
    "verdict": {"outcome": "failed", "reasons": ["too slow"], "rules": []}})",
                                         "file");
  EXPECT_EQ(facts.status, "completed");
  EXPECT_EQ(facts.fault, "last");
  EXPECT_EQ(facts.verdict, record::Outcome::kFailed);
  EXPECT_EQ(facts.reasons, std::vector<std::string>{"too slow"});
  EXPECT_DOUBLE_EQ(facts.simulated_seconds, 12.5);
  EXPECT_DOUBLE_EQ(facts.measures.at("ego_completion_percent"), 80.0);
  EXPECT_DOUBLE_EQ(facts.measures.at("ego_collisions"), 0.0);
  EXPECT_DOUBLE_EQ(facts.measures.at("cbv_selections"), 3.0);
  EXPECT_NEAR(facts.measures.at("cbv_passed_percent"), 200.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(facts.measures.at("cbv_completion_percent"), 75.0);
  EXPECT_NEAR(facts.measures.at("cbv_interactions_percent"), 200.0 / 3.0, 1e-12);
  EXPECT_NEAR(facts.measures.at("cbv_close_interactions_percent"), 100.0 / 3.0, 1e-12);
  EXPECT_EQ(facts.measures.count("cbv_off_road_percent"), 0U);  // null
  EXPECT_EQ(facts.measures.count("real_time_factor"), 0U);
  EXPECT_EQ(facts.measures.count("ttc_mean_s"), 0U);  // absent
  for (const auto& [name, value] : facts.measures) {
    const auto& names = measureNames();
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  }
}

TEST(RunMeasures, RefuseATextThatIsNoSummary) {
  EXPECT_THROW(readSummary("{\"status\": \"comp", "file"), core::InputError);
  EXPECT_THROW(readSummary("{}", "file"), core::InputError);
}

TEST(RunMeasures, NameAFileThatIsNoSummaryInPlainWords) {
  std::string deep;
  for (int i = 0; i < 300000; ++i) deep += R"({"ego":)";
  for (const std::string& text : {std::string("{"), std::string(R"({"ego": {"contacts": [1]}})"),
                                  std::string(R"({"ego": {"contacts": 7}})"), deep}) {
    for (const auto& read : {std::function<void()>([&] { readSummary(text, "the/file"); }),
                             std::function<void()>([&] { contactsIn(text, "the/file"); })}) {
      const std::string error = test::errorOf(read);
      EXPECT_EQ(error.find("json.exception"), std::string::npos) << error;
      EXPECT_NE(error.find("the/file"), std::string::npos) << error;
    }
  }
  EXPECT_THROW(summaryNumbers(deep, "the/file"), core::InputError);
}

TEST(RunMeasures, NoneOfASessionThatWasSteeredByHand) {
  const auto summaryWith = [](const std::string& by_hand) {
    return R"({"status": "completed", "simulated_seconds": 12.5, "steering": {"by_hand": )" +
           by_hand + R"(}, "verdict": {"outcome": "not_judged", "reasons": []}})";
  };
  EXPECT_EQ(readSummary(summaryWith("false"), "summary.json").status, "completed");
  EXPECT_THROW(readSummary(summaryWith("true"), "summary.json"), core::InputError);
}

}  // namespace
}  // namespace cdiff::evaluation
