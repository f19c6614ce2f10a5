// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// All shards below a folder as one list of samples, with the split by session into training and
/// validation, the normaliser of the training part, and mirrored or photometrically changed
/// samples.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diffusion/normalizer.h"
#include "e2e_cdiff/core/random.h"
#include "training/shard.h"

namespace cdiff::training {

/// Keeps the shards in memory (images compressed).
class Dataset {
 public:
  /// `validation_share` of the sessions (by their hash, whatever the seed) are held out; 0: the
  /// training samples serve for both. Throws InputError when there is no shard, a shard is broken,
  /// two schemas differ, or a part is empty.
  Dataset(const std::filesystem::path& folder, double validation_share);

  const SampleSchema& schema() const { return schema_; }
  std::size_t size() const { return places_.size(); }
  Sample sample(std::size_t index) const;
  Sample withoutImage(std::size_t index) const;
  const std::vector<std::size_t>& training() const { return training_; }
  const std::vector<std::size_t>& validation() const { return validation_; }
  std::size_t sessions() const { return sessions_; }
  std::size_t validationSessions() const { return validation_sessions_; }
  /// SHA-256 over the checksums of the shards in order.
  const std::string& sha256() const { return sha256_; }
  /// "vehicle at tick N of session S", for messages.
  std::string describe(std::size_t index) const;

 private:
  struct Place {
    std::size_t shard = 0;
    std::size_t index = 0;
  };
  void readShards(const std::filesystem::path& folder);
  void split(double validation_share);

  std::vector<ShardReader> shards_;
  SampleSchema schema_;
  std::vector<Place> places_;
  std::vector<std::size_t> training_;
  std::vector<std::size_t> validation_;
  std::size_t sessions_ = 0;
  std::size_t validation_sessions_ = 0;
  std::string sha256_;
};

/// Actions: throttle and brake [0, 1] -> [-1, 1], steer by twice its standard deviation over all
/// rows. States: mean and standard deviation of each cell, at least 0.05 m, 0.01 rad and 0.1 m/s.
/// The training samples and, if asked, their mirror images count.
diffusion::Normalizer fitNormalizer(const Dataset& dataset, bool mirrored);

/// Left and right exchanged: image, y, heading, steer, y of the route, and the auxiliary targets
/// whose name in `schema` ends in "_left".
void mirrorSample(const SampleSchema& schema, Sample& sample);

/// Brightness by up to 40 of 255 grey levels, contrast by up to 20 %, and noise of up to 12 grey
/// levels on each value, in place.
void changeLight(const core::RandomStream& random, const core::RandomKey& key,
                 traffic::CameraImage& image);

}  // namespace cdiff::training
