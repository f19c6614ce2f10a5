// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/lockstep/stop_signal.h"

#include <pthread.h>
#include <signal.h>
#include <time.h>

#include "core/program.h"

namespace cdiff::ros {
namespace {

sigset_t stopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : core::stopSignals()) sigaddset(&signals, signal);
  return signals;
}

}  // namespace

StopSignal::StopSignal() {
  const sigset_t signals = stopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

bool StopSignal::raised() {
  const sigset_t signals = stopSignals();
  const timespec at_once{0, 0};
  if (sigtimedwait(&signals, nullptr, &at_once) > 0) raised_ = true;
  return raised_;
}

}  // namespace cdiff::ros
