// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/architecture.h"

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <tuple>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "inference/strict_json.h"

namespace cdiff::diffusion {
namespace {

/// An integer size and its range, in the order of the JSON text. The ranges keep every product of
/// sizes far below 2^63.
struct SizeField {
  const char* name;
  std::int64_t Architecture::*member;
  std::int64_t low;
  std::int64_t high;
  bool optional = false;  // 0 where it is not named
};

constexpr SizeField kSizes[] = {
    {"horizon", &Architecture::horizon, 2, 1024},
    {"diffusion_steps", &Architecture::diffusion_steps, 1, 10000},
    {"kernel", &Architecture::kernel, 1, 31},
    {"groups", &Architecture::groups, 1, 256},
    {"time_width", &Architecture::time_width, 4, 4096},
    {"image_width", &Architecture::image_width, 32, 4096},
    {"image_height", &Architecture::image_height, 32, 4096},
    {"image_features", &Architecture::image_features, 1, 4096},
    {"route_points", &Architecture::route_points, 1, 1024},
    {"route_features", &Architecture::route_features, 0, 4096},
    {"speed_features", &Architecture::speed_features, 0, 4096},
    {"context_width", &Architecture::context_width, 0, 4096},
    {"state_hidden", &Architecture::state_hidden, 1, 4096},
    {"previous_frame", &Architecture::previous_frame, 0, 1024, true},
    {"target_features", &Architecture::target_features, 0, 4096, true},
    {"current_state_rows", &Architecture::current_state_rows, 0, 64, true},
};
constexpr std::int64_t kMinLevels = 2;
constexpr std::int64_t kMaxLevels = 6;
constexpr std::int64_t kMaxChannels = 4096;
constexpr double kMinSpacing = 0.1;    // [m]
constexpr double kMaxSpacing = 100.0;  // [m]

[[noreturn]] void fail(const std::string& what) { throw core::InputError("architecture: " + what); }

void requireInRange(const std::string& name, std::int64_t value, std::int64_t low,
                    std::int64_t high) {
  if (value >= low && value <= high) return;
  fail(name + " is " + std::to_string(value) + "; " + std::to_string(low) + " to " +
       std::to_string(high) + " was expected");
}

void requireMultiple(const std::string& name, std::int64_t value, std::int64_t divisor,
                     const std::string& reason) {
  if (value % divisor == 0) return;
  fail(name + " is " + std::to_string(value) + "; a multiple of " + reason + " (" +
       std::to_string(divisor) + ") was expected");
}

std::int64_t integerOf(const inference::Json& value, const std::string& where) {
  const bool too_large = value.is_number_unsigned() &&
                         value.get<std::uint64_t>() >
                             static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!value.is_number_integer() || too_large) {
    throw core::InputError(where + " is " + (too_large ? value.dump() : inference::kindOf(value)) +
                           "; an integer was expected");
  }
  return value.get<std::int64_t>();
}

const inference::Json& valueOf(const inference::Json& object, const std::string& key,
                               const std::string& source) {
  const auto found = object.find(key);
  if (found == object.end()) {
    throw core::InputError(source + ": the architecture lacks the key '" + key + "'");
  }
  return *found;
}

std::vector<std::int64_t> channelsOf(const inference::Json& value, const std::string& where) {
  if (!value.is_array()) {
    throw core::InputError(where + " is " + inference::kindOf(value) +
                           "; an array of integers was expected");
  }
  std::vector<std::int64_t> channels;
  for (const inference::Json& element : value)
    channels.push_back(integerOf(element, where + " (an element)"));
  return channels;
}

void requireKnownKeys(const inference::Json& object, const std::string& source) {
  std::vector<std::string> known = {"channels", "route_spacing"};
  for (const SizeField& field : kSizes) known.emplace_back(field.name);
  const std::set<std::string> set(known.begin(), known.end());
  for (const auto& item : object.items()) {
    if (set.count(item.key()) > 0) continue;
    throw core::InputError(source + ": the architecture has an unknown key '" + item.key() +
                           "'; the nearest known one is '" + core::nearestName(item.key(), known) +
                           "'");
  }
}

}  // namespace

Architecture Architecture::imageAlone() const {
  Architecture architecture = *this;
  architecture.route_features = 0;
  architecture.speed_features = 0;
  architecture.context_width = 0;
  architecture.previous_frame = 0;
  architecture.target_features = 0;
  architecture.current_state_rows = 0;
  return architecture;
}

Architecture Architecture::withMotion() const {
  Architecture architecture = *this;
  architecture.previous_frame = 4;
  architecture.target_features = 32;
  return architecture;
}

Architecture Architecture::pinned() const {
  Architecture architecture = imageAlone();
  architecture.current_state_rows = std::int64_t{1} << (channels.size() - 1);
  return architecture;
}

