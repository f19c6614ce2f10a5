// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "record/sample_session.h"
#include "record/session_text.h"

namespace cdiff::record {
namespace {

using traffic::SessionStatus;

std::vector<std::string> storyUntil(std::uint64_t last, bool touch = false) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  page::ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  for (std::uint64_t tick = 0; tick <= last; ++tick) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    if (tick == last) snapshot.status = SessionStatus::kTimedOut;
    if (touch && tick == 40) snapshot.contacts = {{"bg_2", "ego"}};
    if (touch && tick == 50) snapshot.contacts = {{"bg_1", "ego"}, {"bg_1", "bg_2"}};
    const cbv::CbvSelection selection = test::sampleSelection(tick, sample.setup.network());
    session::TickRecord record;
    record.snapshot = &snapshot;
    if (snapshot.decision_tick) record.selection = &selection;
    writer.observe(record);
  }
  writer.finish(1.0);
  return sessionStory(writer.result());
}

TEST(SessionStory, ReportsRouteApproachAndContact) {
  const std::vector<std::string> story = storyUntil(120, true);
  ASSERT_EQ(story.size(), 4u);
  // 48 m of 190 m.
  EXPECT_EQ(story[0], "The ego drove 25.3 % of its route in 6.0 s.");
  // At 8 m/s all the time, which is its target speed: the time limit ended it.
  EXPECT_EQ(story[1].rfind("Nothing stopped the ego.", 0), 0u) << story[1];
  // At 6 s the centers are 49 m and 22 m apart. Outlines: 49 - 2.25 - 0.9 and 22 - 2.25 - 0.9.
  EXPECT_EQ(story[2],
            "bg_1 was the only CBV and came as near as 49.57 m between the outlines, at 6.00 s.");
  EXPECT_EQ(story[3],
            "The ego and background vehicle bg_2 touched at 2.00 s, the first of 2 contacts of the "
            "ego; the ego was at fault in 1 of them.");
}

TEST(SessionStory, SaysWhenThereWasNoCbvAndNoContact) {
  const std::vector<std::string> story = storyUntil(20);
  ASSERT_EQ(story.size(), 4u);
  EXPECT_EQ(story[2], "0 CBVs: nothing was tested: no vehicle was ever taken as CBV.");
  EXPECT_EQ(story[3], "No vehicle touched the ego.");
}

TEST(SessionStory, SaysWhenNothingHappened) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  page::ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  writer.finish(0.0);
  EXPECT_EQ(sessionStory(writer.result()),
            std::vector<std::string>{"The session ended before its first tick."});
}

TEST(ReasonText, ExplainsKnownWordsAndKeepsOthers) {
  EXPECT_EQ(rejectionText("too_far"), "it is farther from the ego than cbv.search_radius");
  EXPECT_EQ(rejectionText("not_a_word"), "not_a_word");
  EXPECT_EQ(releaseText("route_end"), "reached the end of its conflict-aware route");
  EXPECT_EQ(releaseText("not_stated"), "not_stated");
}

}  // namespace
}  // namespace cdiff::record
