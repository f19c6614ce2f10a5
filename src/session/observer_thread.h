// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "session/session_observer.h"

namespace cdiff::session {

/// Shows the ticks of a session to its observers in a thread of its own, so that the session goes
/// on meanwhile. Every observer gets every tick in order, as it would in the session's thread.
class ObserverThread {
 public:
  /// Ticks that may wait; the session waits for its observers beyond that.
  static constexpr std::size_t kMostLag = 20;

  /// `observers` are called in this order and must outlive the object.
  explicit ObserverThread(std::vector<SessionObserver*> observers);
  /// Shows what still waits.
  ~ObserverThread();
  ObserverThread(const ObserverThread&) = delete;
  ObserverThread& operator=(const ObserverThread&) = delete;

  /// Takes a tick to show; what the record points to lives as long as `record`. Waits while
  /// kMostLag ticks wait. Throws what an observer threw at an earlier tick, after which nothing
  /// more is shown.
  void show(std::shared_ptr<const TickRecord> record);
  /// Returns once all is shown. Throws what an observer threw.
  void finish();

 private:
  void run();
  void throwError();

  std::vector<SessionObserver*> observers_;
  std::mutex mutex_;  ///< guards all members below
  std::condition_variable changed_;
  std::deque<std::shared_ptr<const TickRecord>> waiting_;  ///< the first is being shown
  std::exception_ptr error_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace cdiff::session
