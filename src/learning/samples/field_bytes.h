// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/field.h"

namespace cdiff::learning {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the files are little endian");

template <class Value>
void putValue(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

inline void putText(std::string& bytes, std::string_view text) {
  putValue(bytes, static_cast<std::uint32_t>(text.size()));
  bytes.append(text);
}

/// Numbers and texts as bytes (little endian hosts only) and back, with a check of what is left.
/// Reads forward through bytes that it does not own.
class ByteReader {
 public:
  /// `what` starts the text of errors: the file.
  ByteReader(std::string_view bytes, std::string what, std::size_t begin = 0)
      : bytes_(bytes), what_(std::move(what)), place_(begin) {}

  template <class Value>
  Value value() {
    static_assert(std::is_trivially_copyable_v<Value>);
    Value result;
    const std::string_view part = take(sizeof(Value));
    std::memcpy(&result, part.data(), sizeof(Value));
    return result;
  }

  std::string_view take(std::size_t count) {
    if (count > bytes_.size() - place_) {
      throw core::InputError(what_ + ": truncated at byte " + std::to_string(place_) + ": " +
                             std::to_string(count) + " bytes expected, " +
                             std::to_string(bytes_.size() - place_) + " left");
    }
    const std::string_view part = bytes_.substr(place_, count);
    place_ += count;
    return part;
  }

  std::string_view text() { return take(value<std::uint32_t>()); }
  std::size_t place() const { return place_; }
  bool atEnd() const { return place_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  std::string what_;
  std::size_t place_;
};

// Fields as the bytes of a shard (learning/samples/shard.h) and back.

/// Appends a value that fits its schema.
void putField(std::string& bytes, const FieldSpec& spec, const FieldValue& value);
/// Reads forward over a field, and gives its value. Throws InputError naming `source` when a packed
/// field says more values than a sample can hold, or does not unpack to its size.
FieldValue takeField(ByteReader& reader, const FieldSpec& spec, const std::string& source);
/// Reads forward over a field.
void skipField(ByteReader& reader, const FieldSpec& spec);

}  // namespace cdiff::learning
