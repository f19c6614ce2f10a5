// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/ego_layers.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "learning/layers.h"

namespace cdiff::planners {
namespace {

constexpr double kTable = 0.1;       // bound of learned rows
constexpr double kReference = 2.0;   // of references before the logistic function
constexpr double kClassBias = -4.6;  // logit of 1 %

/// Offsets of head h and point p: p + 1 cells in direction 2 pi h / heads, the larger coordinate
/// being that; the two points of each height of a pillar alike.
at::Tensor spreadOffsets(const std::string& name, std::int64_t count, std::int64_t heads) {
  const bool pillars = name.find(".cameras.") != std::string::npos;
  const std::int64_t points = pillars ? kCameraPoints : kQueryPoints;
  const std::int64_t reaches = pillars ? kCameraPoints / kPillarPoints : kQueryPoints;
  at::Tensor bias = at::zeros({count});
  float* values = bias.data_ptr<float>();
  for (std::int64_t i = 0; i < count / 2; ++i) {
    const std::int64_t head = i / points % heads;
    const double angle = 2.0 * core::kPi * static_cast<double>(head) / static_cast<double>(heads);
    const double x = std::cos(angle), y = std::sin(angle);
    const double reach = static_cast<double>(i % reaches + 1) / std::max(std::abs(x), std::abs(y));
    values[2 * i] = static_cast<float>(x * reach);
    values[2 * i + 1] = static_cast<float>(y * reach);
  }
  return bias;
}

bool isConvolution(const inference::TensorShape& tensor) { return tensor.shape.size() == 4; }

}  // namespace

void declareCameraEgo(const std::vector<inference::TensorShape>& tensors, std::int64_t heads,
                      learning::ParameterSet& parameters) {
  std::vector<inference::TensorShape> others;
  for (const inference::TensorShape& tensor : tensors) {
    const std::string layer = tensor.name.substr(0, tensor.name.rfind('.'));
    if (isConvolution(tensor)) {
      parameters.declareConvolution(layer, tensor.shape);
    } else {
      others.push_back(tensor);
    }
  }
  parameters.declareAll(others, [](const std::string& name) {
    return core::endsWith(name, ".reference") ? kReference : kTable;
  });
  const at::NoGradGuard no_gradient;
  for (std::size_t i = 0; i < parameters.names().size(); ++i) {
    const std::string& name = parameters.names()[i];
    at::Tensor& values = parameters.tensors()[i];
    if (core::endsWith(name, ".offset.weight") || core::endsWith(name, ".score.weight") ||
        core::endsWith(name, ".score.bias"))
      values.zero_();
    if (core::endsWith(name, ".offset.bias"))
      values.copy_(spreadOffsets(name, values.numel(), heads));
    if (core::endsWith(name, ".class.bias")) values.fill_(kClassBias);
  }
}

at::Tensor EgoLayers::linear(const std::string& name, const at::Tensor& x) const {
  const at::Tensor& weight = parameters_(name + ".weight");
  std::vector<std::int64_t> shape = x.sizes().vec();
  const at::Tensor rows = x.reshape({-1, x.size(-1)});
  shape.back() = weight.size(0);
  return at::addmm(parameters_(name + ".bias"), rows, weight.t()).reshape(shape);
}

at::Tensor EgoLayers::norm(const std::string& name, const at::Tensor& x) const {
  return learning::layerNorm(parameters_, name, x);
}

at::Tensor EgoLayers::mlp(const std::string& name, const at::Tensor& x) const {
  return linear(name + ".out", at::relu(norm(name + ".norm", linear(name + ".in", x))));
}

at::Tensor EgoLayers::feedForward(const std::string& name, const at::Tensor& x) const {
  return linear(name + ".down", at::gelu(linear(name + ".up", x)));
}

at::Tensor EgoLayers::deformable(const std::string& name, const at::Tensor& x,
                                 const at::Tensor& maps, const BatchReading& reading) const {
  const inference::DeformableSizes& s = reading.sizes;
  const at::Tensor scores =
      linear(name + ".score", x).reshape({x.size(0), s.blocks * s.heads, s.points});
  const at::Tensor read =
      readMapsOf(reading, linear(name + ".value", maps), linear(name + ".offset", x),
                 at::softmax(scores, 2).reshape({x.size(0), s.weights()}));
  return linear(name + ".output", read);
}

at::Tensor EgoLayers::attention(const std::string& name, const at::Tensor& x,
                                const at::Tensor& position, const at::Tensor& context) const {
  at::Tensor normed = norm(name + ".norm", x);
  if (position.defined()) normed = normed + position;
  const at::Tensor query = linear(name + ".query", normed);
  const at::Tensor key_value = linear(name + ".key_value", context.defined() ? context : normed);
  return linear(name + ".output", learning::attend(query, key_value, sizes_.heads, {}).mixed);
}

at::Tensor EgoLayers::queryLayer(const std::string& name, const at::Tensor& x,
                                 const at::Tensor& position, const at::Tensor& places,
                                 const at::Tensor& bev) const {
  at::Tensor y = x + attention(name + ".self", x, position, {});
  BatchReading reading{querySizes(sizes_), sizes_.bev.grid(), 1, {}};
  const at::Tensor cells = places.detach().to(at::kCPU).contiguous();
  for (std::int64_t b = 0; b < x.size(0); ++b)
    reading.plans.push_back(std::make_shared<inference::SamplingPlan>(inference::planAround(
        cells.data_ptr<float>() + b * x.size(1) * 2, x.size(1), kQueryPoints)));
  const at::Tensor asking = norm(name + ".cross.norm", y) + position;
  y = y + deformable(name + ".cross", asking.flatten(0, 1), bev, reading).reshape(x.sizes());
  return y + mix(name + ".mix", y);
}

at::Tensor metersOfShares(const BevGrid& bev, const at::Tensor& shares) {
  const Eigen::Vector2d origin = bev.origin();
  return at::stack({shares.select(-1, 0) * bev.length() + origin.x(),
                    shares.select(-1, 1) * bev.width() + origin.y()},
                   -1);
}

at::Tensor sharesOfMeters(const BevGrid& bev, const at::Tensor& meters) {
  const Eigen::Vector2d origin = bev.origin();
  return at::stack({(meters.select(-1, 0) - origin.x()) / bev.length(),
                    (meters.select(-1, 1) - origin.y()) / bev.width()},
                   -1);
}

at::Tensor cellsOfShares(const BevGrid& bev, const at::Tensor& shares) {
  return at::stack({shares.select(-1, 1) * static_cast<double>(bev.columns) - 0.5,
                    shares.select(-1, 0) * static_cast<double>(bev.rows) - 0.5},
                   -1);
}

}  // namespace cdiff::planners
