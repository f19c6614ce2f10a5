// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/dataset.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/file.h"
#include "core/json_file.h"
#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "learning/samples/driving_sample.h"
#include "learning/samples/field.h"

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
  core::requireShallowJson(text, source);
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

namespace fs = std::filesystem;

void ShardWriter::append(const Sample& sample) {
  header_.schema.check(sample);
  for (const FieldSpec& field : header_.schema.fields)
    putField(body_, field, sample.fields.at(field.name));
  ++header_.samples;
}

std::string ShardWriter::take(const std::map<std::string, std::string>& facts) {
  header_.facts = facts;
  std::string content(kind_.magic);
  putValue(content, kShardVersion);
  putText(content, headerText(header_));
  content += body_;
  content += core::sha256(content);
  body_.clear();
  header_.samples = 0;
  return content;
}

void ShardWriter::write(const fs::path& path, const std::map<std::string, std::string>& facts) {
  core::writeOwnFile(path, take(facts));
}

ShardReader::ShardReader(const fs::path& path, const ShardKind& kind)
    : ShardReader(core::readFile(path, kind.name),
                  std::string(kind.name) + " '" + path.string() + "'", kind) {}

ShardReader::ShardReader(std::string content, std::string name, const ShardKind& kind)
    : name_(std::move(name)), content_(std::move(content)) {
  const std::string_view start = std::string_view(content_).substr(0, kind.magic.size());
  if (start != kind.magic.substr(0, start.size()))
    throw InputError(name_ + ": is not a " + kind.name);
  if (content_.size() < kind.magic.size() + 8 + core::kSha256Digits)
    throw InputError(name_ + ": truncated: " + std::to_string(content_.size()) + " bytes");
  ByteReader reader(content_, name_, kind.magic.size());
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
    if (reader.place() == places_.back()) break;  // a sample without bytes: no progress
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

std::vector<fs::path> findDataFiles(const fs::path& folder, const std::string& extension) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == extension) files.push_back(entry->path());
  }
  if (error) throw InputError("data folder '" + folder.string() + "': " + error.message());
  if (files.empty())
    throw InputError("data folder '" + folder.string() + "' holds no *" + extension);
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> findShards(const fs::path& folder) { return findDataFiles(folder, ".shard"); }

namespace {

/// Sessions whose draw lies below the share. Where that is none of several, the one with the lowest
/// draw is held out; where it is all of them, the one with the highest draw is not.
std::set<std::uint64_t> drawHeldOut(const std::set<std::uint64_t>& sessions, double share) {
  const core::RandomStream stream(0, "validation sessions");
  const auto draw = [&](std::uint64_t session) { return stream.uniform({session}, 0); };
  const auto lower = [&](std::uint64_t a, std::uint64_t b) { return draw(a) < draw(b); };
  std::set<std::uint64_t> held_out;
  for (const std::uint64_t session : sessions) {
    if (draw(session) < share) held_out.insert(session);
  }
  if (sessions.size() < 2 || share <= 0.0) return held_out;
  if (held_out.empty()) held_out.insert(*std::min_element(sessions.begin(), sessions.end(), lower));
  if (held_out.size() == sessions.size())
    held_out.erase(*std::max_element(sessions.begin(), sessions.end(), lower));
  return held_out;
}

}  // namespace

namespace {

std::vector<ShardReader> readShards(const fs::path& folder) {
  std::vector<ShardReader> shards;
  for (const fs::path& path : findShards(folder)) shards.emplace_back(path);
  return shards;
}

}  // namespace

Dataset::Dataset(const fs::path& folder, double validation_share)
    : Dataset(readShards(folder), "data folder '" + folder.string() + "'", validation_share) {}

Dataset::Dataset(std::vector<ShardReader> shards, std::string name, double validation_share,
                 std::string unit)
    : name_(std::move(name)), unit_(std::move(unit)), shards_(std::move(shards)) {
  addShards();
  split(validation_share);
}

void Dataset::addShards() {
  core::Sha256 digest;
  for (std::size_t i = 0; i < shards_.size(); ++i) {
    const ShardReader& shard = shards_[i];
    if (i == 0) schema_ = shard.schema();
    if (!(shard.schema() == schema_)) {
      throw InputError(shard.name() + ": its schema " + shard.schema().toJson() +
                       " is not that of the first shard, " + schema_.toJson());
    }
    digest.update(shard.sha256());
    addSamples(i);
  }
  sha256_ = digest.finish();
  if (places_.empty()) {
    throw InputError(
        name_ + ": its shards hold no samples; collect longer sessions (cdiff collect --duration)");
  }
}

void Dataset::addSamples(std::size_t number) {
  const ShardReader& shard = shards_[number];
  FieldNames others;
  for (const FieldSpec& field : schema_.fields) others.insert(field.name);
  if (others.erase(kSessionField) == 0 || schema_.find(kSessionField)->type != FieldType::kU64 ||
      !schema_.find(kSessionField)->shape.empty()) {
    throw InputError(name_ + ": its samples lack the field '" + kSessionField +
                     "' (one u64), by which training and validation are parted; whoever writes "
                     "the shards must store it");
  }
  for (std::size_t i = 0; i < shard.size(); ++i) {
    const Sample sample = shard.sample(i, others);
    places_.push_back({number, i, sample.get<std::vector<std::uint64_t>>(kSessionField).at(0)});
  }
}

void Dataset::split(double validation_share) {
  std::set<std::uint64_t> all;
  for (const Place& place : places_) all.insert(place.session);
  const std::set<std::uint64_t> held_out = drawHeldOut(all, validation_share);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    (held_out.count(places_[i].session) != 0 ? validation_ : training_).push_back(i);
  }
  sessions_ = all.size();
  validation_sessions_ = held_out.size();
  if (validation_share <= 0.0) validation_ = training_;
  if (!training_.empty() && !validation_.empty()) return;
  throw InputError(
      "data: of " + std::to_string(sessions_) + " " + unit_ + " with " +
      std::to_string(places_.size()) + " samples, " + std::to_string(validation_sessions_) +
      " are held out; both parts need one (more " + unit_ + ", or validation share 0)");
}

Sample Dataset::sample(std::size_t index, const FieldNames& left_out) const {
  return shards_[places_.at(index).shard].sample(places_[index].index, left_out);
}

}  // namespace cdiff::learning
