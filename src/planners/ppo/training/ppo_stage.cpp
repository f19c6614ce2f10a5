// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/training/ppo_stage.h"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace cdiff::planners {
namespace {

constexpr double kAdamEpsilon = 1e-5;

at::Tensor toRows(const std::vector<double>& values, const at::Device& device) {
  const std::vector<float> floats(values.begin(), values.end());
  return learning::toTensor(floats, {static_cast<std::int64_t>(floats.size())}, device);
}

/// Observations before each step and, behind those of each episode, the last one of cut episodes (0
/// of the others, which nothing reads): [decisions + episodes, 24].
at::Tensor allObservations(const std::vector<PpoEpisode>& episodes, const at::Device& device) {
  std::vector<float> values;
  std::int64_t rows = 0;
  for (const PpoEpisode& episode : episodes) {
    for (const PpoStep& step : episode.steps)
      values.insert(values.end(), step.observation.begin(), step.observation.end());
    values.insert(values.end(), episode.last.begin(), episode.last.end());
    rows += static_cast<std::int64_t>(episode.steps.size()) + 1;
  }
  return learning::toTensor(values, {rows, static_cast<std::int64_t>(kPpoInputs)}, device);
}

/// Indices of the rows of allObservations that are decisions.
at::Tensor decisionRows(const std::vector<PpoEpisode>& episodes, const at::Device& device) {
  std::vector<at::Tensor> ranges;
  std::int64_t row = 0;
  for (const PpoEpisode& episode : episodes) {
    const auto steps = static_cast<std::int64_t>(episode.steps.size());
    ranges.push_back(at::arange(row, row + steps, at::kLong));
    row += steps + 1;
  }
  return at::cat(ranges).to(device);
}

at::Tensor allActions(const std::vector<PpoEpisode>& episodes, const at::Device& device) {
  std::vector<float> values;
  for (const PpoEpisode& episode : episodes) {
    for (const PpoStep& step : episode.steps)
      values.insert(values.end(), step.action.begin(), step.action.end());
  }
  const auto columns = static_cast<std::int64_t>(kPpoActions);
  return learning::toTensor(values, {static_cast<std::int64_t>(values.size()) / columns, columns},
                            device);
}

}  // namespace

PpoClocks PpoClocks::now() {
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(wall).count(),
          static_cast<double>(std::clock()) / CLOCKS_PER_SEC};
}

PpoEpisodeCounts::PpoEpisodeCounts(const std::vector<PpoEpisode>& all) : episodes(all.size()) {
  for (const PpoEpisode& episode : all) {
    decisions += episode.steps.size();
    total += episode.total();
    if (episode.end == PpoEnd::kGoal) ++goals;
    if (episode.end == PpoEnd::kEgoContact) ++ego_contacts;
    if (episode.end == PpoEnd::kOtherContact) ++other_contacts;
  }
}

learning::Measures PpoEpisodeCounts::measures(const std::string& prefix) const {
  const double count = std::max<double>(1.0, static_cast<double>(episodes));
  const auto ended = static_cast<double>(goals + ego_contacts + other_contacts);
  return {{prefix + "return", total / count},
          {prefix + "goal_share", static_cast<double>(goals) / count},
          {prefix + "goal_share_of_ended", static_cast<double>(goals) / std::max(1.0, ended)},
          {prefix + "ego_contact_share", static_cast<double>(ego_contacts) / count},
          {prefix + "other_contact_share", static_cast<double>(other_contacts) / count},
          {prefix + "count", static_cast<double>(episodes)},
          {prefix + "decisions", static_cast<double>(decisions) / count}};
}

PpoCollector PpoTraining::collector() const {
  PpoCollectorOptions options = settings.collector;
  options.seed = run.options.seed;
  return {routes, options, run.stop};
}

PpoStage::PpoStage(PpoTraining& training) : training_(training) {}

std::vector<learning::TrainedPart> PpoStage::parts() {
  return {{"actor", &training_.networks.actor()}, {"critic", &training_.networks.critic()}};
}

std::int64_t PpoStage::batchSize() const { return training_.run.batchSize(kBatch); }

std::int64_t PpoStage::stepsAnIteration() const {
  const std::int64_t steps =
      training_.settings.collector.buffer * training_.settings.passes / batchSize();
  return std::max<std::int64_t>(1, steps);
}

learning::StageRules PpoStage::rules() const {
  learning::StageRules rules;
  rules.epsilon = kAdamEpsilon;
  rules.linear = true;
  rules.clip_apart = true;
  rules.period = stepsAnIteration();
  return rules;
}

