// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/field_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <new>

namespace cdiff::learning {
namespace {

constexpr int kCompression = 6;
constexpr std::size_t kValueBytes[] = {1, 8, 4, 8, 1};  // by FieldType

std::size_t valueBytes(const FieldSpec& spec) {
  return kValueBytes[static_cast<std::size_t>(spec.type)];
}

std::string_view bytesOf(const FieldValue& value) {
  return std::visit(
      [](const auto& values) {
        return std::string_view(reinterpret_cast<const char*>(values.data()),
                                values.size() * sizeof(values[0]));
      },
      value);
}

std::string compressed(std::string_view bytes) {
  uLongf length = compressBound(bytes.size());
  std::string result(length, '\0');
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &length,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), kCompression) != Z_OK)
    throw std::bad_alloc();
  result.resize(length);
  return result;
}

void unpack(std::string_view bytes, char* target, std::size_t expected, const std::string& what) {
  uLongf length = expected;
  const int code = ::uncompress(reinterpret_cast<Bytef*>(target), &length,
                                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  if (code == Z_OK && length == expected) return;
  throw core::InputError(what + " does not unpack to " + std::to_string(expected) + " bytes");
}

/// A value of the field's type with room for `count` values.
FieldValue emptyValue(FieldType type, std::size_t count) {
  switch (type) {
    case FieldType::kU8:
      return std::vector<std::uint8_t>(count);
    case FieldType::kU64:
      return std::vector<std::uint64_t>(count);
    case FieldType::kF32:
      return std::vector<float>(count);
    case FieldType::kF64:
      return std::vector<double>(count);
    case FieldType::kText:
      break;
  }
  return std::string(count, '\0');
}

char* dataOf(FieldValue& value) {
  return std::visit([](auto& values) { return reinterpret_cast<char*>(values.data()); }, value);
}

std::size_t takeCount(ByteReader& reader, const FieldSpec& spec) {
  return spec.anyCount() ? reader.value<std::uint32_t>() * spec.values() : spec.values();
}

}  // namespace

void putField(std::string& bytes, const FieldSpec& spec, const FieldValue& value) {
  const std::string_view content = bytesOf(value);
  if (spec.type == FieldType::kText) return putText(bytes, content);
  if (spec.anyCount()) {
    const std::size_t rows = content.size() / (valueBytes(spec) * spec.values());
    putValue(bytes, static_cast<std::uint32_t>(rows));
  }
  if (spec.packed) return putText(bytes, compressed(content));
  bytes.append(content);
}

FieldValue takeField(ByteReader& reader, const FieldSpec& spec, const std::string& source) {
  if (spec.type == FieldType::kText) return std::string(reader.text());
  const std::size_t count = takeCount(reader, spec);
  if (spec.packed && count > static_cast<std::size_t>(kMostValues)) {
    throw core::InputError(source + ": field '" + spec.name + "' says that it holds " +
                           std::to_string(count) + " values; at most " +
                           std::to_string(kMostValues) + " were expected");
  }
  const std::size_t length = count * valueBytes(spec);
  const std::string_view content = spec.packed ? reader.text() : reader.take(length);
  FieldValue value = emptyValue(spec.type, count);
  if (spec.packed) {
    unpack(content, dataOf(value), length, source + ": field '" + spec.name + "'");
  } else {
    std::copy(content.begin(), content.end(), dataOf(value));
  }
  return value;
}

void skipField(ByteReader& reader, const FieldSpec& spec) {
  if (spec.type == FieldType::kText) {
    reader.text();
    return;
  }
  const std::size_t count = takeCount(reader, spec);
  if (spec.packed) {
    reader.text();
  } else {
    reader.take(count * valueBytes(spec));
  }
}

}  // namespace cdiff::learning
