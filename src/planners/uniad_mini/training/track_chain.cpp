// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/training/track_chain.h"

#include <algorithm>
#include <cmath>

#include "planners/uniad_mini/track_set.h"

namespace cdiff::planners {
namespace {

/// The look of an example that stands `back` looks before the present one, as bevBatch has it.
std::size_t lookAt(const EgoExample& example, std::size_t back) {
  const std::size_t last = example.looks.size() - 1;
  return last - std::min(last, back);
}

const std::vector<AgentLabel>& labelsAt(const EgoExample& example, std::size_t look) {
  return look + 1 == example.looks.size() ? example.agents : example.looks[look].agents;
}

/// The tracks of a sample as the planner keeps them, without contents.
TrackSet trackSetOf(const TrackAnswer& answer, std::int64_t sample, const HeldTracks& held) {
  TrackSet tracks;
  tracks.live = held.live;
  const std::vector<float> boxes =
      learning::toVector(answer.boxes.back().detach()[sample].to(at::kCPU).contiguous());
  for (std::size_t slot = 0; slot < held.live.size(); ++slot) {
    const float* box = boxes.data() + slot * kBoxNumbers;
    tracks.centers.emplace_back(box[0], box[1]);
    tracks.velocities.emplace_back(box[8], box[9]);
  }
  return tracks;
}

/// Where the queries of a look start; slots whose track left the BEV hold nothing any more.
TrackStart startAfter(const TrackAnswer& before, const std::vector<const EgoExample*>& examples,
                      std::size_t back, const BevGrid& bev, std::vector<HeldTracks>& held) {
  const std::int64_t slots = before.boxes.back().size(1);
  const auto samples = static_cast<std::int64_t>(examples.size());
  std::vector<float> goes_on, references;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    const EgoFrame& look = examples[b]->looks[lookAt(*examples[b], back)];
    const bool has_past = back < examples[b]->looks.size() - 1;
    if (!has_past) held[b] = HeldTracks(static_cast<std::size_t>(slots));
    const TrackSet tracks = trackSetOf(before, static_cast<std::int64_t>(b), held[b]);
    for (std::size_t slot = 0; slot < held[b].live.size(); ++slot) {
      const auto moved = movedCenter(tracks, slot, look.poses, bev);
      held[b].live[slot] = moved.has_value();
      if (!moved) held[b].vehicles[slot].reset();
      const std::array<float, 2> reference =
          moved ? referenceAt(bev, *moved) : std::array<float, 2>{0.0F, 0.0F};
      references.insert(references.end(), reference.begin(), reference.end());
      goes_on.push_back(moved ? 1.0F : 0.0F);
    }
    goes_on.push_back(has_past ? 1.0F : 0.0F);  // the ego's query
  }
  const at::Device device = before.content.device();
  return {learning::toTensor(goes_on, {samples, slots + 1, 1}, device), before.content,
          learning::toTensor(references, {samples, slots, 2}, device)};
}

/// Adds the loss of a look; returns the matches of the last decoder layer.
QueryMatches addLosses(const std::vector<const EgoExample*>& examples, std::size_t back,
                       const std::vector<HeldTracks>& held, const SetLossWeights& weights,
                       FollowedTracks& followed) {
  std::vector<EgoExample> labeled(examples.size());
  std::vector<const EgoExample*> views;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    labeled[b].agents = labelsAt(*examples[b], lookAt(*examples[b], back));
    views.push_back(&labeled[b]);
  }
  QueryMatches matches;
  for (std::size_t layer = 0; layer < followed.answer.boxes.size(); ++layer) {
    const at::Tensor &logits = followed.answer.logits[layer], &boxes = followed.answer.boxes[layer];
    matches.clear();
    for (std::size_t b = 0; b < examples.size(); ++b) {
      const auto sample = static_cast<std::int64_t>(b);
      matches.push_back(
          matchTracks(logits[sample], boxes[sample], labeled[b].agents, held[b], weights));
    }
    const AgentLoss loss = agentLoss(logits, boxes, views, matches, weights);
    followed.kind = followed.kind.defined() ? followed.kind + loss.kind : loss.kind;
    followed.box = followed.box.defined() ? followed.box + loss.box : loss.box;
  }
  return matches;
}

std::vector<std::int64_t> freeSlots(const HeldTracks& held) {
  std::vector<std::int64_t> free;
  for (std::size_t slot = 0; slot < held.live.size(); ++slot) {
    if (!held.live[slot]) free.push_back(static_cast<std::int64_t>(slot));
  }
  return free;
}

