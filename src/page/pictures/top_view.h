// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/markup.h"
#include "page/pictures/map_canvas.h"
#include "record/session_result.h"

namespace cdiff::page {

// The session from above as one SVG element: drivable area, lanes, ego route, conflicts, trails,
// vehicles at the final tick. Names in it are cut to 40 characters; tool tips hold them whole.

core::Markup topViewSvg(const record::SessionResult& result, const MapCanvas& canvas);

/// The same of a session that begins: drivable area, lanes, ego route, and a group for each kind of
/// thing that the live page draws.
core::Markup liveTopViewSvg(const session::SessionSetup& setup, const MapCanvas& canvas);

/// Drivable area and lanes alone.
core::Markup roadSvg(const session::SessionSetup& setup, const MapCanvas& canvas);

/// A vehicle's box, `magnification` times as large as it is, of a CSS class.
core::Markup vehicleSvg(const record::TimelineVehicle& vehicle, const geometry::Pose2d& pose,
                        const MapCanvas& canvas, const std::string& style,
                        double magnification = 1.0);

/// A bar of a round length and the direction of north, in the lower corners and at the top right.
core::Markup scaleBarSvg(const MapCanvas& canvas);

/// Its legend, as HTML, with the lines of attentionSvg and what perceivedSvg draws where `timeline`
/// has any.
core::Markup topViewLegend(const MapCanvas& canvas, const record::Timeline* timeline = nullptr);

/// Factor by which vehicles are drawn larger than they are, so that they can be seen; 1 when the
/// scale allows.
double vehicleMagnification(const MapCanvas& canvas);

/// CSS class of a vehicle in pictures and charts: "ego", "bg", or "cbv c0" to "cbv c4" by order of
/// selection.
std::string styleOf(traffic::VehicleRole role, const std::string& id, const record::CbvLog& cbv);

}  // namespace cdiff::page
