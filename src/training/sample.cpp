// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "training/sample.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::training {
namespace {

using core::InputError;
using nlohmann::json;

void requireCount(const std::string& what, std::int64_t found, std::int64_t expected) {
  if (found == expected) return;
  throw InputError("sample: " + what + " is " + std::to_string(found) + ", the schema says " +
                   std::to_string(expected));
}

std::int64_t sizeIn(const json& object, const char* key, const std::string& source) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer() || found->get<std::int64_t>() < 1 ||
      found->get<std::int64_t>() > 4096) {
    throw InputError(source + ": schema key '" + key + "' must be a whole number in 1..4096");
  }
  return found->get<std::int64_t>();
}

std::vector<std::string> namesIn(const json& object, const std::string& source) {
  const auto found = object.find("auxiliary");
  const std::string wrong = source + ": schema key 'auxiliary' must be a list of texts";
  if (found == object.end() || !found->is_array()) throw InputError(wrong);
  std::vector<std::string> names;
  for (const json& name : *found) {
    if (!name.is_string()) throw InputError(wrong);
    names.push_back(name.get<std::string>());
  }
  return names;
}

}  // namespace

void SampleSchema::check(const Sample& sample) const {
  requireCount("image width", sample.image.width, image_width);
  requireCount("image height", sample.image.height, image_height);
  requireCount("count of image bytes", static_cast<std::int64_t>(sample.image.rgb.size()),
               image_width * image_height * 3);
  requireCount("count of rollout rows", sample.rollout.rows(), horizon);
  requireCount("count of route values", static_cast<std::int64_t>(sample.route.size()),
               2 * route_points);
  requireCount("count of auxiliary targets", static_cast<std::int64_t>(sample.auxiliary.size()),
               static_cast<std::int64_t>(auxiliary.size()));
  if (!std::isfinite(sample.speed)) throw InputError("sample: the speed is not finite");
  if (!sample.rollout.allFinite()) throw InputError("sample: the rollout is not finite");
  for (const float value : sample.route) {
    if (!std::isfinite(value)) throw InputError("sample: the route is not finite");
  }
}

std::string SampleSchema::toJson() const {
  return json{{"horizon", horizon},
              {"image_width", image_width},
              {"image_height", image_height},
              {"route_points", route_points},
              {"route_spacing", route_spacing},
              {"auxiliary", auxiliary}}
      .dump();
}

SampleSchema SampleSchema::fromJson(const std::string& text, const std::string& source) {
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object()) throw InputError(source + ": the schema is not a JSON object");
  SampleSchema schema;
  schema.horizon = sizeIn(object, "horizon", source);
  schema.image_width = sizeIn(object, "image_width", source);
  schema.image_height = sizeIn(object, "image_height", source);
  schema.route_points = sizeIn(object, "route_points", source);
  const auto spacing = object.find("route_spacing");
  if (spacing == object.end() || !spacing->is_number() || !(spacing->get<double>() > 0.0))
    throw InputError(source + ": schema key 'route_spacing' must be a positive number");
  schema.route_spacing = spacing->get<double>();
  schema.auxiliary = namesIn(object, source);
  return schema;
}

bool operator==(const SampleSchema& left, const SampleSchema& right) {
  const auto fields = [](const SampleSchema& schema) {
    return std::tie(schema.horizon, schema.image_width, schema.image_height, schema.route_points,
                    schema.route_spacing, schema.auxiliary);
  };
  return fields(left) == fields(right);
}

}  // namespace cdiff::training
