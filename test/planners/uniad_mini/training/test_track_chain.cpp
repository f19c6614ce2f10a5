// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/uniad_mini/training/track_chain.h"
#include "planners/uniad_mini/training/uniad_mini_task.h"

namespace cdiff::planners {
namespace {

AgentLabel labelAt(std::uint32_t vehicle, float x, float y = 0.0F) {
  AgentLabel label;
  label.vehicle = vehicle;
  label.box[0] = x;
  label.box[1] = y;
  label.box[7] = 1.0F;
  return label;
}

/// Boxes of three slots: at 20 m, at 10.5 m, and at the ego.
at::Tensor threeBoxes() {
  at::Tensor boxes = at::zeros({3, 10});
  boxes[0][0] = 20.0;
  boxes[1][0] = 10.5;
  boxes.select(1, 7).fill_(1.0);
  return boxes;
}

HeldTracks holding(std::size_t slot, std::optional<std::uint32_t> vehicle) {
  HeldTracks held(3);
  held.live[slot] = true;
  held.vehicles[slot] = vehicle;
  return held;
}

// Without tracks the nearest slots answer. Slot 2 holds the vehicle at 20 m: it answers to it
// although slot 0 is there. Where slot 1 holds a false track, the others share the vehicles: 10 m
// and 0 m off cost less than 10 m and 20 m.
TEST(TrackChain, TracksAnswerToTheirVehicles) {
  const std::vector<AgentLabel> labels = {labelAt(7, 10.0F), labelAt(8, 20.0F)};
  const at::Tensor logits = at::zeros({3, 1});
  const at::Tensor boxes = threeBoxes();
  EXPECT_EQ(matchTracks(logits, boxes, labels, HeldTracks(3), {}), (std::vector<int>{1, 0}));
  EXPECT_EQ(matchTracks(logits, boxes, labels, holding(2, 8), {}), (std::vector<int>{1, 2}));
  EXPECT_EQ(matchTracks(logits, boxes, labels, holding(1, std::nullopt), {}),
            (std::vector<int>{2, 0}));
  EXPECT_NE(matchTracks(logits, boxes, {labelAt(9, 10.0F)}, holding(1, 8), {})[0], 1)
      << "held by another vehicle, which is not seen";
}

TEST(TrackChain, WithoutFreeSlotsNewVehiclesAreNobodys) {
  HeldTracks all(3);
  all.live = {true, true, true};
  all.vehicles = {1U, 2U, 3U};
  EXPECT_EQ(
      matchTracks(at::zeros({3, 1}), threeBoxes(), {labelAt(9, 10.0F), labelAt(2, 0.0F)}, all, {}),
      (std::vector<int>{-1, 1}));
}

// Probabilities 0.88, 0.05 and 0.73; slot 1 was matched.
TEST(TrackChain, MatchedTracksGoOnAndSomeFalseOnes) {
  const at::Tensor logits = learning::toTensor({2.0F, -3.0F, 1.0F}, {3, 1}, at::kCPU);
  const std::vector<AgentLabel> labels = {labelAt(7, 10.0F)};
  const core::RandomStream random(1, "test");
  const auto after = [&](double dropped, double false_positive) {
    return heldAfter(logits, labels, {1}, {dropped, false_positive}, {random, {1, 0, 1}});
  };
  HeldTracks held = after(0.0, 0.0);
  EXPECT_EQ(held.live, (std::vector<bool>{false, true, false}));
  EXPECT_EQ(held.vehicles[1], 7U);
  held = after(0.0, 1.0);
  EXPECT_EQ(held.live, (std::vector<bool>{true, true, true}));
  EXPECT_FALSE(held.vehicles[0].has_value());
  EXPECT_EQ(after(1.0, 0.0).live, (std::vector<bool>{false, false, false}));
}

// Over many draws a tenth is dropped: 100 of 1000, give or take three deviations of 9.5.
TEST(TrackChain, DropsAsOftenAsItSays) {
  const core::RandomStream random(1, "test");
  const at::Tensor logits = at::zeros({1, 1});
  int lost = 0;
  for (std::uint32_t step = 0; step < 1000; ++step)
    lost += heldAfter(logits, {labelAt(7, 10.0F)}, {0}, {}, {random, {1, step, 1}}).live[0] ? 0 : 1;
  EXPECT_NEAR(lost, 100, 29);
}

traffic::CameraImage grayImage(std::uint8_t value) {
  return {160, 96, 0, std::vector<std::uint8_t>(160 * 96 * 3, value)};
}

/// A car 20 m ahead, seen `looks` times by an ego that drives on at 4 m/s.
EgoExample seenTimes(std::size_t looks) {
  EgoExample example;
  for (std::size_t i = 0; i < looks; ++i) {
    EgoFrame look;
    for (int camera = 0; camera < 3; ++camera)
      look.images.push_back(grayImage(static_cast<std::uint8_t>(100 + 10 * i)));
    look.poses.present = {{2.0 * static_cast<double>(i), 0.0}, 0.0};
    if (i > 0) look.poses.past = example.looks.back().poses.present;
    look.motion = egoMotion(4.0, 0.0, look.poses);
    look.agents = {labelAt(7, 20.0F - 2.0F * static_cast<float>(i))};
    example.looks.push_back(look);
  }
  example.agents = example.looks.back().agents;
  return example;
}

UniadMiniArchitecture tinyUniad() {
  UniadMiniArchitecture architecture;
  architecture.ego.width = 32;
  architecture.ego.heads = 2;
  architecture.ego.hidden = 32;
  architecture.ego.bev_layers = 1;
  architecture.ego.bev = {16, 16, 4.0, 16.0};
  architecture.decoder_layers = 1;
  architecture.tracks = 4;
  return architecture;
}

/// Largest gradient of the layers that update tracks, and the loss of scores.
std::pair<double, double> followed(std::size_t looks, const TrackDropOptions& drops) {
  UniadMiniNet net(tinyUniad(), 3);
  net.trackParameters().setTrained(true);
  const EgoExample example = seenTimes(looks);
  FollowOptions options;
  options.drops = drops;
  const FollowedTracks tracks =
      followTracks(net, {&example}, options, core::RandomStream(1, "test"), 0);
  EXPECT_EQ(tracks.matches.size(), 1U);
  EXPECT_GE(tracks.matches[0][0], 0);
  (tracks.kind + tracks.box).backward();
  const at::Tensor& grad = net.trackParameters()("track.update.output.weight").grad();
  EXPECT_FALSE(net.bevParameters()("bev.0.mix.up.weight").grad().defined()) << "not trained here";
  return {grad.defined() ? grad.abs().max().item<double>() : 0.0, tracks.kind.item<double>()};
}

TEST(TrackChain, TheUpdateLearnsFromTheLooksThatFollow) {
  EXPECT_EQ(followed(1, {0.0, 0.0}).first, 0.0) << "nothing follows";
  EXPECT_GT(followed(2, {0.0, 0.0}).first, 0.0);
  EXPECT_GT(followed(3, {0.0, 0.0}).second, 0.0);
}

TEST(TrackChain, ShorterExamplesOfABatchStartAfresh) {
  UniadMiniNet net(tinyUniad(), 3);
  const at::NoGradGuard no_gradient;
  const EgoExample alone = seenTimes(1), longer = seenTimes(3);
  const core::RandomStream random(1, "test");
  const FollowedTracks both = followTracks(net, {&alone, &longer}, {}, random, 0);
  const FollowedTracks one = followTracks(net, {&alone}, {}, random, 0);
  const at::Tensor found = both.answer.boxes.back()[0], expected = one.answer.boxes.back()[0];
  EXPECT_LT((found - expected).abs().max().item<double>(), 1e-4);
}

// Ways in the vehicle's own frame: it stands at (10, 5), looks to the left and drives 2 m a step.
TEST(TakenWays, AreInTheFrameOfTheVehicle) {
  EgoExample example;
  AgentLabel label = labelAt(7, 10.0F, 5.0F);
  label.heading = M_PI / 2.0;
  label.size.length = 12.0;
  label.size.width = 2.5;
  label.future.known = 6;
  for (std::size_t i = 0; i < 6; ++i)
    label.future.places[i] = {10.0, 5.0 + 2.0 * static_cast<double>(i + 1)};
  example.others = {label, label};
  example.others[1].future.known = 5;
  const auto ways = takenWaysOf(example);
  ASSERT_EQ(ways.size(), 1U) << "the other one is not known to its end";
  EXPECT_EQ(ways[0].group, MotionGroup::kLarge);
  EXPECT_NEAR(ways[0].places[5].x(), 12.0, 1e-9);
  EXPECT_NEAR(ways[0].places[5].y(), 0.0, 1e-9);
}

}  // namespace
}  // namespace cdiff::planners
