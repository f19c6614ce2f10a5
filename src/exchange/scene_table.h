// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "exchange/recorded_scene.h"

namespace cdiff::exchange {

/// A recorded scene as comma-separated values: a row per tick and vehicle, by tick, with time since
/// the scene's start [s], id, role, center of the box (x, y, z [m]), heading [rad], speed [m/s],
/// length, width and height [m], in the map frame.
std::string sceneTable(const RecordedScene& scene);

}  // namespace cdiff::exchange
