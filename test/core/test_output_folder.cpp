// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <optional>

#include "core/file.h"
#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "support/temporary_folder.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

std::string lockError(const fs::path& folder) {
  try {
    const FolderLock lock(folder, "second");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

/// A process that runs `body` and waits until it is killed with the object.
class Child {
 public:
  explicit Child(const std::function<void()>& body) {
    int ready[2];
    if (::pipe(ready) != 0) std::abort();
    id_ = ::fork();
    if (id_ == 0) {
      body();
      if (::write(ready[1], "x", 1) != 1) ::_exit(1);
      while (true) ::pause();
    }
    char byte = 0;
    if (::read(ready[0], &byte, 1) != 1) std::abort();
    ::close(ready[0]);
    ::close(ready[1]);
  }
  ~Child() {
    ::kill(id_, SIGKILL);
    ::waitpid(id_, nullptr, 0);
  }
  pid_t id() const { return id_; }

 private:
  pid_t id_ = 0;
};

class OutputFolder : public testing::Test {
 protected:
  ~OutputFolder() override { ::unsetenv("TMPDIR"); }
  fs::path folder() const { return scratch_.path() / "made" / "results"; }
  fs::path lockFile() const { return folder() / FolderLock::kFile; }
  test::TemporaryFolder scratch_;
};

TEST_F(OutputFolder, AFileInItsPlaceIsNamedAsOne) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "results";
  writeFileAtomically(file, "");
  EXPECT_EQ(lockError(file), "'" + file.string() + "' is a file; give a folder");
}

TEST_F(OutputFolder, LockIsAFileThatGoesWithTheObject) {
  {
    const FolderLock lock(folder(), "first");
    EXPECT_TRUE(fs::exists(lockFile()));
  }
  EXPECT_FALSE(fs::exists(lockFile()));
  EXPECT_EQ(lockError(folder()), "");
}

TEST_F(OutputFolder, FoldersMadeForNothingGoWithTheLockAndOthersStay) {
  { const FolderLock lock(folder(), "first"); }
  EXPECT_FALSE(fs::exists(folder().parent_path()));
  fs::create_directories(folder().parent_path());
  { const FolderLock lock(folder() / "", "first"); }
  EXPECT_FALSE(fs::exists(folder()));
  EXPECT_TRUE(fs::exists(folder().parent_path())) << "it was there before";
  {
    const FolderLock lock(folder(), "first");
    std::ofstream(folder() / "result") << "kept";
  }
  EXPECT_TRUE(fs::exists(folder() / "result"));
}

TEST_F(OutputFolder, ASecondWriterLearnsHostProcessAndProgramOfTheFirst) {
  std::optional<FolderLock> lock;
  const Child first([&] { lock.emplace(folder(), "cdiff run"); });
  const std::string error = lockError(folder());
  char host[256] = {};
  ::gethostname(host, sizeof(host) - 1);
  EXPECT_NE(error.find("is being written by 'cdiff run', process " + std::to_string(first.id()) +
                       " on host " + host + ", since 20"),
            std::string::npos)
      << error;
}

TEST_F(OutputFolder, ALockOfAKilledProcessIsTakenOver) {
  std::optional<FolderLock> lock;
  {
    const Child first([&] { lock.emplace(folder(), "cdiff run"); });
  }
  EXPECT_TRUE(fs::exists(lockFile()));  // it could not remove it
  EXPECT_EQ(lockError(folder()), "");
  EXPECT_FALSE(fs::exists(lockFile()));
}

TEST_F(OutputFolder, ALockOfAnotherHostSaysWhatToDelete) {
  fs::create_directories(folder());
  std::ofstream(lockFile()) << "host: far.away\nprocess: 12\nprogram: cdiff run\nsince: then\n";
  const std::string error = lockError(folder());
  EXPECT_NE(error.find("process 12 on host far.away"), std::string::npos) << error;
  EXPECT_NE(error.find("if that process is gone, delete '" + lockFile().string() + "'"),
            std::string::npos)
      << error;
  EXPECT_TRUE(fs::exists(lockFile()));
}

TEST_F(OutputFolder, ScratchFoldersOfKilledProcessesAreRemovedAndOthersStay) {
  ::setenv("TMPDIR", scratch_.path().c_str(), 1);
  const auto makeScratch = [] { new ScratchFolder(); };  // not removed by the child
  const Child alive(makeScratch);
  const auto count = [this] {
    return std::distance(fs::directory_iterator(scratch_.path()), fs::directory_iterator());
  };
  { const Child killed(makeScratch); }
  ASSERT_EQ(count(), 2);
  for (const auto& entry : fs::directory_iterator(scratch_.path())) {
    const timespec times[2] = {{0, UTIME_OMIT}, {::time(nullptr) - 3600, 0}};
    ASSERT_EQ(::utimensat(AT_FDCWD, entry.path().c_str(), times, 0), 0);
  }
  const Child next(makeScratch);
  EXPECT_EQ(count(), 2);  // that of `alive` and that of `next`
}

TEST_F(OutputFolder, AReservedFileIsThereWhenWrittenOnly) {
  const fs::path file = scratch_.path() / "summary.json";
  {
    ReservedFile reserved(file, 1 << 16);
    struct stat status {};
    ASSERT_EQ(::stat((file.string() + ".tmp." + std::to_string(::getpid())).c_str(), &status), 0);
    EXPECT_GE(status.st_blocks * 512, 1 << 16);  // its room is taken
    EXPECT_FALSE(fs::exists(file));
    reserved.write("content");
    EXPECT_EQ(readFile(file, "file"), "content");
  }
  { const ReservedFile unused(scratch_.path() / "other", 1 << 16); }
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch_.path()), fs::directory_iterator()), 1);
}

TEST_F(OutputFolder, HalvesOfDeadWritersGoAndThoseOfLivingStay) {
  pid_t dead = 0;
  {
    const Child child([] {});
    dead = child.id();
  }
  const fs::path alive = scratch_.path() / ("a.tmp." + std::to_string(::getpid()));
  const fs::path half = scratch_.path() / ("a.tmp." + std::to_string(dead));
  const fs::path other = scratch_.path() / "a.tmp.mine";
  for (const fs::path& file : {alive, half, other}) std::ofstream(file) << "half";
  removeDeadTemporaries(scratch_.path());
  EXPECT_TRUE(fs::exists(alive));
  EXPECT_FALSE(fs::exists(half));
  EXPECT_TRUE(fs::exists(other));
}

}  // namespace
}  // namespace cdiff::core
