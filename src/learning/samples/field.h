// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::learning {

// Samples as sets of named, typed fields, and the schema that says which fields the samples of a
// shard have. Whoever collects or trains decides on the fields; what stores them knows none.

/// Type of each value; the order is that of the alternatives of FieldValue.
enum class FieldType { kU8, kU64, kF32, kF64, kText };

/// Values row by row; of a text, its bytes.
using FieldValue = std::variant<std::vector<std::uint8_t>, std::vector<std::uint64_t>,
                                std::vector<float>, std::vector<double>, std::string>;

/// First size of a shape where each sample has its own number of rows (boxes, lanes).
constexpr std::int64_t kAnyCount = -1;

/// Most values of a field in one sample.
constexpr std::int64_t kMostValues = 1 << 26;

/// Name, type and shape of a field of a sample.
struct FieldSpec {
  FieldSpec() = default;
  FieldSpec(std::string name, FieldType type, std::vector<std::int64_t> shape = {});

  std::string name;
  FieldType type = FieldType::kF32;
  std::vector<std::int64_t> shape;   ///< empty: one value, or a text
  bool packed = false;               ///< compressed, and read only where it is asked for (images)
  bool finite = true;                ///< refuses values that are not finite
  std::vector<std::string> columns;  ///< names along the last axis; empty: none
  std::map<std::string, double> numbers;  ///< what readers need to know, such as "spacing" [m]

  bool anyCount() const { return !shape.empty() && shape.front() == kAnyCount; }
  /// Values of one row where each sample has its own number of rows, else of the whole field.
  std::size_t values() const;
};

/// One sample: its fields by name.
struct Sample {
  std::map<std::string, FieldValue> fields;

  /// The values of a field; throws InputError where there is none of this name and type.
  template <class Values>
  const Values& get(const std::string& name) const {
    const auto found = fields.find(name);
    const Values* values = found == fields.end() ? nullptr : std::get_if<Values>(&found->second);
    if (values == nullptr)
      throw core::InputError("sample: has no field '" + name + "' of the type asked for");
    return *values;
  }
};

/// The fields of every sample of a shard, in the order in which they are stored.
struct SampleSchema {
  std::vector<FieldSpec> fields;

  /// nullptr: none of this name.
  const FieldSpec* find(const std::string& name) const;
  /// "a, b, c".
  std::string names() const;
  /// Throws InputError naming the first field of `sample` that is missing, unknown, of another type
  /// or count, or not finite.
  void check(const Sample& sample) const;
  /// As a JSON list and back; throws InputError naming `source`, the field and what is wrong.
  std::string toJson() const;
  static SampleSchema fromJson(const std::string& text, const std::string& source);
};

bool operator==(const FieldSpec& left, const FieldSpec& right);
bool operator==(const SampleSchema& left, const SampleSchema& right);

/// Throws InputError naming `source` and the field that is not finite, though its schema asks that.
void requireFinite(const FieldSpec& spec, const FieldValue& value, const std::string& source);

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

// Fields as the bytes of a shard (learning/samples/dataset.h) and back.

/// Appends a value that fits its schema.
void putField(std::string& bytes, const FieldSpec& spec, const FieldValue& value);
/// Reads forward over a field, and gives its value. Throws InputError naming `source` when a packed
/// field says more values than a sample can hold, or does not unpack to its size.
FieldValue takeField(ByteReader& reader, const FieldSpec& spec, const std::string& source);
/// Reads forward over a field.
void skipField(ByteReader& reader, const FieldSpec& spec);

}  // namespace cdiff::learning
