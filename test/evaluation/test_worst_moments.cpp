// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_records.h"
#include "evaluation/worst_moments.h"

namespace cdiff::evaluation {
namespace {

BatchRun runWith(const std::vector<RunContact>& contacts, double nearest) {
  BatchRun run;
  run.record = test::recordWith({}, 50.0);
  run.record.measures["cbv_minimum_distance_m"] = nearest;
  run.contacts = contacts;
  return run;
}

TEST(WorstMoments, AreFaultsThenFastContactsThenApproaches) {
  const std::vector<BatchRun> runs = {
      runWith({}, 9.0),
      runWith({{1.5, "slow", false, "rear", 2.0, 3.0}, {4.0, "fast", false, "rear", 2.0, 9.0}},
              0.0),
      runWith({{2.25, "own", true, "front", 1.0, 1.0, false}}, 0.0), runWith({}, 5.0)};
  const std::vector<WorstMoment> worst = worstMoments(runs, 4);
  ASSERT_EQ(worst.size(), 4u);
  EXPECT_EQ(worst[0].run, 2u);
  EXPECT_DOUBLE_EQ(*worst[0].seconds, 2.25);
  EXPECT_EQ(worst[0].text,
            "contact of the ego with background vehicle own (the ego's fault): front");
  EXPECT_DOUBLE_EQ(*worst[1].seconds, 4.0);
  EXPECT_DOUBLE_EQ(*worst[2].seconds, 1.5);
  EXPECT_EQ(worst[3].run, 3u);
  EXPECT_FALSE(worst[3].seconds.has_value());
  EXPECT_EQ(worst[3].text, "no contact; nearest CBV 5.0 m away between centers");
  EXPECT_EQ(worstMoments(runs, 2).size(), 2u);
  EXPECT_TRUE(worstMoments({}, 5).empty());
}

TEST(WorstMoments, OfAMovingEgoComeBeforeFasterOnesOfAStandingEgo) {
  const std::vector<BatchRun> runs = {runWith(
      {{1.0, "jam", false, "rear", 0.0, 9.0}, {2.0, "cut_in", false, "side", 3.0, 4.0}}, 0.0)};
  EXPECT_DOUBLE_EQ(*worstMoments(runs)[0].seconds, 2.0);
}

TEST(WorstMoments, ContactsAreReadFromASummary) {
  const auto contacts = contactsIn(
      R"({"ego": {"contacts": [{"seconds": 15.8, "with": "v", "ego_at_fault": true, "why": "w",
          "ego_speed_mps": 8, "other_speed_mps": 10.5}]}})",
      "summary.json");
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_DOUBLE_EQ(contacts[0].seconds, 15.8);
  EXPECT_TRUE(contacts[0].ego_at_fault);
  EXPECT_DOUBLE_EQ(contacts[0].other_speed, 10.5);
  EXPECT_EQ(contacts[0].partnerText(), "v");  // of an earlier version
  EXPECT_EQ(contactsIn(R"({"ego": {"contacts": [{"seconds": 15.8, "with": "v", "with_cbv": true,
          "ego_at_fault": true, "why": "w", "ego_speed_mps": 8, "other_speed_mps": 10.5}]}})",
                       "summary.json")[0]
                .partnerText(),
            "CBV v");
  EXPECT_TRUE(contactsIn("{}", "summary.json").empty());
  EXPECT_THROW(contactsIn(R"({"ego": {"contacts": [{}]}})", "summary.json"), core::InputError);
}

}  // namespace
}  // namespace cdiff::evaluation
