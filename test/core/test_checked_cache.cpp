// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/checked_cache.h"
#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "support/own_cache.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

TEST(CheckedCache, KeysHavePlacesOfTheirOwn) {
  const test::OwnCache cache;
  const fs::path file = cacheFile("things", "key", ".txt");
  EXPECT_EQ(file, cache.path() / "things" / (sha256("key") + ".txt"));
  EXPECT_TRUE(fs::is_directory(file.parent_path()));
  EXPECT_NE(cacheFile("things", "other key", ".txt"), file);
}

TEST(CheckedCache, GivesBackWhatWasStored) {
  const test::OwnCache cache;
  const fs::path file = cacheFile("things", "key", ".txt");
  EXPECT_EQ(checkedContent(file), std::nullopt);
  storeChecked(file, "first");
  EXPECT_EQ(checkedContent(file), "first");
  storeChecked(file, "");
  EXPECT_EQ(checkedContent(file), "");
}

TEST(CheckedCache, RefusesWhatIsAnotherNow) {
  const test::OwnCache cache;
  const fs::path file = cacheFile("things", "key", ".txt");
  storeChecked(file, "first");
  writeFileAtomically(file, "First");
  EXPECT_EQ(checkedContent(file), std::nullopt);
  EXPECT_EQ(cachedContent(file), "First") << "as it is, where nobody asks for the checksum";
  storeChecked(file, "first");
  fs::remove(file.string() + ".sha256");
  EXPECT_EQ(checkedContent(file), std::nullopt);
}

TEST(CheckedCache, ALinkIsReplaced) {
  const test::OwnCache cache;
  const fs::path file = cacheFile("things", "key", ".txt");
  const fs::path notes = cache.path() / "notes";
  writeFileAtomically(notes, "mine");
  fs::create_symlink(notes, file);
  storeInCache(file, "first");
  EXPECT_EQ(readFile(notes, "notes"), "mine");
  EXPECT_FALSE(fs::is_symlink(file));
}

TEST(CheckedCache, AFolderThatCannotBeMadeIsNamed) {
  const test::OwnCache cache;
  writeFileAtomically(cache.path(), "a file");
  EXPECT_THROW(cacheFile("things", "key", ".txt"), InputError);
}

}  // namespace
}  // namespace cdiff::core
