// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/batches.h"

#include <algorithm>
#include <cstring>

#include "learning/parameters.h"

namespace cdiff::learning {
namespace {

std::vector<float> floatsOf(const FieldValue& value) {
  return std::visit(
      [](const auto& values) { return std::vector<float>(values.begin(), values.end()); }, value);
}

/// The values of one field of each sample.
std::vector<std::vector<float>> readField(const Dataset& dataset,
                                          const std::vector<std::size_t>& samples,
                                          const std::string& field) {
  FieldNames others;
  for (const FieldSpec& spec : dataset.schema().fields) {
    if (spec.name != field) others.insert(spec.name);
  }
  std::vector<std::vector<float>> all;
  for (const std::size_t index : samples)
    all.push_back(floatsOf(dataset.sample(index, others).fields.at(field)));
  return all;
}

}  // namespace

FieldBatch fieldBatch(const Dataset& dataset, const std::vector<std::size_t>& samples,
                      const std::string& field, const at::Device& device) {
  const FieldSpec* spec = dataset.schema().find(field);
  if (spec == nullptr || spec->type == FieldType::kText) {
    throw core::InputError(dataset.name() + ": its samples have no numbers '" + field +
                           "'; they hold " + dataset.schema().names());
  }
  const std::vector<std::vector<float>> all = readField(dataset, samples, field);
  std::size_t longest = 0;
  for (const std::vector<float>& values : all) longest = std::max(longest, values.size());
  std::vector<float> padded;
  at::Tensor counts = at::empty({static_cast<std::int64_t>(all.size())}, at::kLong);
  for (std::size_t i = 0; i < all.size(); ++i) {
    padded.insert(padded.end(), all[i].begin(), all[i].end());
    padded.insert(padded.end(), longest - all[i].size(), 0.0F);
    counts.data_ptr<std::int64_t>()[i] =
        spec->anyCount() ? static_cast<std::int64_t>(all[i].size() / spec->values()) : 1;
  }
  std::vector<std::int64_t> shape = spec->shape;
  if (spec->anyCount()) shape.front() = static_cast<std::int64_t>(longest / spec->values());
  shape.insert(shape.begin(), static_cast<std::int64_t>(all.size()));
  FieldBatch batch{toTensor(padded, shape, device), {}};
  if (spec->anyCount()) batch.counts = counts.to(device);
  return batch;
}

at::Tensor imageTensor(const std::vector<const traffic::CameraImage*>& images, double scale,
                       const at::Device& device) {
  const std::int64_t height = images.front()->height;
  const std::int64_t width = images.front()->width;
  at::Tensor bytes =
      at::empty({static_cast<std::int64_t>(images.size()), height, width, 3}, at::kByte);
  auto* target = bytes.data_ptr<std::uint8_t>();
  for (const traffic::CameraImage* image : images) {
    std::memcpy(target, image->rgb.data(), image->rgb.size());
    target += image->rgb.size();
  }
  at::Tensor tensor = bytes.to(device).permute({0, 3, 1, 2}).to(at::kFloat);
  tensor = ((tensor / 255.0 - 0.5) / 0.25).contiguous();
  return scale == 1.0 ? tensor : at::avg_pool2d(tensor, 2);
}

}  // namespace cdiff::learning
