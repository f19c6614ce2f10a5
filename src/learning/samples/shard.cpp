// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/shard.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "learning/samples/driving_sample.h"
#include "learning/samples/field_bytes.h"

namespace cdiff::learning {
namespace {

using core::InputError;
using nlohmann::json;

}  // namespace

std::string headerText(const ShardHeader& header) {
  return json{{"fields", json::parse(header.schema.toJson())},
              {"samples", header.samples},
              {"facts", header.facts}}
      .dump();
}

ShardHeader readShardHeader(std::uint32_t version, const std::string& text,
                            const std::string& source) {
  if (version < 1 || version > kShardVersion) {
    throw InputError(source + ": version " + std::to_string(version) +
                     ", this program reads 1 to " + std::to_string(kShardVersion));
  }
  const char* const schema_key = version == 1 ? "schema" : "fields";
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object() || !object.contains(schema_key) || !object.contains("samples") ||
      !object["samples"].is_number_unsigned()) {
    throw InputError(source + ": the header is not JSON with '" + schema_key + "' and 'samples'");
  }
  const std::string schema = object[schema_key].dump();
  ShardHeader header;
  header.schema = version == 1 ? DrivingSchema::fromJson(schema, source).fields()
                               : SampleSchema::fromJson(schema, source);
  header.samples = object["samples"].get<std::size_t>();
  if (!object.contains("facts") || !object["facts"].is_object()) return header;
  for (const auto& [key, value] : object["facts"].items())
    header.facts[key] = value.is_string() ? value.get<std::string>() : value.dump();
  return header;
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kShardMagic = "CDIFFSHD";

}  // namespace

void ShardWriter::append(const Sample& sample) {
  header_.schema.check(sample);
  for (const FieldSpec& field : header_.schema.fields)
    putField(body_, field, sample.fields.at(field.name));
  ++header_.samples;
}

void ShardWriter::write(const fs::path& path, const std::map<std::string, std::string>& facts) {
  header_.facts = facts;
  std::string content(kShardMagic);
  putValue(content, kShardVersion);
  putText(content, headerText(header_));
  content += body_;
  content += core::sha256(content);
  core::writeFileAtomically(path, content);
  body_.clear();
  header_.samples = 0;
}

ShardReader::ShardReader(const fs::path& path)
    : name_("shard '" + path.string() + "'"), content_(core::readFile(path, "shard")) {
  if (content_.size() < kShardMagic.size() + 8 + core::kSha256Digits)
    throw InputError(name_ + ": truncated: " + std::to_string(content_.size()) + " bytes");
  ByteReader reader(content_, name_);
  if (reader.take(kShardMagic.size()) != kShardMagic) throw InputError(name_ + ": is not a shard");
  const auto version = reader.value<std::uint32_t>();
  header_ = readShardHeader(version, std::string(reader.text()), name_);
  const std::size_t begin = reader.place();
  sha256_ = content_.substr(content_.size() - core::kSha256Digits);
  content_.resize(content_.size() - core::kSha256Digits);
  findSamples(begin);
  if (core::sha256(content_) != sha256_)
    throw InputError(name_ + ": the checksum at its end is not that of its content");
}

void ShardReader::findSamples(std::size_t begin) {
  ByteReader reader(content_, name_, std::min(begin, content_.size()));
  while (!reader.atEnd() && places_.size() < header_.samples) {
    places_.push_back(reader.place());
    const std::string sample = name_ + ": sample " + std::to_string(places_.size() - 1);
    for (const FieldSpec& field : header_.schema.fields) {
      if (field.packed) {
        skipField(reader, field);
      } else {
        requireFinite(field, takeField(reader, field, name_), sample);
      }
    }
    if (reader.place() == places_.back()) break;  // fields without a byte
  }
  if (places_.size() == header_.samples && reader.atEnd()) return;
  throw InputError(name_ + ": truncated or overlong: " + std::to_string(places_.size()) + " of " +
                   std::to_string(header_.samples) + " samples, then " +
                   std::to_string(content_.size() - reader.place()) + " bytes");
}

Sample ShardReader::sample(std::size_t index, const FieldNames& left_out) const {
  const std::string name = name_ + ", sample " + std::to_string(index);
  ByteReader reader(content_, name, places_.at(index));
  Sample sample;
  for (const FieldSpec& field : header_.schema.fields) {
    if (left_out.count(field.name) != 0) {
      skipField(reader, field);
    } else {
      sample.fields.emplace(field.name, takeField(reader, field, name));
    }
  }
  return sample;
}

std::vector<fs::path> findShards(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> shards;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".shard") shards.push_back(entry->path());
  }
  if (error) throw InputError("data folder '" + folder.string() + "': " + error.message());
  if (shards.empty()) throw InputError("data folder '" + folder.string() + "' holds no *.shard");
  std::sort(shards.begin(), shards.end());
  return shards;
}

}  // namespace cdiff::learning
