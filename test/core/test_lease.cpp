// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Leases: one holder at a time, whatever happens to it, its folder and the clocks.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <thread>

#include "core/file.h"
#include "core/folder_lock.h"
#include "core/lease.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "support/temporary_folder.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

class LeaseTest : public testing::Test {
 protected:
  LeaseFolder leases(double beat = 60.0, double expiry = 60.0) const {
    return LeaseFolder(folder_, {"test", beat, expiry});
  }
  fs::path file(const std::string& name) const { return folder_ / name; }
  /// As a process of another host would have left it, whose clock is an hour ahead.
  void writeForeign(const std::string& name, const std::string& beat) const {
    fs::create_directories(folder_);
    std::ofstream(file(name)) << "host: other\nboot: other\nprocess: 1\nprogram: cdiff worker\n"
                              << "since: 2099-01-01 00:00:00\nbeat: " << beat << "\n";
    fs::last_write_time(file(name), fs::file_time_type::clock::now() + std::chrono::hours(1));
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.insert(entry.path().filename().string());
    return names;
  }
  /// A process that claims and then waits to be killed.
  pid_t startHolder(const std::string& name) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    LeaseFolder mine(folder_, {"holder", 60.0, 60.0});
    const auto lease = mine.claim(name);
    if (lease) std::ofstream(scratch_.path() / "claimed") << "yes";
    for (;;) ::pause();
  }
  test::TemporaryFolder scratch_;
  fs::path folder_ = scratch_.path() / "leases";
};

TEST_F(LeaseTest, IsHeldByOneAtATime) {
  LeaseFolder first = leases();
  LeaseFolder second = leases();
  auto lease = first.claim("a");
  ASSERT_NE(lease, nullptr);
  EXPECT_TRUE(lease->isHeld());
  EXPECT_EQ(second.claim("a"), nullptr);
  EXPECT_NE(second.claim("b"), nullptr);
  ASSERT_EQ(second.holders().count("a"), 1U);
  const LeaseHolder holder = second.holders().at("a");
  EXPECT_EQ(holder.text.rfind("'test', process " + std::to_string(::getpid()), 0), 0U);
  EXPECT_TRUE(holder.is_alive);
  lease = nullptr;
  EXPECT_NE(second.claim("a"), nullptr);
}

