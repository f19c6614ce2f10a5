// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/bag_records.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

namespace cdiff::node_graph {
namespace {

constexpr std::uint64_t kLongestHeader = 1 << 16;  // [bytes] real ones have less than 100

/// Little-endian, as the format and every machine that this runs on have it.
template <class Number>
std::optional<Number> numberAt(std::string_view bytes, std::uint64_t offset) {
  if (bytes.size() < sizeof(Number) || offset > bytes.size() - sizeof(Number)) return std::nullopt;
  Number number = 0;
  std::memcpy(&number, bytes.data() + offset, sizeof(Number));
  return number;
}

template <class Number>
std::optional<Number> numberOf(const BagFields& fields, std::string_view name) {
  const std::string_view text = textIn(fields, name);
  return text.size() == sizeof(Number) ? numberAt<Number>(text, 0) : std::nullopt;
}

bool isChunk(std::string_view bytes, std::uint64_t offset) {
  const auto record = parseRecord(bytes, offset);
  return record && record->op == BagOp::kChunk && numberIn(record->fields, "size") &&
         !textIn(record->fields, "compression").empty();
}

std::optional<BagOp> opOf(const BagFields& fields) {
  const std::string_view op = textIn(fields, "op");
  if (op.size() != 1) return std::nullopt;
  const auto value = static_cast<std::uint8_t>(op.front());
  const bool known = value >= static_cast<std::uint8_t>(BagOp::kMessage) &&
                     value <= static_cast<std::uint8_t>(BagOp::kConnection);
  return known ? std::optional(static_cast<BagOp>(value)) : std::nullopt;
}

}  // namespace

std::optional<BagFields> parseFields(std::string_view bytes) {
  BagFields fields;
  std::uint64_t offset = 0;
  while (offset < bytes.size()) {
    const auto length = numberAt<std::uint32_t>(bytes, offset);
    offset += sizeof(std::uint32_t);
    if (!length || *length > bytes.size() - offset) return std::nullopt;
    const std::string_view field = bytes.substr(offset, *length);
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    fields[field.substr(0, equals)] = field.substr(equals + 1);
    offset += *length;
  }
  return fields;
}

std::optional<BagRecord> parseRecord(std::string_view bytes, std::uint64_t offset) {
  const auto header_length = numberAt<std::uint32_t>(bytes, offset);
  if (!header_length || *header_length > kLongestHeader) return std::nullopt;
  const std::uint64_t header = offset + sizeof(std::uint32_t);
  const auto data_length = numberAt<std::uint32_t>(bytes, header + *header_length);
  if (!data_length) return std::nullopt;
  const auto fields = parseFields(bytes.substr(header, *header_length));
  if (!fields) return std::nullopt;
  const auto op = opOf(*fields);
  if (!op) return std::nullopt;
  BagRecord record{*op, *fields, {}, header + *header_length + sizeof(std::uint32_t), *data_length};
  record.data = bytes.substr(record.data_begin, *data_length);
  return record;
}

std::optional<std::uint64_t> findChunk(std::string_view bytes, std::uint64_t from) {
  constexpr std::string_view kOpField("\x04\x00\x00\x00op=\x05", 8);
  constexpr std::uint64_t kFarthest = 64;  // [bytes] from the header's start to its op
  const std::uint64_t first = from;
  std::uint64_t at = bytes.find(kOpField, from);
  for (; at != std::string_view::npos; at = bytes.find(kOpField, at + 1)) {
    const std::uint64_t begin = std::max(first, at > kFarthest ? at - kFarthest : 0);
    for (std::uint64_t start = begin; start + sizeof(std::uint32_t) <= at; ++start) {
      if (isChunk(bytes, start)) return start;
    }
  }
  return std::nullopt;
}

std::optional<std::uint32_t> numberIn(const BagFields& fields, std::string_view name) {
  return numberOf<std::uint32_t>(fields, name);
}

std::optional<std::uint64_t> longNumberIn(const BagFields& fields, std::string_view name) {
  return numberOf<std::uint64_t>(fields, name);
}

std::string_view textIn(const BagFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string_view() : found->second;
}

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;             // [bytes]
constexpr std::uint64_t kLargestChunk = std::uint64_t{1} << 29;  // [bytes]; usual are some 10^6
constexpr const char* kCut = "it ends before its last byte";

/// A fault that leaves nothing of the chunk.
ChunkText refused(const std::string& fault) { return {{}, fault}; }

struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

ChunkText decompressLz4(std::string_view data, std::uint64_t most) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)))
    return refused("there is no memory to decompress it");
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(made);
  std::vector<char> piece(kPiece);
  ChunkText text;
  std::size_t wanted = 1;
  while (wanted != 0 && text.bytes.size() <= most) {
    std::size_t taken = data.size();
    std::size_t given = piece.size();
    wanted = LZ4F_decompress(context.get(), piece.data(), &given, data.data(), &taken, nullptr);
    if (LZ4F_isError(wanted)) return refused(std::string("lz4: ") + LZ4F_getErrorName(wanted));
    text.bytes.append(piece.data(), given);
    data.remove_prefix(taken);
    if (wanted != 0 && taken == 0 && given == 0) {
      text.fault = kCut;
      return text;
    }
  }
  return text;
}

struct EndBz2 {
  void operator()(bz_stream* stream) const { BZ2_bzDecompressEnd(stream); }
};

ChunkText decompressBz2(std::string_view data, std::uint64_t most) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK)
    return refused("there is no memory to decompress it");
  const std::unique_ptr<bz_stream, EndBz2> end(&stream);
  std::vector<char> piece(kPiece);
  stream.next_in = const_cast<char*>(data.data());  // the library does not write there
  stream.avail_in = static_cast<unsigned int>(data.size());
  ChunkText text;
  while (text.bytes.size() <= most) {
    stream.next_out = piece.data();
    stream.avail_out = static_cast<unsigned int>(piece.size());
    const int state = BZ2_bzDecompress(&stream);
    if (state != BZ_OK && state != BZ_STREAM_END)
      return refused("bz2: error " + std::to_string(state));
    const std::size_t given = piece.size() - stream.avail_out;
    text.bytes.append(piece.data(), given);
    if (state == BZ_STREAM_END) return text;
    if (given == 0 && stream.avail_in == 0) {
      text.fault = kCut;
      return text;
    }
  }
  return text;
}

/// Plain bytes have no end of their own.
ChunkText copyPlain(std::string_view data, std::uint64_t size) {
  if (size == 0 || data.size() == size) return {std::string(data), {}};
  return {std::string(data.substr(0, size)), data.size() < size ? kCut : ""};
}

}  // namespace

ChunkText decompressChunk(std::string_view compression, std::string_view data, std::uint64_t size) {
  if (compression == "none") return copyPlain(data, size);
  if (compression != "lz4" && compression != "bz2")
    return refused("it has the unknown compression '" + std::string(compression.substr(0, 20)) +
                   "'");
  const std::uint64_t most = size == 0 ? kLargestChunk : std::min(size, kLargestChunk);
  ChunkText text = compression == "lz4" ? decompressLz4(data, most) : decompressBz2(data, most);
  if (text.bytes.size() <= most) return text;
  text.bytes.resize(most);
  text.fault = "it goes on after " + std::to_string(most) + " bytes, " +
               (most == size ? "which its header says it holds" : "more than which is not read");
  return text;
}

}  // namespace cdiff::node_graph
