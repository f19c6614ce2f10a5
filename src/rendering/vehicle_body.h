// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "rendering/canvas.h"
#include "rendering/view.h"

namespace cdiff::rendering {

// Other vehicles as shaded boxes: body, cabin, wheels, tail lights that tell whether it brakes,
// headlights, and a shadow below.

/// Whether the brake lights are on: it slows down by more than 0.5 m/s^2, brakes by more than 0.1,
/// or stands (below 0.1 m/s).
bool brakeLightsOn(const traffic::Vehicle& vehicle);

/// Color of the paint, by a hash of the id.
Color bodyColor(const std::string& id);

void drawVehicle(const traffic::Vehicle& vehicle, const View& view, Canvas& canvas);

}  // namespace cdiff::rendering
