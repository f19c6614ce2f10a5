// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Steers a running session through the panel's client, as a hand on the panel would:
//     panel_hand FOUND
// Once there is a CBV it pauses, steps four ticks, steers and lets the session go on. The file
// FOUND gets a line for each thing that came about. Ends with the session.
#include <fstream>

#include "session_client.h"

namespace {

using cdiff::rviz_panel::SessionClient;
using State = cdiff::rviz_panel::SessionFigures::State;

/// Whether it comes true within 40 s.
template <class Condition>
bool eventually(Condition condition) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(40.0);
  while (!condition() && ros::WallTime::now() < end) ros::WallDuration(0.02).sleep();
  return condition();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "panel_hand");
  const ros::NodeHandle node;
  SessionClient client;
  std::ofstream found(argv[argc - 1]);
  const auto note = [&](const char* what, auto condition) {
    found << what << (eventually(condition) ? " yes" : " no") << std::endl;
  };
  note("CBV", [&] { return !client.figures().slots.empty(); });
  client.pause();
  note("paused", [&] { return client.figures().state == State::kPaused; });
  const std::uint64_t tick = client.figures().tick;
  client.step(4);
  note("stepped", [&] {
    return client.figures().tick == tick + 4 && client.figures().answer == "step: done";
  });
  client.steer("profile", "nonsense");
  note("refused", [&] { return client.figures().refused; });
  client.steer("profile", "safety_critical");
  note("profile", [&] { return client.figures().answer == "profile: done"; });
  client.setParameter("collision_seeking_weight", 20.0);
  note("weight", [&] { return client.figures().answer == "collision_seeking_weight: done"; });
  client.play();
  note("over", [&] { return client.figures().state == State::kOver; });
  return 0;
}
