// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/shard_header.h"

#include <nlohmann/json.hpp>

#include "learning/driving_sample.h"

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

}  // namespace cdiff::learning
