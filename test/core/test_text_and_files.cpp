// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/text.h"
#include "support/real_data.h"

namespace cdiff::core {
namespace {

TEST(Text, NumbersRoundTrip) {
  EXPECT_EQ(formatNumber(0.1), "0.1");
  EXPECT_EQ(formatNumber(-3.0), "-3");
  EXPECT_EQ(parseNumber(formatNumber(1.0 / 3.0)), 1.0 / 3.0);
  EXPECT_EQ(formatFixed(2.345, 1), "2.3");
  EXPECT_FALSE(parseNumber("3x"));
  EXPECT_FALSE(parseNumber(""));
  EXPECT_FALSE(parseNumber("nan"));
  EXPECT_FALSE(parseNumber("inf"));
}

// ctest runs each test in a folder of its own, and the compiler may know the source by a relative path.
TEST(RealData, IsFoundFromAnyFolder) {
  ::unsetenv("E2E_CDIFF_DATA");
  ::setenv("E2E_CDIFF_SHARE", "/somewhere/package", 1);
  EXPECT_EQ(test::realData("towns/a.xml"), "/somewhere/package/../shared/data/towns/a.xml");
}

TEST(Text, SplitAndJoin) {
  EXPECT_EQ(splitText(" a  b ", ' '), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(joinText({"a", "b"}, ", "), "a, b");
  EXPECT_TRUE(splitText("", ' ').empty());
}

TEST(Text, FileNamesStayInTheirFolder) {
  EXPECT_EQ(fileName("../../evil one"), "_.._evil_one");
  EXPECT_EQ(fileName("..."), "unnamed");
  EXPECT_EQ(fileName("a-b_1.2"), "a-b_1.2");
}

// Edit distances to "pdm_lit": 1, 7, 6.
TEST(Text, NearestName) {
  EXPECT_EQ(nearestName("pdm_lit", {"diffusion", "pdm_lite", "plant"}), "pdm_lite");
}

TEST(Angle, Wrap) {
  EXPECT_DOUBLE_EQ(wrapAngle(3.0 * kPi), kPi);
  EXPECT_DOUBLE_EQ(wrapAngle(-kPi), kPi);
  EXPECT_NEAR(angleDifference(-3.0, 3.0), 2.0 * kPi - 6.0, 1e-12);
}

// SHA-256 of "abc": FIPS 180-2, appendix B.1.
TEST(File, Sha256OfKnownText) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(File, AtomicWriteReplacesWholeFile) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("cdiff_file_" + std::to_string(std::rand()));
  std::filesystem::create_directories(folder);
  writeFileAtomically(folder / "a.txt", "one");
  writeFileAtomically(folder / "a.txt", "two");
  EXPECT_EQ(readFile(folder / "a.txt", "text"), "two");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder),
                          std::filesystem::directory_iterator()),
            1);
  EXPECT_THROW(readFile(folder, "text"), InputError);
  EXPECT_THROW(readFile(folder / "none", "text"), InputError);
  EXPECT_THROW(writeFileAtomically(folder / "none" / "a", "x"), InputError);
  std::filesystem::remove_all(folder);
}

TEST(File, AtomicWriteThatFailsLeavesNothingBehind) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("cdiff_file_" + std::to_string(std::rand()));
  std::filesystem::create_directories(folder / "a.txt" / "inside");  // a folder cannot be replaced
  EXPECT_THROW(writeFileAtomically(folder / "a.txt", "one"), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder),
                          std::filesystem::directory_iterator()),
            1);
  writeFileAtomically(folder / "b.txt.tmp.17", "left by a process that was killed");
  removeTemporaries(folder);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.txt.tmp.17"));
  EXPECT_TRUE(std::filesystem::exists(folder / "a.txt"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cdiff::core
