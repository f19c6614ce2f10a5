// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "page/page_parts.h"
#include "page/pictures/map_canvas.h"
#include "record/logs/driving_log.h"

namespace cdiff::page {

// What the report's player and the live page share: elements that assets/player.js fills, and a
// frame as the numbers that it draws.

extern const core::Asset kPlayerScript;
extern const core::Asset kLiveScript;  ///< of the live page, after it
extern const core::Asset kLiveStyle;

/// CSS classes of vehicles, by the number that a frame has for them: ego, background, then CBVs by
/// order of selection, the same again from the sixth on.
const std::vector<std::string>& vehicleStyles();
/// The number of the class of the CBV that was the n-th to be selected, from 0.
std::size_t cbvStyleNumber(std::size_t n);

/// The front view of the CBV in a slot.
Markup sightFigure(int slot);
/// Speed, commands, gap and 2D-TTC of ego and CBVs at the time that is shown.
Markup momentTable();
Markup pageButton(const char* id, const std::string& text,
                  const std::vector<core::Attribute>& more = {});
/// A choice of (value, text), with one of the values selected.
Markup pageChoice(const std::string& id, const std::vector<std::pair<std::string, std::string>>& of,
                  const std::string& selected = "");
Markup zoomButtons();
/// Whether the picture stays on the ego.
Markup followBox(bool checked);

/// `value` to the nearest whole number; 0 where there is none.
long roundedNumber(double value);
/// Six whole numbers per vehicle of the picture, the ego last: index, number of its style, x and y
/// [0.1 pixel], heading clockwise [deg], speed [0.1 m/s]. `cbv_styles` is by index.
nlohmann::ordered_json frameNumbers(const record::TimelineFrame& frame, const MapCanvas& canvas,
                                    const std::vector<std::size_t>& cbv_styles);
/// Seven whole numbers per driven vehicle: index, slot (-1: the ego), throttle, brake, steer [%],
/// gap [cm] and 2D-TTC [0.01 s], both negative where not defined.
nlohmann::ordered_json momentNumbers(const record::TimelineFrame& frame);
/// The script element's text as it is in the page, for a Content-Security-Policy: 'sha256-...'.
std::string scriptHash(const core::Asset& script);

}  // namespace cdiff::page
