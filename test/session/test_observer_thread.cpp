// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>

#include "session/observer_thread.h"

namespace cdiff::session {
namespace {

/// A record that owns its snapshot.
std::shared_ptr<const TickRecord> recordOf(std::uint64_t tick) {
  struct Owned {
    traffic::TrafficSnapshot snapshot;
    TickRecord record;
  };
  const auto owned = std::make_shared<Owned>();
  owned->snapshot.tick = tick;
  owned->record.snapshot = &owned->snapshot;
  return {owned, &owned->record};
}

/// Notes each tick in `log`; fails at one of them.
class Noting : public SessionObserver {
 public:
  Noting(std::string name, std::string& log, std::uint64_t fails_at = 1000)
      : name_(std::move(name)), log_(log), fails_at_(fails_at) {}
  void observe(const TickRecord& record) override {
    if (record.snapshot->tick == fails_at_) throw std::runtime_error(name_ + " fails");
    log_ += name_ + std::to_string(record.snapshot->tick) + " ";
  }

 private:
  std::string name_;
  std::string& log_;
  std::uint64_t fails_at_;
};

/// Observes nothing before it is let go.
class Held : public SessionObserver {
 public:
  Held() : gone_(let_go.get_future()) {}
  void observe(const TickRecord&) override {
    gone_.wait();
    ++observed;
  }
  std::promise<void> let_go;
  std::atomic<std::size_t> observed{0};

 private:
  std::future<void> gone_;
};

TEST(ObserverThread, AllObserversGetAllTicksInOrder) {
  std::string log;
  Noting first("a", log), second("b", log);
  ObserverThread thread({&first, &second});
  for (std::uint64_t tick = 0; tick < 3; ++tick) thread.show(recordOf(tick));
  thread.finish();
  EXPECT_EQ(log, "a0 b0 a1 b1 a2 b2 ");
}

TEST(ObserverThread, TheEndShowsWhatStillWaits) {
  std::string log;
  Noting observer("a", log);
  {
    ObserverThread thread({&observer});
    thread.show(recordOf(0));
    thread.show(recordOf(1));
  }
  EXPECT_EQ(log, "a0 a1 ");
}

TEST(ObserverThread, TheSessionDoesNotWaitForAFewTicks) {
  Held held;
  ObserverThread thread({&held});
  thread.show(recordOf(0));  // returns though the observer is not done with it
  EXPECT_EQ(held.observed, 0u);
  held.let_go.set_value();
  thread.finish();
  EXPECT_EQ(held.observed, 1u);
}

TEST(ObserverThread, TheSessionWaitsBeyondTheMostLag) {
  Held held;
  ObserverThread thread({&held});
  for (std::size_t tick = 0; tick < ObserverThread::kMostLag; ++tick) thread.show(recordOf(tick));
  EXPECT_EQ(held.observed, 0u);
  std::thread letting_go([&] { held.let_go.set_value(); });
  thread.show(recordOf(ObserverThread::kMostLag));  // there is room once the first was shown
  EXPECT_GE(held.observed, 1u);
  thread.finish();
  EXPECT_EQ(held.observed, ObserverThread::kMostLag + 1);
  letting_go.join();
}

TEST(ObserverThread, WhatAnObserverThrowsEndsTheShow) {
  std::string log;
  Noting sound("a", log), failing("b", log, 1);
  ObserverThread thread({&sound, &failing});
  thread.show(recordOf(0));
  thread.show(recordOf(1));
  EXPECT_THROW(thread.finish(), std::runtime_error);
  EXPECT_THROW(thread.show(recordOf(2)), std::runtime_error);
  EXPECT_EQ(log, "a0 b0 a1 ");
}

}  // namespace
}  // namespace cdiff::session
