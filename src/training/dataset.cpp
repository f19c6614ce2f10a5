// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "training/dataset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::training {
namespace {

using core::InputError;
using traffic::Rollout;

/// Least standard deviation of a state cell: x, y [m], heading [rad], speed [m/s].
constexpr std::array<double, traffic::kStateColumns> kLeastDeviation = {0.05, 0.05, 0.01, 0.1};
constexpr double kLeastSteerScale = 0.05;

void mirrorRollout(Rollout& rollout) {
  for (const int column : {traffic::kRolloutY, traffic::kRolloutHeading, traffic::kRolloutSteer})
    rollout.col(column) *= -1.0;
}

/// Sessions whose draw lies below the share; where that is none or all of several, the lowest draw
/// is held out or the highest is not.
std::set<std::uint64_t> drawHeldOut(const std::set<std::uint64_t>& sessions, double share) {
  const core::RandomStream stream(0, "validation sessions");
  const auto draw = [&](std::uint64_t session) { return stream.uniform({session}, 0); };
  const auto lower = [&](std::uint64_t a, std::uint64_t b) { return draw(a) < draw(b); };
  std::set<std::uint64_t> held_out;
  for (const std::uint64_t session : sessions) {
    if (draw(session) < share) held_out.insert(session);
  }
  if (sessions.size() < 2 || share <= 0.0) return held_out;
  if (held_out.empty()) held_out.insert(*std::min_element(sessions.begin(), sessions.end(), lower));
  if (held_out.size() == sessions.size())
    held_out.erase(*std::max_element(sessions.begin(), sessions.end(), lower));
  return held_out;
}

bool endsInLeft(const std::string& name) {
  const std::string ending = "_left";
  return name.size() >= ending.size() &&
         name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace

Dataset::Dataset(const std::filesystem::path& folder, double validation_share) {
  readShards(folder);
  split(validation_share);
}

void Dataset::readShards(const std::filesystem::path& folder) {
  core::Sha256 digest;
  for (const std::filesystem::path& path : findShards(folder)) {
    shards_.emplace_back(path);
    const ShardReader& shard = shards_.back();
    if (shards_.size() == 1) schema_ = shard.schema();
    if (!(shard.schema() == schema_)) {
      throw InputError("shard '" + path.string() + "': its schema " + shard.schema().toJson() +
                       " is not that of the first shard, " + schema_.toJson());
    }
    digest.update(shard.sha256());
    for (std::size_t i = 0; i < shard.size(); ++i) places_.push_back({shards_.size() - 1, i});
  }
  sha256_ = digest.finish();
  if (places_.empty()) {
    throw InputError(
        "data folder '" + folder.string() +
        "': its shards hold no samples; collect longer sessions (cdiff collect --duration)");
  }
}

void Dataset::split(double validation_share) {
  std::set<std::uint64_t> all;
  for (const Place& place : places_) all.insert(shards_[place.shard].session(place.index));
  const std::set<std::uint64_t> held_out = drawHeldOut(all, validation_share);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::uint64_t session = shards_[places_[i].shard].session(places_[i].index);
    (held_out.count(session) != 0 ? validation_ : training_).push_back(i);
  }
  sessions_ = all.size();
  validation_sessions_ = held_out.size();
  if (validation_share <= 0.0) validation_ = training_;
  if (!training_.empty() && !validation_.empty()) return;
  throw InputError("data: of " + std::to_string(sessions_) + " sessions with " +
                   std::to_string(places_.size()) + " samples, " +
                   std::to_string(validation_sessions_) +
                   " are held out; both parts need one (more sessions, or validation share 0)");
}

Sample Dataset::sample(std::size_t index) const {
  return shards_[places_.at(index).shard].sample(places_[index].index);
}

Sample Dataset::withoutImage(std::size_t index) const {
  return shards_[places_.at(index).shard].withoutImage(places_[index].index);
}

std::string Dataset::describe(std::size_t index) const {
  const Sample found = withoutImage(index);
  return found.vehicle + " at tick " + std::to_string(found.tick) + " of session " +
         std::to_string(found.session);
}

diffusion::Normalizer fitNormalizer(const Dataset& dataset, bool mirrored) {
  const Eigen::Index horizon = dataset.schema().horizon;
  Rollout sum = Rollout::Zero(horizon, traffic::kRolloutColumns);
  Rollout squares = sum;
  double count = 0.0;
  for (const std::size_t index : dataset.training()) {
    Rollout rollout = dataset.withoutImage(index).rollout;
    for (int pass = 0; pass < (mirrored ? 2 : 1); ++pass) {
      if (pass == 1) mirrorRollout(rollout);
      sum += rollout;
      squares += rollout.cwiseProduct(rollout);
      count += 1.0;
    }
  }
  diffusion::Normalizer normalizer{sum / count, squares / count};
  normalizer.scale =
      (normalizer.scale - normalizer.mean.cwiseProduct(normalizer.mean)).cwiseMax(0.0).cwiseSqrt();
  for (int column = 0; column < traffic::kStateColumns; ++column) {
    const double least = kLeastDeviation[static_cast<std::size_t>(column)];
    normalizer.scale.col(column) = normalizer.scale.col(column).cwiseMax(least);
  }
  for (const int column : {traffic::kRolloutThrottle, traffic::kRolloutBrake}) {
    normalizer.mean.col(column).setConstant(0.5);
    normalizer.scale.col(column).setConstant(0.5);
  }
  const double steer = std::sqrt(squares.col(traffic::kRolloutSteer).mean() / count);
  normalizer.mean.col(traffic::kRolloutSteer).setZero();
  normalizer.scale.col(traffic::kRolloutSteer).setConstant(std::max(2.0 * steer, kLeastSteerScale));
  return normalizer;
}

void mirrorSample(const SampleSchema& schema, Sample& sample) {
  const int width = sample.image.width;
  for (std::size_t pixel = 0; pixel < sample.image.rgb.size() / 3; ++pixel) {
    const std::size_t column = pixel % static_cast<std::size_t>(width);
    const std::size_t other = pixel - column + static_cast<std::size_t>(width) - 1 - column;
    for (std::size_t c = 0; other > pixel && c < 3; ++c)
      std::swap(sample.image.rgb[3 * pixel + c], sample.image.rgb[3 * other + c]);
  }
  mirrorRollout(sample.rollout);
  for (std::size_t i = 1; i < sample.route.size(); i += 2) sample.route[i] *= -1.0F;
  for (std::size_t i = 0; i < sample.auxiliary.size(); ++i) {
    if (endsInLeft(schema.auxiliary[i])) sample.auxiliary[i] *= -1.0F;
  }
}

void changeLight(const core::RandomStream& random, const core::RandomKey& key,
                 traffic::CameraImage& image) {
  const double brightness = random.uniform(key, 0, -40.0, 40.0);
  const double contrast = random.uniform(key, 1, 0.8, 1.2);
  const double noise = random.uniform(key, 2, 0.0, 12.0) / 127.5;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    if (i % 8 == 0) bits = random.bits(key, static_cast<std::uint32_t>(3 + i / 8));
    const double jitter = noise * (static_cast<double>(bits & 255U) - 127.5);
    bits >>= 8;
    const double value =
        (static_cast<double>(image.rgb[i]) - 127.5) * contrast + 127.5 + brightness + jitter;
    image.rgb[i] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  }
}

}  // namespace cdiff::training
