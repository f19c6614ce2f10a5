// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Shards: files `*.shard` of samples. Little endian: 8 bytes "CDIFFSHD", u32 version, u32 length
/// and text of a JSON header {"schema", "samples", "facts"}, the samples (numbers as written by
/// shard.cpp, images compressed with zlib), and 64 hexadecimal digits: SHA-256 of all before.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "training/sample.h"

namespace cdiff::training {

/// Collects samples in memory, compressed (about 10 kB each), and writes them as one file.
class ShardWriter {
 public:
  explicit ShardWriter(SampleSchema schema) : schema_(std::move(schema)) {}

  /// Throws InputError when the sample does not fit the schema.
  void append(const Sample& sample);
  std::size_t size() const { return samples_; }
  const SampleSchema& schema() const { return schema_; }

  /// Writes what was appended to `path` (".shard") and forgets it: the file is whole or absent
  /// (temporary file, flush, rename). `facts` say where the data come from. Throws InputError
  /// naming the path, also when the disk is full.
  void write(const std::filesystem::path& path,
             const std::map<std::string, std::string>& facts = {});

 private:
  SampleSchema schema_;
  std::size_t samples_ = 0;
  std::string body_;
};

/// A whole shard in memory; images stay compressed until asked for.
class ShardReader {
 public:
  /// Throws InputError that names the file and what is wrong: no such file, truncated, foreign
  /// magic, other version, checksum, header, a sample that does not fit the schema.
  explicit ShardReader(const std::filesystem::path& path);

  const SampleSchema& schema() const { return schema_; }
  const std::map<std::string, std::string>& facts() const { return facts_; }
  std::size_t size() const { return places_.size(); }
  /// Session of a sample, without unpacking it.
  std::uint64_t session(std::size_t index) const { return sessions_[index]; }
  /// A sample with its image; throws InputError when the image does not unpack to its size.
  Sample sample(std::size_t index) const;
  /// All but the image.
  Sample withoutImage(std::size_t index) const;
  /// SHA-256 of the file's content.
  const std::string& sha256() const { return sha256_; }

 private:
  Sample read(std::size_t index, bool with_image) const;
  void readHeader(const std::string& header);
  void findSamples(std::size_t begin);

  std::filesystem::path path_;
  SampleSchema schema_;
  std::map<std::string, std::string> facts_;
  std::size_t announced_ = 0;
  std::string content_;  ///< of the file, without the checksum
  std::string sha256_;
  std::vector<std::size_t> places_;  ///< where each sample begins in `content_`
  std::vector<std::uint64_t> sessions_;
};

/// Every `*.shard` below `folder`, sorted by path. Throws InputError when there is none.
std::vector<std::filesystem::path> findShards(const std::filesystem::path& folder);

}  // namespace cdiff::training
