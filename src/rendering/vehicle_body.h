// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <string>
#include <vector>

#include "rendering/canvas.h"
#include "rendering/road_scene.h"

namespace cdiff::rendering {

// Other vehicles as shaded boxes: body, cabin, wheels, tail lights that show whether it brakes,
// headlights, and a shadow below. Pedestrians and small objects stand upright and have no lights.

/// Whether the brake lights are on: it slows down by more than 0.5 m/s^2, brakes by more than 0.1,
/// or stands (below 0.1 m/s).
bool brakeLightsOn(const traffic::Vehicle& vehicle);

/// Color of the paint.
Color bodyColor(const traffic::Vehicle& vehicle, BodyColors colors);

/// A face of a vehicle, counter-clockwise seen from outside (map frame [m]).
struct BodyFace {
  std::array<Eigen::Vector3d, 8> corners;
  int count = 0;
  Paint paint;
};

/// A vehicle's faces in the order in which they are drawn.
using VehicleBody = std::vector<BodyFace>;

/// The same in every view. `instance`: its number in the label of its pixels, from 1 on.
VehicleBody bodyOf(const traffic::Vehicle& vehicle, std::uint16_t instance, BodyColors colors);

/// A vehicle that a camera may see: the ball around it and its faces.
struct VisibleVehicle {
  Bound bound;
  VehicleBody body;
};

/// Draws the faces that are turned toward the eye.
void drawBody(const VehicleBody& body, const View& view, Canvas& canvas);

}  // namespace cdiff::rendering
