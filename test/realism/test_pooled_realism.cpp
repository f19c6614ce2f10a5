// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "realism/pooled_realism.h"
#include "realism/realism_tables.h"
#include "realism/recorded_traffic.h"
#include "realism/recording.h"
#include "support/real_data.h"

namespace cdiff::realism {
namespace {

/// One vehicle alone, straight on at a speed [m/s].
Recording steady(const std::string& name, double speed, std::size_t states,
                 const std::string& role = "", const std::string& vehicle = "1") {
  Recording recording{name, name.substr(0, name.find('-')), {}};
  recording.tracks.push_back({vehicle, role});
  for (std::size_t i = 0; i < states; ++i)
    recording.tracks[0].states.push_back({{0.1 * speed * static_cast<double>(i), 0.0}, 0.0, 0.0});
  return recording;
}

TEST(PooledCourses, CutTracksAndKeepWhatMoves) {
  // 170 states: 80 + 80, the last 10 are dropped.
  EXPECT_EQ(pooledCourses({steady("a", 5.0, 170)}, "").size(), 2U);
  EXPECT_EQ(pooledCourses({steady("a", 5.0, 180)}, "").size(), 3U);
  EXPECT_TRUE(pooledCourses({steady("a", 0.9, 170)}, "").empty());
  EXPECT_TRUE(pooledCourses({steady("a", 5.0, 170, "background")}, "cbv").empty());
  const auto courses = pooledCourses({steady("a", 5.0, 40, "cbv")}, "cbv");
  ASSERT_EQ(courses.size(), 1U);
  EXPECT_NEAR(courses[0][kLinearSpeed][0], 5.0, 1e-9);
  EXPECT_TRUE(courses[0][kRoadEdge].empty());
}

TEST(PooledCourses, EndWithTheContactThatATrackEndsWith) {
  // 90 states are cut into the last 80; the first 10 are too few. The contact is at the last.
  Recording recording = steady("a", 5.0, 90, "cbv");
  recording.tracks[0].noteContact(89);
  recording.tracks[0].noteContact(90);  // the vehicle is gone
  EXPECT_EQ(recording.tracks[0].contacts, std::set<std::size_t>{89});
  const auto courses = pooledCourses({recording}, "cbv");
  ASSERT_EQ(courses.size(), 1U);
  EXPECT_EQ(courses[0][kCollision].size(), 80U);
  EXPECT_EQ(courses[0][kCollision].back(), 1.0);
  EXPECT_EQ(courses[0][kCollision].front(), 0.0);
  EXPECT_EQ(countCollided(courses), 1U);
  EXPECT_EQ(countCollided(pooledCourses({steady("a", 5.0, 90, "cbv")}, "cbv")), 0U);
}

TEST(RecordedSites, HaveTwoHalvesWithoutACommonVehicle) {
  // Vehicles 9, 10 (in both recordings), 11 have 40, 80 and 40 states: half of them is reached in
  // vehicle 10.
  Recording first = steady("a-1", 5.0, 40, "", "10");
  first.tracks.push_back(steady("", 5.0, 40, "", "9").tracks[0]);
  Recording second = steady("a-2", 5.0, 40, "", "11");
  second.tracks.push_back(first.tracks[0]);
  const RecordedSite site = recordedSites({first, second}).at("a");
  EXPECT_EQ(site.vehicles[0], (std::set<std::string>{"9", "10"}));
  EXPECT_EQ(site.vehicles[1], std::set<std::string>{"11"});
  EXPECT_EQ(site.halves[0].size(), 3U);
  EXPECT_EQ(site.halves[1].size(), 1U);
  EXPECT_EQ(site.all.size(), 4U);
}

TEST(PooledLikelihoods, PoolVehiclesAndSteps) {
  // Simulated: 40 steps at 5.1 m/s (bin 2) and 40 at 10.1 m/s (bin 4); total 80 + 10 x .1 = 81.
  // Logged at 5.2 m/s: 40.1 / 81. No vehicle collides: (2 + .001) / (2 + .002).
  const auto simulated = pooledCourses({steady("a", 5.1, 40), steady("b", 10.1, 40)}, "");
  const auto logged = pooledCourses({steady("c", 5.2, 60)}, "");
  const Likelihoods likelihoods = pooledLikelihoods(logged, simulated);
  EXPECT_NEAR(likelihoods[kLinearSpeed].value(), 40.1 / 81.0, 1e-12);
  EXPECT_NEAR(likelihoods[kCollision].value(), 2.001 / 2.002, 1e-12);
  EXPECT_FALSE(likelihoods[kRoadEdge].has_value());
  EXPECT_FALSE(likelihoods[kOffRoad].has_value());
  EXPECT_FALSE(likelihoods[kRedLight].has_value());
}

TEST(PooledComparison, KeepsSitesApartAndSaysTheCeiling) {
  // Site "slow": halves at 3 m/s and at 5.1 m/s, 40 steps each, so that each half gives the other
  // .1 / 41 in speed; site "fast": both halves alike, 40.1 / 41.
  const std::vector<Recording> log = {
      steady("slow-1", 3.0, 40, "", "1"), steady("slow-2", 5.1, 40, "", "2"),
      steady("fast-1", 20.1, 40, "", "1"), steady("fast-2", 20.2, 40, "", "2")};
  const PooledDrivers drivers = {{"mine", pooledCourses({steady("x", 3.1, 40)}, "")}};
  const PooledResult result = comparePooled(log, drivers, "");
  EXPECT_EQ(result.headline, "fast");
  ASSERT_EQ(result.rows.size(), 2U);
  // slow: half of the logged steps lie in my bin (40.1 / 41), half do not (.1 / 41).
  EXPECT_NEAR(result.rows[0].at_site.at("slow")[kLinearSpeed].value(), std::sqrt(40.1 * 0.1) / 41.0,
              1e-12);
  EXPECT_NEAR(result.rows[0].at_site.at("fast")[kLinearSpeed].value(), 0.1 / 41.0, 1e-12);
  EXPECT_NEAR(result.rows[1].at_site.at("slow")[kLinearSpeed].value(), 0.1 / 41.0, 1e-12);
  EXPECT_NEAR(result.rows[1].at_site.at("fast")[kLinearSpeed].value(), 40.1 / 41.0, 1e-12);
  EXPECT_EQ(comparePooled(log, drivers, "slow").headline, "slow");
  EXPECT_THROW(comparePooled(log, drivers, "slwo"), core::InputError);
  EXPECT_NE(pooledMarkdown(result).find("realism_pooled against fast (headline)"),
            std::string::npos);
  EXPECT_NE(pooledPage(result).find("left out"), std::string::npos);
  EXPECT_NE(pooledJson(result).find("\"headline_site\": \"fast\""), std::string::npos);
}

TEST(PooledComparison, OfRecordedDriversWithThemselvesIsAboveOtherSites) {
  const auto folder = test::realData("real_traffic");
  CDIFF_SKIP_WITHOUT(folder);
  const auto log = readRecordedTraffic(std::vector{folder});
  const auto sites = recordedSites(log);
  ASSERT_EQ(sites.size(), 3U);
  for (const auto& [name, site] : sites) {
    std::size_t common = 0;
    for (const std::string& vehicle : site.vehicles[0]) common += site.vehicles[1].count(vehicle);
    EXPECT_EQ(common, 0U) << name;
    EXPECT_EQ(site.halves[0].size() + site.halves[1].size(), site.all.size()) << name;
    EXPECT_FALSE(site.halves[1].empty()) << name;
  }
  const double ceiling = metaMetric(pooledCeiling(sites.at("Lanker"))).value();
  const double freeway =
      metaMetric(pooledLikelihoods(sites.at("Lanker").all, sites.at("US101").all)).value();
  EXPECT_GT(ceiling, freeway);
  EXPECT_LT(ceiling, 1.0);
  const PooledResult result = comparePooled(log, {}, "");
  EXPECT_EQ(result.headline, "Lanker");
  RecordProperty("ceiling", std::to_string(ceiling));
  RecordProperty("freeway", std::to_string(freeway));
}

}  // namespace
}  // namespace cdiff::realism
