// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Colours of the picture, packed as 0x00bbggrr.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cdiff::rendering {

using Color = std::uint32_t;

constexpr Color rgb(unsigned red, unsigned green, unsigned blue) {
  return red | (green << 8) | (blue << 16);
}

/// `first` where share is 0, `second` where it is 1, rounded per channel.
inline Color mix(Color first, Color second, double share) {
  Color mixed = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    const double from = (first >> shift) & 0xffu;
    const double to = (second >> shift) & 0xffu;
    mixed |= static_cast<Color>(std::floor(from + (to - from) * share + 0.5)) << shift;
  }
  return mixed;
}

/// Every channel times a factor, at most 255.
inline Color shade(Color color, double factor) {
  Color shaded = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    const double value = ((color >> shift) & 0xffu) * factor + 0.5;
    shaded |= static_cast<Color>(std::min(255.0, std::floor(value))) << shift;
  }
  return shaded;
}

constexpr Color kSkyTop = rgb(92, 142, 204);
constexpr Color kSkyHorizon = rgb(205, 221, 235);
constexpr Color kGrassHorizon = rgb(142, 162, 120);
constexpr Color kGrassNear = rgb(84, 120, 58);
constexpr Color kAsphalt = rgb(84, 86, 90);
constexpr Color kPavement = rgb(150, 146, 138);
constexpr Color kUnderside = rgb(58, 60, 64);
constexpr Color kWhitePaint = rgb(232, 232, 228);
constexpr Color kYellowPaint = rgb(228, 184, 44);
constexpr Color kConcrete = rgb(166, 166, 160);

}  // namespace cdiff::rendering
