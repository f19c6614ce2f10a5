// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/bag_records.h"

#include <algorithm>
#include <cstring>

namespace cdiff::ros {
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
  constexpr std::uint64_t kFarthest = 64;  // [bytes] from the header's begin to its op
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

}  // namespace cdiff::ros
