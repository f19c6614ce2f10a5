// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "rendering/road_scene.h"
#include "rendering/signal_heads.h"

namespace cdiff::rendering {

/// What a network looks like, with the buffers of drawing it. One per thread.
struct NetworkScene {
  explicit NetworkScene(const map::RoadNetwork& network) : road(network), signals(network) {}

  RoadScene road;
  SignalHeads signals;
};

}  // namespace cdiff::rendering
