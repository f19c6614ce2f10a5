// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "record/logs/cbv_log.h"
#include "record/sample_session.h"

namespace cdiff::record {
namespace {

/// The sample session's setup with another rate of views.
test::SampleSetup setupWith(double rate) {
  session::ScenarioOptions options = test::sampleOptions();
  options.report.front_view_rate = rate;
  return test::SampleSetup(options);
}

/// The crossing vehicle is a CBV from tick 53 on.
FrontViewLog logOf(const session::SessionSetup& setup, std::uint64_t last) {
  FrontViewLog log(setup);
  for (std::uint64_t tick = 0; tick <= last; ++tick) log.observe(test::sampleSnapshot(tick));
  return log;
}

TEST(FrontViewLog, TakesViewsOfDrivenCbvsAtTheRate) {
  const test::SampleSetup sample = setupWith(2.5);
  const FrontViewLog log = logOf(sample.setup, 80);
  EXPECT_DOUBLE_EQ(log.period(), 0.4);
  ASSERT_EQ(log.views().size(), 4u);  // every 8th tick from 53 to 80: 56, 64, 72, 80
  EXPECT_EQ(log.views()[0].tick, 56u);
  EXPECT_DOUBLE_EQ(log.views()[0].time, 2.8);
  EXPECT_EQ(log.views()[3].tick, 80u);
  EXPECT_EQ(log.views()[0].vehicle_id, "bg_1");
  EXPECT_EQ(log.views()[0].slot, 0);
  const cv::Mat picture = cv::imdecode(log.views()[0].jpeg, cv::IMREAD_COLOR);
  EXPECT_EQ(picture.cols, 320);
  EXPECT_EQ(picture.rows, 192);
  const auto& sky = picture.at<cv::Vec3b>(2, 160);  // blue, green, red
  EXPECT_GT(sky[0], sky[2] + 30);
}

TEST(FrontViewLog, TakesAViewAtAContactOfACbv) {
  const test::SampleSetup sample = setupWith(2.5);
  FrontViewLog log(sample.setup);
  for (std::uint64_t tick = 56; tick <= 60; ++tick) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    if (tick == 57) snapshot.contacts = {{"ego", "bg_1"}};
    if (tick == 59) snapshot.contacts = {{"ego", "bg_2"}};  // no CBV
    log.observe(snapshot);
  }
  ASSERT_EQ(log.views().size(), 2u);
  EXPECT_EQ(log.views()[1].tick, 57u);
}

TEST(FrontViewLog, ACameraThatSharesItsShapesShowsTheSame) {
  const test::SampleSetup sample = setupWith(2.5);
  const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(64);
  const traffic::Vehicle& cbv = snapshot.vehicles[1];
  const auto expected = cameraForPeople(sample.setup, 64, 40).render(snapshot, cbv).rgb;
  FrontViewLog log(sample.setup);
  EXPECT_EQ(log.camera(64, 40).render(snapshot, cbv).rgb, expected) << "without a view";
  log.observe(test::sampleSnapshot(56));
  EXPECT_EQ(log.camera(64, 40).render(snapshot, cbv).rgb, expected);
  log.observe(snapshot);
  ASSERT_EQ(log.views().size(), 2u);
  const FrontViewLog other = logOf(sample.setup, 64);
  EXPECT_EQ(log.views()[1].jpeg, other.views()[1].jpeg) << "between, another camera was used";
}

TEST(FrontViewLog, RateZeroKeepsItEmpty) {
  const test::SampleSetup sample = setupWith(0.0);
  EXPECT_TRUE(logOf(sample.setup, 80).views().empty());
}

TEST(FrontViewLog, PassesOverAVehicleWithoutAPlace) {
  const test::SampleSetup sample = setupWith(10.0);
  FrontViewLog log(sample.setup);
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(60);
  snapshot.vehicles[1].state.position.x() = std::numeric_limits<double>::quiet_NaN();
  log.observe(snapshot);
  EXPECT_TRUE(log.views().empty());
  log.observe(test::sampleSnapshot(62));
  EXPECT_EQ(log.views().size(), 1u);
}

TEST(FrontViewLog, ThinsALongSessionEvenly) {
  const test::SampleSetup sample = setupWith(10.0);
  FrontViewLog log(sample.setup);
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(60);
  for (std::uint64_t tick = 0; tick < 4000; tick += 2) {
    snapshot.tick = tick;
    snapshot.time = 0.05 * static_cast<double>(tick);
    log.observe(snapshot);
  }
  std::size_t bytes = 0;
  for (const FrontView& view : log.views()) bytes += view.jpeg.size();
  EXPECT_LE(bytes, kFrontViewBytes);
  EXPECT_GT(bytes, kFrontViewBytes / 3);  // one halving leaves half
  const auto ticks = static_cast<std::uint64_t>(std::lround(log.period() / 0.05));
  EXPECT_GT(ticks, 2u);
  for (std::size_t i = 0; i < log.views().size(); ++i) EXPECT_EQ(log.views()[i].tick, i * ticks);
}

}  // namespace
}  // namespace cdiff::record
