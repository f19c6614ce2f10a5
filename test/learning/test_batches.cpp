// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/batches.h"
#include "learning/parameters.h"
#include "learning/samples/dataset.h"
#include "support/temporary_folder.h"

namespace cdiff::learning {
namespace {

/// Three samples of session 1 with 2, 0 and 1 boxes, and the number of the sample as its score.
class BatchesTest : public testing::Test {
 protected:
  BatchesTest() {
    ShardWriter writer({{{kSessionField, FieldType::kU64},
                         {"score", FieldType::kF64},
                         {"boxes", FieldType::kF32, {kAnyCount, 2}},
                         {"town", FieldType::kText}}});
    const std::vector<std::vector<float>> boxes = {{1.0F, 2.0F, 3.0F, 4.0F}, {}, {5.0F, 6.0F}};
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      writer.append({{{kSessionField, std::vector<std::uint64_t>{1}},
                      {"score", std::vector<double>{static_cast<double>(i)}},
                      {"boxes", boxes[i]},
                      {"town", std::string("Town02")}}});
    }
    writer.write(folder_.path() / "a.shard");
    dataset_.emplace(folder_.path(), 0.0);
  }
  FieldBatch batch(const std::string& field) const {
    return fieldBatch(*dataset_, {2, 0, 1}, field, at::kCPU);
  }

  test::TemporaryFolder folder_;
  std::optional<Dataset> dataset_;
};

TEST_F(BatchesTest, OneValueASampleInTheOrderAskedFor) {
  const FieldBatch scores = batch("score");
  EXPECT_EQ(scores.values.sizes().vec(), std::vector<std::int64_t>{3});
  EXPECT_EQ(toVector(scores.values), (std::vector<float>{2.0F, 0.0F, 1.0F}));
  EXPECT_FALSE(scores.counts.defined());
}

TEST_F(BatchesTest, RowsThatASampleHasNotAreZeroAndCounted) {
  const FieldBatch boxes = batch("boxes");
  EXPECT_EQ(boxes.values.sizes().vec(), (std::vector<std::int64_t>{3, 2, 2}));
  EXPECT_EQ(toVector(boxes.values), (std::vector<float>{5.0F, 6.0F, 0.0F, 0.0F, 1.0F, 2.0F, 3.0F,
                                                        4.0F, 0.0F, 0.0F, 0.0F, 0.0F}));
  EXPECT_EQ(toVector(boxes.counts), (std::vector<float>{1.0F, 2.0F, 0.0F}));
}

TEST_F(BatchesTest, TextsAndUnknownFieldsAreNamed) {
  for (const char* field : {"town", "weather"}) {
    try {
      batch(field);
      FAIL() << field;
    } catch (const core::InputError& error) {
      EXPECT_NE(std::string(error.what())
                    .find(std::string("have no numbers '") + field +
                          "'; they hold session, score, boxes, town"),
                std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace cdiff::learning
