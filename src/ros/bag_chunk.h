// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The records of a chunk of a bag, decompressed (none, lz4 or bz2).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace cdiff::ros {

struct ChunkText {
  std::string bytes;
  std::string fault;  ///< why the chunk is not whole; empty when it is
};

/// `size` is what the chunk's header says it holds, 0 when its recording was cut off; compressed
/// data know it themselves. Data that end early give the whole blocks before the end (rosbag writes
/// a chunk as one lz4 block), wrong data (checksum,
/// format) nothing; what lies behind their end does not matter.
ChunkText decompressChunk(std::string_view compression, std::string_view data, std::uint64_t size);

}  // namespace cdiff::ros
