// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/camera_ego_sizes.h"

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {

using inference::DeformableSizes;
using inference::TensorList;

void CameraEgoSizes::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"width", "", "Width of a feature."}, width, 16, 1024);
  visitor.integer({"heads", "", "Heads of attention."}, heads, 1, 64);
  visitor.integer({"hidden", "", "Width of the feed-forward networks."}, hidden, 16, 4096);
  visitor.integer({"bev_layers", "", "Layers of the BEV encoder."}, bev_layers, 1, 8);
  bev.describe(visitor);
  visitor.flag({"past_bev", "", "Read the BEV of 0.5 s ago, too."}, past_bev);
  visitor.text({"rig", "", "Preset of the cameras."}, rig, rendering::rigPresets());
  visitor.integer({"image_width", "px", "Width of the images."}, image_width, 32, 1600);
  visitor.integer({"image_height", "px", "Height of the images."}, image_height, 32, 1600);
}

void CameraEgoSizes::validate() const {
  transformer().validate();
  if (image_width % 16 == 0 && image_height % 16 == 0) return;
  throw core::InputError("image_width and image_height are " + std::to_string(image_width) +
                         " and " + std::to_string(image_height) +
                         "; multiples of 16 were expected");
}

rendering::CameraRig CameraEgoSizes::cameras() const {
  rendering::RigOptions options;
  options.preset = rig;
  options.width = image_width;
  options.height = image_height;
  return rendering::rigOf(options, {});
}

DeformableSizes temporalSizes(const CameraEgoSizes& sizes) {
  return {sizes.width, sizes.heads, kTemporalPoints, 2};
}

DeformableSizes cameraSizes(const CameraEgoSizes& sizes) {
  return {sizes.width, sizes.heads, kCameraPoints, 1};
}

DeformableSizes querySizes(const CameraEgoSizes& sizes) {
  return {sizes.width, sizes.heads, kQueryPoints, 1};
}

void addPreNormAttention(const std::string& name, std::int64_t width, TensorList& list) {
  list.norm(name + ".norm", width);
  list.attention(name, width);
}

void addPreNormMix(const std::string& name, const CameraEgoSizes& sizes, TensorList& list) {
  list.norm(name + ".norm", sizes.width);
  list.feedForward(name, sizes.width, sizes.hidden);
}

void addQueryLayer(const std::string& name, const CameraEgoSizes& sizes, TensorList& list) {
  addPreNormAttention(name + ".self", sizes.width, list);
  list.norm(name + ".cross.norm", sizes.width);
  inference::addDeformable(name + ".cross", querySizes(sizes), sizes.width, list);
  addPreNormMix(name + ".mix", sizes, list);
}

void addBevEncoder(const CameraEgoSizes& sizes, TensorList& list) {
  const std::int64_t width = sizes.width;
  for (const inference::TensorShape& tensor : inference::backboneTensors(sizes.backbone()))
    list.add(tensor.name, tensor.shape);
  list.add("table.camera", {static_cast<std::int64_t>(sizes.cameras().cameras.size()), width});
  list.add("table.bev.query", {sizes.bev.cells(), width});
  list.add("table.bev.position", {sizes.bev.cells(), width});
  list.mlp("bev.motion", kEgoMotionNumbers, width, width);
  for (std::int64_t i = 0; i < sizes.bev_layers; ++i) {
    const std::string name = "bev." + std::to_string(i);
    inference::addDeformable(name + ".temporal", temporalSizes(sizes), 2 * width, list);
    list.norm(name + ".temporal.norm", width);
    inference::addDeformable(name + ".cameras", cameraSizes(sizes), width, list);
    list.norm(name + ".cameras.norm", width);
    list.feedForward(name + ".mix", width, sizes.hidden);
    list.norm(name + ".mix.norm", width);
  }
}

}  // namespace cdiff::planners
