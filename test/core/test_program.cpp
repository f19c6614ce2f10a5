// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Standard streams, signals and guarded children, each in a process of its own.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <functional>

#include "core/forked_work.h"
#include "core/guarded_process.h"
#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

/// Exit code of a body that runs in a forked process.
int inChild(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool isNull(int descriptor) {
  struct stat opened {};
  struct stat null {};
  return ::fstat(descriptor, &opened) == 0 && ::stat("/dev/null", &null) == 0 &&
         opened.st_rdev == null.st_rdev;
}

TEST(Program, OpensClosedStandardStreamsAndLeavesOthers) {
  const int code = inChild([] {
    ::close(STDIN_FILENO);
    ::close(STDERR_FILENO);
    prepareProgram();
    const bool closed_ones = isNull(STDIN_FILENO) && isNull(STDERR_FILENO);
    return closed_ones && !isNull(STDOUT_FILENO) ? 0 : 1;
  });
  EXPECT_EQ(code, 0);
}

TEST(Program, WritesBeyondALimitAreErrorsThatNameIt) {
  const int code = inChild([] {
    prepareProgram();
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    char name[] = "/tmp/e2e_cdiff_test_XXXXXX";
    const int file = ::mkstemp(name);
    ::unlink(name);
    const std::string content(1001, 'x');
    if (::write(file, content.data(), 1000) != 1000) return 1;
    if (::write(file, content.data(), 1) != -1 || errno != EFBIG) return 2;
    const std::string text = writeErrorText(EFBIG);
    return text.find("beyond 1000 bytes") != std::string::npos &&
                   text.find("ulimit -f") != std::string::npos
               ? 0
               : 3;
  });
  EXPECT_EQ(code, 0);
}

TEST(Program, AChildThatPrintsWithoutEndIsEnded) {
  const ProcessOutput output;
  GuardedProcess child("/usr/bin/yes", {}, {}, {{}, -1, output.descriptor()});
  EXPECT_FALSE(child.waitForEnd(300.0, output));
  EXPECT_TRUE(output.isTooLong());
  EXPECT_EQ(child.endSignal(), SIGKILL);
  EXPECT_EQ(output.end(4).size(), 4U);
  const ProcessOutput few;
  GuardedProcess other("/bin/sh", {"-c", "echo a; echo b > /dev/stderr"}, {},
                       {{}, -1, few.descriptor()});
  EXPECT_TRUE(other.waitForEnd(300.0, few));
  EXPECT_EQ(few.end(), "b\n") << "a shell's redirection begins the file anew";
}

TEST(Program, AStopSignalBeforeThereIsAnythingToStopEndsItWithAWord) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const ProcessOutput errors;
    const int code = inChild([&] {
      ::dup2(errors.descriptor(), STDERR_FILENO);
      ::signal(signal, SIG_DFL);  // shells ignore SIGINT in what they start in the background
      prepareProgram();
      ::raise(signal);
      return 0;
    });
    EXPECT_EQ(code, ExitCode::kInterrupted) << signal;
    EXPECT_EQ(errors.end(), "interrupted\n") << signal;
  }
}

TEST(Program, ASignalThatTheCallerIgnoresStaysIgnored) {
  const int code = inChild([] {
    ::signal(SIGINT, SIG_IGN);
    prepareProgram();
    ::raise(SIGINT);
    return 0;
  });
  EXPECT_EQ(code, 0);
}

TEST(Program, ExitCodesOfChildrenAreSeenWhateverTheCallerIgnores) {
  const auto codeOfChild = [] {
    return *runForked([] { return 7; }, 60.0, std::atomic<bool>{false}).exit_code;
  };
  EXPECT_EQ(inChild([&] {
              ::signal(SIGCHLD, SIG_IGN);
              prepareProgram();
              return codeOfChild();
            }),
            7);
  EXPECT_EQ(inChild([&] {
              ::signal(SIGCHLD, SIG_IGN);  // and again by some library
              return codeOfChild();
            }),
            ExitCode::kRunTimeError);
}

TEST(Program, ThreeSignalsRequestAStop) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EQ(inChild([signal] {
                ::signal(signal, SIG_DFL);
                const std::atomic<bool>& stop = catchStopSignals();
                if (stop || stopRequested()) return 1;
                ::raise(signal);
                return stop && stopRequested() ? 0 : 2;
              }),
              0)
        << signal;
    // Blocked, as in nodes, it waits to be taken.
    EXPECT_EQ(inChild([signal] {
                sigset_t one;
                sigemptyset(&one);
                sigaddset(&one, signal);
                ::signal(signal, SIG_DFL);
                ::sigprocmask(SIG_BLOCK, &one, nullptr);
                ::raise(signal);
                return stopRequested() ? 0 : 1;
              }),
              0)
        << signal;
  }
}

TEST(Program, HangUpStaysIgnoredUnderNohup) {
  EXPECT_EQ(inChild([] {
              ::signal(SIGHUP, SIG_IGN);
              const std::atomic<bool>& stop = catchStopSignals();
              ::raise(SIGHUP);
              return stop ? 1 : 0;
            }),
            0);
}

TEST(GuardedProcess, DistinguishesExitCodeAndSignal) {
  GuardedProcess exits("/bin/sh", {"-c", "exit 7"}, {}, {"/dev/null"});
  ASSERT_TRUE(exits.waitForEnd(10.0));
  EXPECT_EQ(exits.exitCode(), 7);
  EXPECT_EQ(exits.endSignal(), 0);
  EXPECT_EQ(exits.endText(), "exit code 7");
  GuardedProcess crashes("/bin/sh", {"-c", "kill -SEGV $$"}, {}, {"/dev/null"});
  ASSERT_TRUE(crashes.waitForEnd(10.0));
  EXPECT_EQ(crashes.endSignal(), SIGSEGV);
  EXPECT_EQ(crashes.exitCode(), 128 + SIGSEGV);
  EXPECT_EQ(crashes.endText(), "signal 11 (Segmentation fault)");
}

TEST(GuardedProcess, SaysWhereAKillingSignalComesFrom) {
  GuardedProcess killed("/bin/sh", {"-c", "kill -KILL $$"}, {}, {"/dev/null"});
  ASSERT_TRUE(killed.waitForEnd(10.0));
  EXPECT_EQ(killed.endText().rfind("signal 9 (Killed) from outside", 0), 0U) << killed.endText();
  GuardedProcess late("/bin/sh", {"-c", "kill -XCPU $$"}, {}, {"/dev/null"});
  ASSERT_TRUE(late.waitForEnd(10.0));
  EXPECT_EQ(late.endSignal(), SIGXCPU);
  EXPECT_NE(late.endText().find("`ulimit -t`"), std::string::npos) << late.endText();
}

TEST(GuardedProcess, ProgramsAreFoundPastFoldersThatCannotBeRead) {
  EXPECT_EQ(findProgram("/bin/sh", "dash"), "/bin/sh");
  ::setenv("PATH", "/nowhere:/proc/1/fd:/bin", 1);
  EXPECT_EQ(findProgram("sh", "dash"), "/bin/sh");
  try {
    findProgram("no_such_program", "no-such-package");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "the program 'no_such_program' was not found; install the package "
                 "no-such-package or name the program's file");
  }
}

}  // namespace
}  // namespace cdiff::core
