// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/layers.h"

#include <cmath>

namespace cdiff::learning {

at::Tensor linear(const ParameterSet& parameters, const std::string& name, const at::Tensor& x) {
  const at::Tensor weight = parameters(name + ".weight").unsqueeze(2).unsqueeze(3);
  return at::conv2d(x.unsqueeze(2).unsqueeze(3), weight, parameters(name + ".bias")).flatten(1);
}

at::Tensor linearOfRows(const ParameterSet& parameters, const std::string& name,
                        const at::Tensor& x) {
  const at::Tensor weight = parameters(name + ".weight")
                                .unsqueeze(2)
                                .unsqueeze(3)
                                .contiguous(at::MemoryFormat::ChannelsLast);
  const at::Tensor image = x.reshape({1, x.size(0), 1, x.size(1)}).permute({0, 3, 1, 2});
  const at::Tensor y = at::conv2d(image, weight, parameters(name + ".bias"));
  return y.permute({0, 2, 3, 1}).reshape({x.size(0), weight.size(0)});
}

at::Tensor dense(const ParameterSet& parameters, const std::string& name, const at::Tensor& x) {
  std::vector<std::int64_t> shape = x.sizes().vec();
  const at::Tensor y = linear(parameters, name, x.reshape({x.numel() / x.size(-1), x.size(-1)}));
  shape.back() = y.size(1);
  return y.reshape(shape);
}

at::Tensor layerNorm(const ParameterSet& parameters, const std::string& name, const at::Tensor& x) {
  constexpr double kEpsilon = 1e-5;
  return at::layer_norm(x, {x.size(-1)}, parameters(name + ".weight"), parameters(name + ".bias"),
                        kEpsilon);
}

at::Tensor mlp(const ParameterSet& parameters, const std::string& name, const at::Tensor& x) {
  const at::Tensor hidden =
      layerNorm(parameters, name + ".norm", dense(parameters, name + ".in", x));
  return dense(parameters, name + ".out", at::relu(hidden));
}

Attended attend(const at::Tensor& query, const at::Tensor& key_value, std::int64_t heads,
                const at::Tensor& mask) {
  const std::int64_t width = query.size(2);
  const std::int64_t head_width = width / heads;
  const auto byHead = [&](const at::Tensor& x) {
    return x.reshape({x.size(0), x.size(1), heads, head_width}).transpose(1, 2).contiguous();
  };
  const at::Tensor key = byHead(key_value.narrow(2, 0, width));
  const at::Tensor value = byHead(key_value.narrow(2, width, width));
  at::Tensor scores =
      at::matmul(byHead(query), key.transpose(2, 3)) / std::sqrt(static_cast<double>(head_width));
  if (mask.defined()) scores = scores + mask;
  const at::Tensor weights = at::softmax(scores, -1);
  const at::Tensor mixed = at::matmul(weights, value).transpose(1, 2).reshape(query.sizes());
  return {mixed, weights};
}

}  // namespace cdiff::learning
