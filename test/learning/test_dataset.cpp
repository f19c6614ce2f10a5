// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/small_samples.h"

namespace cdiff::learning {
namespace {

using core::InputError;

std::uint64_t sessionOf(const Dataset& dataset, std::size_t index) {
  return dataset.sample(index).get<std::vector<std::uint64_t>>("session").at(0);
}

TEST(Dataset, HoldsOutWholeSessions) {
  const test::TemporaryFolder folder;
  for (int shard = 0; shard < 2; ++shard) {
    DrivingShardWriter writer(test::smallSchema());
    for (std::size_t i = 0; i < 60; ++i) writer.append(test::smallSample(i % 8, i / 2));
    writer.write(folder.path() / (std::to_string(shard) + ".shard"));
  }
  const Dataset dataset(folder.path(), 0.3);
  EXPECT_EQ(dataset.size(), 120U);
  EXPECT_EQ(dataset.sessions(), 30U);
  EXPECT_EQ(dataset.training().size() + dataset.validation().size(), 120U);
  std::set<std::uint64_t> held_out;
  for (const std::size_t i : dataset.validation()) held_out.insert(sessionOf(dataset, i));
  EXPECT_EQ(held_out.size(), dataset.validationSessions());
  for (const std::size_t i : dataset.training())
    EXPECT_EQ(held_out.count(sessionOf(dataset, i)), 0U);
}

TEST(Dataset, OfTwoSessionsOneIsHeldOutWhateverTheShare) {
  const test::TemporaryFolder folder;
  DrivingShardWriter writer(test::smallSchema());
  for (std::size_t i = 0; i < 6; ++i) writer.append(test::smallSample(i, i / 3));
  writer.write(folder.path() / "a.shard");
  for (const double share : {1e-9, 0.1, 0.9}) {
    const Dataset dataset(folder.path(), share);
    EXPECT_EQ(dataset.validationSessions(), 1U) << share;
    EXPECT_EQ(dataset.validation().size(), 3U) << share;
    EXPECT_EQ(dataset.training().size(), 3U) << share;
  }
}

TEST(Dataset, RefusesASplitWithoutBothPartsAndForeignSchemas) {
  const test::TemporaryFolder folder;
  test::writeShard(folder.path() / "a.shard", 4);
  EXPECT_THROW(Dataset(folder.path(), 1e-9), InputError);
  EXPECT_EQ(Dataset(folder.path(), 0.0).validation().size(), 4U);
  DrivingSchema other = test::smallSchema();
  other.route_spacing = 2.0;
  DrivingShardWriter writer(other);
  writer.append(test::smallSample(0, 1));
  writer.write(folder.path() / "b.shard");
  EXPECT_THROW(Dataset(folder.path(), 0.0), InputError);
}

TEST(Dataset, ShardsWithoutSamplesAreNamed) {
  const test::TemporaryFolder folder;
  test::writeShard(folder.path() / "a.shard", 0);
  try {
    const Dataset dataset(folder.path(), 0.0);
    FAIL() << "read";
  } catch (const core::InputError& error) {
    EXPECT_EQ(std::string(error.what())
                  .rfind("data folder '" + folder.path().string() +
                             "': its shards hold no samples; collect",
                         0),
              0U)
        << error.what();
  }
}

TEST(Dataset, SamplesWithoutASessionAreNamed) {
  const test::TemporaryFolder folder;
  ShardWriter writer(SampleSchema{{{"speed", FieldType::kF32}}});
  writer.append({{{"speed", std::vector<float>{1.0F}}}});
  writer.write(folder.path() / "a.shard");
  try {
    const Dataset dataset(folder.path(), 0.0);
    FAIL() << "read";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("lack the field 'session' (one u64)"),
              std::string::npos)
        << error.what();
  }
}

TEST(DrivingDataset, NamesTheFieldThatTheDataLack) {
  SampleSchema schema = test::smallSchema().fields();
  schema.fields.erase(schema.fields.end() - 1);  // the image
  EXPECT_NO_THROW(DrivingSchema::fromFields(test::smallSchema().fields(), "data"));
  try {
    DrivingSchema::fromFields(schema, "data");
    FAIL() << "taken";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("data: lacks the field 'image'"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cdiff::learning
