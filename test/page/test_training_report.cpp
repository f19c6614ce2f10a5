// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "page/training_pages.h"

namespace cdiff::page {
namespace {

constexpr const char* kCurves =
    "stage,step,seconds,figure,value\n"
    "fine_tune,10,20.5,loss,0.9\n"
    "fine_tune,10,20.5,loss_rollout,0.8\n"
    "fine_tune,20,41.0,loss,0.7\n"
    "fine_tune,20,41.0,held_out_regression_ade_m,1.5\n"
    "denoiser,5,3.0,loss,0.4\n";

std::string errorOf(const std::string& text) {
  try {
    readTrainingCurves(text, "curves.csv");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(TrainingReport, ReadsStagesInOrderWithTheirCurves) {
  const auto stages = readTrainingCurves(kCurves, "curves.csv");
  ASSERT_EQ(stages.size(), 2U);
  EXPECT_EQ(stages[0].name, "fine_tune");
  EXPECT_EQ(stages[0].steps, 20);
  EXPECT_DOUBLE_EQ(stages[0].seconds, 41.0);
  EXPECT_EQ(stages[0].curves.at("loss"), (TrainingCurve{{20.5, 0.9}, {41.0, 0.7}}));
  EXPECT_EQ(stages[1].name, "denoiser");
}

TEST(TrainingReport, DrawsEachQuantityOnceAndEscapesTheCard) {
  const std::string page =
      trainingReport("model <1>", readTrainingCurves(kCurves, "curves.csv"), "| a & b |");
  EXPECT_NE(page.find("model &lt;1&gt;"), std::string::npos);
  EXPECT_NE(page.find("a &amp; b"), std::string::npos);
  EXPECT_NE(page.find("Held out: mean displacement [m]"), std::string::npos);
  EXPECT_EQ(page.find("Held out: throttle"), std::string::npos);
  std::size_t charts = 0;
  for (std::size_t at = page.find("<svg role"); at != std::string::npos;
       at = page.find("<svg role", at + 1))
    ++charts;
  EXPECT_EQ(charts, 3U);  // loss and displacement of one stage, loss of the other
}

TEST(TrainingReport, DrawsHowEpisodesWent) {
  const std::string page =
      trainingReport("driver",
                     readTrainingCurves("stage,step,seconds,figure,value\n"
                                        "policy,1,2.0,episode_return,-3.5\n"
                                        "policy,1,2.0,episode_goal_share,0.25\n"
                                        "policy,64,4.0,held_out_goal_share,0.5\n"
                                        "policy,65,5.0,episode_goal_share,0.75\n",
                                        "curves.csv"),
                     "");
  EXPECT_NE(page.find("Mean return of episodes"), std::string::npos);
  EXPECT_NE(page.find("Share of episodes that end so"), std::string::npos);
  EXPECT_NE(page.find("held out goal share"), std::string::npos);
  EXPECT_NE(page.find("episode goal share"), std::string::npos);
}

TEST(TrainingReport, PassesOverARowThatAKillCutOff) {
  const auto stages = readTrainingCurves(std::string(kCurves) + "denoiser,6,3.", "curves.csv");
  EXPECT_EQ(stages[1].steps, 5);
}

TEST(TrainingReport, NamesTheLineOfWhatIsNoCurve) {
  EXPECT_NE(errorOf("a,b\n").find("curves.csv: line 1"), std::string::npos);
  EXPECT_NE(errorOf(std::string(kCurves) + "x,y\n").find("line 7"), std::string::npos);
  EXPECT_NE(errorOf(std::string(kCurves) + "denoiser,six,3,loss,1\n").find("line 7"),
            std::string::npos);
  EXPECT_NE(errorOf("stage,step,seconds,figure,value\n").find("no measurement"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::page
