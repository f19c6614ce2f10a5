// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// SIGINT, SIGTERM and SIGHUP without a handler: they are blocked from here on, in every thread
/// made later, and asked for when it suits. So a session can end in order, whatever it is doing.
#pragma once

namespace cdiff::ros {

class StopSignal {
 public:
  /// Make it before any other thread exists, hence before ros::init.
  StopSignal();
  /// Whether one of them has come, now or before.
  bool raised();

 private:
  bool raised_ = false;
};

}  // namespace cdiff::ros
