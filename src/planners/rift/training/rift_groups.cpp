// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/training/rift_groups.h"

#include "e2e_cdiff/core/random.h"
#include "learning/samples/sample_order.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {
namespace {

constexpr double kNeighborRadius = 60.0;     // [m]
constexpr std::size_t kProfileLength = 100;  // [m]

std::vector<traffic::Vehicle> neighborsOf(const traffic::TrafficSnapshot& snapshot,
                                          const traffic::Vehicle& own) {
  std::vector<traffic::Vehicle> neighbors;
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (other.id == own.id || traffic::onDifferentLevels(own, other)) continue;
    if ((other.state.position - own.state.position).norm() <= kNeighborRadius)
      neighbors.push_back(other);
  }
  return neighbors;
}

}  // namespace

std::vector<RiftMoment> riftMoments(const learning::Scene& scene, const PlutoScene& tracks,
                                    std::uint32_t number,
                                    const learning::SceneSampleOptions& options) {
  const core::RandomStream thinning(core::hashText(tracks.name()), "rift_standing");
  std::vector<RiftMoment> moments;
  for (std::size_t d = 0; d < tracks.drives().size(); ++d) {
    if (!options.wants(tracks.drives()[d].target_speed)) continue;
    for (const auto& [decision, arc_length] : tracks.drives()[d].places) {
      if ((decision + d) % options.stride() != 0) continue;
      const traffic::TrafficSnapshot& snapshot = scene.decisions[decision];
      const traffic::Vehicle* own = snapshot.find(scene.drives[d].vehicle_id);
      const core::RandomKey key{d, static_cast<std::uint32_t>(decision), 0};
      if (own->state.speed < learning::kStanding &&
          thinning.uniform(key, 0) >= options.standing_share)
        continue;
      moments.push_back(
          {{number, static_cast<std::uint32_t>(decision), static_cast<std::uint32_t>(d), 0},
           neighborsOf(snapshot, *own)});
    }
  }
  return moments;
}

RiftGroups::OfWorld& RiftGroups::ofWorld(const PlutoWorld& world) {
  std::unique_ptr<OfWorld>& known = worlds_[&world];
  if (!known) known = std::make_unique<OfWorld>(model_, world);
  return *known;
}

RiftGroup RiftGroups::of(const PlutoScene& scene, const RiftMoment& moment) {
  const PlutoWorld& world = scene.world();
  OfWorld& tools = ofWorld(world);
  const PlutoMoment view = scene.moment(moment.place.decision, moment.place.drive);
  RiftState state;
  state.lines = tools.builder.linesOf(view);
  state.pose = view.point().state.pose();
  state.elevations.clear();
  for (std::size_t i = 0; i <= kProfileLength; ++i)
    state.elevations.push_back(
        view.route->path().pointAt(view.arc_length + static_cast<double>(i)).z());
  state.speed = view.point().state.speed;
  state.size = view.vehicles->size(view.own);
  for (const traffic::Vehicle& other : moment.neighbors) {
    state.neighbors.push_back(
        {planning::forecastMotion(other, world.network, vehicle_, kRiftSteps), other.dimensions});
  }
  const PlutoOutput output = tools.network.forward(tools.builder.inputOf(view, state.lines));
  return {output.features, output.logits,
          evaluator_.returnsOf(state, output.candidates, tools.mask)};
}

}  // namespace cdiff::planners
