// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "learning/samples/dataset.h"
#include "planners/pluto/pluto_network.h"
#include "planners/pluto/training/pluto_scenes.h"

namespace cdiff::planners {

/// Which moments of a scene become samples.
struct PlutoSampleOptions : learning::SceneSampleOptions {
  double least_future = 3.0;  ///< of undisturbed driving [s]

  void describe(core::OptionsVisitor& visitor);
};

/// A moment to learn from: where it is in the scenes.
struct PlutoPlace {
  std::uint32_t scene = 0;
  std::uint32_t decision = 0;
  std::uint32_t drive = 0;
  std::uint32_t steps = 0;  ///< of the future that count, at most kPlutoSteps
};

/// Of a scene: every period a moment of each driven vehicle that drives on for at least
/// `least_future`. The future ends before a contact, a jump, and noise that lasts longer than 1 s
/// (a forced stop); in the first second there is none at all.
std::vector<PlutoPlace> plutoPlaces(const PlutoScene& scene, std::uint32_t number,
                                    const PlutoSampleOptions& options);

/// Where a vehicle then was, in the frame of its pose at the moment. Rows from `steps` on are 0.
struct PlutoTarget {
  PlutoTrajectory future = PlutoTrajectory::Zero();
  std::array<double, kPlutoSteps> elevations{};  ///< by row, z of the road [m]
  std::int64_t steps = 0;
  std::size_t line = 0;  ///< reference line nearest to the end
  std::size_t mode = 0;  ///< of it: 10 m of arc length each, up to where the end lies
};

/// `frame`: pose that the network is to plan from, the vehicle's own or a disturbed one, from which
/// the future leads back to the recorded way: the offset e over the distance s driven is the cubic
/// with e and de/ds of the frame at 0 and none of both at L = 2 s x speed, 10 to 20 m. Where the
/// future is cut, the end is where its last speed leads along the line.
PlutoTarget plutoTarget(const PlutoScene& scene, const PlutoPlace& place,
                        const geometry::Pose2d& frame, const std::vector<ReferenceLine>& lines);

/// Where another vehicle then was, in the frame of its own pose at the moment, as PlutoTrajectory,
/// and which rows count.
struct AgentFuture {
  PlutoTrajectory future = PlutoTrajectory::Zero();
  std::array<bool, kPlutoSteps> known{};
};
AgentFuture agentFuture(const PlutoScene& scene, std::size_t decision, std::uint32_t vehicle);

// Places as stored samples and back: samples name their scene, and scenes stay in memory.

learning::SampleSchema plutoFields();
learning::Sample toSample(const PlutoPlace& place, const PlutoScene& scene);
PlutoPlace toPlutoPlace(const learning::Sample& sample);

}  // namespace cdiff::planners
