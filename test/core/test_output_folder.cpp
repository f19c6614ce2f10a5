// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>
#include <new>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <thread>

#include "core/file.h"
#include "core/folder_access.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/scratch_folder.h"
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

std::set<std::string> namesOf(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
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

class OutputFolderTest : public testing::Test {
 protected:
  ~OutputFolderTest() override { ::unsetenv("TMPDIR"); }
  fs::path folder() const { return scratch_.path() / "made" / "results"; }
  fs::path lockFile() const { return folder() / FolderLock::kFile; }
  test::TemporaryFolder scratch_;
};

TEST_F(OutputFolderTest, AFileInItsPlaceIsNamedAsOne) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "results";
  writeFileAtomically(file, "");
  EXPECT_EQ(lockError(file), "'" + file.string() + "' is a file; give a folder");
}

TEST_F(OutputFolderTest, LockIsAFileThatGoesWithTheObject) {
  {
    const FolderLock lock(folder(), "first");
    EXPECT_TRUE(fs::exists(lockFile()));
  }
  EXPECT_FALSE(fs::exists(lockFile()));
  EXPECT_EQ(lockError(folder()), "");
}

TEST_F(OutputFolderTest, FoldersMadeForNothingGoWithTheLockAndOthersStay) {
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

TEST_F(OutputFolderTest, ASecondWriterLearnsHostProcessAndProgramOfTheFirst) {
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

TEST_F(OutputFolderTest, ALockOfAKilledProcessIsTakenOver) {
  std::optional<FolderLock> lock;
  {
    const Child first([&] { lock.emplace(folder(), "cdiff run"); });
  }
  EXPECT_TRUE(fs::exists(lockFile()));  // it could not remove it
  EXPECT_EQ(lockError(folder()), "");
  EXPECT_FALSE(fs::exists(lockFile()));
}

TEST_F(OutputFolderTest, ALockOfAnotherHostSaysWhatToDelete) {
  fs::create_directories(folder());
  std::ofstream(lockFile()) << "host: far.away\nprocess: 12\nprogram: cdiff run\nsince: then\n";
  const std::string error = lockError(folder());
  EXPECT_NE(error.find("process 12 on host far.away"), std::string::npos) << error;
  EXPECT_NE(error.find("if that process is gone, delete '" + lockFile().string() + "'"),
            std::string::npos)
      << error;
  EXPECT_TRUE(fs::exists(lockFile()));
}

TEST_F(OutputFolderTest, AForeignLockIsQuotedSafely) {
  fs::create_directories(folder());
  std::ofstream(lockFile()) << "host: far\033[31m" << std::string(300, 'x')
                            << "\nprocess: 12\nprogram: cdiff run\nsince: then\n";
  const std::string error = lockError(folder());
  EXPECT_NE(error.find("on host far\xEF\xBF\xBD[31mx"), std::string::npos) << error;
  EXPECT_EQ(error.find(std::string(100, 'x')), std::string::npos) << error;
}

TEST_F(OutputFolderTest, ScratchFoldersOfKilledProcessesAreRemovedAndOthersStay) {
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

TEST_F(OutputFolderTest, AScratchFolderOfAUserStays) {
  ::setenv("TMPDIR", scratch_.path().c_str(), 1);
  const fs::path mine = scratch_.path() / "e2e_cdiff_scratch_mine";
  fs::create_directory(mine);
  std::ofstream(mine / "thesis") << "mine";
  const timespec times[2] = {{0, UTIME_OMIT}, {::time(nullptr) - 3600, 0}};
  ASSERT_EQ(::utimensat(AT_FDCWD, mine.c_str(), times, 0), 0);
  const Child next([] { new ScratchFolder(); });  // the first scratch folder of its process
  EXPECT_EQ(readFile(mine / "thesis", "file"), "mine");
}

TEST_F(OutputFolderTest, ALockThatIsALinkOrNotOursIsRefusedAndStays) {
  const fs::path notes = scratch_.path() / "notes";
  std::ofstream(notes) << "mine";
  fs::create_directories(folder());
  fs::create_symlink(notes, lockFile());
  EXPECT_NE(lockError(folder()).find(lockFile().string()), std::string::npos);
  EXPECT_EQ(readFile(notes, "notes"), "mine");
  fs::remove(lockFile());
  for (const char* content : {"", "my own lock\n"}) {
    std::ofstream(lockFile()) << content;
    EXPECT_NE(lockError(folder()).find(lockFile().string()), std::string::npos);
    EXPECT_EQ(readFile(lockFile(), "lock"), content);
  }
  fs::remove(lockFile());
  ASSERT_EQ(::mkfifo(lockFile().c_str(), 0644), 0);
  EXPECT_NE(lockError(folder()).find(lockFile().string()), std::string::npos);
  EXPECT_EQ(namesOf(folder()), (std::set<std::string>{".lock"}));
}

TEST_F(OutputFolderTest, AFolderThatIsALinkIsRefused) {
  fs::create_directories(scratch_.path() / "elsewhere");
  const fs::path link = scratch_.path() / "link";
  fs::create_directory_symlink(scratch_.path() / "elsewhere", link);
  EXPECT_NE(lockError(link).find("elsewhere"), std::string::npos);
  EXPECT_NE(lockError(link / "").find("elsewhere"), std::string::npos);
  EXPECT_THROW(OutputFolder{link}, InputError);
  EXPECT_THROW(OutputFolder::requireFree(link, {"a"}), InputError);
  EXPECT_TRUE(fs::is_empty(scratch_.path() / "elsewhere"));
}

TEST_F(OutputFolderTest, ReplacesAndRemovesOnlyWhatItsRecordLists) {
  fs::create_directories(folder());
  std::ofstream(folder() / "mine") << "mine";
  std::ofstream(folder() / "half.part") << "mine";
  OutputFolder output(folder());
  EXPECT_THROW(output.write("mine", "ours"), InputError);
  EXPECT_THROW(output.write("half", "ours"), InputError);
  EXPECT_THROW(output.claim("mine"), InputError);
  EXPECT_THROW(OutputFolder::requireFree(folder(), {"ours", "mine"}), InputError);
  output.write("ours", "first");
  output.write("ours", "second");
  EXPECT_EQ(readFile(folder() / "ours", "file"), "second");
  EXPECT_TRUE(OutputFolder::lists(folder(), "ours"));
  OutputFolder::requireFree(folder(), {"ours"});
  output.remove({"mine"});
  output.clear();
  EXPECT_EQ(readFile(folder() / "mine", "file"), "mine");
  EXPECT_EQ(namesOf(folder()), (std::set<std::string>{"half.part", "mine"}));
}

TEST_F(OutputFolderTest, WhatTookTheNameOfARemovedFileIsTheUsers) {
  OutputFolder output(folder());
  output.write("a", "ours");
  output.write("b", "ours");
  output.remove({"a"});
  std::ofstream(folder() / "a") << "mine";
  EXPECT_THROW(output.write("a", "ours"), InputError);
  fs::remove(folder() / "b");
  fs::create_symlink(folder() / "a", folder() / "b");
  EXPECT_THROW(output.write("b", "ours"), InputError) << "a link is never the program's";
  output.clear();
  EXPECT_TRUE(fs::is_symlink(folder() / "b"));
  EXPECT_EQ(readFile(folder() / "a", "file"), "mine");
}

TEST_F(OutputFolderTest, ARecordThatIsNotOursOrCutOffHarmsNothing) {
  fs::create_directories(folder());
  const fs::path record = folder() / OutputFolder::kRecord;
  std::ofstream(record) << "my list\n";
  EXPECT_THROW(OutputFolder(folder()).write("a", "ours"), InputError);
  EXPECT_EQ(readFile(record, "record"), "my list\n");
  fs::remove(record);
  OutputFolder output(folder());
  output.write("a", "ours");
  std::ofstream(record, std::ios::app) << "notes";  // a write of "notes.txt" that was cut off
  std::ofstream(folder() / "notes") << "mine";
  output.write("b", "ours");
  EXPECT_THROW(output.write("notes", "ours"), InputError);
  std::ofstream(record, std::ios::app) << "../outside\n..\n";
  std::ofstream(folder().parent_path() / "outside") << "mine";
  output.clear();
  EXPECT_EQ(readFile(folder().parent_path() / "outside", "file"), "mine");
  EXPECT_EQ(namesOf(folder()), (std::set<std::string>{"notes"}));
}

TEST_F(OutputFolderTest, SubfoldersAreClearedAndStayWithFilesOfTheUsers) {
  OutputFolder output(folder());
  OutputFolder(output.subfolder("full")).write("ours", "");
  OutputFolder(output.subfolder("ours")).write("ours", "");
  std::ofstream(folder() / "full" / "mine") << "mine";
  fs::create_directory(folder() / "theirs");
  OutputFolder(output.subfolder("theirs")).write("ours", "");
  fs::create_directory_symlink(folder() / "theirs", folder() / "link");
  EXPECT_THROW(output.subfolder("link"), InputError);
  output.clear();
  EXPECT_FALSE(fs::exists(folder() / "ours"));
  EXPECT_EQ(namesOf(folder() / "full"), (std::set<std::string>{"mine"}));
  EXPECT_TRUE(fs::exists(folder() / "theirs" / "ours")) << "that folder is not on the record";
}

TEST_F(OutputFolderTest, ARenamedFolderIsFollowedAndADeletedOneMadeAgain) {
  OutputFolder output(folder());
  PendingFile first(output, "first");
  first.append("whole");
  const fs::path moved = folder().parent_path() / "moved";
  fs::rename(folder(), moved);
  EXPECT_EQ(output.path(), moved);
  first.finish();
  EXPECT_EQ(readFile(moved / "first", "file"), "whole");
  EXPECT_FALSE(fs::exists(folder()));
  PendingFile second(output, "second", 1 << 16);
  second.append("saved");
  fs::remove_all(moved);
  EXPECT_FALSE(output.wasDeleted());
  second.finish();
  EXPECT_TRUE(output.wasDeleted());
  EXPECT_EQ(readFile(folder() / "second", "file"), "saved");
}

/// Memory that a child shares.
struct Shared {
  std::atomic<int> writes{0};
  std::atomic<bool> end{false};
};

/// Writes files until it shall end; ends with 1 at an error.
void writeUntilEnd(const fs::path& folder, Shared& shared) {
  try {
    OutputFolder output(folder);
    for (; !shared.end; ++shared.writes)
      output.write("file_" + std::to_string(shared.writes % 3), "content");
    ::_exit(0);
  } catch (const std::exception& error) {
    static_cast<void>(!::write(STDERR_FILENO, error.what(), std::strlen(error.what())));
    ::_exit(1);
  }
}

TEST_F(OutputFolderTest, AFolderMayBeRenamedOrDeletedAtAnyMomentOfAWrite) {
  void* memory =
      ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  auto& shared = *new (memory) Shared;
  const pid_t writer = ::fork();
  if (writer == 0) writeUntilEnd(folder(), shared);
  std::mt19937 random(1);
  std::uniform_int_distribution<int> pause(0, 2000);  // [us]
  int status = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int before = shared.writes;
    while (shared.writes < before + 2 && ::waitpid(writer, &status, WNOHANG) == 0)
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    std::this_thread::sleep_for(std::chrono::microseconds(pause(random)));
    ::kill(writer, SIGSTOP);
    ASSERT_EQ(::waitpid(writer, &status, WUNTRACED), writer) << "it ended in trial " << trial;
    ASSERT_TRUE(WIFSTOPPED(status)) << "it ended in trial " << trial;
    const fs::path moved = scratch_.path() / "moved";
    fs::remove_all(moved);
    if (trial % 2 == 0 && fs::exists(folder())) fs::rename(folder(), moved);
    if (trial % 2 == 1) fs::remove_all(folder());
    ::kill(writer, SIGCONT);
  }
  shared.end = true;
  ASSERT_EQ(::waitpid(writer, &status, 0), writer);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  ::munmap(memory, sizeof(Shared));
}

TEST_F(OutputFolderTest, APendingFileIsThereWhenFinishedOnlyAndTakesItsRoom) {
  OutputFolder output(folder());
  {
    PendingFile file(output, "summary.json", 1 << 16);
    struct stat status {};
    ASSERT_EQ(::stat((folder() / "summary.json.part").c_str(), &status), 0);
    EXPECT_GE(status.st_blocks * 512, 1 << 16);  // its room is taken
    EXPECT_FALSE(fs::exists(folder() / "summary.json"));
    file.append("con");
    file.append("tent");
    file.finish();
    EXPECT_EQ(readFile(folder() / "summary.json", "file"), "content");
  }
  { const PendingFile unused(output, "other"); }
  EXPECT_EQ(namesOf(folder()), (std::set<std::string>{".cdiff_files", "summary.json"}));
}

TEST_F(OutputFolderTest, AFileThatTookTheNameMeanwhileStaysAndSoDoesWhatWasWritten) {
  OutputFolder output(folder());
  {
    PendingFile file(output, "trace.csv");
    file.append("whole");
    std::ofstream(folder() / "trace.csv") << "mine";
    EXPECT_THROW(file.finish(), InputError);
  }
  EXPECT_EQ(readFile(folder() / "trace.csv", "file"), "mine");
  EXPECT_EQ(readFile(folder() / "trace.csv.part", "file"), "whole");
}

TEST_F(OutputFolderTest, NamesThatWouldForgeTheRecordAreRefused) {
  OutputFolder output(folder());
  for (const char* name : {"x\nthesis", "a/b", "", "tab\there"})
    EXPECT_THROW(output.claim(name), InputError) << name;
  EXPECT_EQ(output.names(), std::set<std::string>());
}

TEST_F(OutputFolderTest, ABackupOfTheRecordByAHardLinkStaysAsItWas) {
  OutputFolder output(folder());
  output.write("a", "ours");
  const fs::path backup = scratch_.path() / "backup";
  fs::create_hard_link(folder() / OutputFolder::kRecord, backup);
  const std::string before = readFile(backup, "record");
  output.write("b", "ours");
  EXPECT_EQ(readFile(backup, "record"), before);
}

TEST_F(OutputFolderTest, ARecordThatAnotherProcessHoldsIsNamed) {
  OutputFolder output(folder());
  output.write("a", "ours");
  const fs::path record = folder() / OutputFolder::kRecord;
  const Child holder([&] {
    static const int descriptor = ::open(record.c_str(), O_RDONLY);
    ::flock(descriptor, LOCK_EX);
  });
  try {
    output.write("b", "ours");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(record.string()), std::string::npos) << error.what();
  }
}

TEST_F(OutputFolderTest, AMovedFolderIsNamedWhenAskedFor) {
  OutputFolder output(folder());
  EXPECT_NO_THROW(output.requireInPlace());
  fs::rename(folder(), scratch_.path() / "moved");
  EXPECT_THROW(output.requireInPlace(), Error);
}

TEST_F(OutputFolderTest, HalvesOfKilledWritersAreRemovedByTheNext) {
  {
    const Child killed([this] {
      static OutputFolder output(folder());
      static PendingFile file(output, "trace.csv");
    });
  }
  EXPECT_TRUE(fs::exists(folder() / "trace.csv.part"));
  std::ofstream(folder() / "mine.part") << "mine";
  OutputFolder output(folder());
  output.removeUnfinished();
  EXPECT_EQ(namesOf(folder()), (std::set<std::string>{"mine.part"}));
}

TEST_F(OutputFolderTest, DraftsOfKilledWritersAreRemovedAndThoseOfOthersStay) {
  OutputFolder output(folder());
  {
    const Child killed([this] { static const Draft draft = makeDraft(folder(), "half"); });
  }
  const Draft written = makeDraft(folder(), "half");
  fs::create_symlink(folder() / "mine", folder() / ".cdiff_draft.linked");
  EXPECT_EQ(namesOf(folder()).size(), 3U);
  output.removeUnfinished();
  EXPECT_EQ(namesOf(folder()),
            (std::set<std::string>{written.path.filename(), ".cdiff_draft.linked"}));
}

TEST(OutputFolder, TooManyOpenFilesAreARunTimeErrorAndLeaveNoHalfFile) {
  const test::TemporaryFolder scratch;
  OutputFolder folder(scratch.path() / "out");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const FileDescriptor lowest(::dup(STDIN_FILENO));
  int failures = 0;
  for (rlim_t left = 0; left < 8; ++left) {
    const rlimit few{static_cast<rlim_t>(lowest.get()) + 1 + left, before.rlim_max};
    Failure failure{0, ""};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
    try {
      folder.write("file", "text");
    } catch (const std::exception& error) {
      ::setrlimit(RLIMIT_NOFILE, &before);  // a sanitizer opens a file to look at the exception
      failure = failureOf(error);
    }
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    EXPECT_EQ(namesOf(scratch.path() / "out").count("file.part"), 0U) << left;
    if (failure.exit_code == 0) continue;
    ++failures;
    EXPECT_EQ(failure.exit_code, 2) << failure.text;
    EXPECT_NE(failure.text.find("`ulimit -n`"), std::string::npos) << failure.text;
  }
  EXPECT_GE(failures, 3);
  folder.write("file", "whole");
  EXPECT_EQ(readFile(scratch.path() / "out" / "file", "file"), "whole");
}

}  // namespace
}  // namespace cdiff::core
