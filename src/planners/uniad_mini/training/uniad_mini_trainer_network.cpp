// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/training/uniad_mini_trainer_network.h"

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/uniad_mini/neighbor_cells.h"

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

namespace {

/// Unit vectors (cosine, sine) of boxes' headings [B, A, 2].
at::Tensor headingsOf(const at::Tensor& boxes) {
  const at::Tensor heading = at::stack({boxes.select(2, 7), boxes.select(2, 6)}, 2);
  return heading / at::sqrt(heading.square().sum(2, true) + 1e-6);
}

/// MotionGroup of boxes [B, A].
at::Tensor groupsOf(const at::Tensor& boxes) {
  std::vector<std::int64_t> groups;
  const std::vector<float> numbers = learning::toVector(boxes.to(at::kCPU).contiguous());
  for (std::size_t i = 0; i < numbers.size(); i += kBoxNumbers)
    groups.push_back(
        static_cast<std::int64_t>(motionGroupOf(std::exp(static_cast<double>(numbers[i + 3])),
                                                std::exp(static_cast<double>(numbers[i + 2])))));
  return learning::toIndices(groups, {boxes.size(0), boxes.size(1)}, boxes.device());
}

}  // namespace

at::Tensor UniadMiniNet::readBev(const std::string& name, const at::Tensor& x,
                                 const at::Tensor& shares, const at::Tensor& bev) const {
  const CameraEgoSizes& sizes = architecture_.ego;
  BatchReading reading{querySizes(sizes), sizes.bev.grid(), 1, {}};
  const at::Tensor cells = cellsOfShares(sizes.bev, shares.detach()).to(at::kCPU).contiguous();
  for (std::int64_t b = 0; b < x.size(0); ++b)
    reading.plans.push_back(std::make_shared<inference::SamplingPlan>(inference::planAround(
        cells.data_ptr<float>() + b * x.size(1) * 2, x.size(1), kQueryPoints)));
  const at::Tensor asking = plans_.norm(name + ".norm", x).flatten(0, 1);
  return plans_.deformable(name, asking, bev, reading).reshape(x.sizes());
}

std::pair<at::Tensor, at::Tensor> UniadMiniNet::startModes(const TrackAnswer& tracks) const {
  const at::Tensor boxes = tracks.boxes.back().detach();
  const std::int64_t samples = boxes.size(0), rows = architecture_.rows();
  const at::Tensor ego_group =
      learning::toIndices(std::vector<std::int64_t>(static_cast<std::size_t>(samples), 0),
                          {samples, 1}, boxes.device());
  const at::Tensor groups = at::cat({groupsOf(boxes), ego_group}, 1).reshape({-1});
  const at::Tensor own =
      anchors_.index_select(0, groups).reshape({samples, rows, kMotionModes, kEgoWaypoints, 2});
  const at::Tensor ahead =
      learning::toTensor({1.0F, 0.0F}, {1, 1, 2}, boxes.device()).expand({samples, 1, 2});
  const at::Tensor forward =
      at::cat({headingsOf(boxes), ahead}, 1).reshape({samples, rows, 1, 1, 2});
  const at::Tensor left = at::stack({-forward.select(4, 1), forward.select(4, 0)}, 4);
  const at::Tensor turned = forward * own.narrow(4, 0, 1) + left * own.narrow(4, 1, 1);
  const auto end = [](const at::Tensor& ways) { return ways.select(3, kEgoWaypoints - 1); };
  const at::Tensor centers = metersOfShares(architecture_.ego.bev, tracks.centers).unsqueeze(2);
  const at::Tensor shares = sharesOfMeters(architecture_.ego.bev, centers + end(turned));
  const at::Tensor numbers =
      at::cat({end(own) / kAnchorUnit, end(turned) / kAnchorUnit, 2.0 * shares - 1.0}, 3);
  return {turned, plans_.mlp("motion.anchor", numbers) + plans_.table("mode") +
                      tracks.features.unsqueeze(2)};
}

at::Tensor UniadMiniNet::fuse(const std::string& name, const at::Tensor& x,
                              const at::Tensor& shares, const MotionSurroundings& around) const {
  const at::Tensor of_agents = x + plans_.attention(name + ".agents", x, {}, around.tracks);
  const at::Tensor of_map = x + plans_.attention(name + ".map", x, {}, around.map);
  const at::Tensor of_bev = x + readBev(name + ".bev", x, shares, around.bev);
  return plans_.mlp(name + ".fuse", at::cat({of_agents, of_map, of_bev, around.own}, 2));
}

