// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "watch/page_command.h"

namespace cdiff::node_graph {

/// The link of live pages to a session of the node graph: calls the services of its traffic
/// simulator one after the other, in a thread of its own. Of several values for one slider that
/// wait, the newest is sent.
class ServiceLink : public watch::SessionLink {
 public:
  /// `at_most`: pace that the session begins with.
  explicit ServiceLink(double at_most);
  ~ServiceLink() override;
  ServiceLink(const ServiceLink&) = delete;
  ServiceLink& operator=(const ServiceLink&) = delete;

  void send(const watch::PageCommand& command, Answer answer) override;
  std::string state() const override;
  double pace() const override;

 private:
  using Clock = std::chrono::steady_clock;
  void work();
  void look();

  mutable std::mutex mutex_;
  mutable Clock::time_point wanted_;  ///< when the state was asked for last
  std::condition_variable changed_;
  std::deque<std::pair<watch::PageCommand, Answer>> queue_;
  std::string state_ = "playing";
  double pace_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace cdiff::node_graph