void Architecture::validate() const {
  for (const SizeField& field : kSizes) {
    requireInRange(field.name, this->*field.member, field.low, field.high);
  }
  const auto levels = static_cast<std::int64_t>(channels.size());
  requireInRange("the count of channels", levels, kMinLevels, kMaxLevels);
  const std::int64_t halvings = std::int64_t{1} << (levels - 1);
  requireMultiple("horizon", horizon, halvings, "2^(levels - 1)");
  requireMultiple("current_state_rows", current_state_rows, halvings, "2^(levels - 1)");
  for (const std::int64_t channel : channels) {
    requireInRange("an element of channels", channel, 1, kMaxChannels);
    requireMultiple("an element of channels", channel, groups, "groups");
  }
  if (kernel % 2 == 0) fail("kernel is " + std::to_string(kernel) + "; an odd one was expected");
  requireMultiple("time_width", time_width, 2, "a sine and a cosine each");
  if (!(route_spacing >= kMinSpacing && route_spacing <= kMaxSpacing)) {
    fail("route_spacing is " + core::formatNumber(route_spacing) + " m; " +
         core::formatNumber(kMinSpacing) + " to " + core::formatNumber(kMaxSpacing) +
         " was expected");
  }
}

std::string Architecture::toJson() const {
  nlohmann::ordered_json object;
  for (const SizeField& field : kSizes) {
    if (!field.optional || this->*field.member != 0) object[field.name] = this->*field.member;
  }
  object["channels"] = channels;
  object["route_spacing"] = route_spacing;
  return object.dump();
}

Architecture Architecture::fromJson(const std::string& text, const std::string& source) {
  const inference::Json object = inference::parseStrictJson(text, source + ": the architecture");
  if (!object.is_object()) {
    throw core::InputError(source + ": the architecture is " + inference::kindOf(object) +
                           "; an object was expected");
  }
  requireKnownKeys(object, source);
  const std::string prefix = source + ": the architecture's ";
  Architecture result;
  for (const SizeField& field : kSizes) {
    if (field.optional && !object.contains(field.name)) continue;
    result.*field.member = integerOf(valueOf(object, field.name, source), prefix + field.name);
  }
  result.channels = channelsOf(valueOf(object, "channels", source), prefix + "channels");
  const inference::Json& spacing = valueOf(object, "route_spacing", source);
  if (!spacing.is_number()) {
    throw core::InputError(prefix + "route_spacing is " + inference::kindOf(spacing) +
                           "; a number was expected");
  }
  result.route_spacing = spacing.get<double>();
  try {
    result.validate();
  } catch (const core::InputError& error) {
    throw core::InputError(source + ": " + error.what());
  }
  return result;
}

bool operator==(const Architecture& left, const Architecture& right) {
  for (const SizeField& field : kSizes) {
    if (left.*field.member != right.*field.member) return false;
  }
  return left.channels == right.channels && left.route_spacing == right.route_spacing;
}

std::vector<float> routeTokens(const Architecture& architecture, const geometry::Polyline& path,
                               double arc_length, const geometry::Pose2d& pose) {
  if (path.empty()) throw std::invalid_argument("routeTokens: the path is empty");
  std::vector<float> tokens;
  tokens.reserve(static_cast<std::size_t>(2 * architecture.route_points));
  for (std::int64_t i = 1; i <= architecture.route_points; ++i) {
    const double ahead = arc_length + static_cast<double>(i) * architecture.route_spacing;
    const Eigen::Vector2d token =
        pose.toBody(path.extendedPoseAt(ahead).position) / kRouteTokenScale;
    tokens.push_back(static_cast<float>(token.x()));
    tokens.push_back(static_cast<float>(token.y()));
  }
  return tokens;
}

namespace {

using Size = std::int64_t;

/// Collects tensors in order; layouts are those of libtorch.
class TensorList {
 public:
  void add(const std::string& name, std::vector<Size> shape) {
    tensors_.push_back({name, std::move(shape)});
  }
  void linear(const std::string& name, Size in, Size out) {
    add(name + ".weight", {out, in});
    add(name + ".bias", {out});
  }
  void convolution(const std::string& name, Size in, Size out, Size kernel) {
    add(name + ".weight", {out, in, kernel});
    add(name + ".bias", {out});
  }
  void transposedConvolution(const std::string& name, Size in, Size out, Size kernel) {
    add(name + ".weight", {in, out, kernel});
    add(name + ".bias", {out});
  }
  /// Without bias.
  void imageConvolution(const std::string& name, Size in, Size out, Size kernel) {
    add(name + ".weight", {out, in, kernel, kernel});
  }
  void norm(const std::string& name, Size channels) {
    add(name + ".weight", {channels});
    add(name + ".bias", {channels});
  }
  std::vector<inference::TensorShape> take() { return std::move(tensors_); }