MotionAnswer UniadMiniNet::forecast(const at::Tensor& bev, const TrackAnswer& tracks,
                                    const MapAnswer& map) const {
  const BevGrid& grid = architecture_.ego.bev;
  const std::int64_t samples = tracks.features.size(0), rows = architecture_.rows(),
                     width = architecture_.ego.width;
  const at::Tensor centers = metersOfShares(grid, tracks.centers).unsqueeze(2);
  const auto [turned, start] = startModes(tracks);
  at::Tensor x = start.reshape({samples, rows * kMotionModes, width});
  const MotionSurroundings around = {
      bev, tracks.features + place(tracks.centers), map.tokens,
      tracks.features.unsqueeze(2).expand({samples, rows, kMotionModes, width}).reshape(x.sizes())};
  at::Tensor ways = turned;
  MotionAnswer answer;
  for (std::int64_t i = 0; i < architecture_.motion_layers; ++i) {
    const std::string name = "motion." + std::to_string(i);
    const at::Tensor ends = centers + ways.select(3, kEgoWaypoints - 1);
    x = fuse(name, x, sharesOfMeters(grid, ends).reshape({samples, -1, 2}), around);
    const at::Tensor normed = plans_.norm(name + ".norm", x);
    const at::Tensor numbers =
        plans_.mlp(name + ".offset", normed)
            .reshape({samples, rows, kMotionModes, kEgoWaypoints, kGaussianNumbers});
    ways = turned + at::cumsum(kOffsetUnit * numbers.narrow(4, 0, 2), 3);
    answer.ways.push_back(ways);
    answer.spreads.push_back(numbers.narrow(4, 2, 3));
    answer.logits.push_back(
        plans_.mlp(name + ".score", normed).reshape({samples, rows, kMotionModes}));
    answer.modes = normed.reshape({samples, rows, kMotionModes, width});
  }
  return answer;
}

namespace {

/// [B, cells, channels] of the halved map -> of the fine one.
at::Tensor stretched(const inference::MapGrid& fine, const at::Tensor& x) {
  std::vector<std::int64_t> index;
  for (std::int64_t cell = 0; cell < fine.cells(); ++cell) index.push_back(halvedCell(fine, cell));
  return x.index_select(1, learning::toIndices(index, {fine.cells()}, x.device()));
}

/// [B, cells, channels] -> of the halved map.
at::Tensor halved(const inference::MapGrid& fine, const at::Tensor& x) {
  const std::int64_t channels = x.size(2);
  return x.reshape({x.size(0), fine.height / 2, 2, fine.width / 2, 2, channels})
      .mean({2, 4})
      .reshape({x.size(0), fine.cells() / 4, channels});
}

}  // namespace

at::Tensor neighborsOf(const inference::MapGrid& grid, const at::Tensor& x) {
  std::vector<std::int64_t> index = neighborCells(grid);
  for (std::int64_t& cell : index) cell = cell < 0 ? grid.cells() : cell;
  const at::Tensor padded = at::cat({x, at::zeros_like(x.narrow(1, 0, 1))}, 1);
  const auto count = static_cast<std::int64_t>(index.size());
  return padded.index_select(1, learning::toIndices(index, {count}, x.device()))
      .reshape({x.size(0), grid.cells(), kTaps * x.size(2)});
}

at::Tensor UniadMiniNet::agentShares(const TrackAnswer& tracks, const MotionAnswer& motion,
                                     std::int64_t step) const {
  const std::int64_t slots = architecture_.tracks;
  const at::Tensor centers = tracks.centers.narrow(1, 0, slots);
  if (step == 0) return centers;
  const at::Tensor ways = motion.ways.back().narrow(1, 0, slots).select(3, step - 1).detach();
  const at::Tensor best =
      motion.logits.back().narrow(1, 0, slots).argmax(2, true).unsqueeze(3).expand({-1, -1, 1, 2});
  const at::Tensor meters = metersOfShares(architecture_.ego.bev, centers);
  return sharesOfMeters(architecture_.ego.bev, meters + ways.gather(2, best).squeeze(2));
}

