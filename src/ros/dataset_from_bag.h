// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Training samples from a recorded session: for every image of a driven vehicle what it then did,
/// in its own frame (SI units; rows as in traffic/rollout.h), and its route tokens.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "diffusion/architecture.h"
#include "learning/driving_sample.h"

namespace cdiff::ros {

struct DatasetOptions {
  diffusion::Architecture architecture;  ///< horizon, image size, route tokens
  double standing_share = 0.25;          ///< part kept of samples that stand all the time
  double offset_share = 0.2;             ///< of samples that move, the part displaced once more
  double offset_lateral = 0.75;          ///< largest displacement to the side [m]
  double offset_heading = 12.0;          ///< largest turn of a displaced vehicle [deg]
};

/// What is in a data set; sums, so that those of several bags add up.
struct DatasetStatistics {
  std::uint64_t images = 0;
  std::uint64_t samples = 0;
  std::map<std::string, std::uint64_t> dropped;       ///< images that gave no sample, by reason
  std::map<std::string, std::uint64_t> maneuvers;     ///< samples: straight, left, right, other
  std::map<std::string, std::uint64_t> stop_reasons;  ///< samples: none, light, leader, ...
  std::map<std::string, std::uint64_t>
      kinds;  ///< samples: standing, starting, stopping,
              ///< recovering, displaced, off_road, off_course, in_junction
  std::array<std::uint64_t, 8> speeds{};  ///< samples by speed, 2 m/s a bin, the last open
  double steer_sum = 0.0;                 ///< of mean |steer| of each sample
  std::uint64_t contacts = 0;             ///< of driven vehicles
  double seconds = 0.0;                   ///< simulated

  void add(const DatasetStatistics& other);
};

/// Samples of a bag, by tick and slot. An image gives one if its vehicle was driven, without noise,
/// contact or jump, from the tick before it to the end of the horizon. Throws InputError for a file
/// that is no bag, holds no session of ours, no images, images of another size, or decisions that
/// are not 0.1 s apart; the texts name the file.
std::vector<learning::DrivingSample> samplesFromBag(const std::filesystem::path& bag,
                                                    const DatasetOptions& options,
                                                    DatasetStatistics& statistics);

/// The schema that such samples fit.
learning::DrivingSchema schemaOf(const diffusion::Architecture& architecture);

}  // namespace cdiff::ros
