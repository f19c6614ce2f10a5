// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/camera_ego/training/bev_transfer.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

WeightTensors encoderOf(const CameraEgoSizes& sizes) {
  inference::TensorList list;
  addBevEncoder(sizes, list);
  return testing::randomTensors(list.take());
}

TEST(BevTransfer, TheSameGridChangesNothing) {
  const CameraEgoSizes sizes;
  const WeightTensors weights = encoderOf(sizes);
  const WeightTensors found = bevEncoderFor(sizes, {sizes, weights, "test"});
  ASSERT_EQ(found.size(), weights.size());
  for (const auto& [name, tensor] : weights)
    EXPECT_EQ(found.at(name).values, tensor.values) << name;
}

// From 4 x 4 cells of 2 m, 4 m behind to 4 m ahead and 4 m to both sides, to 4 x 4 cells of 3 m, 6
// m behind to 6 m ahead: new centers lie at -4.5, -1.5, 1.5, 4.5 m, old ones at -3, -1, 1, 3 m.
// With rows that hold 10 x + y of their centers, the new ones hold that of (-3, -1.5, 1.5, 3) m.
TEST(BevTransfer, RowsOfCellsAreReadWhereTheNewCellsLie) {
  CameraEgoSizes from, to;
  from.bev = {4, 4, 2.0, 4.0};
  to.bev = {4, 4, 3.0, 6.0};
  WeightTensors weights = encoderOf(from);
  inference::Tensor& query = weights.at("table.bev.query");
  for (std::int64_t cell = 0; cell < 16; ++cell) {
    const Eigen::Vector2d center = from.bev.center(cell);
    for (std::int64_t channel = 0; channel < from.width; ++channel)
      query.values[static_cast<std::size_t>(cell * from.width + channel)] =
          static_cast<float>(10.0 * center.x() + center.y());
  }
  const WeightTensors found = bevEncoderFor(to, {from, weights, "test"});
  const double places[] = {-3.0, -1.5, 1.5, 3.0};
  for (std::size_t cell = 0; cell < 16; ++cell)
    EXPECT_NEAR(found.at("table.bev.query").values[cell * static_cast<std::size_t>(to.width) + 5],
                10.0 * places[cell / 4] + places[cell % 4], 1e-4)
        << cell;
  EXPECT_EQ(found.at("stem.conv.weight").values, weights.at("stem.conv.weight").values);
  const char* offset = "bev.0.temporal.offset.bias";
  EXPECT_NEAR(3.0F * found.at(offset).values[0], 2.0F * weights.at(offset).values[0], 1e-6)
      << "as many meters";
  EXPECT_EQ(found.at("bev.0.cameras.offset.bias").values,
            weights.at("bev.0.cameras.offset.bias").values);
}

TEST(BevTransfer, OtherSizesAreRefused) {
  const CameraEgoSizes sizes;
  CameraEgoSizes deeper;
  deeper.bev_layers = 3;
  const WeightTensors weights = encoderOf(sizes);
  EXPECT_THROW(bevEncoderFor(deeper, {sizes, weights, "test"}), core::InputError);
  EXPECT_THROW(bevEncoderFor(sizes, {sizes, {}, "test"}), core::InputError);
}

}  // namespace
}  // namespace cdiff::planners
