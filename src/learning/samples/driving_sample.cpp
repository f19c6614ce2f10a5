// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/driving_sample.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::learning {
namespace {

using core::InputError;
using nlohmann::json;

constexpr const char* kImage = "image";
// Fields that not all driving samples have.
constexpr const char* kTargetSpeed = "target_speed";
constexpr const char* kPreviousImage = "previous_image";
constexpr const char* kPreviousKnown = "previous_known";
constexpr const char* kSecondsBefore = "seconds_before";  // of kPreviousImage

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

using RolloutMatrix =
    Eigen::Matrix<float, Eigen::Dynamic, traffic::kRolloutColumns, Eigen::RowMajor>;

std::vector<float> rolloutValues(const traffic::Rollout& rollout) {
  const RolloutMatrix values = rollout.cast<float>();
  return {values.data(), values.data() + values.size()};
}

template <class Value>
std::vector<Value> one(Value value) {
  return {value};
}

/// The first value of a field.
template <class Value>
Value first(const Sample& sample, const char* name) {
  return sample.get<std::vector<Value>>(name).at(0);
}

Sample toFields(const DrivingSample& sample, const DrivingSchema& schema) {
  Sample stored{{{"session", one(sample.session)},
                 {"tick", one(sample.tick)},
                 {"speed", one(sample.speed)},
                 {"recovering", one(static_cast<std::uint8_t>(sample.recovering))},
                 {"maneuver", one(sample.maneuver)},
                 {"stop_reason", one(sample.stop_reason)},
                 {"vehicle", sample.vehicle},
                 {"rollout", rolloutValues(sample.rollout)},
                 {"route", sample.route},
                 {"auxiliary", sample.auxiliary},
                 {kImage, sample.image.rgb}}};
  if (schema.target_speeds) stored.fields[kTargetSpeed] = one(sample.target_speed);
  if (schema.previous_interval <= 0.0) return stored;
  const bool known = !sample.previous_image.empty();
  stored.fields[kPreviousKnown] = one(static_cast<std::uint8_t>(known));
  stored.fields[kPreviousImage] =
      known ? sample.previous_image.rgb : std::vector<std::uint8_t>(sample.image.rgb.size(), 0);
  return stored;
}

traffic::CameraImage emptyImage(const DrivingSchema& schema, std::uint64_t tick) {
  traffic::CameraImage image;
  image.width = static_cast<int>(schema.image_width);
  image.height = static_cast<int>(schema.image_height);
  image.tick = tick;
  return image;
}

/// All but the pixels.
DrivingSample fromFields(const Sample& stored, const DrivingSchema& schema) {
  DrivingSample sample;
  sample.session = first<std::uint64_t>(stored, "session");
  sample.tick = first<std::uint64_t>(stored, "tick");
  sample.speed = first<double>(stored, "speed");
  sample.recovering = first<std::uint8_t>(stored, "recovering") != 0;
  sample.maneuver = first<std::uint8_t>(stored, "maneuver");
  sample.stop_reason = first<std::uint8_t>(stored, "stop_reason");
  sample.vehicle = stored.get<std::string>("vehicle");
  const auto& rollout = stored.get<std::vector<float>>("rollout");
  sample.rollout = Eigen::Map<const RolloutMatrix>(rollout.data(), schema.horizon,
                                                   RolloutMatrix::ColsAtCompileTime)
                       .cast<double>();
  sample.route = stored.get<std::vector<float>>("route");
  sample.auxiliary = stored.get<std::vector<float>>("auxiliary");
  sample.image = emptyImage(schema, sample.tick);
  if (schema.target_speeds) sample.target_speed = first<double>(stored, kTargetSpeed);
  return sample;
}

const FieldSpec& fieldIn(const SampleSchema& stored, const std::string& name,
                         std::size_t dimensions, const std::string& source) {
  const FieldSpec* field = stored.find(name);
  if (field == nullptr)
    throw InputError(source + ": lacks the field '" + name + "'; it holds " + stored.names());
  if (field->shape.size() != dimensions || field->anyCount())
    throw InputError(source + ": field '" + name + "' has another shape than in driving samples");
  return *field;
}

}  // namespace

