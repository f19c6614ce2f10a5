// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/field.h"
#include "learning/small_samples.h"

namespace cdiff::learning {
namespace {

using core::InputError;
using test::smallSample;
using test::smallSchema;

class ShardTest : public testing::Test {
 protected:
  void SetUp() override {
    DrivingShardWriter writer(smallSchema());
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

  /// The shards of the folder hold the first three small samples and no other.
  void expectSmallSamples() const {
    const Dataset stored(folder_.path(), 0.0);
    const DrivingDataset dataset(stored);
    ASSERT_EQ(dataset.size(), 3U);
    EXPECT_TRUE(dataset.schema() == smallSchema());
    for (std::size_t i = 0; i < 3; ++i) {
      const DrivingSample expected = smallSample(i, 100 + i);
      const DrivingSample found = dataset.sample(i);
      EXPECT_EQ(found.image.rgb, expected.image.rgb);
      EXPECT_EQ(found.image.tick, expected.tick);
      EXPECT_EQ(found.speed, expected.speed);
      EXPECT_EQ(found.rollout, expected.rollout.cast<float>().cast<double>());
      EXPECT_EQ(found.route, expected.route);
      EXPECT_EQ(found.session, 100 + i);
      EXPECT_EQ(found.vehicle, expected.vehicle);
      EXPECT_EQ(found.tick, expected.tick);
      EXPECT_EQ(found.recovering, expected.recovering);
      EXPECT_EQ(found.maneuver, expected.maneuver);
      EXPECT_TRUE(dataset.withoutImage(i).image.empty());
    }
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
  EXPECT_TRUE(reader.schema() == smallSchema().fields());
  EXPECT_EQ(reader.facts().at("town"), "Town01");
  expectSmallSamples();
}

TEST_F(ShardTest, KeepsTheImageBeforeAndTheTargetSpeedWhereTheyAreKnown) {
  test::TemporaryFolder folder;
  test::writeShard(folder.path() / "motion.shard", 6, test::motionSchema());
  const Dataset stored(folder.path(), 0.0);
  const DrivingDataset dataset(stored);
  EXPECT_TRUE(dataset.schema() == test::motionSchema());
  EXPECT_FALSE(dataset.schema() == smallSchema());
  for (std::size_t i = 0; i < 6; ++i) {
    const DrivingSample expected = test::motionSample(i, 1);
    const DrivingSample found = dataset.sample(i);
    EXPECT_EQ(found.image.rgb, expected.image.rgb);
    EXPECT_EQ(found.previous_image.rgb, expected.previous_image.rgb) << i;
    EXPECT_EQ(found.previous_image.empty(), i % 3 == 2);
    EXPECT_EQ(std::isnan(found.target_speed), i % 5 == 4);
    if (i % 5 != 4) {
      EXPECT_EQ(found.target_speed, expected.target_speed);
    }
    EXPECT_TRUE(dataset.withoutImage(i).previous_image.empty());
    EXPECT_EQ(dataset.withoutImage(i).speed, expected.speed);
  }
}

TEST_F(ShardTest, AuxiliaryTargetsMayBeUnknown) {
  DrivingSchema schema = smallSchema();
  schema.auxiliary = {"gap", "offset"};
  DrivingShardWriter writer(schema);
  DrivingSample sample = smallSample(0, 1);
  EXPECT_THROW(writer.append(sample), InputError);
  sample.auxiliary = {4.5F, std::numeric_limits<float>::quiet_NaN()};
  writer.append(sample);
  writer.write(folder_.path() / "b.shard");
  const ShardReader reader(folder_.path() / "b.shard");
  const Sample found = reader.sample(0);
  EXPECT_EQ(found.get<std::vector<float>>("auxiliary")[0], 4.5F);
  EXPECT_TRUE(std::isnan(found.get<std::vector<float>>("auxiliary")[1]));
  EXPECT_EQ(reader.schema().find("auxiliary")->columns, schema.auxiliary);
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
  changed[8] = 3;
  expectError(changed, "version 3, this program reads 1 to 2");
}

TEST_F(ShardTest, RefusesAHeaderThatDoesNotFitTheSamples) {
  expectError(resealed("\"samples\":3", "\"samples\":4"), "3 of 4 samples");
  expectError(resealed("\"samples\":3", "\"samples\":2"), "truncated or overlong");
  expectError(resealed("[8,7]", "[9,7]"), "truncated");
  expectError(resealed("[8,7]", "[-9 ]"), "field 'rollout': 'shape' holds the size -9");
  expectError(resealed("[64,64,3]", "[64,96,3]"), "field 'image' does not unpack");
  expectError(resealed("\"fields\"", "\"fieldz\""), "header");
}

TEST_F(ShardTest, WriterNamesWhatDoesNotFit) {
  DrivingShardWriter writer(smallSchema());
  DrivingSample sample = smallSample(0, 1);
  sample.rollout.conservativeResize(7, Eigen::NoChange);
  EXPECT_THROW(writer.append(sample), InputError);
  sample = smallSample(0, 1);
  sample.image.width = 32;
  EXPECT_THROW(writer.append(sample), InputError);
  sample = smallSample(0, 1);
  sample.rollout(3, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writer.append(sample), InputError);
  EXPECT_EQ(writer.size(), 0U);
  core::writeFileAtomically(folder_.path() / "file", "");
  EXPECT_THROW(writer.write(folder_.path() / "file" / "a.shard"), InputError);
}

/// A shard of version 1: its header names sizes, its samples are those of version 2.
std::string versionOne(const std::string& version_two) {
  ByteReader reader(version_two, "shard", 8 + sizeof(std::uint32_t));
  reader.text();
  const std::size_t end = version_two.size() - 64;
  std::string content = "CDIFFSHD";
  putValue(content, std::uint32_t{1});
  putText(content, R"({"schema":{"horizon":8,"image_width":64,"image_height":64,"route_points":4,)"
                   R"("route_spacing":3.0,"auxiliary":[]},"samples":3,"facts":{"town":"Town01"}})");
  content += version_two.substr(reader.place(), end - reader.place());
  return content + core::sha256(content);
}

TEST_F(ShardTest, ReadsVersionOne) {
  core::writeFileAtomically(file_, versionOne(content_));
  EXPECT_EQ(ShardReader(file_).facts().at("town"), "Town01");
  expectSmallSamples();
  std::string broken = versionOne(content_);
  const std::string key = "\"horizon\":8";
  broken.replace(broken.find(key), key.size(), "\"horizon\":0");
  expectError(broken, "schema key 'horizon' must be a whole number");
}

TEST_F(ShardTest, BodyIsThatOfVersionOne) {
  // Offsets of a sample as version 1 had them: session and tick (u64), speed (f64), three bytes,
  // the vehicle's id behind its u32 length, 8 x 7 + 4 x 2 floats, the image behind its length.
  ByteReader reader(content_, "shard", 8 + sizeof(std::uint32_t));
  reader.text();
  EXPECT_EQ(reader.value<std::uint64_t>(), 100U);
  EXPECT_EQ(reader.value<std::uint64_t>(), 0U);
  EXPECT_EQ(reader.value<double>(), 5.0);
  reader.take(3);
  EXPECT_EQ(reader.text(), "v0");
  EXPECT_EQ(reader.value<float>(), 0.5F);  // x after 0.1 s at 5 m/s
  reader.take((8 * 7 + 4 * 2 - 1) * sizeof(float));
  reader.text();
  EXPECT_EQ(reader.value<std::uint64_t>(), 101U);
}

/// Fields that no driving sample has: boxes and lanes, as many as there are, and scores.
SampleSchema sceneSchema() {
  FieldSpec boxes("boxes", FieldType::kF32, {kAnyCount, 5});
  boxes.columns = {"x", "y", "heading", "length", "width"};
  FieldSpec lanes("lanes", FieldType::kF64, {kAnyCount, 3, 2});
  lanes.numbers = {{"spacing", 2.5}};
  FieldSpec picture("picture", FieldType::kU8, {2, 2});
  picture.packed = true;
  return {{{kSessionField, FieldType::kU64},
           boxes,
           lanes,
           {"scores", FieldType::kF32, {3}},
           picture,
           {"town", FieldType::kText}}};
}

Sample scene(std::size_t boxes) {
  return {{{kSessionField, std::vector<std::uint64_t>{7}},
           {"boxes", std::vector<float>(5 * boxes, 0.5F)},
           {"lanes", std::vector<double>(6, 0.25)},
           {"scores", std::vector<float>{0.1F, 0.2F, 0.7F}},
           {"picture", std::vector<std::uint8_t>{1, 2, 3, 4}},
           {"town", std::string("Town02")}}};
}

TEST(FieldBytes, RefusesMoreRowsThanASampleCanHold) {
  FieldSpec boxes = sceneSchema().fields[1];
  boxes.packed = true;  // so that nothing but the number says how many there are
  std::string bytes;
  putField(bytes, boxes, std::vector<float>(10, 0.5F));
  bytes.replace(0, 4, "\xff\xff\xff\x7f");  // 2^31 - 1 rows of 5 values
  ByteReader reader(bytes, "a.shard");
  try {
    takeField(reader, boxes, "a.shard");
    ADD_FAILURE() << "taken";
  } catch (const core::InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("a.shard: field 'boxes' says that it holds", 0), 0U)
        << error.what();
  }
}

TEST_F(ShardTest, KeepsFieldsThatItNeverHeardOf) {
  ShardWriter writer(sceneSchema());
  for (const std::size_t boxes : {2U, 0U, 3U}) writer.append(scene(boxes));
  writer.write(file_);
  const ShardReader reader(file_);
  EXPECT_TRUE(reader.schema() == sceneSchema());
  EXPECT_EQ(reader.sample(0).fields, scene(2).fields);
  EXPECT_EQ(reader.sample(1).fields, scene(0).fields);
  EXPECT_EQ(reader.sample(2).fields, scene(3).fields);
  const Sample part = reader.sample(2, {"boxes", "picture"});
  EXPECT_EQ(part.fields.count("boxes") + part.fields.count("picture"), 0U);
  EXPECT_EQ(part.fields.size(), 4U);
}

TEST_F(ShardTest, WriterNamesTheFieldThatDoesNotFit) {
  const auto refusal = [](const Sample& sample) -> std::string {
    try {
      ShardWriter(sceneSchema()).append(sample);
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_EQ(refusal(scene(1)), "taken");
  Sample sample = scene(1);
  sample.fields["scores"] = std::vector<float>(2);
  EXPECT_EQ(refusal(sample), "sample: field 'scores' holds 2 values, the schema says 3");
  sample = scene(1);
  sample.fields["boxes"] = std::vector<float>(7);
  EXPECT_EQ(refusal(sample),
            "sample: field 'boxes' holds 7 values, the schema says a multiple of 5");
  sample = scene(1);
  sample.fields["scores"] = std::vector<double>(3);
  EXPECT_EQ(refusal(sample), "sample: field 'scores' has another type than f32");
  sample = scene(1);
  sample.fields.erase("town");
  EXPECT_EQ(refusal(sample), "sample: field 'town' of the schema is missing");
  sample = scene(1);
  sample.fields["weather"] = std::string("rain");
  EXPECT_EQ(refusal(sample), "sample: field 'weather' is not in the schema");
  sample = scene(1);
  sample.fields["lanes"] = std::vector<double>(6, std::numeric_limits<double>::infinity());
  EXPECT_EQ(refusal(sample), "sample: field 'lanes' is not finite");
}

TEST_F(ShardTest, FindsShardsInOrder) {
  DrivingShardWriter writer(smallSchema());
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
}  // namespace cdiff::learning
