// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "planners/pluto/training/pluto_samples.h"
#include "planners/rift/rift_evaluator.h"

namespace cdiff::planners {

/// A moment of a driven vehicle with the vehicles around it, as far as their forecasts need them.
struct RiftMoment {
  PlutoPlace place;
  std::vector<traffic::Vehicle> neighbors;  ///< within 60 m on its level, in the snapshot's order
};

/// Every period a moment of each driven vehicle; `scene` is what `tracks` was made of, `number` its
/// place in the list of scenes.
std::vector<RiftMoment> riftMoments(const learning::Scene& scene, const PlutoScene& tracks,
                                    std::uint32_t number,
                                    const learning::SceneSampleOptions& options);

/// The candidates of a state: what the score head reads of each, Pluto's logits, simulated returns.
struct RiftGroup {
  std::vector<float> features;  ///< [candidates, width]
  std::vector<float> logits;    ///< by candidate
  std::vector<double> returns;  ///< by candidate
};

/// Makes groups of moments with Pluto's network, whose layers before the score head stay as they
/// are.
class RiftGroups {
 public:
  /// `tracker`: that candidates are driven with, which should be the one that will drive.
  RiftGroups(const PlutoModel& model, const dynamics::BicycleModelOptions& vehicle,
             const planning::PlanTrackerOptions& tracker = {})
      : model_(model), vehicle_(vehicle), evaluator_(vehicle, tracker) {}

  RiftGroup of(const PlutoScene& scene, const RiftMoment& moment);

 private:
  /// Kept for each road network: scene builder, network with its lane tokens, drivable area.
  struct OfWorld {
    PlutoSceneBuilder builder;
    PlutoNetwork network;
    DrivableMask mask;

    OfWorld(const PlutoModel& model, const PlutoWorld& world)
        : builder(model.architecture, world.network),
          network(model, builder.pieces().all()),
          mask(world.area) {}
  };
  OfWorld& ofWorld(const PlutoWorld& world);

  PlutoModel model_;
  dynamics::BicycleModelOptions vehicle_;
  RiftEvaluator evaluator_;
  std::map<const PlutoWorld*, std::unique_ptr<OfWorld>> worlds_;
};

}  // namespace cdiff::planners