SampleSchema DrivingSchema::fields() const {
  FieldSpec rollout("rollout", FieldType::kF32, {horizon, traffic::kRolloutColumns});
  rollout.columns = {"x", "y", "heading", "speed", "throttle", "steer", "brake"};
  FieldSpec route("route", FieldType::kF32, {route_points, 2});
  route.numbers = {{"spacing", route_spacing}};
  FieldSpec targets("auxiliary", FieldType::kF32, {static_cast<std::int64_t>(auxiliary.size())});
  targets.columns = auxiliary;
  targets.finite = false;
  FieldSpec image(kImage, FieldType::kU8, {image_height, image_width, 3});
  image.packed = true;
  SampleSchema schema{{{"session", FieldType::kU64},
                       {"tick", FieldType::kU64},
                       {"speed", FieldType::kF64},
                       {"recovering", FieldType::kU8},
                       {"maneuver", FieldType::kU8},
                       {"stop_reason", FieldType::kU8},
                       {"vehicle", FieldType::kText},
                       rollout,
                       route,
                       targets,
                       image}};
  if (target_speeds) {
    schema.fields.emplace_back(kTargetSpeed, FieldType::kF64);
    schema.fields.back().finite = false;
  }
  if (previous_interval <= 0.0) return schema;
  image.name = kPreviousImage;
  image.numbers = {{kSecondsBefore, previous_interval}};
  schema.fields.emplace_back(kPreviousKnown, FieldType::kU8);
  schema.fields.push_back(image);
  return schema;
}

DrivingSchema DrivingSchema::fromFields(const SampleSchema& stored, const std::string& source) {
  DrivingSchema schema;
  schema.horizon = fieldIn(stored, "rollout", 2, source).shape[0];
  const FieldSpec& image = fieldIn(stored, "image", 3, source);
  schema.image_height = image.shape[0];
  schema.image_width = image.shape[1];
  const FieldSpec& route = fieldIn(stored, "route", 2, source);
  schema.route_points = route.shape[0];
  const auto spacing = route.numbers.find("spacing");
  if (spacing != route.numbers.end()) schema.route_spacing = spacing->second;
  schema.auxiliary = fieldIn(stored, "auxiliary", 1, source).columns;
  schema.target_speeds = stored.find(kTargetSpeed) != nullptr;
  if (const FieldSpec* previous = stored.find(kPreviousImage)) {
    const auto seconds = previous->numbers.find(kSecondsBefore);
    if (seconds == previous->numbers.end() || !(seconds->second > 0.0))
      throw InputError(source + ": field '" + kPreviousImage + "' does not say its " +
                       kSecondsBefore);
    schema.previous_interval = seconds->second;
  }
  for (const FieldSpec& field : schema.fields().fields) {
    if (field == fieldIn(stored, field.name, field.shape.size(), source)) continue;
    throw InputError(source + ": field '" + field.name + "' is another than in driving samples");
  }
  return schema;
}

std::vector<std::string> drivingFields() {
  std::vector<std::string> names;
  for (const FieldSpec& field : DrivingSchema().fields().fields) names.push_back(field.name);
  return names;
}

