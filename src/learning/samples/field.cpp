// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/field.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "core/text.h"

namespace cdiff::learning {
namespace {

using core::InputError;
using nlohmann::json;

constexpr const char* kTypeNames[] = {"u8", "u64", "f32", "f64", "text"};

std::size_t countOf(const FieldValue& value) {
  return std::visit([](const auto& values) { return values.size(); }, value);
}

bool allFinite(const FieldValue& value) {
  const auto finite = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](auto each) { return std::isfinite(each); });
  };
  if (const auto* floats = std::get_if<std::vector<float>>(&value)) return finite(*floats);
  if (const auto* doubles = std::get_if<std::vector<double>>(&value)) return finite(*doubles);
  return true;
}

void checkCount(const FieldSpec& spec, std::size_t found) {
  if (spec.type == FieldType::kText) return;
  const std::size_t expected = spec.values();
  if (spec.anyCount() ? found % expected == 0 : found == expected) return;
  throw InputError("sample: field '" + spec.name + "' holds " + std::to_string(found) +
                   " values, the schema says " + (spec.anyCount() ? "a multiple of " : "") +
                   std::to_string(expected));
}

FieldType typeIn(const json& entry, const std::string& where) {
  for (std::size_t i = 0; i < std::size(kTypeNames); ++i) {
    if (entry.value("type", json()) == kTypeNames[i]) return static_cast<FieldType>(i);
  }
  throw InputError(where + ": 'type' must be u8, u64, f32, f64 or text");
}

/// Sizes from 0; the first may be kAnyCount, and then no other is 0.
void checkShape(const FieldSpec& spec, const std::string& where) {
  std::int64_t values = 1;
  for (std::size_t i = 0; i < spec.shape.size(); ++i) {
    const bool any = i == 0 && spec.anyCount();
    const std::int64_t least = spec.anyCount() ? 1 : 0;
    if (!any && (spec.shape[i] < least || spec.shape[i] > kMostValues))
      throw InputError(where + ": 'shape' holds the size " + std::to_string(spec.shape[i]));
    if (!any) values *= spec.shape[i];
    if (values > kMostValues) throw InputError(where + ": 'shape' is too large");
  }
  if (spec.type == FieldType::kText && (!spec.shape.empty() || spec.packed))
    throw InputError(where + ": a text has neither shape nor packing");
}

FieldSpec specIn(const json& entry, const std::string& source) {
  if (!entry.is_object() || !entry.value("name", json()).is_string())
    throw InputError(source + ": each field of the schema must be an object with a 'name'");
  FieldSpec spec;
  spec.name = entry.at("name").get<std::string>();
  const std::string where = source + ": field '" + spec.name + "'";
  spec.type = typeIn(entry, where);
  try {
    spec.shape = entry.value("shape", spec.shape);
    spec.packed = entry.value("packed", spec.packed);
    spec.finite = entry.value("finite", spec.finite);
    spec.columns = entry.value("columns", spec.columns);
    spec.numbers = entry.value("numbers", spec.numbers);
  } catch (const json::exception&) {
    throw InputError(where + ": 'shape', 'packed', 'finite', 'columns' or 'numbers' is malformed");
  }
  checkShape(spec, where);
  return spec;
}

}  // namespace

FieldSpec::FieldSpec(std::string field_name, FieldType field_type,
                     std::vector<std::int64_t> field_shape)
    : name(std::move(field_name)), type(field_type), shape(std::move(field_shape)) {}

std::size_t FieldSpec::values() const {
  std::size_t count = 1;
  for (std::size_t i = anyCount() ? 1 : 0; i < shape.size(); ++i)
    count *= static_cast<std::size_t>(shape[i]);
  return count;
}

const FieldSpec* SampleSchema::find(const std::string& name) const {
  for (const FieldSpec& field : fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

std::string SampleSchema::names() const {
  std::vector<std::string> all;
  for (const FieldSpec& field : fields) all.push_back(field.name);
  return core::joinText(all, ", ");
}

void SampleSchema::check(const Sample& sample) const {
  for (const FieldSpec& field : fields) {
    const auto found = sample.fields.find(field.name);
    if (found == sample.fields.end())
      throw InputError("sample: field '" + field.name + "' of the schema is missing");
    if (found->second.index() != static_cast<std::size_t>(field.type)) {
      throw InputError("sample: field '" + field.name + "' has another type than " +
                       kTypeNames[static_cast<std::size_t>(field.type)]);
    }
    checkCount(field, countOf(found->second));
    requireFinite(field, found->second, "sample");
  }
  for (const auto& entry : sample.fields) {
    if (find(entry.first) == nullptr)
      throw InputError("sample: field '" + entry.first + "' is not in the schema");
  }
}

std::string SampleSchema::toJson() const {
  json list = json::array();
  for (const FieldSpec& field : fields) {
    list.push_back({{"name", field.name},
                    {"type", kTypeNames[static_cast<std::size_t>(field.type)]},
                    {"shape", field.shape},
                    {"packed", field.packed},
                    {"finite", field.finite},
                    {"columns", field.columns},
                    {"numbers", field.numbers}});
  }
  return list.dump();
}

SampleSchema SampleSchema::fromJson(const std::string& text, const std::string& source) {
  const json list = json::parse(text, nullptr, false);
  if (!list.is_array()) throw InputError(source + ": the schema is not a list of fields");
  SampleSchema schema;
  std::set<std::string> names;
  for (const json& entry : list) {
    schema.fields.push_back(specIn(entry, source));
    if (!names.insert(schema.fields.back().name).second)
      throw InputError(source + ": field '" + schema.fields.back().name + "' comes twice");
  }
  return schema;
}

bool operator==(const FieldSpec& left, const FieldSpec& right) {
  const auto parts = [](const FieldSpec& spec) {
    return std::tie(spec.name, spec.type, spec.shape, spec.packed, spec.finite, spec.columns,
                    spec.numbers);
  };
  return parts(left) == parts(right);
}

bool operator==(const SampleSchema& left, const SampleSchema& right) {
  return left.fields == right.fields;
}

void requireFinite(const FieldSpec& spec, const FieldValue& value, const std::string& source) {
  if (spec.finite && !allFinite(value))
    throw InputError(source + ": field '" + spec.name + "' is not finite");
}

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
