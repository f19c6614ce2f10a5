// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "learning/samples/dataset.h"
#include "learning/samples/scene.h"
#include "planners/plant/plant_network.h"

namespace cdiff::planners {

/// A moment of a driven vehicle that PlanT learns from (body frame at planning time, SI units).
struct PlantExample {
  PlantInput input;       ///< without ids
  PlantWaypoints driven;  ///< where the vehicle was 0.5, 1.0, 1.5 and 2.0 s later [m]
  /// Bins of each vehicle token's attributes 0.5 s later, in the frame at planning time; kNoBin in
  /// all where the vehicle was gone.
  std::vector<std::array<std::uint8_t, kPlantAttributes>> next;
  double speed = 0.0;  ///< own, which the network is not given [m/s]
  std::uint64_t session = 0;
};

inline constexpr std::uint8_t kNoBin = 255;

/// Bins of a token of attributes (kPlantBins); values beyond the ends are in the outermost bins.
std::array<std::uint8_t, kPlantAttributes> plantBins(const PlantToken& token);

/// Makes PlanT's samples of scenes: every period a moment of each driven vehicle, if for the 2 s to
/// come it drives by itself, without noise, fault, contact or jump. The waypoints are where it then
/// was: after noise, where the expert steered back to.
class PlantSampler {
 public:
  PlantSampler(const PlantArchitecture& architecture, const learning::SceneSampleOptions& options)
      : architecture_(architecture), options_(options) {}

  std::vector<PlantExample> examplesOf(const learning::Scene& scene);

 private:
  const map::RoadNetwork& networkOf(const learning::Scene& scene);

  PlantArchitecture architecture_;
  learning::SceneSampleOptions options_;
  std::map<std::string, std::unique_ptr<map::RoadNetwork>> networks_;  ///< by SHA-256 of the text
};

// Examples as stored samples and back.

learning::SampleSchema plantFields();
learning::Sample toSample(const PlantExample& example);
PlantExample toExample(const learning::Sample& sample);

}  // namespace cdiff::planners
