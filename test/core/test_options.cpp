// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/option_fields.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/options.h"

namespace cdiff::core {
namespace {

struct InnerOptions {
  double radius = 60.0;
  std::string ranking = "score";
  void describe(OptionsVisitor& visitor) {
    visitor.number({"radius", "m", "Radius."}, radius, 0.0, 100.0);
    visitor.text({"ranking", "", "Ranking."}, ranking, {"score", "nearest"});
  }
};

struct OuterOptions {
  std::int64_t seed = 1;
  bool record = false;
  double radius_of_start = 5.0;
  std::vector<std::string> edges;
  std::vector<Eigen::Vector3d> points;
  InnerOptions inner;
  void describe(OptionsVisitor& visitor) {
    visitor.integer({"seed", "", "Seed."}, seed, 0, 100);
    visitor.flag({"record", "", "Record."}, record);
    visitor.number({"radius_of_start", "m", "Radius of the start."}, radius_of_start, 0.0, 10.0);
    visitor.list({"edges", "", "Edges."}, edges);
    visitor.points({"points", "m", "Points."}, points);
    visitor.group({"inner", "", "Inner."}, inner);
  }
};

std::string errorOf(const std::string& yaml) {
  OuterOptions options;
  try {
    loadOptions({"file.yaml", yaml}, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Options, AreFlatByTheirFullKeys) {
  OuterOptions options;
  options.edges = {"a", "b"};
  const std::map<std::string, std::string> values = flatOptions(options);
  EXPECT_EQ(values.at("seed"), "1");
  EXPECT_EQ(values.at("edges"), "[\"a\", \"b\"]");
  EXPECT_EQ(values.at("inner.radius"), "60");
  EXPECT_EQ(values.at("inner.ranking"), "\"score\"");
  EXPECT_EQ(values.size(), 7u);  // the group itself has no value
}

TEST(Options, AnAssignmentToAGroupNamesItsKeysAndTheirValues) {
  OuterOptions options;
  const auto refusal = [&](const std::string& assignment) -> std::string {
    try {
      overrideOption(assignment, "--set", options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("inner=nearest"),
            "--set: key 'inner' is a group of keys and cannot be 'nearest'; set one of its keys: "
            "inner.radius, inner.ranking (one of {score, nearest})");
  EXPECT_EQ(refusal("inner={radius: 7}"), "");
  EXPECT_EQ(options.inner.radius, 7.0);
}

TEST(Options, LoadKeepsWhatIsNotGiven) {
  OuterOptions options;
  loadOptions({"file.yaml", "seed: 7\ninner:\n  radius: 12.5\npoints: [[1, 2], [3, 4, 5]]\n"},
              options);
  EXPECT_EQ(options.seed, 7);
  EXPECT_EQ(options.inner.radius, 12.5);
  EXPECT_EQ(options.inner.ranking, "score");
  ASSERT_EQ(options.points.size(), 2u);
  EXPECT_EQ(options.points[0].z(), 0.0);
  EXPECT_EQ(options.points[1].z(), 5.0);
}

TEST(Options, UnknownKeyNamesFileLineAndNearestKey) {
  const std::string error = errorOf("seed: 1\ninner:\n  radiuss: 3\n");
  EXPECT_TRUE(mentions(error, "file.yaml:3")) << error;
  EXPECT_TRUE(mentions(error, "inner.radiuss")) << error;
  EXPECT_TRUE(mentions(error, "nearest known key is 'radius'")) << error;
}

TEST(Options, ValueOutOfRangeNamesRange) {
  const std::string error = errorOf("inner: {radius: 101}\n");
  EXPECT_TRUE(mentions(error, "inner.radius")) << error;
  EXPECT_TRUE(mentions(error, "[0, 100] m")) << error;
}

TEST(Options, WrongTypesAreErrors) {
  EXPECT_TRUE(mentions(errorOf("seed: 1.5\n"), "whole number"));
  EXPECT_TRUE(mentions(errorOf("seed: [1]\n"), "whole number"));
  EXPECT_TRUE(mentions(errorOf("record: maybe\n"), "true or false"));
  EXPECT_TRUE(mentions(errorOf("inner: 3\n"), "group"));
  EXPECT_TRUE(mentions(errorOf("inner: {radius: .nan}\n"), "number"));
  EXPECT_TRUE(mentions(errorOf("points: [[1]]\n"), "points"));
  EXPECT_TRUE(mentions(errorOf("inner: {ranking: scores}\n"), "did you mean 'score'"));
}

TEST(Options, BrokenYamlAndRepeatedKeysAreErrors) {
  EXPECT_TRUE(mentions(errorOf("seed: [1\n"), "not valid YAML"));
  EXPECT_TRUE(mentions(errorOf("seed: 1\nseed: 2\n"), "given twice"));
  EXPECT_TRUE(mentions(errorOf("- 1\n"), "map of keys"));
}

TEST(Options, ANulByteIsNamedWithItsLine) {
  EXPECT_EQ(errorOf(std::string("seed: 1\nrecord\0: true\n", 22)),
            "file.yaml:2: holds a NUL byte, which no text has; expected YAML in UTF-8");
  OuterOptions options;
  // "seed: 7" in UTF-16 with its mark.
  std::string wide = "\xFF\xFE";
  for (const char letter : std::string("seed: 7\n")) wide += {letter, '\0'};
  loadOptions({"wide.yaml", wide}, options);
  EXPECT_EQ(options.seed, 7);
}

TEST(Options, AChoiceThatIsFarFromAllIsExplained) {
  const std::string error = errorOf("inner: {ranking: agressive}\n");
  EXPECT_FALSE(mentions(error, "did you mean")) << error;
  EXPECT_TRUE(mentions(error, "expected one of {score, nearest}: ")) << error;
}

// 8 MiB are 8388608 bytes, 64 KiB 65536.
TEST(Options, WhatIsTooLargeIsRefusedAtOnceAndNotQuoted) {
  const std::string long_text(70000, 'x');
  EXPECT_TRUE(mentions(errorOf("inner: {ranking: " + long_text + "}\n"),
                       "key 'inner.ranking' is a text of 70000 bytes; at most 65536"));
  EXPECT_TRUE(mentions(errorOf("? " + long_text + "\n: 1\n"), "longer than any known one"));
  EXPECT_LT(errorOf("inner: {ranking: " + long_text.substr(0, 60000) + "}\n").size(), 500U);
  EXPECT_TRUE(mentions(errorOf("#" + std::string(9000000, 'x')), "at most 8388608"));
  EXPECT_TRUE(mentions(errorOf("seed: " + std::string(5000, '[')), "nested deeper"));
}

TEST(Options, OverrideTakesPathOrUniqueLeaf) {
  OuterOptions options;
  overrideOption("inner.radius=3", "--set", options);
  EXPECT_EQ(options.inner.radius, 3.0);
  overrideOption("ranking=nearest", "--set", options);
  EXPECT_EQ(options.inner.ranking, "nearest");
  overrideOption("edges=[a, b]", "--set", options);
  EXPECT_EQ(options.edges.size(), 2u);
  EXPECT_EQ(options.seed, 1) << "an override leaves everything else";
}

TEST(Options, OverrideErrorsNameTheSource) {
  OuterOptions options;
  EXPECT_THROW(overrideOption("radius", "--set", options), InputError);
  EXPECT_THROW(overrideOption("radios=3", "--set", options), InputError);
  EXPECT_THROW(overrideOption("seed=101", "--set", options), InputError);
}

TEST(Options, ValuesSetInCodeAreHeldAgainstTheirRanges) {
  OuterOptions options;
  EXPECT_NO_THROW(requireRanges(options, "outer"));
  options.inner.radius = 100.5;
  try {
    requireRanges(options, "outer");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "outer option 'inner.radius' is 100.5; expected a number in [0, 100] m");
  }
  options.inner.radius = 100.0;
  options.inner.ranking = "farthest";
  EXPECT_THROW(requireRanges(options, "outer"), InputError);
  EXPECT_EQ(options.inner.ranking, "farthest") << "nothing is changed";
}

TEST(Options, DumpReadsBackToTheSameText) {
  OuterOptions options;
  options.inner.radius = 0.1 + 0.2;
  options.edges = {"a#1", "-b: c", "\"quoted\""};
  options.points = {{1.0 / 3.0, -2.0, 0.0}};
  const std::string text = dumpOptions(options);
  OuterOptions loaded;
  loadOptions({"dump", text}, loaded);
  EXPECT_EQ(dumpOptions(loaded), text);
  EXPECT_EQ(loaded.inner.radius, options.inner.radius);
  EXPECT_EQ(loaded.edges, options.edges);
}

}  // namespace
}  // namespace cdiff::core
