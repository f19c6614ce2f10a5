// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Takes the place of one call of libsumo for the tests (LD_PRELOAD): it crashes in the middle of a
/// session.
#include <libsumo/Vehicle.h>

#include <csignal>

void libsumo::Vehicle::setSpeed(const std::string& /*id*/, double /*speed*/) {
  constexpr int kCallsBefore = 5;
  static int calls = 0;
  if (++calls > kCallsBefore) std::raise(SIGSEGV);
}
