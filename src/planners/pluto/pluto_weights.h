// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "planners/weight_files.h"

namespace cdiff::planners {

/// Sizes of the network of `pluto` and `rift` and of what it is given; they travel in the metadata
/// of the weight file.
struct PlutoArchitecture {
  std::int64_t width = 64;          ///< of a token, a multiple of 16 x heads
  std::int64_t heads = 4;           ///< of attention
  std::int64_t hidden = 256;        ///< of the feed-forward networks, a multiple of 16
  std::int64_t encoder_layers = 2;  ///< of the scene
  std::int64_t decoder_layers = 2;  ///< of the queries
  std::int64_t agents = 24;         ///< most vehicles that are tokens; the nearest are kept
  std::int64_t polygons = 60;       ///< most pieces of lanes that are tokens, likewise
  std::int64_t lines = 4;           ///< most reference lines
  double radius = 80.0;             ///< vehicles and lanes farther away get no token [m]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for sizes that do not fit each other.
  void validate() const;
};

inline constexpr std::int64_t kPlutoModes = 12;    ///< longitudinal modes of a reference line
inline constexpr std::int64_t kPlutoSteps = 80;    ///< of a trajectory
inline constexpr double kPlutoPeriod = 0.1;        ///< of trajectories and of the history [s]
inline constexpr std::int64_t kPlutoHistory = 20;  ///< differences between the last 21 decisions
inline constexpr std::int64_t kPlutoChannels = 6;  ///< x, y [m], cos, sin of heading, vx, vy [m/s]
inline constexpr std::int64_t kFreeChannels = 4;   ///< the first four of these
inline constexpr double kLineLength = 120.0;       ///< of a reference line, at most [m]
inline constexpr double kModeLength = 10.0;        ///< of a reference line for each mode [m]

inline constexpr std::int64_t kPlutoFrequencies = 16;  ///< of each number of a pose

/// Both planners have the same network.
inline constexpr WeightKind kPluto = {"pluto", "pluto.safetensors", "e2e_cdiff.pluto.1"};
inline constexpr WeightKind kRift = {"rift", "rift.safetensors", "e2e_cdiff.rift.1"};

using PlutoModel = NetworkWeights<PlutoArchitecture>;

/// Names and shapes of the weights. Of two dimensions and more: `NAME.weight` of layers and
/// `table.NAME`, rows that are learned as they are.
std::vector<inference::TensorShape> plutoTensors(const PlutoArchitecture& architecture);
/// Whether a tensor belongs to the score head, the part that RIFT trains.
bool ofScoreHead(const std::string& tensor);

inline PlutoModel readPlutoModel(const WeightKind& kind, const std::filesystem::path& folder) {
  return readNetwork<PlutoArchitecture>(kind, folder, plutoTensors);
}

}  // namespace cdiff::planners
