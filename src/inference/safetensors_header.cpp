// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/safetensors_header.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "e2e_cdiff/core/exceptions.h"
#include "inference/strict_json.h"

namespace cdiff::inference {

void failOn(const std::string& source, const std::string& what) {
  throw core::InputError(source + ": " + what);
}

namespace {

/// A size or an offset: an integer from 0 to 2^63 - 1.
std::uint64_t naturalOf(const Json& value, const std::string& where) {
  if (!value.is_number_integer()) {
    throw core::InputError(where + " is " + kindOf(value) + "; an integer was expected");
  }
  constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kLargest) {
    throw core::InputError(where + " is " + value.dump() + "; 0 to 2^63 - 1 was expected");
  }
  return value.get<std::uint64_t>();
}

const Json& memberOf(const Json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end()) throw core::InputError(where + " lacks the key '" + key + "'");
  return *found;
}

TensorType typeOf(const Json& value, const std::string& where) {
  if (value == "F16") return TensorType::kF16;
  if (value == "F32") return TensorType::kF32;
  throw core::InputError(where + ": dtype is " + excerpt(value.dump()) +
                         "; F16 or F32 was expected");
}

const Json& arrayOf(const Json& object, const char* key, const std::string& where) {
  const Json& array = memberOf(object, key, where);
  if (!array.is_array()) {
    throw core::InputError(where + ": " + key + " is " + kindOf(array) + "; an array was expected");
  }
  return array;
}

/// Bytes of a tensor; throws when they exceed 2^64 - 1.
std::uint64_t sizeInBytes(const TensorEntry& entry, const std::string& where) {
  std::uint64_t bytes = bytesOf(entry.type);
  for (const std::int64_t size : entry.shape) {
    if (__builtin_mul_overflow(bytes, static_cast<std::uint64_t>(size), &bytes)) {
      throw core::InputError(where + ": the size of shape " + shapeText(entry.shape) +
                             " overflows 64 bits");
    }
  }
  return bytes;
}

void readOffsets(const Json& object, TensorEntry& entry, const std::string& where) {
  const Json& offsets = arrayOf(object, "data_offsets", where);
  if (offsets.size() != 2) {
    throw core::InputError(where + ": data_offsets has " + std::to_string(offsets.size()) +
                           " elements; [begin, end] was expected");
  }
  entry.begin = naturalOf(offsets[0], where + ": data_offsets' begin");
  entry.end = naturalOf(offsets[1], where + ": data_offsets' end");
  if (entry.begin > entry.end) {
    throw core::InputError(where + ": data_offsets begin at " + std::to_string(entry.begin) +
                           " and end before, at " + std::to_string(entry.end));
  }
  const std::uint64_t expected = sizeInBytes(entry, where);
  if (entry.end - entry.begin != expected) {
    throw core::InputError(where + ": data_offsets span " +
                           std::to_string(entry.end - entry.begin) + " bytes; shape " +
                           shapeText(entry.shape) + " and dtype need " + std::to_string(expected));
  }
}

TensorEntry entryOf(const std::string& name, const Json& object, const std::string& source) {
  const std::string where = source + ": tensor '" + name + "'";
  if (!object.is_object()) {
    throw core::InputError(where + " is " + kindOf(object) + "; an object was expected");
  }
  for (const auto& item : object.items()) {
    if (item.key() != "dtype" && item.key() != "shape" && item.key() != "data_offsets") {
      throw core::InputError(where + " has a foreign key '" + item.key() +
                             "'; dtype, shape and data_offsets were expected");
    }
  }
  TensorEntry entry;
  entry.name = name;
  entry.type = typeOf(memberOf(object, "dtype", where), where);
  for (const Json& size : arrayOf(object, "shape", where)) {
    entry.shape.push_back(
        static_cast<std::int64_t>(naturalOf(size, where + ": an element of shape")));
  }
  readOffsets(object, entry, where);
  return entry;
}

std::map<std::string, std::string> metadataOf(const Json& object, const std::string& source) {
  if (!object.is_object()) {
    failOn(source,
           std::string(kMetadataKey) + " is " + kindOf(object) + "; an object was expected");
  }
  std::map<std::string, std::string> metadata;
  for (const auto& item : object.items()) {
    if (!item.value().is_string()) {
      failOn(source, "metadata '" + item.key() + "' is " + kindOf(item.value()) +
                         "; a string was expected");
    }
    metadata[item.key()] = item.value().get<std::string>();
  }
  return metadata;
}

/// Sorts the entries as they lie in the data section and checks that they fill it exactly.
void arrange(std::vector<TensorEntry>& entries, std::uint64_t data_size,
             const std::string& source) {
  std::sort(entries.begin(), entries.end(), [](const TensorEntry& a, const TensorEntry& b) {
    return std::tie(a.begin, a.end, a.name) < std::tie(b.begin, b.end, b.name);
  });
  std::uint64_t end = 0;
  for (const TensorEntry& entry : entries) {
    if (entry.begin != end) {
      const bool overlap = entry.begin < end;
      failOn(source, "tensor '" + entry.name + "' begins at byte " + std::to_string(entry.begin) +
                         (overlap ? ", an overlap with" : ", a gap after") +
                         " the tensor before, which ends at " + std::to_string(end));
    }
    end = entry.end;
  }
  if (end > data_size) {
    failOn(source, "truncated: the tensors need " + std::to_string(end) +
                       " bytes after the header, the file has " + std::to_string(data_size));
  }
  if (end < data_size) {
    failOn(source, std::to_string(data_size - end) + " trailing bytes after the last tensor");
  }
}

}  // namespace

SafetensorsHeader parseHeader(std::string_view text, std::uint64_t data_size,
                              const std::string& source) {
  const Json json = parseStrictJson(text, source + ": the header");
  if (!json.is_object()) {
    failOn(source, "the header is " + kindOf(json) + "; a JSON object was expected");
  }
  SafetensorsHeader header;
  for (const auto& item : json.items()) {
    if (item.key() == kMetadataKey) {
      header.metadata = metadataOf(item.value(), source);
    } else {
      header.entries.push_back(entryOf(item.key(), item.value(), source));
    }
  }
  arrange(header.entries, data_size, source);
  return header;
}

void requireExpected(const SafetensorsHeader& header, const std::vector<TensorShape>& expected,
                     const std::string& source) {
  std::map<std::string, const TensorEntry*> present;
  for (const TensorEntry& entry : header.entries) present[entry.name] = &entry;
  for (const TensorShape& tensor : expected) {
    const auto found = present.find(tensor.name);
    if (found == present.end()) {
      failOn(source, "missing tensor '" + tensor.name + "' of shape " + shapeText(tensor.shape));
    }
    if (found->second->shape != tensor.shape) {
      failOn(source, "tensor '" + tensor.name + "' has shape " + shapeText(found->second->shape) +
                         "; " + shapeText(tensor.shape) + " was expected");
    }
    present.erase(found);
  }
  if (!present.empty()) failOn(source, "unknown tensor '" + present.begin()->first + "'");
}

std::uint64_t bytesOf(TensorType type) { return type == TensorType::kF16 ? 2 : 4; }

std::string shapeText(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    text += (i == 0 ? "" : ", ") + std::to_string(shape[i]);
  }
  return text + "]";
}

}  // namespace cdiff::inference
