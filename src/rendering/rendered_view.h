// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::rendering {

/// What a pixel shows. Shadows are what they fall on: road.
enum class SceneClass : std::uint8_t {
  kSky,
  kTerrain,    ///< grass and slopes
  kStructure,  ///< sides and undersides of bridges
  kPavement,
  kRoad,
  kMarking,  ///< lane markings and stop lines
  kSignal,   ///< traffic lights with their masts
  kVehicle
};

/// Whether labels are rendered beside the picture.
enum class Labels { kNone, kClassesAndInstances };

/// What the paint of vehicles says.
enum class BodyColors {
  kById,   ///< nothing: a hash of the id chooses it, as in every image that a planner gets
  kByRole  ///< who it is, as in every picture for people: ego red, CBVs purple, the others blue
};

/// What one camera saw, and where asked for what each pixel shows (row-major from the top left, as
/// many as pixels; empty where not asked for).
struct RenderedView {
  traffic::CameraImage image;
  std::vector<SceneClass> classes;
  std::vector<std::uint16_t> instances;  ///< 0: no vehicle; n: the snapshot's vehicles[n - 1]
};

/// Pixels of each of the snapshot's vehicles in the image that shows most of it; `vehicles`: how
/// many the snapshot has. Of views with labels.
std::vector<int> mostPixels(const std::vector<RenderedView>& views, std::size_t vehicles);

}  // namespace cdiff::rendering
