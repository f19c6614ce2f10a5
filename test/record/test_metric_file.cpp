// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/metric_file.h"

namespace cdiff::record {
namespace {

using Lines = std::vector<std::string>;

class MetricFile : public ::testing::Test {
 protected:
  MetricFile() { std::filesystem::create_directories(folder_); }
  ~MetricFile() override { std::filesystem::remove_all(folder_); }

  Lines evaluate(const std::string& metric, const std::string& content) {
    const auto path = folder_ / "cases";
    core::writeFileAtomically(path, content);
    return evaluateMetricFile(metric, path.string());
  }

  /// Text of the InputError; empty when there was none.
  std::string errorOf(const std::string& metric, const std::string& content) {
    try {
      evaluate(metric, content);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return {};
  }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("test_metric_file_" + std::to_string(getpid()));
};

const char* const kHeader =
    "x_i,y_i,vx_i,vy_i,hx_i,hy_i,length_i,width_i,x_j,y_j,vx_j,vy_j,hx_j,hy_j,length_j,width_j\n";

TEST_F(MetricFile, GivesTimesToCollisionOfBoxPairs) {
  // Gap 14 - (4 + 4) / 2 = 10 m at 4 m/s: 2.5 s. Side by side 9 m apart: never.
  const Lines lines = evaluate("ttc_2d", std::string(kHeader) +
                                             "0,0,4,0,1,0,4,2,14,0,0,0,1,0,4,2\r\n\n"
                                             "0,0,4,0,1,0,4,2,14,9,0,0,1,0,4,2\n");
  EXPECT_EQ(lines, (Lines{"1: 2.5", "2: inf"}));
}

TEST_F(MetricFile, RefusesBoxesThatCannotBe) {
  const std::string header = kHeader;
  EXPECT_NE(errorOf("ttc_2d", header + "0,0,4,0,1,0,-4,2,14,0,0,0,1,0,4,2\n")
                .find(":2: column length_i is \"-4\", expected a size above 0"),
            std::string::npos);
  EXPECT_NE(errorOf("ttc_2d", header + "0,0,4,0,1,0,4,2,14,0,0,0,1,0,4,0\n").find("width_j"),
            std::string::npos);
  EXPECT_NE(errorOf("ttc_2d", header + "0,0,4,0,0,0,4,2,14,0,0,0,1,0,4,2\n").find("column hx_i"),
            std::string::npos);
}

TEST_F(MetricFile, RefusesTwoColumnsOfOneName) {
  EXPECT_NE(errorOf("ttc_2d", "note,note," + std::string(kHeader)).find(":1: two columns"),
            std::string::npos);
}

TEST_F(MetricFile, FindsColumnsByName) {
  const Lines lines = evaluate("ttc_2d",
                               "note,length_i,width_i,x_i,y_i,hx_i,hy_i,vx_i,vy_i,"
                               "length_j,width_j,x_j,y_j,hx_j,hy_j,vx_j,vy_j\n"
                               "any,4,2,0,0,1,0,4,0,4,2,14,0,1,0,0,0\n");
  EXPECT_EQ(lines, Lines{"1: 2.5"});
}

TEST_F(MetricFile, GivesShapiroWilkOfCases) {
  // Evenly spaced values of three: W = 1, p = 1. Two values are too few.
  const Lines lines =
      evaluate("shapiro_wilk", R"({"cases": [{"kind": "even", "x": [1, 2, 3]}, {"x": [1, 2]}]})");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].rfind("1 (even, n = 3): W = ", 0), 0U) << lines[0];
  EXPECT_EQ(lines[1], "2 (n = 2): none, n = 2, needs at least 3");
}

TEST_F(MetricFile, SaysWhyACaseHasNoShapiroWilk) {
  EXPECT_EQ(
      evaluate("shapiro_wilk", R"({"cases": [{"x": []}, {"x": [2, 2, 2.0, 2]}]})"),
      (Lines{"1 (n = 0): none, n = 0, needs at least 3", "2 (n = 4): none, all values are equal"}));
}

TEST_F(MetricFile, RefusesValuesThatAreNoNumbers) {
  // NaN is no JSON; null and text are, but no numbers; 1e999 is beyond a double.
  EXPECT_NE(errorOf("shapiro_wilk", R"({"cases": [{"x": [1, NaN, 3]}]})").find("line 1, column"),
            std::string::npos);
  EXPECT_NE(errorOf("shapiro_wilk", R"({"cases": [{"x": [1, 2, 3]}, {"x": [1, null, 3]}]})")
                .find("case 2: \"x\" holds null, expected numbers"),
            std::string::npos);
  EXPECT_NE(errorOf("wasserstein", R"({"cases": [{"a": [1e999], "b": [1]}]})").find("1e999"),
            std::string::npos);
  const std::string nan_pair = "0,0,nan,0,1,0,4,2,14,0,0,0,1,0,4,2\n";
  EXPECT_NE(errorOf("ttc_2d", std::string(kHeader) + nan_pair)
                .find(":2: column vx_i is \"nan\", expected a finite number"),
            std::string::npos);
}

TEST_F(MetricFile, GivesWassersteinOfCases) {
  // |7 - 4| / 2 + |7 - 8| / 2 = 2.
  const Lines lines =
      evaluate("wasserstein", R"({"cases": [{"a": [7], "b": [8, 4]}, {"a": [], "b": [1]}]})");
  EXPECT_EQ(lines, (Lines{"1 (n = 1, 2): 2", "2 (n = 0, 1): none, a sample is empty"}));
}

TEST_F(MetricFile, NamesWhatIsWrong) {
  EXPECT_NE(errorOf("ttc_2d", "x_i\n1\n").find(":2: no column y_i"), std::string::npos);
  EXPECT_NE(errorOf("ttc_2d", std::string(kHeader) + "0,a\n").find("column y_i is \"a\""),
            std::string::npos);
  EXPECT_NE(errorOf("ttc_2d", "").find("expected a header"), std::string::npos);
  EXPECT_NE(errorOf("wasserstein", "{").find("not JSON"), std::string::npos);
  EXPECT_NE(errorOf("wasserstein", "[]").find("\"cases\""), std::string::npos);
  EXPECT_NE(
      errorOf("wasserstein", R"({"cases": [{"a": [1]}]})").find("case 1: expected a list \"b\""),
      std::string::npos);
  EXPECT_NE(errorOf("shapiro_wilk", R"({"cases": [{"x": [1, "two"]}]})").find("holds \"two\""),
            std::string::npos);
  EXPECT_NE(errorOf("shapiro", "{}").find("nearest: shapiro_wilk"), std::string::npos);
  EXPECT_THROW(evaluateMetricFile("ttc_2d", "/nowhere/pairs.csv"), core::InputError);
}

}  // namespace
}  // namespace cdiff::record
