// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Rates of egos with intervals, their order, and what the page shows of them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/text.h"
#include "evaluation/separation/ego_ranking.h"

namespace cdiff::evaluation {
namespace {

/// `contacts` of one kind in 1 km and 2 minutes.
EgoRun runOf(const std::string& ego, const std::string& scenario, const std::string& seed,
             std::size_t contacts, ContactKind kind = ContactKind::kCutIn) {
  EgoRun run;
  run.ego = ego;
  run.setting = "challenging, CBVs diffusion";
  run.scenario = scenario;
  run.seed = seed;
  run.report = "runs/" + ego + scenario + seed + "/report.html";
  run.kilometers = 1.0;
  run.minutes = 2.0;
  run.completion_percent = 90.0;
  for (std::size_t i = 0; i < contacts; ++i) {
    EgoRun::Contact contact;
    contact.seconds = 10.0 + static_cast<double>(i);
    contact.traced = {kind, 5.0 + static_cast<double>(i), 6.0, true};
    run.contacts.push_back(contact);
  }
  return run;
}

/// Two routes, seeds 1 and 2, the same number of contacts in each run.
void add(const std::string& ego, std::size_t contacts, std::vector<EgoRun>& runs) {
  for (const std::string scenario : {"a", "b"}) {
    for (const std::string seed : {"1", "2"}) runs.push_back(runOf(ego, scenario, seed, contacts));
  }
}

TEST(EgoRanking, FewestContactsPerKilometerAreFirst) {
  std::vector<EgoRun> runs;
  add("bad", 3, runs);
  add("good", 0, runs);
  add("middling", 1, runs);
  const std::vector<EgoRanking> rankings = rankEgos(runs);
  ASSERT_EQ(rankings.size(), 1U);
  const auto& egos = rankings.front().egos;
  ASSERT_EQ(egos.size(), 3U);
  EXPECT_EQ(egos[0].ego, "good");
  EXPECT_EQ(egos[1].ego, "middling");
  EXPECT_EQ(egos[2].ego, "bad");
  EXPECT_DOUBLE_EQ(egos[2].per_km, 3.0);      // 12 in 4 km
  EXPECT_DOUBLE_EQ(egos[2].per_minute, 1.5);  // 12 in 8 min
  // Garwood: 0 events reach to -ln 0.025 = 3.689; over 4 km.
  EXPECT_NEAR(egos[0].per_km_interval.high, 3.689 / 4.0, 1e-3);
  EXPECT_EQ(egos[0].per_km_interval.low, 0.0);
  // The order is the same on both seeds.
  EXPECT_NEAR(*rankings.front().odd_even, 1.0, 1e-12);
}

TEST(EgoRanking, TheReferenceFamilyMustBeInOrder) {
  std::vector<EgoRun> runs;
  add("careful", 0, runs);
  add("careful_half_second_late", 3, runs);
  add("careful_second_late", 1, runs);
  add("constant_speed", 9, runs);
  const EgoRanking ranking = rankEgos(runs).front();
  ASSERT_EQ(ranking.remarks.size(), 1U);
  EXPECT_NE(ranking.remarks[0].find("out of order: careful_half_second_late"), std::string::npos);
  EXPECT_DOUBLE_EQ(*ranking.separation, 9.0);
  EXPECT_DOUBLE_EQ(*ranking.area_under_curve, 1.0);
}

TEST(EgoRanking, NeighborsWhoseIntervalsOverlapAreNamed) {
  std::vector<EgoRun> runs;
  add("careful", 1, runs);
  add("constant_speed", 2, runs);  // 4 and 8 in 4 km: [0.27, 2.56] and [0.86, 3.94]
  EXPECT_EQ(rankEgos(runs).front().remarks,
            std::vector<std::string>{"intervals overlap: careful and constant_speed"});
}

TEST(EgoRanking, WithdrawnAttacksAreAShareOfDecisions) {
  std::vector<EgoRun> runs = {runOf("careful", "a", "1", 0), runOf("careful", "b", "1", 0)};
  EXPECT_FALSE(rankEgos(runs).front().egos.front().withdrawn_percent);
  runs[0].challenges = 30;
  runs[0].withdrawn = 5;
  runs[1].challenges = 10;
  runs[1].withdrawn = 5;  // 10 of 40
  EXPECT_DOUBLE_EQ(*rankEgos(runs).front().egos.front().withdrawn_percent, 25.0);
}

TEST(EgoRanking, AnEgoThatStoodHasNoRateAndIsLast) {
  std::vector<EgoRun> runs;
  runs.push_back(runOf("stood", "a", "1", 5));
  runs.back().kilometers = 0.0;
  runs.push_back(runOf("bad", "a", "1", 3));
  const std::vector<EgoRanking> rankings = rankEgos(runs);
  ASSERT_EQ(rankings.front().egos.size(), 2U);
  EXPECT_EQ(rankings.front().egos[1].ego, "stood");
  const std::string csv = rankingCsv(rankings);
  EXPECT_NE(csv.find("stood,1,0.000,2.000,5,,,,2.500"), std::string::npos) << csv;
}

TEST(EgoRanking, SettingsAreNotPooled) {
  std::vector<EgoRun> runs;
  add("careful", 1, runs);
  runs.push_back(runOf("careful", "a", "1", 5));
  runs.back().setting = "naturalistic, CBVs diffusion";
  const auto rankings = rankEgos(runs);
  ASSERT_EQ(rankings.size(), 2U);
  EXPECT_EQ(rankings[0].egos.front().contacts, 4U);
  EXPECT_EQ(rankings[1].egos.front().contacts, 5U);
}

TEST(EgoRanking, ThePageLinksTheWorstCaseOfEachKind) {
  std::vector<EgoRun> runs = {runOf("careful", "a", "1", 1), runOf("careful", "b", "1", 3),
                              runOf("careful", "b", "2", 1, ContactKind::kOncoming)};
  // The fastest impact is the third contact of the second run, at 12 s.
  runs.back().contacts.front().avoided["rss"] = {true, true, false};
  const auto rankings = rankEgos(runs);
  const EgoFigures& ego = rankings.front().egos.front();
  EXPECT_EQ(ego.kinds.at(ContactKind::kCutIn), 4U);
  EXPECT_EQ(ego.worst.at(ContactKind::kCutIn), &runs[1]);
  EXPECT_EQ(ego.avoided.at("rss").avoided[0], 1U);
  EXPECT_EQ(ego.avoided.at("rss").avoided[2], 0U);
  const std::string page = rankingPage("test", rankings);
  EXPECT_NE(page.find("runs/carefulb1/report.html#t=10.0"), std::string::npos);
  EXPECT_NE(page.find("runs/carefulb2/report.html#t=8.0"), std::string::npos);
  // Head and one ego.
  EXPECT_EQ(core::splitText(rankingCsv(rankings), '\n').size(), 2U);
}

}  // namespace
}  // namespace cdiff::evaluation
