// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// One TraCI session with a SUMO process of our own: every call goes through `guarded`, which
/// bounds it in wall time [s] and turns every way to fail into a SimulatorError that quotes SUMO's
/// log; a SumoRefusal where SUMO ended by itself, or crashed while it loaded its input.
#pragma once

#include <signal.h>

#include <functional>
#include <string>
#include <utility>

#include "simulation/sumo_process.h"

namespace cdiff::simulation {

class SumoLink {
 public:
  /// Starts SUMO and connects. `call_timeout` bounds each guarded call.
  SumoLink(const SumoCommand& command, double call_timeout);
  /// Closes the session and ends SUMO.
  ~SumoLink();
  SumoLink(const SumoLink&) = delete;
  SumoLink& operator=(const SumoLink&) = delete;

  /// Runs calls of libtraci under the deadline. `what` says in errors what was tried ("step").
  template <class Call>
  auto guarded(const std::string& what, Call&& call) {
    const Guard guard(*this);
    try {
      select();
      return std::forward<Call>(call)();
    } catch (...) {
      fail(what);
    }
  }
  /// Runs a call inside a guarded one; answers false when SUMO refuses it and throws on when SUMO
  /// is lost.
  bool attempt(const std::function<void()>& call);

  const std::string& version() const { return version_; }
  int processId() const { return sumo_.process().id(); }

 private:
  /// Selects this session, holds signals back (an interrupted read would look like a lost SUMO) and
  /// sets the deadline.
  class Guard {
   public:
    explicit Guard(SumoLink& link);
    ~Guard();
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    SumoLink& link_;
    sigset_t previous_;
  };

  void connect();
  void select() const;
  [[noreturn]] void fail(const std::string& what);
  std::string lossText(const std::string& what, const std::string& reason);

  SumoProcess sumo_;
  double limit_;
  std::string label_;
  std::string version_;
  bool connected_ = false;
  bool loaded_ = false;  ///< network and demand
};

}  // namespace cdiff::simulation