 private:
  std::vector<inference::TensorShape> tensors_;
};

void addConditioning(TensorList& list, const Architecture& a) {
  if (a.takesRoute()) {
    list.linear("route.0", 2 * a.route_points, 2 * a.route_features);
    list.linear("route.2", 2 * a.route_features, a.route_features);
    list.add("no_route", {a.route_features});
  }
  if (a.takesSpeed()) list.linear("speed.0", 1, a.speed_features);
  if (a.takesPrevious()) list.add("no_previous", {a.image_features});
  if (a.takesTarget()) {
    list.linear("target.0", 1, a.target_features);
    list.add("no_target", {a.target_features});
  }
  if (a.context_width > 0) list.linear("context.0", a.joinedFeatures(), a.context_width);
  list.linear("time.0", a.time_width, 4 * a.time_width);
  list.linear("time.2", 4 * a.time_width, a.time_width);
}

void addResidualBlock(TensorList& list, const Architecture& a, const std::string& name, Size in,
                      Size out) {
  list.convolution(name + ".block1.conv", in, out, a.kernel);
  list.norm(name + ".block1.norm", out);
  list.linear(name + ".inject", a.time_width + a.contextValues(), out);
  list.convolution(name + ".block2.conv", out, out, a.kernel);
  list.norm(name + ".block2.norm", out);
  if (in != out) list.convolution(name + ".skip", in, out, 1);
}

void addBlockPair(TensorList& list, const Architecture& a, const std::string& name, Size in,
                  Size out) {
  addResidualBlock(list, a, name + ".a", in, out);
  addResidualBlock(list, a, name + ".b", out, out);
}

void addUNet(TensorList& list, const Architecture& a) {
  const std::size_t levels = a.channels.size();
  Size in = traffic::kRolloutColumns;
  for (std::size_t level = 0; level < levels; ++level) {
    const std::string name = "down." + std::to_string(level);
    const Size out = a.channels[level];
    addBlockPair(list, a, name, in, out);
    if (level + 1 < levels) list.convolution(name + ".sample", out, out, 3);
    in = out;
  }
  addBlockPair(list, a, "middle", in, in);
  for (std::size_t step = 0; step + 1 < levels; ++step) {
    const std::string name = "up." + std::to_string(step);
    const Size out = a.channels[levels - 2 - step];
    addBlockPair(list, a, name, 2 * a.channels[levels - 1 - step], out);
    list.transposedConvolution(name + ".sample", out, out, 4);
  }
  const Size width = a.channels.front();
  list.convolution("head.block.conv", width, width, a.kernel);
  list.norm("head.block.norm", width);
  list.convolution("head.out", width, traffic::kActionColumns, 1);
}

void addStateHead(TensorList& list, const Architecture& a) {
  const Size speed = a.startsFromSpeed() ? 1 : 0;
  list.linear("state.0", a.horizon * traffic::kActionColumns + speed + a.time_width,
              a.state_hidden);
  list.linear("state.2", a.state_hidden, a.state_hidden);
  list.linear("state.4", a.state_hidden, a.horizon * traffic::kStateColumns);
}

void addBasicBlock(TensorList& list, const std::string& name, Size in, Size out) {
  list.imageConvolution(name + ".conv1", in, out, 3);
  list.norm(name + ".norm1", out);
  list.imageConvolution(name + ".conv2", out, out, 3);
  list.norm(name + ".norm2", out);
  if (in == out) return;
  list.imageConvolution(name + ".down.conv", in, out, 1);
  list.norm(name + ".down.norm", out);
}

/// Size of the last feature map: five layers of stride 2, each rounding up.
Size afterStrides(Size pixels) {
  for (int i = 0; i < 5; ++i) pixels = (pixels + 1) / 2;
  return pixels;
}

}  // namespace

std::vector<inference::TensorShape> denoiserTensors(const Architecture& architecture) {
  TensorList list;
  addConditioning(list, architecture);
  addUNet(list, architecture);
  addStateHead(list, architecture);
  return list.take();
}

std::vector<inference::TensorShape> encoderTensors(const Architecture& architecture) {
  constexpr Size kStemChannels = 64;
  constexpr Size kSqueezeChannels = 64;
  constexpr int kBlocks[] = {3, 4, 6, 3};
  TensorList list;
  list.imageConvolution("stem.conv", 3, kStemChannels, 7);
  list.norm("stem.norm", kStemChannels);
  Size in = kStemChannels;
  for (int layer = 0; layer < 4; ++layer) {
    const Size out = kStemChannels << layer;
    for (int block = 0; block < kBlocks[layer]; ++block) {
      addBasicBlock(list, "layer" + std::to_string(layer + 1) + "." + std::to_string(block), in,
                    out);
      in = out;
    }
  }
  list.add("squeeze.weight", {kSqueezeChannels, in, 1, 1});
  list.add("squeeze.bias", {kSqueezeChannels});
  list.linear("project",
              kSqueezeChannels * afterStrides(architecture.image_height) *
                  afterStrides(architecture.image_width),
              architecture.image_features);
  return list.take();
}

}  // namespace cdiff::diffusion
