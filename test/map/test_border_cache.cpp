// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <functional>

#include "core/checked_cache.h"
#include "core/file.h"
#include "map/border_cache.h"
#include "support/own_cache.h"

namespace cdiff::map {
namespace {

namespace fs = std::filesystem;

/// Roads 4 m wide and 20 m apart, with a bend, so that each is a ring of its own.
std::vector<Strip> roads(std::size_t count) {
  std::vector<Strip> strips;
  for (std::size_t i = 0; i < count; ++i) {
    const double y = 20.0 * static_cast<double>(i) - 100.0;
    strips.push_back({{{0.0, y}, {40.0, y}, {70.1234, y + 3.0}}, 4.0});
  }
  return strips;
}

/// The only union that the cache holds.
fs::path keptFile(const test::OwnCache& cache) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(cache.path() / "borders"))
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  EXPECT_EQ(files.size(), 1u);
  return files.empty() ? fs::path() : files.front();
}

TEST(BorderCache, TheKeptUnionIsTheSame) {
  const test::OwnCache cache;
  const std::vector<Strip> strips = roads(kLeastKeptOutlines);
  const std::vector<Ring> polygons = {{{-50.0, 0.0}, {-40.0, 0.0}, {-40.0, 9.999}}};
  const std::vector<Ring> expected = uniteOutlines(strips, polygons);
  ASSERT_EQ(expected.size(), kLeastKeptOutlines + 1);
  EXPECT_EQ(keptUnion(strips, polygons), expected);
  EXPECT_EQ(keptUnion(strips, polygons), expected);
  keptFile(cache);
}

TEST(BorderCache, IsReadAgain) {
  const test::OwnCache cache;
  const std::vector<Strip> strips = roads(kLeastKeptOutlines);
  keptUnion(strips, {});
  core::storeChecked(keptFile(cache), "0 0 2000 0 0 1500 \n");
  const std::vector<Ring> triangle = {{{0.0, 0.0}, {2.0, 0.0}, {0.0, 1.5}}};
  EXPECT_EQ(keptUnion(strips, {}), triangle);
}

TEST(BorderCache, OtherOutlinesHaveAnotherUnion) {
  const test::OwnCache cache;
  std::vector<Strip> strips = roads(kLeastKeptOutlines);
  const std::vector<Ring> first = keptUnion(strips, {});
  strips.back().width = 5.0;
  EXPECT_NE(keptUnion(strips, {}), first);
  EXPECT_EQ(keptUnion(strips, {}), uniteOutlines(strips, {}));
}

/// Changes that a cache may suffer.
const std::vector<std::function<void(const fs::path&)>> kDamages = {
    [](const fs::path& file) { core::writeFileAtomically(file, ""); },
    [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) - 1); },
    [](const fs::path& file) { fs::remove(file.string() + ".sha256"); }};

TEST(BorderCache, ADamagedOneIsMadeAgain) {
  const test::OwnCache cache;
  const std::vector<Strip> strips = roads(kLeastKeptOutlines);
  const std::vector<Ring> expected = keptUnion(strips, {});
  const fs::path file = keptFile(cache);
  const std::string content = core::readFile(file, "kept union");
  for (std::size_t i = 0; i < kDamages.size(); ++i) {
    kDamages[i](file);
    EXPECT_EQ(keptUnion(strips, {}), expected) << i;
    EXPECT_EQ(core::checkedContent(file), content) << i;
  }
}

TEST(BorderCache, GoesOnWithoutACache) {
  const test::OwnCache cache;
  core::writeFileAtomically(cache.path(), "a file, where no folder can be made");
  const std::vector<Strip> strips = roads(kLeastKeptOutlines);
  EXPECT_EQ(keptUnion(strips, {}), uniteOutlines(strips, {}));
}

TEST(BorderCache, FewOutlinesLeaveNoFile) {
  const test::OwnCache cache;
  const std::vector<Strip> strips = roads(kLeastKeptOutlines - 1);
  EXPECT_EQ(keptUnion(strips, {}), uniteOutlines(strips, {}));
  EXPECT_FALSE(fs::exists(cache.path()));
}

}  // namespace
}  // namespace cdiff::map
