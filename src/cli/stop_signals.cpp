// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "stop_signals.h"

#include <csignal>

namespace cdiff::cli {
namespace {

// A signal handler can reach nothing else.
std::atomic<bool> stop_requested{false};

void requestStop(int) { stop_requested = true; }

}  // namespace

const std::atomic<bool>& catchStopSignals() {
  stop_requested = false;
  struct sigaction action {};
  action.sa_handler = requestStop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return stop_requested;
}

}  // namespace cdiff::cli
