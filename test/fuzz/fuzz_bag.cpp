// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The records and chunks of a bag are read as far as they can be: nothing is thrown, whatever the
// bytes are.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "node_graph/bags/bag_records.h"

using namespace cdiff::node_graph;

namespace {

void readChunk(const BagRecord& record) {
  constexpr std::uint64_t kLargest = 1 << 20;  // [byte]; more takes memory alone
  const std::uint64_t size = numberIn(record.fields, "size").value_or(0);
  const ChunkText text =
      decompressChunk(textIn(record.fields, "compression"), record.data, size % kLargest);
  for (std::uint64_t at = 0; const auto inner = parseRecord(text.bytes, at);) at = inner->end();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  std::uint64_t at = 0;
  while (const auto record = parseRecord(bytes, at)) {
    if (record->op == BagOp::kChunk) readChunk(*record);
    at = record->end();
  }
  if (const auto chunk = findChunk(bytes, at)) parseRecord(bytes, *chunk);
  return 0;
}
