// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/bag_chunk.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <memory>
#include <vector>

namespace cdiff::ros {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;        // [bytes]
constexpr std::uint64_t kLargest = std::uint64_t{1} << 31;  // [bytes] of a chunk
constexpr const char* kCut = "it ends before its last byte";

/// A fault that leaves nothing of the chunk.
ChunkText refused(const std::string& fault) { return {{}, fault}; }

struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

ChunkText decompressLz4(std::string_view data) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)))
    return refused("there is no memory to decompress it");
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(made);
  std::vector<char> piece(kPiece);
  ChunkText text;
  std::size_t wanted = 1;
  while (wanted != 0 && text.bytes.size() <= kLargest) {
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

ChunkText decompressBz2(std::string_view data) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK)
    return refused("there is no memory to decompress it");
  const std::unique_ptr<bz_stream, EndBz2> end(&stream);
  std::vector<char> piece(kPiece);
  stream.next_in = const_cast<char*>(data.data());  // the library does not write there
  stream.avail_in = static_cast<unsigned int>(data.size());
  ChunkText text;
  while (text.bytes.size() <= kLargest) {
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
  ChunkText text = compression == "lz4" ? decompressLz4(data) : decompressBz2(data);
  return text.bytes.size() > kLargest ? refused("it holds more than 2 GiB") : text;
}

}  // namespace cdiff::ros