void DrivingSchema::check(const DrivingSample& sample) const {
  requireCount("image width", sample.image.width, image_width);
  requireCount("image height", sample.image.height, image_height);
  requireCount("count of image bytes", static_cast<std::int64_t>(sample.image.rgb.size()),
               image_width * image_height * 3);
  if (!sample.previous_image.empty())
    requireCount("count of bytes of the image before",
                 static_cast<std::int64_t>(sample.previous_image.rgb.size()),
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

DrivingSchema DrivingSchema::fromJson(const std::string& text, const std::string& source) {
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object()) throw InputError(source + ": the schema is not a JSON object");
  DrivingSchema schema;
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

bool operator==(const DrivingSchema& left, const DrivingSchema& right) {
  const auto fields = [](const DrivingSchema& schema) {
    return std::tie(schema.horizon, schema.image_width, schema.image_height, schema.route_points,
                    schema.route_spacing, schema.auxiliary, schema.previous_interval,
                    schema.target_speeds);
  };
  return fields(left) == fields(right);
}

void DrivingShardWriter::append(const DrivingSample& sample) {
  schema_.check(sample);
  writer_.append(toFields(sample, schema_));
}

DrivingDataset::DrivingDataset(const Dataset& stored)
    : stored_(stored), schema_(DrivingSchema::fromFields(stored.schema(), stored.name())) {}

DrivingSample DrivingDataset::sample(std::size_t index) const {
  const Sample stored = stored_.sample(index);
  DrivingSample sample = fromFields(stored, schema_);
  sample.image.rgb = stored.get<std::vector<std::uint8_t>>(kImage);
  if (schema_.previous_interval <= 0.0 || first<std::uint8_t>(stored, kPreviousKnown) == 0)
    return sample;
  sample.previous_image = emptyImage(schema_, sample.tick);
  sample.previous_image.rgb = stored.get<std::vector<std::uint8_t>>(kPreviousImage);
  return sample;
}

DrivingSample DrivingDataset::withoutImage(std::size_t index) const {
  return fromFields(stored_.sample(index, {kImage, kPreviousImage}), schema_);
}

namespace {

bool endsInLeft(const std::string& name) {
  const std::string ending = "_left";
  return name.size() >= ending.size() &&
         name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

/// Where in the schema the target lies that `name` is in a mirror: of "A_left_B" that is
/// "A_right_B" and the other way round, of others the target itself.
std::size_t mirrored(const DrivingSchema& schema, std::size_t index) {
  std::string name = schema.auxiliary[index];
  for (const auto& [side, other] : {std::pair{"_left_", "_right_"}, {"_right_", "_left_"}}) {
    const std::size_t at = name.find(side);
    if (at == std::string::npos) continue;
    name.replace(at, std::string(side).size(), other);
    const auto found = std::find(schema.auxiliary.begin(), schema.auxiliary.end(), name);
    return found == schema.auxiliary.end()
               ? index
               : static_cast<std::size_t>(found - schema.auxiliary.begin());
  }
  return index;
}

void mirrorImage(traffic::CameraImage& image) {
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t pixel = 0; pixel < image.rgb.size() / 3; ++pixel) {
    const std::size_t column = pixel % width;
    const std::size_t other = pixel - column + width - 1 - column;
    for (std::size_t c = 0; other > pixel && c < 3; ++c)
      std::swap(image.rgb[3 * pixel + c], image.rgb[3 * other + c]);
  }
}

}  // namespace

void mirrorRollout(traffic::Rollout& rollout) {
  for (const int column : {traffic::kRolloutY, traffic::kRolloutHeading, traffic::kRolloutSteer})
    rollout.col(column) *= -1.0;
}

void mirrorSample(const DrivingSchema& schema, DrivingSample& sample) {
  mirrorImage(sample.image);
  mirrorImage(sample.previous_image);
  mirrorRollout(sample.rollout);
  for (std::size_t i = 1; i < sample.route.size(); i += 2) sample.route[i] *= -1.0F;
  const std::vector<float> targets = sample.auxiliary;
  for (std::size_t i = 0; i < sample.auxiliary.size(); ++i) {
    sample.auxiliary[i] = targets[mirrored(schema, i)];
    if (endsInLeft(schema.auxiliary[i])) sample.auxiliary[i] *= -1.0F;
  }
}

void changeLight(const core::RandomStream& random, const core::RandomKey& key,
                 traffic::CameraImage& image, std::uint32_t frame) {
  const double brightness = random.uniform(key, 0, -40.0, 40.0);
  const double contrast = random.uniform(key, 1, 0.8, 1.2);
  const double noise = random.uniform(key, 2, 0.0, 12.0) / 127.5;
  const std::size_t first = 3 + frame * ((image.rgb.size() + 7) / 8);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    if (i % 8 == 0) bits = random.bits(key, static_cast<std::uint32_t>(first + i / 8));
    const double jitter = noise * (static_cast<double>(bits & 255U) - 127.5);
    bits >>= 8;
    const double value =
        (static_cast<double>(image.rgb[i]) - 127.5) * contrast + 127.5 + brightness + jitter;
    image.rgb[i] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  }
}

}  // namespace cdiff::learning
