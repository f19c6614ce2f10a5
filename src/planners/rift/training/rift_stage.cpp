// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/training/rift_stage.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "learning/layers.h"
#include "metrics/formulas/rank_correlation.h"

namespace cdiff::planners {
namespace {

constexpr float kNoCandidate = -1e9F;

/// 0, 1, ... count - 1 in an order drawn from the stream.
std::vector<std::size_t> shuffled(std::size_t count, const core::RandomStream& random,
                                  std::uint32_t round) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = count; i > 1; --i) {
    const core::RandomKey key{i, round, 0};
    std::swap(order[i - 1], order[random.index(key, 0, i)]);
  }
  return order;
}

/// Sums over judged states of one policy.
struct PolicySums {
  double best = 0.0;       ///< return of the candidate of the largest logit
  double expected = 0.0;   ///< mean return under the softmax
  double agreement = 0.0;  ///< rank correlation of logits and returns

  void add(const std::vector<float>& logits, const std::vector<double>& returns) {
    const auto largest = std::max_element(logits.begin(), logits.end());
    best += returns[static_cast<std::size_t>(largest - logits.begin())];
    double sum = 0.0;
    double weighted = 0.0;
    for (std::size_t i = 0; i < logits.size(); ++i) {
      const double weight = std::exp(static_cast<double>(logits[i]) - *largest);
      sum += weight;
      weighted += weight * returns[i];
    }
    expected += weighted / sum;
    agreement +=
        metrics::rankCorrelation(std::vector<double>(logits.begin(), logits.end()), returns)
            .value_or(0.0);
  }
  void report(const std::string& prefix, double count, learning::Measures& measures) const {
    measures[prefix + "best_return"] = best / count;
    measures[prefix + "expected_return"] = expected / count;
    measures[prefix + "rank_correlation"] = agreement / count;
  }
};

}  // namespace

at::Tensor riftScores(const learning::ParameterSet& head, const at::Tensor& features) {
  return learning::mlp(head, "score", features).squeeze(1);
}

double riftRate(double first, std::int64_t step, std::int64_t batches, std::int64_t epochs) {
  constexpr double kFallPerBuffer = 0.9;
  constexpr double kLeastRate = 1e-6;
  constexpr double kLeastShare = 0.9;  // at the end of a buffer
  constexpr std::int64_t kWarmUpEpochs = 3;
  const std::int64_t steps = batches * epochs;
  const std::int64_t buffer = step / steps;
  const double rate =
      std::max(kLeastRate, first * std::pow(kFallPerBuffer, static_cast<double>(buffer)));
  const std::int64_t here = step % steps;
  const std::int64_t warm_up = std::min(kWarmUpEpochs * batches, steps);
  if (here < warm_up) return rate * static_cast<double>(here + 1) / static_cast<double>(warm_up);
  const double share = static_cast<double>(here - warm_up) /
                       static_cast<double>(std::max<std::int64_t>(1, steps - warm_up));
  const double fall = 0.5 * (1.0 + std::cos(core::kPi * share));
  return rate * (kLeastShare + (1.0 - kLeastShare) * fall);
}

RiftBuffer::RiftBuffer(const std::vector<RiftGroup>& groups, std::int64_t width,
                       const learning::ParameterSet& head, const at::Device& device) {
  const at::NoGradGuard no_gradient;
  const auto states = static_cast<std::int64_t>(groups.size());
  std::size_t most = 1;
  for (const RiftGroup& group : groups) most = std::max(most, group.returns.size());
  const auto count = static_cast<std::int64_t>(most);
  std::vector<float> values(groups.size() * most * static_cast<std::size_t>(width));
  std::vector<float> first(groups.size() * most);
  std::vector<float> advantages(groups.size() * most);
  std::vector<float> mask(groups.size() * most, kNoCandidate);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const RiftGroup& group = groups[i];
    const auto row = static_cast<std::ptrdiff_t>(i * most);
    std::copy(group.features.begin(), group.features.end(), values.begin() + row * width);
    std::copy(group.logits.begin(), group.logits.end(), first.begin() + row);
    const std::vector<double> relative = groupAdvantages(group.returns);
    std::transform(relative.begin(), relative.end(), advantages.begin() + row,
                   [](double value) { return static_cast<float>(value); });
    std::fill_n(mask.begin() + row, group.returns.size(), 0.0F);
  }
  features = learning::toTensor(values, {states, count, width}, device);
  rows.first_logits = learning::toTensor(first, {states, count}, device);
  rows.advantages = learning::toTensor(advantages, {states, count}, device);
  rows.mask = learning::toTensor(mask, {states, count}, device);
  rows.old_logits = riftScores(head, features.flatten(0, 1)).reshape({states, count});
}

RiftStage::RiftStage(RiftTrainingState& state) : state_(state) {}

std::int64_t RiftStage::batchSize() const { return state_.run.batchSize(kRiftBatch); }

/// The samples of a buffer are gathered by the weights of its start.
learning::StageRules RiftStage::rules() const {
  learning::StageRules rules;
  rules.period = stepsOfBuffer();
  return rules;
}

std::int64_t RiftStage::batches() const {
  return (state_.settings.buffer + batchSize() - 1) / batchSize();
}

/// Indices in the data set; every training moment comes once before any comes again.
std::vector<std::size_t> RiftStage::momentsOf(std::int64_t buffer) const {
  const std::vector<std::size_t>& training = state_.run.dataset.training();
  const core::RandomStream random = state_.run.stream("rift moments");
  const auto wanted = static_cast<std::size_t>(state_.settings.buffer);
  std::vector<std::size_t> moments;
  std::vector<std::size_t> order;
  std::size_t round = training.size();  // none yet
  for (std::size_t i = 0; i < wanted; ++i) {
    const std::size_t place = static_cast<std::size_t>(buffer) * wanted + i;
    if (order.empty() || place / training.size() != round) {
      round = place / training.size();
      order = shuffled(training.size(), random, static_cast<std::uint32_t>(round));
    }
    moments.push_back(training[order[place % training.size()]]);
  }
  return moments;
}

