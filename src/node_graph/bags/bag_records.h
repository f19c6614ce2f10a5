// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace cdiff::node_graph {

// Records of the ROS bag format 2.0 in a text of bytes (wiki.ros.org/Bags/Format/2.0), read without
// trust: whatever the bytes are, nothing outside them is touched and nothing is thrown.

/// First line of a bag.
inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

/// Kind of a bag's record: the `op` field of format 2.0.
enum class BagOp : std::uint8_t {
  kMessage = 2,
  kFileHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

/// Named values of a header; the views point into the bytes that were read.
using BagFields = std::map<std::string_view, std::string_view>;

/// Fields written one after the other; nullopt when they do not fill `bytes` exactly.
std::optional<BagFields> parseFields(std::string_view bytes);

/// One record of a bag's file: header fields, and the data as far as the file holds them.
struct BagRecord {
  BagOp op = BagOp::kMessage;
  BagFields fields;
  std::string_view data;          ///< the bytes of it that exist
  std::uint64_t data_begin = 0;   ///< offset in the bytes
  std::uint64_t data_length = 0;  ///< as written; more than `data` holds when the bytes end before

  bool whole() const { return data.size() == data_length; }
  /// Offset after the record.
  std::uint64_t end() const { return data_begin + data_length; }
};

/// The record at an offset; nullopt when there is none.
std::optional<BagRecord> parseRecord(std::string_view bytes, std::uint64_t offset);

/// Offset of the first chunk record at `from` or later, found by its header's form; nullopt when
/// there is none.
std::optional<std::uint64_t> findChunk(std::string_view bytes, std::uint64_t from);

/// Little-endian number that fills a field; nullopt when the field is missing or of another size.
std::optional<std::uint32_t> numberIn(const BagFields& fields, std::string_view name);
std::optional<std::uint64_t> longNumberIn(const BagFields& fields, std::string_view name);
/// Text of a field; empty when it is missing.
std::string_view textIn(const BagFields& fields, std::string_view name);

// The records of a chunk of a bag, decompressed (none, lz4 or bz2).

/// The decompressed content of a chunk.
struct ChunkText {
  std::string bytes;
  std::string fault;  ///< why the chunk is not whole; empty when it is
};

/// `size` is what the chunk's header says it holds, 0 when its recording was cut off: no more than
/// that is decompressed, and at most 512 MiB. Data that end early give the whole blocks before the
/// end (rosbag writes a chunk as one lz4 block), wrong data (checksum, format) nothing; what lies
/// behind their end does not matter.
ChunkText decompressChunk(std::string_view compression, std::string_view data, std::uint64_t size);

}  // namespace cdiff::node_graph
