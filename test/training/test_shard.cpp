// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "training/shard.h"
#include "training/small_samples.h"

namespace cdiff::training {
namespace {

using core::InputError;
using test::smallSample;
using test::smallSchema;

class ShardTest : public testing::Test {
 protected:
  void SetUp() override {
    ShardWriter writer(smallSchema());
    for (std::size_t i = 0; i < 3; ++i) writer.append(smallSample(i, 100 + i));
    writer.write(file_, {{"town", "Town01"}});
    content_ = core::readFile(file_, "shard");
  }

  /// Text of the error that reading `content` in place of the shard throws; empty if none.
  std::string errorOf(const std::string& content) const {
    core::writeFileAtomically(file_, content);
    try {
      const ShardReader reader(file_);
      for (std::size_t i = 0; i < reader.size(); ++i) reader.sample(i);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  void expectError(const std::string& content, const std::string& reason) const {
    const std::string error = errorOf(content);
    EXPECT_NE(error.find(reason), std::string::npos) << error;
    EXPECT_NE(error.find(file_.string()), std::string::npos) << error;
  }

  /// The content with a part of its header replaced and the checksum made right again.
  std::string resealed(const std::string& from, const std::string& to) const {
    std::string changed = content_.substr(0, content_.size() - 64);
    changed.replace(changed.find(from), from.size(), to);
    return changed + core::sha256(changed);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "a.shard";
  std::string content_;
};

TEST_F(ShardTest, KeepsEverySampleToTheBit) {
  const ShardReader reader(file_);
  ASSERT_EQ(reader.size(), 3U);
  EXPECT_TRUE(reader.schema() == smallSchema());
  EXPECT_EQ(reader.facts().at("town"), "Town01");
  for (std::size_t i = 0; i < 3; ++i) {
    const Sample expected = smallSample(i, 100 + i);
    const Sample found = reader.sample(i);
    EXPECT_EQ(found.image.rgb, expected.image.rgb);
    EXPECT_EQ(found.image.tick, expected.tick);
    EXPECT_EQ(found.speed, expected.speed);
    EXPECT_EQ(found.rollout, expected.rollout.cast<float>().cast<double>());
    EXPECT_EQ(found.route, expected.route);
    EXPECT_EQ(found.session, 100 + i);
    EXPECT_EQ(reader.session(i), 100 + i);
    EXPECT_EQ(found.vehicle, expected.vehicle);
    EXPECT_EQ(found.tick, expected.tick);
    EXPECT_EQ(found.recovering, expected.recovering);
    EXPECT_EQ(found.maneuver, expected.maneuver);
    EXPECT_TRUE(reader.withoutImage(i).image.empty());
  }
}

TEST_F(ShardTest, AuxiliaryTargetsMayBeUnknown) {
  SampleSchema schema = smallSchema();
  schema.auxiliary = {"gap", "offset"};
  ShardWriter writer(schema);
  Sample sample = smallSample(0, 1);
  EXPECT_THROW(writer.append(sample), InputError);
  sample.auxiliary = {4.5F, std::numeric_limits<float>::quiet_NaN()};
  writer.append(sample);
  writer.write(folder_.path() / "b.shard");
  const ShardReader reader(folder_.path() / "b.shard");
  EXPECT_EQ(reader.sample(0).auxiliary[0], 4.5F);
  EXPECT_TRUE(std::isnan(reader.sample(0).auxiliary[1]));
}

TEST_F(ShardTest, RefusesEveryTruncation) {
  // Every cut is refused with an error, whatever the cut leaves behind.
  for (std::size_t length = 0; length < content_.size(); length += 97)
    EXPECT_NE(errorOf(content_.substr(0, length)), "") << length;
  expectError(content_.substr(0, 40), "truncated");
  expectError(content_.substr(0, content_.size() / 2), "truncated");
}

TEST_F(ShardTest, RefusesAnotherByteAnywhere) {
  for (std::size_t place = 0; place < content_.size(); place += 101) {
    std::string changed = content_;
    changed[place] = static_cast<char>(changed[place] ^ 1);
    EXPECT_NE(errorOf(changed), "") << place;
  }
  std::string in_the_last_image = content_;
  in_the_last_image[content_.size() - 70] ^= 1;
  expectError(in_the_last_image, "checksum");
}

TEST_F(ShardTest, RefusesForeignAndLaterFiles) {
  std::string changed = content_;
  changed[0] = 'X';
  expectError(changed, "is not a shard");
  changed = content_;
  changed[8] = 2;
  expectError(changed, "version 2, this program reads 1");
}

TEST_F(ShardTest, RefusesAHeaderThatDoesNotFitTheSamples) {
  expectError(resealed("\"samples\":3", "\"samples\":4"), "3 of 4 samples");
  expectError(resealed("\"samples\":3", "\"samples\":2"), "truncated or overlong");
  expectError(resealed("\"horizon\":8", "\"horizon\":9"), "truncated");
  expectError(resealed("\"horizon\":8", "\"horizon\":0"), "'horizon'");
  expectError(resealed("\"image_width\":64", "\"image_width\":96"), "does not unpack");
  expectError(resealed("\"schema\"", "\"scheme\""), "header");
}

TEST_F(ShardTest, WriterNamesWhatDoesNotFit) {
  ShardWriter writer(smallSchema());
  Sample sample = smallSample(0, 1);
  sample.rollout.conservativeResize(7, Eigen::NoChange);
  EXPECT_THROW(writer.append(sample), InputError);
  sample = smallSample(0, 1);
  sample.image.width = 32;
  EXPECT_THROW(writer.append(sample), InputError);
  sample = smallSample(0, 1);
  sample.rollout(3, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writer.append(sample), InputError);
  EXPECT_EQ(writer.size(), 0U);
  EXPECT_THROW(writer.write(folder_.path() / "no such folder" / "a.shard"), InputError);
}

TEST_F(ShardTest, FindsShardsInOrder) {
  ShardWriter writer(smallSchema());
  writer.append(smallSample(0, 1));
  std::filesystem::create_directories(folder_.path() / "0");
  writer.write(folder_.path() / "0" / "z.shard");
  const auto shards = findShards(folder_.path());
  ASSERT_EQ(shards.size(), 2U);
  EXPECT_EQ(shards[0], folder_.path() / "0" / "z.shard");
  EXPECT_EQ(shards[1], file_);
  std::filesystem::create_directories(folder_.path() / "empty");
  EXPECT_THROW(findShards(folder_.path() / "empty"), InputError);
  EXPECT_THROW(findShards(folder_.path() / "missing"), InputError);
}

}  // namespace
}  // namespace cdiff::training
