// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <vector>

#include "core/clock.h"
#include "core/file.h"
#include "core/program.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "support/error_text.h"
#include "support/real_data.h"
#include "support/temporary_folder.h"

namespace cdiff::core {
namespace {

TEST(Text, NumbersRoundTrip) {
  EXPECT_EQ(formatNumber(0.1), "0.1");
  EXPECT_EQ(formatNumber(-3.0), "-3");
  EXPECT_EQ(parseNumber(formatNumber(1.0 / 3.0)), 1.0 / 3.0);
  EXPECT_EQ(formatFixed(2.345, 1), "2.3");
  EXPECT_FALSE(parseNumber("3x"));
  EXPECT_EQ(parseNumber("+3"), 3.0);
  EXPECT_FALSE(parseNumber("+-3"));
  EXPECT_FALSE(parseNumber(""));
  EXPECT_FALSE(parseNumber("nan"));
  EXPECT_FALSE(parseNumber("inf"));
}

// ctest runs each test in a folder of its own, and the compiler may know the source by a relative
// path.
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

// 1.5 h east of Greenwich, where the whole hours do not tell: POSIX counts westwards. Between the
// two readings of the clock at most a few seconds pass.
TEST(Text, TheTimeIsLocalForPeopleAndForFileNames) {
  ::setenv("TZ", "TEST-1:30", 1);
  ::tzset();
  for (const bool people : {true, false}) {
    const std::string text = people ? timeText() : timeForFileName();
    std::tm local{};
    const char* end =
        ::strptime(text.c_str(), people ? "%Y-%m-%d %H:%M:%S" : "%Y%m%d_%H%M%S", &local);
    ASSERT_TRUE(end != nullptr && *end == '\0') << text;
    const double seconds = std::difftime(std::time(nullptr) + 5400, ::timegm(&local));
    EXPECT_GE(seconds, 0.0) << text;
    EXPECT_LT(seconds, 10.0) << text;
  }
  ::unsetenv("TZ");
  ::tzset();
}

TEST(Text, LowerCaseIsThatOfAscii) {
  EXPECT_EQ(lowerCase("NaN_1-Z"), "nan_1-z");
  EXPECT_EQ(lowerCase("\xC3\x84@["), "\xC3\x84@[");
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

// Edit distances: "nine" to "none" 1 of 4 letters; "agressive" to "naturalistic" 9 of 12.
TEST(Text, OnlyACloseNameIsSuggested) {
  EXPECT_EQ(closeName("nine", {"all", "none"}), "none");
  EXPECT_EQ(closeName("agressive", {"naturalistic", "safety_critical"}), "");
  EXPECT_EQ(closeName("critical", {"naturalistic", "safety_critical"}), "safety_critical");
  EXPECT_EQ(closeName("x", {}), "");
  EXPECT_EQ(didYouMean("nine", {"none"}), "; did you mean 'none'?");
  EXPECT_EQ(didYouMean("x", {"none"}), "");
  EXPECT_EQ(shortened("abcdef", 3), "abc...");
  EXPECT_EQ(shortened("abc", 3), "abc");
}

using test::errorOf;

TEST(File, WhatTheSystemRefusesIsNamed) {
  const test::TemporaryFolder folder;
  const auto loop = folder.path() / "loop";
  std::filesystem::create_symlink("loop", loop);
  for (const auto& action : std::vector<std::function<void()>>{
           [&] { isFile(loop); }, [&] { isFolder(loop / "x"); }, [&] { readFile(loop, "text"); }}) {
    const std::string text = errorOf(action);
    EXPECT_NE(text.find("'" + loop.string()), std::string::npos) << text;
    EXPECT_NE(text.find("Too many levels of symbolic links"), std::string::npos) << text;
  }
  EXPECT_NE(errorOf([] { isFile(std::string(300, 'a')); }).find("File name too long"),
            std::string::npos);
  EXPECT_FALSE(isFile(folder.path() / "none"));
  EXPECT_TRUE(isFolder(folder.path()));
  writeFileAtomically(folder.path() / "sparse", "");
  std::filesystem::resize_file(folder.path() / "sparse", std::uintmax_t{3} << 30);
  EXPECT_NE(errorOf([&] { readFile(folder.path() / "sparse", "text"); }).find("3221225472 bytes"),
            std::string::npos);
}

/// Whether readFile refuses a file by name and says `part`; in a process of its own, which is ended
/// when it waits or reads without end.
bool isRefused(const std::filesystem::path& file, const std::string& part) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit processor{3, 3};  // [s]
    ::setrlimit(RLIMIT_CPU, &processor);
    ::alarm(60);
    const std::string text = errorOf([&] { readFile(file, "text"); });
    const bool named = text.find("text '" + file.string() + "'") != std::string::npos;
    ::_exit(named && text.find(part) != std::string::npos ? 0 : 1);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(File, OnlyRegularFilesAreRead) {
  const test::TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", folder.path() / "zeros");
  std::filesystem::create_symlink(pipe, folder.path() / "link");
  const int handle = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string place = (folder.path() / "socket").string();
  ASSERT_LT(place.size(), sizeof(address.sun_path));
  place.copy(address.sun_path, place.size());
  ASSERT_EQ(::bind(handle, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_TRUE(isRefused(pipe, "pipe"));
  EXPECT_TRUE(isRefused(folder.path() / "link", "pipe"));
  EXPECT_TRUE(isRefused(folder.path() / "zeros", "device"));
  EXPECT_TRUE(isRefused("/dev/zero", "device"));
  EXPECT_TRUE(isRefused(folder.path() / "socket", "socket"));
  EXPECT_TRUE(isRefused(folder.path(), "folder"));
  ::close(handle);
  EXPECT_NE(errorOf([&] { requireRegularFile(pipe, "bag"); }).find("bag '" + pipe.string() + "'"),
            std::string::npos);
}

TEST(File, ReadsLinksAndFilesWhoseSizeIsNotKnownBeforehand) {
  const test::TemporaryFolder folder;
  const std::string text(10000, 'x');
  writeFileAtomically(folder.path() / "a", text);
  std::filesystem::create_symlink("a", folder.path() / "link");
  EXPECT_EQ(readFile(folder.path() / "link", "text"), text);
  EXPECT_NO_THROW(requireRegularFile(folder.path() / "link", "text"));
  writeFileAtomically(folder.path() / "empty", "");
  EXPECT_EQ(readFile(folder.path() / "empty", "text"), "");
  // The kernel says 0 bytes of it.
  ASSERT_EQ(std::filesystem::file_size("/proc/self/maps"), 0U);
  EXPECT_GT(readFile("/proc/self/maps", "text").size(), 1000U);
}

// 10000 bytes are read with a limit of 10000 and refused with one of 9999; /proc tells no size
// before.
TEST(File, MoreBytesThanTheLimitAreRefused) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "a";
  writeFileAtomically(file, std::string(10000, 'x'));
  EXPECT_EQ(readFile(file, "text", 10000).size(), 10000U);
  EXPECT_NE(errorOf([&] { readFile(file, "text", 9999); }).find("at most 9999"), std::string::npos);
  EXPECT_NE(errorOf([] { readFile("/proc/self/maps", "text", 100); }).find("at most 100"),
            std::string::npos);
}

TEST(File, AMissingTemporaryFolderIsNamed) {
  const char* before = std::getenv("TMPDIR");
  const std::string saved = before != nullptr ? before : "";
  ::setenv("TMPDIR", "/no/such/folder", 1);
  const std::string text = errorOf([] { temporaryFolder(); });
  before != nullptr ? ::setenv("TMPDIR", saved.c_str(), 1) : ::unsetenv("TMPDIR");
  EXPECT_NE(text.find("TMPDIR is '/no/such/folder'"), std::string::npos) << text;
}

TEST(Failure, SaysWhatAnExceptionMeansToTheUser) {
  EXPECT_EQ(failureOf(InputError("a")).exit_code, 3);
  EXPECT_EQ(failureOf(SimulatorError("a")).exit_code, 2);
  EXPECT_EQ(failureOf(Interrupted("a")).exit_code, 130);
  EXPECT_EQ(failureOf(SimulatorError("SUMO was lost")).text, "SUMO was lost");
  const std::filesystem::filesystem_error path(
      "status", "loop", std::make_error_code(std::errc::too_many_symbolic_link_levels));
  EXPECT_EQ(failureOf(path).exit_code, 3);
  EXPECT_EQ(failureOf(path).text.find("cannot use 'loop': Too many levels"), 0U);
  const std::filesystem::filesystem_error open_files(
      "list", "folder", std::make_error_code(std::errc::too_many_files_open));
  EXPECT_EQ(failureOf(open_files).exit_code, 2);
  const std::system_error thread(std::make_error_code(std::errc::resource_unavailable_try_again));
  EXPECT_NE(failureOf(thread).text.find("ulimit -u"), std::string::npos);
  EXPECT_EQ(failureOf(std::bad_alloc()).text.find("out of memory"), 0U);
  EXPECT_EQ(failureOf(std::length_error("vector::_M_default_append")).text.find("out of memory"),
            0U);
  EXPECT_EQ(failureOf(std::out_of_range("map::at")).text.find("internal error (map::at)"), 0U);
  EXPECT_EQ(failureOf(std::out_of_range("map::at")).exit_code, 2);
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
  const test::TemporaryFolder scratch;
  const std::filesystem::path folder = scratch.path() / "files";
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
}

TEST(File, AtomicWriteThatFailsLeavesNothingBehind) {
  const test::TemporaryFolder scratch;
  const std::filesystem::path folder = scratch.path() / "files";
  std::filesystem::create_directories(folder / "a.txt" / "inside");  // a folder cannot be replaced
  EXPECT_THROW(writeFileAtomically(folder / "a.txt", "one"), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder),
                          std::filesystem::directory_iterator()),
            1);
}

TEST(File, AnOutputIsWrittenThroughDevicesAndPipesAndReplacesNone) {
  namespace fs = std::filesystem;
  const test::TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0644), 0);
  EXPECT_THROW(writeFileAtomically(pipe, "text"), InputError) << "nobody reads";
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  writeFileAtomically(pipe, "text");
  char read[8] = {};
  EXPECT_EQ(::read(reader, read, sizeof(read)), 4);
  EXPECT_STREQ(read, "text");
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  writeFileAtomically("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const int open = ::open((folder.path() / "stream").c_str(), O_RDWR | O_CREAT, 0644);
  ASSERT_EQ(::write(open, "first ", 6), 6);
  writeFileAtomically("/dev/fd/" + std::to_string(open), "second");
  ::close(open);
  EXPECT_EQ(readFile(folder.path() / "stream", "file"), "first second");
}

TEST(File, AnOutputFollowsNoLinkOutOfItsFolder) {
  namespace fs = std::filesystem;
  const test::TemporaryFolder folder;
  const test::TemporaryFolder other;
  writeFileAtomically(other.path() / "theirs", "theirs");
  fs::create_symlink(other.path() / "theirs", folder.path() / "out");
  fs::create_symlink(folder.path() / "nothing", folder.path() / "dangling");
  writeFileAtomically(folder.path() / "here", "before");
  fs::create_symlink("here", folder.path() / "inside");
  EXPECT_THROW(writeFileAtomically(folder.path() / "out", "text"), InputError);
  EXPECT_THROW(writeFileAtomically(folder.path() / "dangling", "text"), InputError);
  EXPECT_EQ(readFile(other.path() / "theirs", "file"), "theirs");
  writeFileAtomically(folder.path() / "inside", "text");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "inside"));
  EXPECT_EQ(readFile(folder.path() / "here", "file"), "text");
}

