// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/camera_ego/training/ego_validation.h"

namespace cdiff::planners {
namespace {

/// A moment of a network at which the ego drove straight on at 4 m/s.
EgoExample momentOf(std::uint64_t network) {
  EgoExample example;
  example.network = network;
  example.speed = 4.0;
  example.driven.places = atConstantVelocity(4.0);
  example.driven.known = kEgoWaypoints;
  return example;
}

/// A plan that lies `beside` meters beside that way.
EgoAnswer answerBeside(double beside) {
  EgoAnswer answer;
  answer.plan = atConstantVelocity(4.0);
  for (Eigen::Vector2d& place : answer.plan) place.y() += beside;
  return answer;
}

/// Two moments of each network; the plan of network n lies n m beside the way.
learning::Measures measured(std::uint64_t networks) {
  const ConstantDetections prior({}, 3);
  EgoValidation validation;
  for (std::uint64_t network = 1; network <= networks; ++network) {
    for (int moment = 0; moment < 2; ++moment) {
      validation.add(momentOf(network), answerBeside(static_cast<double>(network)), prior,
                     BevGrid{});
    }
  }
  return validation.measures();
}

TEST(EgoValidation, DrawsNetworksForItsIntervals) {
  // Means of 1, 2, 3, 4, 5 m drawn with replacement lie within 1 and 5 around 3 m, and of 1,000
  // draws with a spread of sqrt(2 / 5) = 0.63 m the extreme ones are beyond 2 and 4.
  const learning::Measures measures = measured(5);
  EXPECT_NEAR(measures.at("l2_at_1s_m"), 3.0, 1e-12);
  EXPECT_GE(measures.at("l2_at_1s_m_low"), 1.0);
  EXPECT_LE(measures.at("l2_at_1s_m_low"), 2.0);
  EXPECT_GE(measures.at("l2_at_1s_m_high"), 4.0);
  EXPECT_LE(measures.at("l2_at_1s_m_high"), 5.0);
}

TEST(EgoValidation, SaysByHowMuchAPlanIsBetterThanAConstantVelocity) {
  // A constant velocity is where the ego drove: the plan is worse by 3 m on average, between 1 and
  // 5 m in every draw; the same networks on both sides.
  const learning::Measures measures = measured(5);
  EXPECT_NEAR(measures.at("constant_velocity_l2_at_2s_m"), 0.0, 1e-12);
  EXPECT_NEAR(measures.at("l2_at_2s_m_gain"), -3.0, 1e-12);
  EXPECT_NEAR(measures.at("l2_at_2s_m_gain_low"), -measures.at("l2_at_2s_m_high"), 1e-12);
  EXPECT_NEAR(measures.at("l2_at_2s_m_gain_high"), -measures.at("l2_at_2s_m_low"), 1e-12);
  EXPECT_NE(egoTable(measures, "Plan").find("| Plan | 3.00 ["), std::string::npos);
}

TEST(EgoValidation, HasNoIntervalsOfTwoNetworks) {
  const learning::Measures measures = measured(2);
  EXPECT_NEAR(measures.at("l2_at_1s_m"), 1.5, 1e-12);
  EXPECT_EQ(measures.count("l2_at_1s_m_low"), 0U);
  EXPECT_NE(egoTable(measures, "Plan").find("| Plan | 1.50 / 1.50 / 1.50 |"), std::string::npos);
}

TEST(EgoValidation, WritesARowForEachNetworkAndMeasure) {
  const ConstantDetections prior({}, 3);
  EgoValidation validation;
  validation.add(momentOf(7), answerBeside(0.25), prior, BevGrid{});
  for (int moment = 0; moment < 2; ++moment)
    validation.add(momentOf(9), answerBeside(0.5), prior, BevGrid{});
  const std::string rows = validation.byNetwork();
  EXPECT_EQ(rows.find("network,moments,measure,value\n1,1,"), 0U) << rows;
  EXPECT_NE(rows.find("\n1,1,l2_at_2s_m,0.25\n"), std::string::npos) << rows;
  EXPECT_NE(rows.find("\n2,2,l2_at_2s_m,0.5\n"), std::string::npos) << rows;
}

}  // namespace
}  // namespace cdiff::planners
