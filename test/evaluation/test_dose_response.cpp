// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/dose_response.h"
#include "evaluation/run_records.h"

namespace cdiff::evaluation {
namespace {

/// A run of a variant on a route whose driving score is `score`.
RunRecord runOf(const std::string& variant, const std::string& route, double score) {
  RunRecord record = test::recordWith({route, "1"}, score);
  record.factors["variant"] = variant;
  return record;
}

TEST(DoseResponse, DosesAreOrderedByNumberAndPooledOverSharedRoutes) {
  const std::vector<RunRecord> records = {
      runOf("speed_10", "a", 30),           runOf("speed_10", "b", 50),
      runOf("speed_-2", "a", 10),           runOf("speed_-2", "b", 20),
      runOf("speed_4.5", "a", 20),          runOf("speed_4.5", "b", 40),
      runOf("speed_4.5", "only_here", 900), runOf("other", "a", 1)};
  const auto responses = doseResponses(records, {"ego_driving_score"});
  ASSERT_EQ(responses.size(), 1U);
  const DoseResponse& response = responses.front();
  EXPECT_EQ(response.axis, "speed");
  EXPECT_EQ(response.routes, 2U);
  ASSERT_EQ(response.doses.size(), 3U);
  EXPECT_EQ(response.doses[0].dose, -2.0);
  EXPECT_EQ(response.doses[1].dose, 4.5);
  EXPECT_EQ(response.doses[2].dose, 10.0);
  EXPECT_DOUBLE_EQ(*response.doses[0].response.value, 15.0);
  EXPECT_DOUBLE_EQ(*response.doses[1].response.value, 30.0);
  EXPECT_DOUBLE_EQ(*response.doses[2].response.value, 40.0);
  EXPECT_DOUBLE_EQ(*response.rank_correlation, 1.0);
  EXPECT_NE(doseMarkdown(responses).find("| speed | ego_driving_score |"), std::string::npos);
}

TEST(DoseResponse, IntervalDrawsTheSameRoutesAtEveryDose) {
  // Route a rises with the dose, route b falls: drawn alone they give 1 and -1.
  std::vector<RunRecord> records;
  for (int dose = 1; dose <= 4; ++dose) {
    const std::string variant = "speed_" + std::to_string(dose);
    records.push_back(runOf(variant, "a", 20.0 * dose));
    records.push_back(runOf(variant, "b", 50.0 - 10.0 * dose));
  }
  const auto responses = doseResponses(records, {"ego_driving_score"});
  EXPECT_DOUBLE_EQ(*responses.front().rank_correlation, 1.0);
  EXPECT_DOUBLE_EQ(responses.front().interval->low, -1.0);
  EXPECT_DOUBLE_EQ(responses.front().interval->high, 1.0);
}

TEST(DoseResponse, ADoseHasOneGuidanceProfile) {
  std::vector<RunRecord> records;
  for (int dose = 1; dose <= 3; ++dose)
    records.push_back(runOf("weight_" + std::to_string(dose), "a", dose));
  records[1].factors["guidance_profile"] = "other";  // as an axis of profiles has
  EXPECT_EQ(doseResponses(records, {"ego_driving_score"}).size(), 1U);
  records.push_back(runOf("weight_2", "a", 5));
  EXPECT_THROW(doseResponses(records, {"ego_driving_score"}), core::InputError);
}

TEST(DoseResponse, WrongInputIsRefused) {
  EXPECT_THROW(
      doseResponses({runOf("speed_1", "a", 1), runOf("speed_2", "a", 1)}, {"ego_driving_score"}),
      core::InputError);
  std::vector<RunRecord> records = {runOf("speed_1", "a", 1), runOf("speed_2", "a", 1),
                                    runOf("speed_3", "a", 1)};
  EXPECT_NO_THROW(doseResponses(records, {"ego_driving_score"}));
  EXPECT_THROW(doseResponses(records, {"ego_driving_scores"}), core::InputError);
  records[1].factors["method"] = "paper";
  EXPECT_THROW(doseResponses(records, {"ego_driving_score"}), core::InputError);
}

}  // namespace
}  // namespace cdiff::evaluation