TEST(File, AShippedNameOrAFileIsFoundOrTheNearestNamed) {
  const test::TemporaryFolder folder;
  for (const char* name : {"smoke.yaml", "paper.yaml", "notes.txt"})
    writeFileAtomically(folder.path() / name, "");
  EXPECT_EQ(shippedNames(folder.path()), (std::vector<std::string>{"paper", "smoke"}));
  EXPECT_EQ(shippedOrFile(folder.path(), "smoke", "matrix"), folder.path() / "smoke.yaml");
  const std::string file = (folder.path() / "notes.txt").string();
  EXPECT_EQ(shippedOrFile(folder.path(), file, "matrix"), file);
  try {
    shippedOrFile(folder.path(), "smok", "matrix");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "matrix 'smok' is neither a file nor a shipped matrix; the nearest shipped one is "
                 "'smoke' (all: paper, smoke)");
  }
  try {
    shippedOrFile(folder.path(), "mine/smok.yaml", "matrix");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "matrix 'mine/smok.yaml': there is no such file");
  }
}

TEST(File, ATemporaryFolderThatCannotBeWrittenToIsRefused) {
  const bool root = ::geteuid() == 0;  // whom permissions do not stop
  constexpr uid_t kNobody = 65534;
  if (::seteuid(root ? kNobody : ::geteuid()) != 0)
    GTEST_SKIP() << "root is the only user of this name space";
  ASSERT_EQ(::seteuid(root ? 0 : ::geteuid()), 0);
  const test::TemporaryFolder folder;
  std::filesystem::permissions(
      folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  ::setenv("TMPDIR", folder.path().c_str(), 1);
  EXPECT_EQ(::seteuid(root ? kNobody : ::geteuid()), 0);
  EXPECT_THROW(temporaryFolder(), InputError);
  EXPECT_EQ(::seteuid(root ? 0 : ::geteuid()), 0);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_EQ(temporaryFolder(), folder.path());
  ::unsetenv("TMPDIR");
}

}  // namespace
}  // namespace cdiff::core
