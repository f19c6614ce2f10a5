// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/observer_thread.h"

#include <utility>

namespace cdiff::session {

ObserverThread::ObserverThread(std::vector<SessionObserver*> observers)
    : observers_(std::move(observers)), thread_([this] { run(); }) {}

ObserverThread::~ObserverThread() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ObserverThread::show(std::shared_ptr<const TickRecord> record) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return error_ || waiting_.size() < kMostLag; });
  throwError();
  waiting_.push_back(std::move(record));
  if (waiting_.size() == 1) changed_.notify_all();
}

void ObserverThread::finish() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return error_ || waiting_.empty(); });
  throwError();
}

void ObserverThread::throwError() {
  if (error_) std::rethrow_exception(error_);
}

void ObserverThread::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::shared_ptr<const TickRecord> record = waiting_.front();
    lock.unlock();
    try {
      for (SessionObserver* observer : observers_) observer->observe(*record);
      lock.lock();
    } catch (...) {
      lock.lock();
      error_ = std::current_exception();
      waiting_.clear();
      changed_.notify_all();
      return;
    }
    waiting_.pop_front();
    if (waiting_.empty() || waiting_.size() == kMostLag - 1) changed_.notify_all();
  }
}

}  // namespace cdiff::session
