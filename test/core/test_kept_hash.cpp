// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>

#include "core/file.h"
#include "core/kept_content.h"
#include "core/kept_hash.h"
#include "e2e_cdiff/core/exceptions.h"
#include "support/temporary_folder.h"

namespace cdiff::core {
namespace {

class KeptHash : public testing::Test {
 protected:
  KeptHash() { keepContent(8); }
  ~KeptHash() override { keepContent(0); }
  void write(const std::string& text) const { std::ofstream(file_) << text; }
  test::TemporaryFolder scratch_;
  std::filesystem::path file_ = scratch_.path() / "weights";
};

TEST_F(KeptHash, IsThatOfTheContentAlsoRightAfterAChange) {
  for (const std::string text : {"first", "other", "third"}) {  // of the same size
    write(text);
    EXPECT_EQ(keptSha256(file_, "weights"), sha256(text));
    EXPECT_EQ(keptSha256(file_, "weights"), sha256(text));
  }
}

// A file of the package, which nobody has changed in the last seconds.
TEST_F(KeptHash, IsThatOfTheContentOfAFileThatStays) {
  const std::filesystem::path file = shareFolder() / "package.xml";
  const std::string expected = sha256(readFile(file, "package"));
  EXPECT_EQ(keptSha256(file, "package"), expected);
  EXPECT_EQ(keptSha256(file, "package"), expected);
}

TEST_F(KeptHash, ThrowsForAFileThatIsNotThere) {
  EXPECT_THROW(keptSha256(file_, "weights"), InputError);
}

}  // namespace
}  // namespace cdiff::core