/// The BEV of a look, without gradients but for the present one's.
at::Tensor encodeLook(const UniadMiniNet& net, const std::vector<const EgoExample*>& examples,
                      std::size_t back, const at::Device& device, const at::Tensor& past) {
  const CameraEgoSizes& sizes = net.architecture().ego;
  std::optional<at::NoGradGuard> no_gradient;
  if (back > 0) no_gradient.emplace();
  BevBatch batch = bevBatch(examples, back, sizes.bev, device);
  if (sizes.past_bev) return net.bev().encode(batch, past);
  for (std::size_t b = 0; b < examples.size(); ++b) {
    const geometry::Pose2d& pose = examples[b]->looks[lookAt(*examples[b], back)].poses.present;
    batch.temporal[b] =
        std::make_shared<inference::SamplingPlan>(temporalPlan(sizes.bev, pose, pose));
  }
  return net.bev().encode(batch, {});
}

}  // namespace

std::vector<int> matchTracks(const at::Tensor& logits, const at::Tensor& boxes,
                             const std::vector<AgentLabel>& labels, const HeldTracks& held,
                             const SetLossWeights& weights) {
  std::vector<int> result(labels.size(), -1);
  EgoExample rest;
  std::vector<std::size_t> of_rest;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (std::size_t slot = 0; slot < held.live.size(); ++slot) {
      if (held.live[slot] && held.vehicles[slot] == labels[i].vehicle)
        result[i] = static_cast<int>(slot);
    }
    if (result[i] >= 0) continue;
    of_rest.push_back(i);
    rest.agents.push_back(labels[i]);
  }
  const std::vector<std::int64_t> free = freeSlots(held);
  if (free.empty() || of_rest.empty()) return result;
  const auto count = static_cast<std::int64_t>(free.size());
  const at::Tensor index = learning::toIndices(free, {count}, logits.device());
  const QueryMatches found =
      matchAgents(logits.detach().index_select(0, index).unsqueeze(0),
                  boxes.detach().index_select(0, index).unsqueeze(0), {&rest}, weights);
  for (std::size_t i = 0; i < of_rest.size(); ++i) {
    if (found[0][i] < 0) continue;
    result[of_rest[i]] = static_cast<int>(free[static_cast<std::size_t>(found[0][i])]);
  }
  return result;
}

HeldTracks heldAfter(const at::Tensor& logits, const std::vector<AgentLabel>& labels,
                     const std::vector<int>& matches, const TrackDropOptions& options,
                     const TrackDraws& draws) {
  const std::vector<float> scores = learning::toVector(logits.detach().to(at::kCPU).contiguous());
  HeldTracks held(scores.size());
  std::vector<bool> matched(scores.size(), false);
  const auto chance = [&](std::size_t slot) {
    return draws.random.uniform(draws.key, static_cast<std::uint32_t>(slot));
  };
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i] < 0) continue;
    const auto slot = static_cast<std::size_t>(matches[i]);
    matched[slot] = true;
    held.live[slot] = chance(slot) >= options.dropped;
    if (held.live[slot]) held.vehicles[slot] = labels[i].vehicle;
  }
  for (std::size_t slot = 0; slot < scores.size(); ++slot) {
    const double score = 1.0 / (1.0 + std::exp(-static_cast<double>(scores[slot])));
    if (!matched[slot] && score >= kBirthScore)
      held.live[slot] = chance(slot) < options.false_positive;
  }
  return held;
}

FollowedTracks followTracks(const UniadMiniNet& net, const std::vector<const EgoExample*>& examples,
                            const FollowOptions& options, const core::RandomStream& random,
                            std::int64_t step) {
  const CameraEgoSizes& sizes = net.architecture().ego;
  std::size_t looks = 1;
  for (const EgoExample* example : examples) looks = std::max(looks, example->looks.size());
  FollowedTracks followed;
  std::vector<HeldTracks> held(examples.size(),
                               HeldTracks(static_cast<std::size_t>(net.architecture().tracks)));
  for (std::size_t back = looks; back-- > 0;) {
    followed.bev = encodeLook(net, examples, back, options.device, followed.bev);
    TrackStart start;
    if (back + 1 < looks) start = startAfter(followed.answer, examples, back, sizes.bev, held);
    followed.answer =
        net.seeTracks(followed.bev, static_cast<std::int64_t>(examples.size()), start);
    followed.matches = addLosses(examples, back, held, options.weights, followed);
    for (std::size_t b = 0; back > 0 && b < examples.size(); ++b) {
      const core::RandomKey key{b + 1, static_cast<std::uint32_t>(step),
                                static_cast<std::uint16_t>(back)};
      held[b] = heldAfter(followed.answer.logits.back()[static_cast<std::int64_t>(b)],
                          labelsAt(*examples[b], lookAt(*examples[b], back)), followed.matches[b],
                          options.drops, {random, key});
    }
  }
  followed.kind = followed.kind / static_cast<double>(looks);
  followed.box = followed.box / static_cast<double>(looks);
  return followed;
}

}  // namespace cdiff::planners
