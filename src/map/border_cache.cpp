// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/border_cache.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <polyclipping/clipper.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "core/checked_cache.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::map {
namespace {

/// Part of the key: raise the number when the union of the same outlines becomes another.
constexpr const char* kUnionVersion = "e2e_cdiff union 1, Clipper " CLIPPER_VERSION;

template <class Value>
void addBytes(const Value& value, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void addPoints(const std::vector<Eigen::Vector2d>& points, std::string& bytes) {
  addBytes(static_cast<std::uint64_t>(points.size()), bytes);
  for (const Eigen::Vector2d& point : points) {
    addBytes(point.x(), bytes);
    addBytes(point.y(), bytes);
  }
}

/// All that the union depends on.
std::string keyOf(const std::vector<Strip>& strips, const std::vector<Ring>& polygons) {
  std::string key = kUnionVersion;
  addBytes(static_cast<std::uint64_t>(strips.size()), key);
  for (const Strip& strip : strips) {
    addBytes(strip.width, key);
    addPoints(strip.line, key);
  }
  for (const Ring& polygon : polygons) addPoints(polygon, key);
  return key;
}

/// Coordinates in millimeters, a space after each, a ring a line.
std::string textOf(const std::vector<Ring>& rings) {
  std::string text;
  for (const Ring& ring : rings) {
    for (const Eigen::Vector2d& point : ring) {
      text += std::to_string(std::llround(point.x() * kUnitsPerMeter)) + ' ';
      text += std::to_string(std::llround(point.y() * kUnitsPerMeter)) + ' ';
    }
    text += '\n';
  }
  return text;
}

/// Takes a coordinate [m] and the space after it.
double takeCoordinate(std::string_view& line) {
  std::int64_t units = 0;
  const auto read = std::from_chars(line.data(), line.data() + line.size(), units);
  const auto length = static_cast<std::size_t>(read.ptr - line.data());
  line.remove_prefix(std::min(length + 1, line.size()));
  return static_cast<double>(units) / kUnitsPerMeter;
}

/// Of a text that textOf() made.
std::vector<Ring> ringsOf(std::string_view text) {
  std::vector<Ring> rings;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1);
    std::string_view line = text.substr(0, end);
    Ring& ring = rings.emplace_back();
    while (!line.empty()) {
      const double x = takeCoordinate(line);
      ring.emplace_back(x, takeCoordinate(line));
    }
    text.remove_prefix(end + 1);
  }
  return rings;
}

/// Where the union is kept; nothing without a cache folder.
std::optional<std::filesystem::path> placeOf(const std::string& key) {
  try {
    return core::cacheFile("borders", key, ".txt");
  } catch (const core::InputError&) {
    return std::nullopt;
  }
}

void keep(const std::filesystem::path& file, const std::vector<Ring>& rings) {
  try {
    core::storeChecked(file, textOf(rings));
  } catch (const core::InputError&) {
    // A full or read-only disk costs the next process time and nothing else.
  }
}

}  // namespace

std::vector<Ring> keptUnion(const std::vector<Strip>& strips, const std::vector<Ring>& polygons) {
  if (strips.size() + polygons.size() < kLeastKeptOutlines) return uniteOutlines(strips, polygons);
  const auto file = placeOf(keyOf(strips, polygons));
  if (!file) return uniteOutlines(strips, polygons);
  if (const auto text = core::checkedContent(*file)) return ringsOf(*text);
  std::vector<Ring> rings = uniteOutlines(strips, polygons);
  keep(*file, rings);
  return rings;
}

}  // namespace cdiff::map
