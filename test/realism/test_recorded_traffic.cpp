// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/scratch_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "realism/recorded_session.h"
#include "realism/recorded_traffic.h"
#include "realism/recording.h"
#include "support/real_data.h"

namespace cdiff::realism {
namespace {

constexpr const char* kHeader = "recording,vehicle,t,x,y,heading,speed,length,width\n";

class RecordedTraffic : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    core::writeFileAtomically(folder_.path() / "log.csv", text);
    return folder_.path() / "log.csv";
  }
  std::string refusalOf(const std::string& text) const {
    try {
      readRecordedTraffic(write(text));
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  }
  core::ScratchFolder folder_;
};

TEST_F(RecordedTraffic, ReadsTracksAndSplitsThemAtGaps) {
  const auto recordings =
      readRecordedTraffic(write(std::string(kHeader) + "Main-1,7,0.0,1,2,0.5,9,4.6,1.9\n"
                                                       "Main-1,7,0.1,2,2,0.5,9,4.6,1.9\n"
                                                       "Main-1,7,0.4,5,2,0.5,9,4.6,1.9\n"
                                                       "Main-1,8,0.2,0,0,0,0,10,2.5\n"
                                                       "Side-1,7,0.0,0,0,0,0,4,2\n"));
  ASSERT_EQ(recordings.size(), 2U);
  EXPECT_EQ(recordings[0].site, "Main");
  EXPECT_EQ(recordings[1].site, "Side");
  ASSERT_EQ(recordings[0].tracks.size(), 3U);
  EXPECT_EQ(recordings[0].tracks[0].states.size(), 2U);
  EXPECT_EQ(recordings[0].tracks[0].length, 4.6);
  EXPECT_EQ(recordings[0].tracks[1].first, 4U);
  EXPECT_EQ(recordings[0].tracks[1].at(4).position.x(), 5.0);
  EXPECT_EQ(recordings[0].tracks[2].id, "8");
  EXPECT_EQ(recordings[0].tracks[2].width, 2.5);
}

TEST_F(RecordedTraffic, NamesFileAndMissingAndExpectedColumns) {
  const std::string text = refusalOf("vehicle,t,x,y,speed\n1,0,0,0,0\n");
  EXPECT_NE(text.find("log.csv"), std::string::npos) << text;
  EXPECT_NE(text.find("missing columns recording, heading, length, width"), std::string::npos)
      << text;
  EXPECT_NE(text.find("expected recording, vehicle, t, x, y, heading, length, width"),
            std::string::npos)
      << text;
  EXPECT_NE(refusalOf("").find("missing columns"), std::string::npos);
}

TEST_F(RecordedTraffic, NamesTheLineThatCannotBeRead) {
  const std::string header = kHeader;
  EXPECT_NE(refusalOf(header).find("without a row"), std::string::npos);
  EXPECT_NE(refusalOf(header + "a,1,0,0,x,0,0,4,2\n").find(":2: column y holds 'x'"),
            std::string::npos);
  EXPECT_NE(refusalOf(header + "a,1,0.05,0,0,0,0,4,2\n").find("10 rows a second"),
            std::string::npos);
  EXPECT_NE(refusalOf(header + "a,1,0,0,0\n").find(":2: has 5 cells"), std::string::npos);
  EXPECT_NE(refusalOf(header + "a,1,0,0,0,0,0,4,0\n").find("must be positive"), std::string::npos);
  EXPECT_NE(refusalOf(header + "a,1,0.1,0,0,0,0,4,2\na,1,0,0,0,0,0,4,2\n").find(":3: vehicle '1'"),
            std::string::npos);
}

TEST_F(RecordedTraffic, RefusesRowsThatAreSortedByTime) {
  const std::string text = refusalOf(std::string(kHeader) +
                                     "a,1,0,0,0,0,0,4,2\na,2,0,0,9,0,0,4,2\n"
                                     "a,1,0.1,1,0,0,0,4,2\n");
  EXPECT_NE(text.find(":4: rows of vehicle '1'"), std::string::npos) << text;
  const std::string twice = refusalOf(std::string(kHeader) +
                                      "a,1,0.1,0,0,0,0,4,2\na,2,0,0,9,0,0,4,2\n"
                                      "a,1,0,1,0,0,0,4,2\n");
  EXPECT_NE(twice.find(":4: vehicle '1' goes back in time"), std::string::npos) << twice;
  EXPECT_NE(refusalOf(std::string(kHeader) + "a,1,1e19,0,0,0,0,4,2\n").find("time 1e+19 s"),
            std::string::npos);
}

TEST_F(RecordedTraffic, ReadsTheFilesOfAFolder) {
  write(std::string(kHeader) + "A-1,1,0,0,0,0,0,4,2\n");
  core::writeFileAtomically(folder_.path() / "other.csv", "recording,vehicle\nA-1,1\n");
  EXPECT_EQ(readRecordedTraffic(std::vector{folder_.path()}).size(), 1U);
  std::filesystem::remove(folder_.path() / "log.csv");
  EXPECT_THROW(readRecordedTraffic(std::vector{folder_.path()}), core::InputError);
}

TEST_F(RecordedTraffic, ReadsResultsEveryTenthOfASecond) {
  core::writeFileAtomically(folder_.path() / "session.yaml",
                            "scenario:\n  simulation_step: 0.05\n");
  core::writeFileAtomically(folder_.path() / "trace.csv",
                            "tick,id,role,x,y,heading,speed,throttle,steer,brake\n"
                            "0,a,background,0,0,0,1,,,\n"
                            "1,a,background,0.05,0,0,1,,,\n"
                            "2,a,background,0.1,0,0,1,,,\n"
                            "4,a,cbv,0.2,0,0,1,0,0,0\n"
                            "6,a,cbv,0.3,0,0,1,0,0,0\n");
  const Recording recording = readResult(folder_.path());
  ASSERT_EQ(recording.tracks.size(), 2U);
  EXPECT_EQ(recording.tracks[0].role, "background");
  EXPECT_EQ(recording.tracks[0].states.size(), 2U);
  EXPECT_EQ(recording.tracks[1].role, "cbv");
  EXPECT_EQ(recording.tracks[1].first, 2U);
  EXPECT_EQ(recording.tracks[1].states.size(), 2U);
  core::writeFileAtomically(folder_.path() / "session.yaml",
                            "scenario:\n  simulation_step: 0.03\n");
  EXPECT_THROW(readResult(folder_.path()), core::InputError);
}

/// Boxes are 4.5 m long. Vehicle a touches b at tick 3, between steps 1 and 2, and is gone.
TEST_F(RecordedTraffic, ReadsContactsOfEveryTick) {
  core::writeFileAtomically(folder_.path() / "session.yaml",
                            "scenario:\n  simulation_step: 0.05\n");
  core::writeFileAtomically(folder_.path() / "trace.csv",
                            "tick,id,role,x,y,heading,speed,throttle,steer,brake\n"
                            "2,ego,ego,10,0,0,1,0,0,0\n"
                            "2,a,cbv,5,0,0,1,0,0,0\n"
                            "2,c,background,5,9,0,1,,,\n"
                            "3,ego,ego,10,0,0,1,0,0,0\n"
                            "3,a,cbv,5.6,0,0,1,0,0,0\n"
                            "3,c,background,5.6,9,0,1,,,\n"
                            "4,ego,ego,10,0,0,1,0,0,0\n"
                            "4,c,background,6,9,0,1,,,\n");
  const Recording recording = readResult(folder_.path());
  ASSERT_EQ(recording.tracks.size(), 3U);
  EXPECT_EQ(recording.tracks[0].contacts, std::set<std::size_t>{1});
  EXPECT_EQ(recording.tracks[1].contacts, std::set<std::size_t>{1});
  EXPECT_TRUE(recording.tracks[1].touchesAt(1));
  EXPECT_TRUE(recording.tracks[2].contacts.empty());
}

/// A box of another size: the trace shows none, the summary knows the contacts. Vehicle a left at
/// tick 5, its last step is 1.
TEST_F(RecordedTraffic, ReadsContactsThatTheSessionCounted) {
  core::writeFileAtomically(folder_.path() / "session.yaml",
                            "scenario:\n  simulation_step: 0.05\n");
  core::writeFileAtomically(folder_.path() / "trace.csv",
                            "tick,id,role,x,y,heading,speed,throttle,steer,brake\n"
                            "0,ego,ego,0,0,0,1,0,0,0\n"
                            "0,a,background,9,0,0,1,,,\n"
                            "2,ego,ego,0,0,0,1,0,0,0\n"
                            "2,a,cbv,5,0,0,1,0,0,0\n"
                            "4,ego,ego,0,0,0,1,0,0,0\n");
  core::writeFileAtomically(folder_.path() / "summary.json",
                            R"({"ego": {"contacts": [{"tick": 3, "with": "a"}]},
                                "cbv": {"selections": [
                                  {"vehicle_id": "a", "contact_with": "ego", "released_tick": 5},
                                  {"vehicle_id": "a", "contact_with": null, "released_tick": 1}]}})");
  const Recording recording = readResult(folder_.path());
  ASSERT_EQ(recording.tracks.size(), 3U);
  EXPECT_EQ(recording.tracks[0].contacts, std::set<std::size_t>{1});  // the ego
  EXPECT_TRUE(recording.tracks[1].contacts.empty());                  // a, before it was CBV
  EXPECT_EQ(recording.tracks[2].contacts, std::set<std::size_t>{1});
  core::writeFileAtomically(folder_.path() / "summary.json", "{}");
  EXPECT_THROW(readResult(folder_.path()), core::InputError);
}

TEST(RecordedFiles, HoldTheVehiclesThatTheirReadmeCounts) {
  const auto folder = test::realData("real_traffic");
  CDIFF_SKIP_WITHOUT(folder);
  const auto recordings = readRecordedTraffic(std::vector{folder});
  EXPECT_EQ(recordings.size(), 17U);
  std::size_t rows = 0;
  for (const Recording& recording : recordings) {
    for (const Track& track : recording.tracks) rows += track.states.size();
  }
  EXPECT_EQ(rows, 66391U);
}

}  // namespace
}  // namespace cdiff::realism
