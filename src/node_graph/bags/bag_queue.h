// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "node_graph/bags/session_bag_writer.h"
#include "node_graph/lockstep/tick_answers.h"

namespace cdiff::node_graph {

/// Writes ticks into a bag from a thread of its own, in the order in which they come, so that
/// neither compression nor the disk holds up who hands them over. Where the disk is slower than the
/// session, a bounded number of ticks waits, then who hands them over does, and is counted.
class BagQueue {
 public:
  static constexpr std::size_t kRoom = 64;  ///< ticks that may wait

  /// How the disk keeps up.
  struct Load {
    std::uint64_t written = 0;     ///< ticks
    std::size_t waiting = 0;       ///< ticks
    std::size_t most_waiting = 0;  ///< ticks
    std::uint64_t full = 0;        ///< ticks that found no room at once
  };

  /// `bag` must outlive the object. Nobody else writes into it as long as the object exists.
  explicit BagQueue(BagFile& bag);
  /// Writes what waits.
  ~BagQueue();
  BagQueue(const BagQueue&) = delete;
  BagQueue& operator=(const BagQueue&) = delete;

  /// Takes a tick; waits while there is no room. The messages must not change any more. Throws the
  /// InputError of an earlier tick that the bag could not take.
  void write(const TickMessages& tick);
  /// Waits until every tick is written. Throws as write().
  void finish();
  Load load() const;

 private:
  void work();
  std::optional<TickMessages> next();
  void written();
  void stop();

  BagFile& bag_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<TickMessages> ticks_;  ///< the first one is being written
  Load load_;
  std::exception_ptr error_;  ///< of the bag, which takes nothing more then
  bool over_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace cdiff::node_graph