learning::Loss PpoStage::loss(std::int64_t step) {
  const std::int64_t iteration = step / stepsAnIteration();
  if (buffer_.iteration != iteration) collect(iteration);
  std::vector<std::int64_t> drawn;
  for (const std::size_t row : samplesOf(step)) drawn.push_back(static_cast<std::int64_t>(row));
  const at::Tensor rows = at::tensor(drawn, at::kLong).to(training_.run.device);
  const auto batch = [&](const at::Tensor& all) { return all.index_select(0, rows); };
  const PpoNetworks& networks = training_.networks;
  const at::Tensor observations = batch(buffer_.observations);
  const at::Tensor density =
      networks.logDensity(networks.mean(observations), batch(buffer_.actions));
  const at::Tensor ratio = (density - batch(buffer_.densities)).exp();
  const at::Tensor advantage = batch(buffer_.advantages);
  const double clip = training_.settings.clip_ratio;
  const at::Tensor gain =
      at::min(advantage * ratio, advantage * ratio.clamp(1.0 - clip, 1.0 + clip)).mean();
  const at::Tensor critic =
      at::smooth_l1_loss(networks.value(observations), batch(buffer_.returns));
  const at::Tensor entropy = networks.entropy();
  const at::Tensor actor = -(gain + training_.settings.entropy_weight * entropy);
  return {actor + critic, {{"actor", actor}, {"critic", critic}, {"entropy", entropy}}};
}

std::vector<std::size_t> PpoStage::samplesOf(std::int64_t step) {
  const core::RandomStream random = training_.run.stream("ppo minibatches");
  const auto count = static_cast<std::size_t>(
      buffer_.actions.defined() ? buffer_.actions.size(0) : training_.settings.collector.buffer);
  std::vector<std::size_t> rows;
  for (std::int64_t i = 0; i < batchSize(); ++i)
    rows.push_back(
        random.index({static_cast<std::uint64_t>(step)}, static_cast<std::uint32_t>(i), count));
  return rows;
}

void PpoStage::collect(std::int64_t iteration) {
  const PpoClocks begin = PpoClocks::now();
  const PpoActor actor(training_.networks.weights());
  const std::vector<PpoEpisode> episodes = training_.collector().explore(actor, iteration);
  fill(episodes);
  buffer_.iteration = iteration;
  const PpoEpisodeCounts counts(episodes);
  news_ = counts.measures("episode_");
  for (std::size_t i = 0; i < kPpoActions; ++i)
    news_["deviation_" + std::string(i == 0 ? "acceleration" : "steer")] = actor.deviation()[i];
  notePace(begin);
  decisions_ = counts.decisions;
}

/// Of the last iteration from its start to that of this one, learning included.
void PpoStage::notePace(const PpoClocks& begin) {
  if (decisions_ > 0) {
    const auto decisions = static_cast<double>(decisions_);
    news_["decisions_per_second"] = decisions / (begin.wall - begun_.wall);
    news_["decisions_per_processor_second"] = decisions / (begin.processors - begun_.processors);
  }
  begun_ = begin;
}

std::vector<PpoValued> PpoStage::valued(const std::vector<PpoEpisode>& episodes,
                                        const at::Tensor& observations) const {
  const std::vector<float> values = learning::toVector(training_.networks.value(observations));
  std::vector<PpoValued> decisions;
  std::size_t row = 0;
  for (const PpoEpisode& episode : episodes) {
    for (std::size_t i = 0; i < episode.steps.size(); ++i, ++row) {
      const bool last = i + 1 == episode.steps.size();
      decisions.push_back({episode.steps[i].reward, values[row], values[row + 1],
                           last && episode.end != PpoEnd::kCut, last});
    }
    ++row;
  }
  return decisions;
}

void PpoStage::fill(const std::vector<PpoEpisode>& episodes) {
  const at::NoGradGuard no_gradient;
  const at::Device device = training_.run.device;
  const at::Tensor all = allObservations(episodes, device);
  const std::vector<PpoValued> decisions = valued(episodes, all);
  const std::vector<double> advantages =
      ppoAdvantages(decisions, training_.settings.discount, training_.settings.advantage_decay);
  std::vector<double> returns;
  for (std::size_t i = 0; i < decisions.size(); ++i)
    returns.push_back(advantages[i] + decisions[i].value);
  buffer_.observations = all.index_select(0, decisionRows(episodes, device));
  buffer_.actions = allActions(episodes, device);
  buffer_.densities =
      training_.networks.logDensity(training_.networks.mean(buffer_.observations), buffer_.actions);
  buffer_.advantages = toRows(ppoNormalized(advantages), device);
  buffer_.returns = toRows(returns, device);
}

learning::Measures PpoStage::news() {
  learning::Measures fresh;
  fresh.swap(news_);
  return fresh;
}

learning::Measures PpoStage::measureHeldOut() {
  const PpoActor actor(training_.networks.weights());
  const auto episodes = training_.collector().evaluate(actor, training_.settings.held_out_rounds);
  return PpoEpisodeCounts(episodes).measures("");
}

}  // namespace cdiff::planners
