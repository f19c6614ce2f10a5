// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "inference/instruction_set.h"
#include "inference/transformer_layers.h"
#include "planners/plant/plant_tokens.h"
#include "planners/weight_files.h"

namespace cdiff::planners {

/// Places of the driven vehicle 0.5, 1.0, 1.5 and 2.0 s ahead, in its body frame [m].
using PlantWaypoints = std::array<Eigen::Vector2d, kPlantWaypoints>;

/// What PlanT plans for one vehicle at one decision.
struct PlantOutput {
  PlantWaypoints waypoints;
  /// By vehicle token: share of the last layer's attention of the CLS token, mean over heads. CLS
  /// and route tokens have the rest up to 1.
  std::vector<float> attention;
};

inline constexpr WeightKind kPlant = {"plant", "plant.safetensors", "e2e_cdiff.plant.1"};
inline constexpr double kPlantStepScale = 5.0;  ///< what an output of 1 stands for [m]
inline constexpr std::int64_t kPlantSummary = 64;
inline constexpr std::int64_t kPlantStates = kPlantSummary + 1;

/// Bins of the auxiliary task by attribute, in the order of PlantToken: x, y over +-30 m, heading
/// over +-pi, speed over 0 to 60 km/h, width and length over 0 to 30 m.
inline constexpr std::array<std::int64_t, kPlantAttributes> kPlantBins = {128, 128, 32,
                                                                          16,  128, 128};
inline constexpr std::array<const char*, kPlantAttributes> kPlantAttributeNames = {
    "x", "y", "heading", "speed", "width", "length"};

/// Names and shapes of the weights.
std::vector<inference::TensorShape> plantTensors(const PlantArchitecture& architecture);

using PlantModel = NetworkWeights<PlantArchitecture>;
inline PlantModel readPlantModel(const std::filesystem::path& folder) {
  return readNetwork<PlantArchitecture>(kPlant, folder, plantTensors);
}

/// PlanT (Renz et al. 2022, at reduced width; docs/plant.md): tokens of vehicles and route through
/// a transformer's encoder; its CLS token, with the light, is the state of a GRU that steps from
/// waypoint to waypoint. Several moments at once; each has the same output to the last bit,
/// whatever the others are.
class PlantNetwork {
 public:
  explicit PlantNetwork(const PlantModel& model,
                        inference::InstructionSet set = inference::bestInstructionSet());

  std::vector<PlantOutput> forward(const std::vector<PlantInput>& inputs);

 private:
  void embed(const std::vector<PlantInput>& inputs);
  void decode(const std::vector<PlantInput>& inputs, std::vector<PlantOutput>& outputs);

  PlantArchitecture architecture_;
  inference::Linear token_;
  std::vector<float> cls_;  ///< [width], as are the two below
  std::vector<float> vehicle_type_;
  std::vector<float> route_type_;
  inference::LayerNorm norm_;
  std::vector<inference::TransformerLayer> layers_;
  inference::Linear summary_;
  inference::GruCell gru_;
  inference::Linear step_;
  // Memory of a call.
  std::vector<std::int64_t> begins_;
  inference::Rows attributes_;
  inference::Rows tokens_;
  inference::Rows types_;
  inference::Rows state_;
  inference::Rows gru_input_;
  inference::Rows change_;
  inference::TransformerMemory memory_;
};

}  // namespace cdiff::planners
