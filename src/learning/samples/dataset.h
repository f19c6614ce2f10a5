// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "learning/samples/shard.h"

namespace cdiff::learning {

/// The field of every sample that says of which session it is: a u64, such as core::hashText of the
/// session's name.
constexpr const char* kSessionField = "session";

/// All shards below a folder as one list of samples, with the split by session into training and
/// validation.
/// Keeps the shards in memory (packed fields compressed).
class Dataset {
 public:
  /// `validation_share` of the sessions (by their hash, whatever the seed) are held out; 0: the
  /// training samples serve for both. Throws InputError when there is no shard, a shard is broken,
  /// two schemas differ, the samples name no session, or a part is empty.
  Dataset(const std::filesystem::path& folder, double validation_share);

  const SampleSchema& schema() const { return schema_; }
  std::size_t size() const { return places_.size(); }
  /// A sample without the fields `left_out`.
  Sample sample(std::size_t index, const FieldNames& left_out = {}) const;
  const std::vector<std::size_t>& training() const { return training_; }
  const std::vector<std::size_t>& validation() const { return validation_; }
  std::size_t sessions() const { return sessions_; }
  std::size_t validationSessions() const { return validation_sessions_; }
  /// SHA-256 over the checksums of the shards in order.
  const std::string& sha256() const { return sha256_; }
  /// "data folder 'FOLDER'", for messages.
  const std::string& name() const { return name_; }

 private:
  struct Place {
    std::size_t shard = 0;
    std::size_t index = 0;
    std::uint64_t session = 0;
  };
  void readShards(const std::filesystem::path& folder);
  void addSamples(const ShardReader& shard);
  void split(double validation_share);

  std::string name_;
  std::vector<ShardReader> shards_;
  SampleSchema schema_;
  std::vector<Place> places_;
  std::vector<std::size_t> training_;
  std::vector<std::size_t> validation_;
  std::size_t sessions_ = 0;
  std::size_t validation_sessions_ = 0;
  std::string sha256_;
};

}  // namespace cdiff::learning
