// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/pacer_fixture.h"

namespace cdiff::node_graph {
namespace {

std::atomic<int> ending{0};
std::atomic<int> most_ending{0};
std::atomic<int> ended{0};

/// Counts how many of its objects end at once.
class EndingNode {
 public:
  explicit EndingNode(bool fails) : fails_(fails) {}
  ~EndingNode() {
    const int now = ++ending;
    if (now > most_ending) most_ending = now;
    std::this_thread::yield();
    --ending;
    ++ended;
  }
  int run() {
    if (fails_) throw std::runtime_error("the node fails");
    return 5;
  }

 private:
  bool fails_;
};

TEST(HostedNodes, EndOneAfterAnother) {
  constexpr int kThreads = 8;
  constexpr int kNodes = 200;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([] {
      for (int j = 0; j < kNodes; ++j) runNodeObject<EndingNode>(false);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ended, kThreads * kNodes);
  EXPECT_EQ(most_ending, 1);
}

TEST(HostedNodes, EndAlsoWhenTheyFail) {
  EXPECT_EQ(runNodeObject<EndingNode>(false), 5);
  const int before = ended;
  EXPECT_THROW(runNodeObject<EndingNode>(true), std::runtime_error);
  EXPECT_EQ(ended, before + 1);
}

TEST(HostedNodes, AreWaitedForAtTheEndOfASessionAlsoWhereNoneWasHeard) {
  test::initRos();
  StopSignal stop;
  const ParticipantTracker participants({kMetricsNode, kRecorderNode});
  const Connections connections;
  SessionWatch watch(stop, participants, connections);
  const auto wait = [&watch](double seconds) {
    const auto begin = SessionWatch::Clock::now();
    watch.waitForObservers(seconds);
    return secondsSince(begin);
  };
  const HostedNode recorder("/" + std::string(kRecorderNode));
  EXPECT_GE(wait(0.2), 0.2);
  EXPECT_LT(wait(30.0), 20.0) << "it has 5 s";
}

}  // namespace
}  // namespace cdiff::node_graph
