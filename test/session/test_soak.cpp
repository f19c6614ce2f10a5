// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Many sessions one after another in one process: neither memory nor file descriptors nor processes
// may grow.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>

#include "core/file.h"
#include "core/text.h"
#include "session/closed_loop.h"
#include "session/session_request.h"

namespace cdiff::session {
namespace {

/// What this process holds.
struct Holdings {
  long resident = 0;     ///< [kB]
  long descriptors = 0;  ///< open files and sockets
  long children = 0;     ///< processes, dead ones that no one waited for included
};

Holdings holdings() {
  namespace fs = std::filesystem;
  Holdings now;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) now.resident = std::stol(line.substr(6));
  }
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator("/proc/self/fd"))
    ++now.descriptors;
  for (const auto& task : fs::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (long child = 0; children >> child;) ++now.children;
  }
  return now;
}

/// Counts ticks and takes the course's hash.
class Course : public SessionObserver {
 public:
  void observe(const TickRecord& record) override {
    ++ticks;
    for (const traffic::Vehicle& vehicle : record.snapshot->vehicles)
      text_ += vehicle.id + core::formatNumber(vehicle.state.position.x());
  }
  std::string hash() const { return core::sha256(text_); }
  long ticks = 0;

 private:
  std::string text_;
};

std::string drive(const std::string& scenario, const std::string& planner, long& ticks) {
  SessionRequest request;
  request.scenario = scenario;
  request.cbv_planner = planner;
  const SessionSetup setup(resolveRequest(request));
  ClosedLoop loop(setup);
  Course course;
  loop.addObserver(course);
  const std::atomic<bool> stop{false};
  EXPECT_NE(loop.run(stop), traffic::SessionStatus::kError);
  ticks += course.ticks;
  return course.hash();
}

// 12 000 ticks are 600 s of simulated time, some 25 sessions. The first ones of each planner fill
// caches (networks, weights, the allocator); after those the process may grow by 16 MB, less than 1
// MB a session. A session that kept its network would add 3 MB, one that kept its model 90 MB.
TEST(Soak, SessionsInSequenceLeaveNothingBehind) {
  constexpr long kTicks = 12000;
  constexpr long kGrowth = 16 * 1024;  // [kB]
  const std::pair<const char*, const char*> kinds[] = {{"crossing_left_turn", "pdm_lite"},
                                                       {"roundabout_entry", "diffusion"},
                                                       {"t_junction_left", "two_stage_pid"}};
  std::map<std::string, std::string> courses;
  long ticks = 0;
  for (const auto& [scenario, planner] : kinds) courses[scenario] = drive(scenario, planner, ticks);
  for (const auto& [scenario, planner] : kinds)
    EXPECT_EQ(drive(scenario, planner, ticks), courses[scenario]);
  const Holdings begin = holdings();
  ticks = 0;
  int sessions = 0;
  while (ticks < kTicks) {
    const auto& [scenario, planner] = kinds[sessions++ % 3];
    EXPECT_EQ(drive(scenario, planner, ticks), courses[scenario]) << "session " << sessions;
    const Holdings now = holdings();
    ASSERT_EQ(now.descriptors, begin.descriptors) << "session " << sessions;
    ASSERT_EQ(now.children, begin.children) << "session " << sessions;
    ASSERT_LT(now.resident, begin.resident + kGrowth) << "session " << sessions;
  }
  std::cout << sessions << " sessions, " << ticks << " ticks; resident " << begin.resident << " -> "
            << holdings().resident << " kB, " << begin.descriptors << " descriptors\n";
}

}  // namespace
}  // namespace cdiff::session
