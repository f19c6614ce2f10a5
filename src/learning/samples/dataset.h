// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "learning/samples/field.h"

namespace cdiff::learning {

constexpr std::uint32_t kShardVersion = 2;

/// The JSON header of a shard: {"fields" (SampleSchema), "samples", "facts"} in version 2. Version
/// 1 knew the samples of one planner only: {"schema" (DrivingSchema), "samples", "facts"}; its
/// samples are stored as version 2 stores the fields of a DrivingSample.
struct ShardHeader {
  SampleSchema schema;
  std::size_t samples = 0;
  std::map<std::string, std::string> facts;  ///< where the data come from
};

/// In the current version.
std::string headerText(const ShardHeader& header);
/// Throws InputError naming `source` for another version and for a header that is malformed.
ShardHeader readShardHeader(std::uint32_t version, const std::string& text,
                            const std::string& source);

// Shards: files `*.shard` of samples. Little endian: 8 bytes of its kind, u32 version, u32 length
// and text of the header (learning/samples/dataset.h), the samples, and 64 hexadecimal digits:
// SHA-256 of all before. A sample is its fields in the order of the schema: the values as they are;
// before them the u32 number of rows where each sample has its own; a text, and a packed field's
// zlib stream, after its u32 length.

/// What the samples of a file are for: its first 8 bytes, and what messages call it.
struct ShardKind {
  std::string_view magic;
  const char* name;
};
inline constexpr ShardKind kShardKind = {"CDIFFSHD", "shard"};

/// Names of fields.
using FieldNames = std::set<std::string>;

/// Collects samples in memory, packed fields compressed, and writes them as one file.
class ShardWriter {
 public:
  explicit ShardWriter(SampleSchema schema, const ShardKind& kind = kShardKind) : kind_(kind) {
    header_.schema = std::move(schema);
  }

  /// Throws InputError when the sample does not fit the schema.
  void append(const Sample& sample);
  std::size_t size() const { return header_.samples; }
  const SampleSchema& schema() const { return header_.schema; }

  /// What was appended as the bytes of a file, which is forgotten. `facts` say where the data come
  /// from.
  std::string take(const std::map<std::string, std::string>& facts = {});
  /// The same into the file `path` (".shard"), which is whole or absent (temporary file, flush,
  /// rename). Throws InputError naming the path, also when the disk is full.
  void write(const std::filesystem::path& path,
             const std::map<std::string, std::string>& facts = {});

 private:
  ShardKind kind_;
  ShardHeader header_;
  std::string body_;
};

/// A whole shard in memory; packed fields stay so until asked for.
class ShardReader {
 public:
  /// Throws InputError that names the file and what is wrong: no such file, truncated, foreign
  /// magic, other version, checksum, header, a sample that does not fit the schema.
  explicit ShardReader(const std::filesystem::path& path, const ShardKind& kind = kShardKind);
  /// The same from a file's bytes; `name` starts the text of errors.
  ShardReader(std::string content, std::string name, const ShardKind& kind = kShardKind);

  const SampleSchema& schema() const { return header_.schema; }
  const std::map<std::string, std::string>& facts() const { return header_.facts; }
  std::size_t size() const { return places_.size(); }
  /// A sample without the fields `left_out`; throws InputError when a packed field does not unpack
  /// to its size.
  Sample sample(std::size_t index, const FieldNames& left_out = {}) const;
  /// SHA-256 of the file's content.
  const std::string& sha256() const { return sha256_; }
  /// "shard 'FILE'", for messages.
  const std::string& name() const { return name_; }

 private:
  void findSamples(std::size_t begin);

  std::string name_;  ///< before errors
  ShardHeader header_;
  std::string content_;  ///< of the file, without the checksum
  std::string sha256_;
  std::vector<std::size_t> places_;  ///< where each sample starts in `content_`
};

/// Every file of this extension (".shard") below `folder`, sorted by path. Throws InputError when
/// there is none.
std::vector<std::filesystem::path> findDataFiles(const std::filesystem::path& folder,
                                                 const std::string& extension);
std::vector<std::filesystem::path> findShards(const std::filesystem::path& folder);

/// The field of every sample that names its session: a u64, such as core::hashText of the session's
/// name.
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
  /// The same of shards in memory; `name` stands for the data in messages, `unit` for what a value
  /// of kSessionField is ("networks"), of which a share is held out.
  Dataset(std::vector<ShardReader> shards, std::string name, double validation_share,
          std::string unit = "sessions");
  /// Without samples.
  Dataset() = default;

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
  /// "sessions" or "networks".
  const std::string& unit() const { return unit_; }

 private:
  struct Place {
    std::size_t shard = 0;
    std::size_t index = 0;
    std::uint64_t session = 0;
  };
  void addShards();
  void addSamples(std::size_t shard);
  void split(double validation_share);

  std::string name_;
  std::string unit_;
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