at::Tensor UniadMiniNet::nextState(const std::string& name, const at::Tensor& state,
                                   const at::Tensor& placed, const at::Tensor& sure) const {
  const BevGrid& bev = architecture_.ego.bev;
  const inference::MapGrid half = {bev.rows / 2, bev.columns / 2};
  const double mask_logit = std::log(kOccupancyMask / (1.0 - kOccupancyMask));
  at::Tensor next =
      state +
      plans_.linear(name + ".conv", neighborsOf(half, plans_.norm(name + ".conv.norm", state)));
  const at::Tensor normed = plans_.norm(name + ".norm", next);
  const auto product = [](const at::Tensor& cells, const at::Tensor& agents) {
    return at::bmm(cells, agents.transpose(1, 2));  // [B, c, A]
  };
  const at::Tensor masks = product(normed, plans_.linear(name + ".mask", placed));
  const at::Tensor admitted = masks.ge(mask_logit) & sure.unsqueeze(1).gt(0.5);
  const at::Tensor scores =
      product(plans_.linear(name + ".query", normed), plans_.linear(name + ".key", placed)) /
      std::sqrt(static_cast<double>(kOccupancyWidth));
  // Where none is admitted all weights are equal, and then 0.
  const at::Tensor weights = at::softmax(scores.masked_fill(admitted.logical_not(), -1e30), 2) *
                             admitted.to(scores.scalar_type());
  const at::Tensor mixed = at::bmm(weights, plans_.linear(name + ".value", placed));
  next = next + plans_.linear(name + ".output", mixed);
  return next + plans_.mix(name + ".mix", next);
}

at::Tensor UniadMiniNet::occupancy(const at::Tensor& bev, const TrackAnswer& tracks,
                                   const MotionAnswer& motion, const at::Tensor& sure) const {
  const inference::MapGrid grid = architecture_.ego.bev.grid();
  const std::int64_t slots = architecture_.tracks, samples = sure.size(0);
  const at::Tensor modes = motion.modes.narrow(1, 0, slots).amax(2);
  const at::Tensor agents =
      plans_.mlp("occupancy.agent", at::cat({tracks.features.narrow(1, 0, slots), modes}, 2));
  const auto onCells = [&](const char* name) {
    return plans_.linear(name, bev).reshape({samples, grid.cells(), kOccupancyWidth});
  };
  at::Tensor state = halved(grid, onCells("occupancy.bev"));
  const at::Tensor base = onCells("occupancy.fine");
  std::vector<at::Tensor> logits;
  for (std::int64_t step = 0; step < kOccupancySteps; ++step) {
    const std::string name = "occupancy." + std::to_string(step);
    const at::Tensor placed = agents + place(agentShares(tracks, motion, step));
    state = nextState(name, state, placed, sure);
    const at::Tensor cells = plans_.norm("occupancy.fine.norm", base + stretched(grid, state));
    logits.push_back(at::bmm(plans_.linear(name + ".mask", placed), cells.transpose(1, 2)));
  }
  return at::stack(logits, 1);
}

at::Tensor UniadMiniNet::plan(const at::Tensor& bev, const TrackAnswer& tracks,
                              const MotionAnswer& motion, const at::Tensor& commands) const {
  const inference::MapGrid grid = architecture_.ego.bev.grid();
  const std::int64_t samples = commands.size(0), width = architecture_.ego.width;
  const at::Tensor cells = bev.reshape({samples, grid.cells(), width});
  const at::Tensor narrow = at::relu(plans_.linear("plan.adapter.in", neighborsOf(grid, cells)));
  const at::Tensor tokens =
      plans_.norm("plan.bev.norm", cells + plans_.linear("plan.adapter.out", narrow)) +
      bev_layers_.table("bev.position");
  const at::Tensor modes = motion.modes.select(1, architecture_.tracks);  // [B, M, width]
  const at::Tensor ego = tracks.features.narrow(1, architecture_.tracks, 1).expand(modes.sizes());
  const at::Tensor command =
      plans_.table("command").index_select(0, commands).unsqueeze(1).expand(modes.sizes());
  at::Tensor x = plans_.mlp("plan.query", at::cat({modes, ego, command}, 2)).amax(1, true);
  for (std::int64_t i = 0; i < architecture_.plan_layers; ++i) {
    const std::string name = "plan." + std::to_string(i);
    x = x + plans_.attention(name, x, {}, tokens);
    x = x + plans_.mix(name + ".mix", x);
  }
  const at::Tensor offsets = plans_.mlp("plan.way", plans_.norm("plan.norm", x));
  return at::cumsum(kOffsetUnit * offsets.reshape({samples, kEgoWaypoints, 2}), 1);
}

}  // namespace cdiff::planners