TEST_F(LeaseTest, ManyClaimantsShareNoName) {
  constexpr int kThreads = 4;
  constexpr int kNames = 200;
  std::vector<std::vector<std::string>> got(kThreads);
  std::vector<std::shared_ptr<const Lease>> kept[kThreads];
  std::vector<std::unique_ptr<LeaseFolder>> folders;
  for (int i = 0; i < kThreads; ++i)
    folders.push_back(std::make_unique<LeaseFolder>(folder_, LeaseTerms{"test", 60.0, 60.0}));
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      for (int n = 0; n < kNames; ++n) {
        const std::string name = "run" + std::to_string(n);
        if (auto lease = folders[i]->claim(name)) {
          got[i].push_back(name);
          kept[i].push_back(std::move(lease));
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::set<std::string> all;
  std::size_t count = 0;
  for (const auto& names : got) {
    all.insert(names.begin(), names.end());
    count += names.size();
  }
  EXPECT_EQ(all.size(), count) << "a name has two holders";
  EXPECT_EQ(all.size(), static_cast<std::size_t>(kNames));
}

TEST_F(LeaseTest, OfAKilledProcessOfThisHostIsTakenOverAtOnce) {
  const pid_t holder = startHolder("a");
  while (!fs::exists(scratch_.path() / "claimed"))
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  LeaseFolder mine = leases();
  EXPECT_EQ(mine.claim("a"), nullptr);
  ::kill(holder, SIGSTOP);
  EXPECT_EQ(mine.claim("a"), nullptr) << "one that stands still is still there";
  ::kill(holder, SIGKILL);
  ::waitpid(holder, nullptr, 0);
  const auto lease = mine.claim("a");
  ASSERT_NE(lease, nullptr);
  EXPECT_EQ(files(), (std::set<std::string>{"a.2"}));
  EXPECT_FALSE(lease->isFromAnotherHost());
}

TEST_F(LeaseTest, OfAnotherHostIsTakenOverOnceItStaysTheSameWhateverItsClockSays) {
  writeForeign("a.1", "000000000001");
  LeaseFolder mine = leases(60.0, 2.0);
  EXPECT_EQ(mine.claim("a"), nullptr);
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  writeForeign("a.1", "000000000002");
  EXPECT_EQ(mine.claim("a"), nullptr) << "it has beaten since";
  ASSERT_EQ(mine.holders().count("a"), 1U);
  EXPECT_TRUE(mine.holders().at("a").is_alive);
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  const auto lease = mine.claim("a");
  ASSERT_NE(lease, nullptr);
  EXPECT_TRUE(lease->isFromAnotherHost());
}

TEST_F(LeaseTest, OfAnotherHostGivesNoSignOfLifeUntilItsFileChanges) {
  writeForeign("a.1", "000000000001");
  LeaseFolder mine = leases();
  EXPECT_FALSE(mine.holders().at("a").is_alive);
  EXPECT_FALSE(mine.holders().at("a").is_alive);
  writeForeign("a.1", "000000000002");
  EXPECT_TRUE(mine.holders().at("a").is_alive);
  EXPECT_TRUE(mine.holders().at("a").is_alive) << "also at the next look";
}

TEST_F(LeaseTest, IsLostWhereAnotherTookItOver) {
  LeaseFolder mine = leases();
  const auto lease = mine.claim("a");
  writeForeign("a.2", "000000000000");
  fs::remove(file("a.1"));
  EXPECT_FALSE(lease->isHeld());
  EXPECT_EQ(leases().claim("a"), nullptr);
}

TEST_F(LeaseTest, LostLeavesTheNextOneWithItsNameThere) {
  LeaseFolder mine = leases();
  auto lease = mine.claim("a");
  fs::remove(file("a.1"));
  LeaseFolder theirs = leases();
  const auto next = theirs.claim("a");
  ASSERT_NE(next, nullptr);
  lease = nullptr;
  EXPECT_TRUE(next->isHeld());
  EXPECT_EQ(files(), std::set<std::string>{"a.1"});
}

TEST_F(LeaseTest, BeatsInItsFile) {
  LeaseFolder mine = leases(0.01);
  const auto lease = mine.claim("a");
  const std::string before = readFile(file("a.1"), "lease");
  EXPECT_NE(before.find("beat: 0"), std::string::npos) << before;
  for (int i = 0; i < 1000 && readFile(file("a.1"), "lease") == before; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const std::string after = readFile(file("a.1"), "lease");
  EXPECT_NE(after, before);
  EXPECT_EQ(after.size(), before.size());
  EXPECT_TRUE(lease->isHeld());
}

TEST_F(LeaseTest, OfAFolderThatVanishesIsLostAndIsClaimedAnew) {
  LeaseFolder mine = leases(0.01);
  const auto lease = mine.claim("a");
  fs::remove_all(folder_);
  EXPECT_FALSE(lease->isHeld());
  const auto other = mine.claim("b");
  ASSERT_NE(other, nullptr);
  EXPECT_TRUE(fs::exists(file("b.1")));
}

// Nobody could say whether its holder lives: waiting for it would never end.
TEST_F(LeaseTest, ThatCannotBeReadIsNamed) {
  fs::create_directories(file("folder.2"));
  fs::create_symlink("nowhere", file("link.1"));
  LeaseFolder mine = leases();
  EXPECT_THROW(mine.claim("folder"), InputError);
  EXPECT_THROW(mine.claim("link"), InputError);
  EXPECT_THROW(mine.holders(), InputError);
  EXPECT_NE(mine.claim("a"), nullptr);
}

TEST_F(LeaseTest, WithoutContentIsLeftBehindOnlyOnceItStaysSo) {
  fs::create_directories(folder_);
  std::ofstream(file("a.1").string()) << "";
  EXPECT_EQ(leases(60.0, 60.0).claim("a"), nullptr);
  LeaseFolder mine = leases(60.0, 0.01);
  EXPECT_EQ(mine.claim("a"), nullptr);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_NE(mine.claim("a"), nullptr);
}

TEST_F(LeaseTest, SaysThatItsFolderCannotBeWritten) {
  std::ofstream(folder_.string()) << "a file";
  LeaseFolder mine = leases();
  EXPECT_THROW(mine.claim("a"), InputError);
}

TEST_F(LeaseTest, LeftBehindIsRemovedAndHeldStays) {
  writeForeign("dead.1", "000000000000");
  std::ofstream(file(".cdiff_draft.abcdef")) << "half";
  LeaseFolder mine = leases(60.0, 0.01);
  auto lease = mine.claim("held");
  mine.removeLeftBehind();  // sees the foreign one for the first time
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  mine.removeLeftBehind();
  EXPECT_EQ(files(), (std::set<std::string>{"held.1"}));
  lease = nullptr;
  mine.removeLeftBehind();
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(LeaseTest, AFolderLockOfAHostThatIsGoneCanBeRemoved) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / FolderLock::kFile)
      << "host: other\nprocess: 1\nprogram: cdiff run\nsince: 2026-01-01 00:00:00\n";
  EXPECT_THROW(FolderLock(folder_, "test"), InputError);
  FolderLock::removeLeftBehind(folder_);
  const FolderLock lock(folder_, "test");
  FolderLock::removeLeftBehind(folder_);
  EXPECT_TRUE(fs::exists(folder_ / FolderLock::kFile)) << "one that is held stays";
}

}  // namespace
}  // namespace cdiff::core
