// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/training/uniad_mini_trainer_network.h"

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {
namespace {

/// [N, width] for each of B samples: [B, N, width].
at::Tensor repeated(const at::Tensor& rows, std::int64_t samples) {
  return rows.unsqueeze(0).expand({samples, rows.size(0), rows.size(1)});
}

/// The ego's own place as shares of the BEV [B, 1, 2].
at::Tensor egoShares(const BevGrid& bev, const at::Tensor& like) {
  const Eigen::Vector2d share = bev.toShare(Eigen::Vector2d::Zero());
  return learning::toTensor({static_cast<float>(share.x()), static_cast<float>(share.y())},
                            {1, 1, 2}, like.device())
      .expand({like.size(0), 1, 2});
}

/// kBoxNumbers of centers and of what a layer answers, in SI units.
at::Tensor boxesOf(const BevGrid& bev, const at::Tensor& shares, const at::Tensor& box) {
  return at::cat(
      {metersOfShares(bev, shares), box.narrow(2, 2, 6), kVelocityUnit * box.narrow(2, 8, 2)}, 2);
}

/// Deviations of forecasts start at 2.7 m: at 1 m, far ways would outweigh all other losses.
void widenForecasts(std::int64_t layers, learning::ParameterSet& parameters) {
  const at::NoGradGuard no_gradient;
  for (std::int64_t i = 0; i < layers; ++i) {
    at::Tensor bias = parameters("motion." + std::to_string(i) + ".offset.out.bias");
    bias.reshape({kEgoWaypoints, kGaussianNumbers}).narrow(1, 2, 2).fill_(1.0);
  }
}

void loadPart(const WeightTensors& weights, const std::string& source,
              learning::ParameterSet& parameters) {
  WeightTensors part;
  for (const std::string& name : parameters.names()) {
    const auto found = weights.find(name);
    if (found != weights.end()) part.insert(*found);
  }
  parameters.load(part, source);
}

}  // namespace

UniadMiniNet::UniadMiniNet(const UniadMiniArchitecture& architecture, std::uint64_t seed)
    : architecture_(architecture),
      bev_parameters_(core::RandomStream(seed, "uniad_mini bev start")),
      track_parameters_(core::RandomStream(seed, "uniad_mini track start")),
      plan_parameters_(core::RandomStream(seed, "uniad_mini plan start")),
      bev_layers_(bev_parameters_, architecture.ego),
      tracks_(track_parameters_, architecture.ego),
      plans_(plan_parameters_, architecture.ego),
      bev_(bev_layers_) {
  const std::int64_t heads = architecture.ego.heads;
  declareCameraEgo(uniadBevTensors(architecture), heads, bev_parameters_);
  declareCameraEgo(uniadTrackTensors(architecture), heads, track_parameters_);
  declareCameraEgo(uniadPlanTensors(architecture), heads, plan_parameters_);
  widenForecasts(architecture.motion_layers, plan_parameters_);
  setAnchors(clusterAnchors({}));
}

void UniadMiniNet::setAnchors(const std::array<MotionAnchors, kMotionGroups>& anchors) {
  const at::Device device = plan_parameters_.tensors().front().device();
  anchors_ = learning::toTensor(toTensor(anchors).values,
                                {kMotionGroups, kMotionModes, kEgoWaypoints, 2}, device);
}

WeightTensors UniadMiniNet::values() const {
  WeightTensors all = bev_parameters_.values();
  for (const auto& part : {track_parameters_.values(), plan_parameters_.values()})
    all.insert(part.begin(), part.end());
  all[kAnchorTable] = {{kMotionGroups * kMotionModes, 2 * kEgoWaypoints},
                       learning::toVector(anchors_.to(at::kCPU).contiguous())};
  return all;
}

void UniadMiniNet::load(const WeightTensors& weights, const std::string& source) {
  loadPart(weights, source, bev_parameters_);
  loadPart(weights, source, track_parameters_);
  loadPart(weights, source, plan_parameters_);
  const auto anchors = weights.find(kAnchorTable);
  if (anchors == weights.end())
    throw core::InputError(source + ": there is no tensor '" + kAnchorTable + "'");
  setAnchors(toAnchors(anchors->second));
}

void UniadMiniNet::moveTo(const at::Device& device) {
  bev_parameters_.moveTo(device);
  track_parameters_.moveTo(device);
  plan_parameters_.moveTo(device);
  anchors_ = anchors_.to(device);
}

TrackAnswer UniadMiniNet::seeTracks(const at::Tensor& bev, std::int64_t samples,
                                    const TrackStart& start) const {
  const BevGrid& grid = architecture_.ego.bev;
  const std::int64_t slots = architecture_.tracks;
  at::Tensor x =
      repeated(at::cat({tracks_.table("track.content"), tracks_.table("ego.content")}, 0), samples);
  at::Tensor reference = repeated(tracks_.table("track.reference"), samples);
  if (start.held.defined()) {
    const at::Tensor held = start.held.narrow(1, 0, slots);
    x = start.held * start.content + (1.0 - start.held) * x;
    reference = held * start.reference + (1.0 - held) * reference;
  }
  TrackAnswer answer;
  const at::Tensor ego = egoShares(grid, x);
  answer.centers = at::cat({at::sigmoid(reference).detach(), ego}, 1);
  const at::Tensor position = place(answer.centers);
  for (std::int64_t i = 0; i < architecture_.decoder_layers; ++i) {
    const std::string name = "track." + std::to_string(i);
    x = tracks_.queryLayer(name, x, position, cellsOfShares(grid, answer.centers), bev);
    answer.features = tracks_.norm(name + ".norm", x);
    const at::Tensor boxes = tracks_.mlp(name + ".box", answer.features);
    const at::Tensor box = boxes.narrow(1, 0, slots);
    reference = reference + box.narrow(2, 0, 2);
    const at::Tensor shares = at::sigmoid(reference);
    answer.logits.push_back(tracks_.linear(name + ".class", answer.features.narrow(1, 0, slots)));
    answer.boxes.push_back(boxesOf(grid, shares, box));
    answer.ego_velocities.push_back(kVelocityUnit * boxes.select(1, slots).narrow(1, 8, 2));
    answer.centers = at::cat({shares.detach(), ego}, 1);
    reference = reference.detach();
  }
  answer.content = updated(answer.features, position);
  return answer;
}

at::Tensor UniadMiniNet::updated(const at::Tensor& features, const at::Tensor& position) const {
  const at::Tensor y = features + tracks_.attention("track.update", features, position, {});
  return y + tracks_.mix("track.update.mix", y);
}

MapAnswer UniadMiniNet::seeMap(const at::Tensor& bev, std::int64_t samples) const {
  const BevGrid& grid = architecture_.ego.bev;
  const auto lines = [&](const at::Tensor& reference) {
    return at::sigmoid(reference).reshape({samples, architecture_.map_lines, kMapPoints, 2});
  };
  MapAnswer answer;
  at::Tensor x = repeated(tracks_.table("map.content"), samples);
  at::Tensor reference = repeated(tracks_.table("map.reference"), samples);
  for (std::int64_t i = 0; i < architecture_.decoder_layers; ++i) {
    const std::string name = "map." + std::to_string(i);
    const at::Tensor middles = lines(reference).detach().mean(2);
    x = tracks_.queryLayer(name, x, tracks_.table("map.position"), cellsOfShares(grid, middles),
                           bev);
    answer.tokens = tracks_.norm(name + ".norm", x);
    reference = reference + tracks_.mlp(name + ".points", answer.tokens);
    answer.logits.push_back(tracks_.linear(name + ".class", answer.tokens));
    answer.lines.push_back(lines(reference));
    reference = reference.detach();
  }
  return answer;
}

}  // namespace cdiff::planners
