// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "exchange/recorded_scene.h"

namespace cdiff::exchange {

// OpenSCENARIO's reference point of a vehicle is the middle of its rear axle on the ground. Ours is
// the center of the box. The rear axle lies this share of the length behind the center, as in the
// bicycle model of a car of 4.5 m; the front axle lies as far ahead.
inline constexpr double kAxleShare = 0.315;

/// Distance from the rear axle forward to the center of the box [m].
double rearAxleToCenter(const traffic::VehicleDimensions& dimensions);

/// Who drives the ego of an exported scenario.
enum class ExportedEgo {
  kTrajectory,  ///< it follows its recorded course
  kExternal     ///< a controller that is not in the file drives it from its first place
};

/// Text of an OpenSCENARIO 1.2 file of a recorded scene: each vehicle follows the course of its
/// rear axle as a polyline with absolute times, from 0 s at the scene's start. A vehicle that
/// appears later is added then, one that leaves is deleted. A vehicle with a single state is left
/// out. World positions are in the map frame, which is also that of the OpenDRIVE file
/// `network_file`. The same scene gives the same bytes.
std::string openScenarioText(const RecordedScene& scene, const std::string& network_file,
                             ExportedEgo ego);

}  // namespace cdiff::exchange
