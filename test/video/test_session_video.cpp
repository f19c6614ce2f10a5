// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/verdict_cases.h"
#include "video/session_video.h"
#include "video/video_highlights.h"

namespace cdiff::video {
namespace {

namespace fs = std::filesystem;
using traffic::SessionStatus;

/// What a command prints.
std::string outputOf(const std::string& command) {
  std::string output;
  FILE* pipe = ::popen(command.c_str(), "r");
  std::array<char, 65536> buffer{};
  std::size_t count = 0;
  while ((count = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0) {
    output.append(buffer.data(), count);
  }
  ::pclose(pipe);
  return output;
}

/// Frames of a video, decoded again: rows of red, green, blue from the top left.
struct Decoded {
  static constexpr std::size_t kBytes = 3U * 1280U * 720U;
  std::string rgb;
  std::size_t count() const { return rgb.size() / kBytes; }
  std::array<int, 3> pixel(std::size_t frame, std::size_t x, std::size_t y) const {
    const std::size_t at = frame * kBytes + 3 * (1280 * y + x);
    const auto byte = [&](std::size_t i) {
      return static_cast<int>(static_cast<unsigned char>(rgb[at + i]));
    };
    return {byte(0), byte(1), byte(2)};
  }
};

Decoded decode(const fs::path& file, const std::string& frames) {
  return {outputOf("ffmpeg -v error -nostdin -i '" + file.string() + "' -vf \"select='" + frames +
                   "',scale=in_color_matrix=bt709\" -vsync 0 -f rawvideo -pix_fmt rgb24 -")};
}

std::string streamOf(const fs::path& file) {
  return outputOf(
      "ffprobe -v error -count_frames -show_entries "
      "stream=codec_name,width,height,pix_fmt,r_frame_rate,nb_read_frames -of csv=p=0 '" +
      file.string() + "'");
}

/// Puts `folder` in front of everything in PATH, or in its place, until the end of the test.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) : before_(std::getenv("PATH")) {
    ::setenv("PATH", path.c_str(), 1);
  }
  ~SearchPath() { ::setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

/// Plays ticks 0 to `last` of the sample session to writer and video; `change` may alter them.
using Change = void (*)(traffic::TrafficSnapshot&);
void unchanged(traffic::TrafficSnapshot&) {}

std::string videoError(const fs::path& folder, std::uint64_t last, Change change = &unchanged) {
  const test::SampleSetup sample;
  page::ResultWriter writer(sample.setup, test::sampleFacts(), folder);
  SessionVideo video(sample.setup, folder);
  for (std::uint64_t tick = 0; tick <= last; ++tick) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    if (tick == last) snapshot.status = SessionStatus::kTimedOut;
    change(snapshot);
    const cbv::CbvSelection selection = test::sampleSelection(tick, sample.setup.network());
    session::TickRecord record;
    record.snapshot = &snapshot;
    if (snapshot.decision_tick) record.selection = &selection;
    writer.observe(record);
    video.observe(record);
  }
  writer.finish(1.0);
  video.finish(writer.result());
  return video.error();
}

void expectColor(const std::array<int, 3>& pixel, const std::array<int, 3>& wanted) {
  // Coding loses a little; the colors of roles differ by more than 100 in some channel.
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(pixel[i], wanted[i], 15) << "channel " << i;
}

TEST(SessionVideo, HasEveryTenthOfASecondAndTheVerdict) {
  const test::TemporaryFolder scratch;
  ASSERT_EQ(videoError(scratch.path(), 60), "");
  const fs::path file = scratch.path() / kVideoFile;
  // Ticks 0, 2 ... 60, then the verdict.
  EXPECT_EQ(streamOf(file),
            "h264,1280,720,yuv420p,10/1," + std::to_string(31 + kVerdictFrames) + "\n");
  const Decoded frames = decode(file, "eq(n,0)+eq(n,15)+eq(n,30)");
  ASSERT_EQ(frames.count(), 3u);
  // The ego, red, in the middle of the picture from above: x 640 to 1280, y 44 to 720.
  for (std::size_t i = 0; i < 3; ++i) expectColor(frames.pixel(i, 960, 382), {198, 40, 40});
  // 640 pixels show 120 m. The road's border is 3.2 m to the right of the ego's center: grass 10 m
  // (53 pixels) to the south.
  expectColor(frames.pixel(0, 960, 382 + 53), {238, 241, 236});
  // At 3 s the crossing vehicle is a CBV: the front view has its sky; before, there is none.
  EXPECT_GT(frames.pixel(2, 320, 100)[2], frames.pixel(2, 320, 100)[0] + 30);
  expectColor(frames.pixel(0, 320, 100), {245, 246, 248});
}

TEST(SessionVideo, ShowsACbvWhereItIs) {
  const test::TemporaryFolder scratch;
  ASSERT_EQ(videoError(scratch.path(), 60,
                       [](traffic::TrafficSnapshot& snapshot) {
                         snapshot.vehicles[1].role = traffic::VehicleRole::kCbv;
                         snapshot.vehicles[1].cbv_slot = 0;
                         snapshot.vehicles[1].state.position =
                             snapshot.vehicles[0].state.position + Eigen::Vector2d(-30.0, 15.0);
                         snapshot.vehicles[1].state.heading = 0.0;
                       }),
            "");
  const Decoded frames = decode(scratch.path() / kVideoFile, "eq(n,10)");
  ASSERT_EQ(frames.count(), 1u);
  // 16 / 3 pixels per meter: 160 to the left, 80 up.
  expectColor(frames.pixel(0, 960 - 160, 382 - 80), {123, 31, 162});
}

/// Left border of the box with the verdict, for a session of these cases; the video has its last
/// ticks alone.
std::array<int, 3> verdictColor(const std::string& name) {
  const auto& cases = test::verdictCases();
  const auto wanted =
      std::find_if(cases.begin(), cases.end(),
                   [&](const test::VerdictCase& candidate) { return candidate.name == name; });
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample(test::optionsOf(*wanted));
  page::ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  SessionVideo video(sample.setup, scratch.path());
  test::playCase(writer, *wanted);
  writer.finish(1.0);
  video.finish(writer.result());
  EXPECT_EQ(video.error(), "");
  // 900 pixels wide in the middle of 1280 x 720, with a frame of 4 pixels.
  return decode(scratch.path() / kVideoFile, "eq(n,0)").pixel(0, 190, 360);
}

TEST(SessionVideo, EndsWithTheVerdictInItsColor) {
  expectColor(verdictColor("completed"), {27, 110, 54});
  expectColor(verdictColor("struck_attacked"), {122, 74, 0});
  expectColor(verdictColor("struck"), {163, 25, 25});
  expectColor(verdictColor("no_rules"), {93, 102, 112});
  expectColor(verdictColor("broken"), {91, 42, 134});
}

/// bg_1, a CBV, stands in the ego's way: a contact at 1 s, after which it is gone.
void contactAtOneSecond(traffic::TrafficSnapshot& snapshot) {
  traffic::Vehicle& other = snapshot.vehicles[1];
  other.role = traffic::VehicleRole::kCbv;
  other.cbv_slot = 0;
  // 4.4 m ahead of the ego at 1 s, standing: 0.3 m apart at the tick before.
  other.state.position = {5.0 + 8.0 + 4.4, -2.0};
  other.state.heading = 0.0;
  other.state.speed = 0.0;
  if (snapshot.tick == 20) snapshot.contacts = {{"bg_1", "ego"}};
  if (snapshot.tick > 20) snapshot.vehicles.erase(snapshot.vehicles.begin() + 1);
}

TEST(SessionVideo, AContactOfTheEgoStaysToBeSeen) {
  const test::TemporaryFolder scratch;
  ASSERT_EQ(videoError(scratch.path(), 60, &contactAtOneSecond), "");
  const Decoded frames = decode(scratch.path() / kVideoFile, "eq(n,9)+eq(n,10)+eq(n,25)+eq(n,26)");
  ASSERT_EQ(frames.count(), 4u);
  // The plate at the lower border of the front view (y 44 to 428), red: the ego is at fault.
  const auto plate = [&](std::size_t frame) { return frames.pixel(frame, 4, 424); };
  for (const std::size_t during : {1U, 2U}) {
    expectColor(plate(during), {163, 25, 25});
    // The front view is that of the contact although its CBV is gone: the label's purple.
    expectColor(frames.pixel(during, 4, 48), {123, 31, 162});
  }
  // The ring of 26 pixels is around the place of the contact, 2.25 m (12 pixels) ahead of the ego
  // at 1 s: above it at (972, 356).
  expectColor(frames.pixel(1, 972, 356), {163, 25, 25});
  EXPECT_GT(plate(0)[2], 60);  // a road, no red
  expectColor(plate(3), {245, 246, 248});
}

/// CBVs "a" (slot 0) and "b" (slot 1) at these distances east of the ego.
std::string followed(FollowedCbv& focus, double a, double b) {
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(0);
  snapshot.vehicles.resize(1);
  const Eigen::Vector2d ego = snapshot.vehicles[0].state.position;
  for (const auto& [id, distance] : {std::pair("a", a), std::pair("b", b)}) {
    snapshot.vehicles.push_back(test::sampleVehicle(id, traffic::VehicleRole::kCbv,
                                                    ego + Eigen::Vector2d(distance, 0), 0.0, 5.0));
    snapshot.vehicles.back().cbv_slot = id[0] - 'a';
  }
  const traffic::Vehicle* shown = focus.update(snapshot);
  return shown == nullptr ? "" : shown->id;
}

TEST(FollowedCbv, IsTheNearestAndChangesOnlyForOneThatIsClearlyNearer) {
  FollowedCbv focus;
  EXPECT_EQ(followed(focus, 30, 20), "b");  // not slot 0
  EXPECT_EQ(followed(focus, 18, 20), "b");  // 2 m nearer
  EXPECT_EQ(followed(focus, 20, 20), "b");
  EXPECT_EQ(followed(focus, 16, 20), "a");  // 4 m nearer
  EXPECT_EQ(followed(focus, 19, 17), "a");
  EXPECT_EQ(followed(focus, 19, 16), "b");  // 3 m
  traffic::TrafficSnapshot alone = test::sampleSnapshot(0);
  EXPECT_EQ(focus.update(alone), nullptr);
  EXPECT_EQ(followed(focus, 20, 21), "a");
  FollowedCbv fresh;
  EXPECT_EQ(followed(fresh, 20, 20), "a");  // a tie: the lower slot
}

TEST(SessionVideo, EqualSessionsGiveEqualFiles) {
  const test::TemporaryFolder first;
  const test::TemporaryFolder second;
  ASSERT_EQ(videoError(first.path(), 20), "");
  ASSERT_EQ(videoError(second.path(), 20), "");
  EXPECT_EQ(core::readFile(first.path() / kVideoFile, "video"),
            core::readFile(second.path() / kVideoFile, "video"));
}

TEST(SessionVideo, StrangeSessionsHaveOneToo) {
  const auto strange = [](traffic::TrafficSnapshot& snapshot) {
    snapshot.vehicles[1].id = "<script>\xC3\xA4\xFF" + std::string(400, 'x');
    snapshot.vehicles[1].role = traffic::VehicleRole::kCbv;
    snapshot.vehicles[1].cbv_slot = 3;
    snapshot.vehicles[2].state.position.x() = std::numeric_limits<double>::infinity();
    if (snapshot.tick > 6) snapshot.vehicles.clear();
  };
  const test::TemporaryFolder scratch;
  EXPECT_EQ(videoError(scratch.path(), 10, strange), "");
  EXPECT_EQ(streamOf(scratch.path() / kVideoFile),
            "h264,1280,720,yuv420p,10/1," + std::to_string(6 + kVerdictFrames) + "\n");
}

TEST(SessionVideo, ASessionWithoutTicksHasTheVerdictAlone) {
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  page::ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  SessionVideo video(sample.setup, scratch.path());
  writer.finish(0.0);
  video.finish(writer.result());
  EXPECT_EQ(video.error(), "");
  EXPECT_EQ(streamOf(scratch.path() / kVideoFile),
            "h264,1280,720,yuv420p,10/1," + std::to_string(kVerdictFrames) + "\n");
}

/// The result folder without its video.
void expectWholeResult(const fs::path& folder) {
  for (const char* name :
       {"session.yaml", "trace.csv", "summary.json", "junit.xml", "report.html"}) {
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    EXPECT_EQ(entry.path().string().find("mp4"), std::string::npos) << entry.path();
  }
}

TEST(SessionVideo, WithoutTheEncoderTheSessionIsWhole) {
  const test::TemporaryFolder scratch;
  const SearchPath nothing("/nonexistent");
  const std::string error = videoError(scratch.path(), 20);
  EXPECT_NE(error.find("install the Debian package ffmpeg"), std::string::npos) << error;
  expectWholeResult(scratch.path());
}

/// A program called ffmpeg that does something else.
std::string fakeEncoder(const fs::path& folder, const std::string& script) {
  fs::create_directories(folder);
  core::writeFileAtomically(folder / "ffmpeg", "#!/bin/sh\n" + script + "\n");
  fs::permissions(folder / "ffmpeg", fs::perms::owner_all);
  return folder.string() + ":" + std::getenv("PATH");
}

TEST(SessionVideo, AnEncoderThatFailsIsQuoted) {
  const test::TemporaryFolder tools;
  for (const char* script :
       {"echo 'No space left on device' >&2; exit 1",                   // before any frame
        "cat > /dev/null; echo 'No space left on device' >&2; exit 1",  // after the last one
        "cat > /dev/null; echo 'No space left on device' >&2; exit 0"}) {
    const test::TemporaryFolder scratch;
    const SearchPath path(fakeEncoder(tools.path(), script));
    const std::string error = videoError(scratch.path(), 20);
    EXPECT_NE(error.find("session.mp4' was not written"), std::string::npos) << error;
    EXPECT_NE(error.find("No space left on device"), std::string::npos) << error;
    expectWholeResult(scratch.path());
  }
}

TEST(VideoEncoder, AProgramThatReadsNothingIsEnded) {
  const test::TemporaryFolder tools;
  const test::TemporaryFolder scratch;
  const SearchPath path(fakeEncoder(tools.path(), "exec sleep 50"));
  const auto begin = std::chrono::steady_clock::now();
  try {
    VideoEncoder encoder(scratch.path() / "a.mp4", {1280, 720, 10}, 1);
    const std::vector<std::uint8_t> frame(3 * 1280 * 720, 128);
    while (true) encoder.write(frame);
  } catch (const core::SimulatorError& error) {
    EXPECT_NE(std::string(error.what()).find("it took nothing for 1 s"), std::string::npos)
        << error.what();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(40));
  EXPECT_TRUE(fs::is_empty(scratch.path()));
}

TEST(VideoEncoder, AVideoThatIsNotOursStays) {
  const test::TemporaryFolder scratch;
  const fs::path file = scratch.path() / "a.mp4";
  core::writeFileAtomically(file, "mine");
  try {
    const VideoEncoder encoder(file, {64, 64, 10});
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
  }
  EXPECT_EQ(core::readFile(file, "video"), "mine");
}

TEST(VideoEncoder, ReplacesAnEarlierVideoOnlyWhenFinished) {
  const test::TemporaryFolder scratch;
  const fs::path file = scratch.path() / "a.mp4";
  const std::vector<std::uint8_t> frame(3 * 64 * 64, 128);
  {
    VideoEncoder encoder(file, {64, 64, 10});
    encoder.write(frame);
    EXPECT_FALSE(fs::exists(file));
  }
  EXPECT_TRUE(fs::is_empty(scratch.path()));
  VideoEncoder encoder(file, {64, 64, 10});
  encoder.write(frame);
  encoder.finish();
  EXPECT_TRUE(fs::exists(file));
}

}  // namespace
}  // namespace cdiff::video