/// Rows of the buffer that a step trains on.
std::vector<std::int64_t> RiftStage::rowsOf(std::int64_t step) const {
  const std::int64_t epoch = step / batches();  // over all buffers
  const auto order = shuffled(static_cast<std::size_t>(state_.settings.buffer),
                              state_.run.stream("rift order"), static_cast<std::uint32_t>(epoch));
  const auto begin = static_cast<std::size_t>(step % batches() * batchSize());
  const std::size_t end = std::min(order.size(), begin + static_cast<std::size_t>(batchSize()));
  return {order.begin() + static_cast<std::ptrdiff_t>(begin),
          order.begin() + static_cast<std::ptrdiff_t>(end)};
}

std::vector<std::size_t> RiftStage::samplesOf(std::int64_t step) {
  const std::vector<std::size_t> moments = momentsOf(step / stepsOfBuffer());
  std::vector<std::size_t> samples;
  for (const std::int64_t row : rowsOf(step))
    samples.push_back(moments[static_cast<std::size_t>(row)]);
  return samples;
}

void RiftStage::gather(std::int64_t buffer) {
  std::vector<RiftGroup> groups;
  for (const std::size_t index : momentsOf(buffer)) {
    if (state_.run.stop) throw core::Interrupted("stopped while states were gathered");
    const RiftMoment& moment = state_.moments[index];
    groups.push_back(state_.groups.of(state_.scenes[moment.place.scene], moment));
  }
  buffer_.emplace(groups, state_.model.architecture.width, state_.head, state_.run.device);
  gathered_ = buffer;
  state_.run.log << "gathered " << groups.size() << " states of buffer " << buffer << std::endl;
}

learning::Loss RiftStage::loss(std::int64_t step) {
  const std::int64_t buffer = step / stepsOfBuffer();
  if (gathered_ != buffer) gather(buffer);
  const std::vector<std::int64_t> rows = rowsOf(step);
  const at::Tensor indices =
      learning::toIndices(rows, {static_cast<std::int64_t>(rows.size())}, state_.run.device);
  const auto chosen = [&](const at::Tensor& all) { return all.index_select(0, indices); };
  const at::Tensor features = chosen(buffer_->features);
  RiftRows part;
  part.logits =
      riftScores(state_.head, features.flatten(0, 1)).reshape({features.size(0), features.size(1)});
  part.old_logits = chosen(buffer_->rows.old_logits);
  part.first_logits = chosen(buffer_->rows.first_logits);
  part.advantages = chosen(buffer_->rows.advantages);
  part.mask = chosen(buffer_->rows.mask);
  const at::Tensor value = riftLoss(state_.settings.objectiveOf(), part);
  return {value, {{"objective", value}}};
}

std::optional<double> RiftStage::learningRate(std::int64_t step) const {
  return riftRate(state_.run.options.learning_rate, step, batches(), state_.settings.epochs);
}

learning::Measures RiftStage::measureHeldOut() {
  const at::NoGradGuard no_gradient;
  if (held_out_.empty()) {
    for (const std::size_t index : state_.run.held_out) {
      const RiftMoment& moment = state_.moments[index];
      held_out_.push_back(state_.groups.of(state_.scenes[moment.place.scene], moment));
    }
  }
  PolicySums before, after;
  double best = 0.0;
  double gain = 0.0;
  double squares = 0.0;
  for (const RiftGroup& group : held_out_) {
    const at::Tensor features = learning::toTensor(
        group.features,
        {static_cast<std::int64_t>(group.returns.size()), state_.model.architecture.width},
        state_.run.device);
    const double so_far = after.best - before.best;
    before.add(group.logits, group.returns);
    after.add(learning::toVector(riftScores(state_.head, features)), group.returns);
    best += *std::max_element(group.returns.begin(), group.returns.end());
    const double one = after.best - before.best - so_far;
    gain += one;
    squares += one * one;
  }
  const double count = std::max(1.0, static_cast<double>(held_out_.size()));
  learning::Measures measures;
  before.report("pluto_", count, measures);
  after.report("", count, measures);
  measures["largest_return"] = best / count;
  measures["gain"] = gain / count;
  measures["gain_error"] =
      std::sqrt(std::max(0.0, squares / count - (gain / count) * (gain / count)) / count);
  return measures;
}

std::string riftTable(const learning::Measures& held_out) {
  std::string table =
      "Returns of simulated candidates on held-out states.\n\n"
      "| Scores | return of the largest | mean under the softmax | rank correlation |\n"
      "|---|---|---|---|\n";
  for (const auto& [title, prefix] :
       {std::make_pair("Pluto", "pluto_"), std::make_pair("RIFT", "")}) {
    const std::string key = prefix;
    table += "| " + std::string(title) + " | " +
             core::formatFixed(held_out.at(key + "best_return"), 3) + " | " +
             core::formatFixed(held_out.at(key + "expected_return"), 3) + " | " +
             core::formatFixed(held_out.at(key + "rank_correlation"), 3) + " |\n";
  }
  table += "\nGain in the return of the largest: " + core::formatFixed(held_out.at("gain"), 3) +
           " with a standard error of " + core::formatFixed(held_out.at("gain_error"), 3) +
           "; the best candidate of each state has " +
           core::formatFixed(held_out.at("largest_return"), 3) + ".\n";
  return table;
}

}  // namespace cdiff::planners
