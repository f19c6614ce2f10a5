// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/bag_queue.h"

#include <algorithm>

namespace cdiff::node_graph {

BagQueue::BagQueue(BagFile& bag) : bag_(bag), thread_([this] { work(); }) {}

BagQueue::~BagQueue() { stop(); }

void BagQueue::write(const TickMessages& tick) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (ticks_.size() >= kRoom) {
    ++load_.full;
    changed_.wait(lock, [this] { return ticks_.size() < kRoom || error_; });
  }
  if (error_) std::rethrow_exception(error_);
  ticks_.push_back(tick);
  load_.most_waiting = std::max(load_.most_waiting, ticks_.size());
  changed_.notify_all();
}

void BagQueue::finish() {
  stop();
  if (error_) std::rethrow_exception(error_);
}

BagQueue::Load BagQueue::load() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Load load = load_;
  load.waiting = ticks_.size();
  return load;
}

void BagQueue::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void BagQueue::work() {
  try {
    while (const auto tick = next()) {
      bag_.write(*tick);
      written();
    }
  } catch (const std::exception&) {
    const std::lock_guard<std::mutex> lock(mutex_);
    error_ = std::current_exception();
    ticks_.clear();
    changed_.notify_all();
  }
}

/// The tick to write now, which keeps its place until it is written; nullopt at the end.
std::optional<TickMessages> BagQueue::next() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return over_ || !ticks_.empty(); });
  if (ticks_.empty()) return std::nullopt;
  return ticks_.front();
}

void BagQueue::written() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ticks_.pop_front();
  ++load_.written;
  changed_.notify_all();
}

}  // namespace cdiff::node_graph
