// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/dataset.h"

#include <algorithm>
#include <set>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::learning {
namespace {

using core::InputError;

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

}  // namespace

Dataset::Dataset(const std::filesystem::path& folder, double validation_share)
    : name_("data folder '" + folder.string() + "'") {
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
    addSamples(shard);
  }
  sha256_ = digest.finish();
  if (places_.empty()) {
    throw InputError(
        name_ + ": its shards hold no samples; collect longer sessions (cdiff collect --duration)");
  }
}

void Dataset::addSamples(const ShardReader& shard) {
  FieldNames others;
  for (const FieldSpec& field : schema_.fields) others.insert(field.name);
  if (others.erase(kSessionField) == 0 || schema_.find(kSessionField)->type != FieldType::kU64 ||
      !schema_.find(kSessionField)->shape.empty()) {
    throw InputError(name_ + ": its samples lack the field '" + kSessionField +
                     "' (one u64), by which training and validation are parted; whoever writes "
                     "the shards must store it");
  }
  for (std::size_t i = 0; i < shard.size(); ++i) {
    const Sample sample = shard.sample(i, others);
    places_.push_back(
        {shards_.size() - 1, i, sample.get<std::vector<std::uint64_t>>(kSessionField).at(0)});
  }
}

void Dataset::split(double validation_share) {
  std::set<std::uint64_t> all;
  for (const Place& place : places_) all.insert(place.session);
  const std::set<std::uint64_t> held_out = drawHeldOut(all, validation_share);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    (held_out.count(places_[i].session) != 0 ? validation_ : training_).push_back(i);
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

Sample Dataset::sample(std::size_t index, const FieldNames& left_out) const {
  return shards_[places_.at(index).shard].sample(places_[index].index, left_out);
}

}  // namespace cdiff::learning
