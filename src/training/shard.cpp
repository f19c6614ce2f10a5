// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "training/shard.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "training/bytes.h"

namespace cdiff::training {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using nlohmann::json;

constexpr std::string_view kMagic = "CDIFFSHD";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kDigestLength = 64;

std::string compressed(const std::vector<std::uint8_t>& bytes) {
  uLongf length = compressBound(bytes.size());
  std::string result(length, '\0');
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &length, bytes.data(), bytes.size(), 6) !=
      Z_OK)
    throw std::bad_alloc();
  result.resize(length);
  return result;
}

std::vector<std::uint8_t> unpacked(std::string_view bytes, std::size_t expected,
                                   const std::string& what) {
  std::vector<std::uint8_t> result(expected);
  uLongf length = expected;
  const int code = ::uncompress(result.data(), &length,
                                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  if (code != Z_OK || length != expected)
    throw InputError(what + ": the image does not unpack to " + std::to_string(expected) +
                     " bytes");
  return result;
}

void putFloats(std::string& bytes, const std::vector<float>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

std::vector<float> takeFloats(ByteReader& reader, std::int64_t count) {
  std::vector<float> values(static_cast<std::size_t>(count));
  const std::string_view part = reader.take(values.size() * sizeof(float));
  std::copy(part.begin(), part.end(), reinterpret_cast<char*>(values.data()));
  return values;
}

/// Reads one sample; the image stays empty, its compressed bytes go to `image`.
Sample takeSample(ByteReader& reader, const SampleSchema& schema, std::string_view& image) {
  Sample sample;
  sample.session = reader.value<std::uint64_t>();
  sample.tick = reader.value<std::uint64_t>();
  sample.speed = reader.value<double>();
  sample.recovering = reader.value<std::uint8_t>() != 0;
  sample.maneuver = reader.value<std::uint8_t>();
  sample.stop_reason = reader.value<std::uint8_t>();
  sample.vehicle = std::string(reader.text());
  const std::vector<float> rollout = takeFloats(reader, schema.horizon * traffic::kRolloutColumns);
  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, traffic::kRolloutColumns, Eigen::RowMajor>;
  sample.rollout =
      Eigen::Map<const Matrix>(rollout.data(), schema.horizon, Matrix::ColsAtCompileTime)
          .cast<double>();
  sample.route = takeFloats(reader, 2 * schema.route_points);
  sample.auxiliary = takeFloats(reader, static_cast<std::int64_t>(schema.auxiliary.size()));
  image = reader.text();
  return sample;
}

}  // namespace

void ShardWriter::append(const Sample& sample) {
  schema_.check(sample);
  putValue(body_, sample.session);
  putValue(body_, sample.tick);
  putValue(body_, sample.speed);
  putValue(body_, static_cast<std::uint8_t>(sample.recovering));
  putValue(body_, sample.maneuver);
  putValue(body_, sample.stop_reason);
  putText(body_, sample.vehicle);
  for (Eigen::Index i = 0; i < sample.rollout.size(); ++i)
    putValue(body_, static_cast<float>(sample.rollout.data()[i]));
  putFloats(body_, sample.route);
  putFloats(body_, sample.auxiliary);
  putText(body_, compressed(sample.image.rgb));
  ++samples_;
}

void ShardWriter::write(const fs::path& path, const std::map<std::string, std::string>& facts) {
  const std::string header = json{
      {"schema", json::parse(schema_.toJson())},
      {"samples", samples_},
      {"facts", facts}}.dump();
  std::string content(kMagic);
  putValue(content, kVersion);
  putText(content, header);
  content += body_;
  content += core::sha256(content);
  core::writeFileAtomically(path, content);
  body_.clear();
  samples_ = 0;
}

ShardReader::ShardReader(const fs::path& path)
    : path_(path), content_(core::readFile(path, "shard")) {
  const std::string name = "shard '" + path.string() + "'";
  if (content_.size() < kMagic.size() + 8 + kDigestLength)
    throw InputError(name + ": truncated: " + std::to_string(content_.size()) + " bytes");
  ByteReader reader(content_, name);
  if (reader.take(kMagic.size()) != kMagic) throw InputError(name + ": is not a shard");
  const auto version = reader.value<std::uint32_t>();
  if (version != kVersion) {
    throw InputError(name + ": version " + std::to_string(version) + ", this program reads " +
                     std::to_string(kVersion));
  }
  readHeader(std::string(reader.text()));
  const std::size_t begin = reader.place();
  sha256_ = content_.substr(content_.size() - kDigestLength);
  content_.resize(content_.size() - kDigestLength);
  findSamples(begin);
  if (core::sha256(content_) != sha256_)
    throw InputError(name + ": the checksum at its end is not that of its content");
}

void ShardReader::readHeader(const std::string& header) {
  const std::string name = "shard '" + path_.string() + "'";
  const json object = json::parse(header, nullptr, false);
  if (!object.is_object() || !object.contains("schema") || !object.contains("samples") ||
      !object["samples"].is_number_unsigned())
    throw InputError(name + ": the header is not JSON with 'schema' and 'samples'");
  schema_ = SampleSchema::fromJson(object["schema"].dump(), name);
  announced_ = object["samples"].get<std::size_t>();
  if (!object.contains("facts") || !object["facts"].is_object()) return;
  for (const auto& [key, value] : object["facts"].items())
    facts_[key] = value.is_string() ? value.get<std::string>() : value.dump();
}

void ShardReader::findSamples(std::size_t begin) {
  const std::string name = "shard '" + path_.string() + "'";
  ByteReader reader(content_, name, std::min(begin, content_.size()));
  while (!reader.atEnd() && places_.size() < announced_) {
    places_.push_back(reader.place());
    std::string_view image;
    const Sample sample = takeSample(reader, schema_, image);
    sessions_.push_back(sample.session);
    if (!sample.rollout.allFinite() || !std::isfinite(sample.speed))
      throw InputError(name + ": sample " + std::to_string(places_.size() - 1) + " is not finite");
  }
  if (places_.size() == announced_ && reader.atEnd()) return;
  throw InputError(name + ": truncated or overlong: " + std::to_string(places_.size()) + " of " +
                   std::to_string(announced_) + " samples, then " +
                   std::to_string(content_.size() - reader.place()) + " bytes");
}

Sample ShardReader::read(std::size_t index, bool with_image) const {
  const std::string name = "shard '" + path_.string() + "', sample " + std::to_string(index);
  ByteReader reader(content_, name, places_.at(index));
  std::string_view image;
  Sample sample = takeSample(reader, schema_, image);
  sample.image.width = static_cast<int>(schema_.image_width);
  sample.image.height = static_cast<int>(schema_.image_height);
  sample.image.tick = sample.tick;
  if (with_image) {
    const auto bytes = static_cast<std::size_t>(schema_.image_width * schema_.image_height * 3);
    sample.image.rgb = unpacked(image, bytes, name);
  }
  return sample;
}

Sample ShardReader::sample(std::size_t index) const { return read(index, true); }
Sample ShardReader::withoutImage(std::size_t index) const { return read(index, false); }

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

}  // namespace cdiff::training
