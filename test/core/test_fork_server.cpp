// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <thread>

#include "core/file.h"
#include "core/fork_server.h"
#include "core/process_pool.h"
#include "support/processes.h"
#include "support/temporary_folder.h"

namespace cdiff::core {
namespace {

constexpr int kInherited = 21;
constexpr int kAfresh = 22;

/// Never joined: the server has two threads from then on.
std::unique_ptr<std::thread> second_thread;

/// How the test's own program serves: the first word says what a job does. The server counts the
/// jobs that it was given.
ForkedRun preparation(const std::vector<std::string>& words) {
  static int jobs = 0;
  ++jobs;
  if (words[0] == "hang_early") ::pause();
  if (words[0] == "thread") second_thread = std::make_unique<std::thread>([] { ::pause(); });
  return [words] {
    if (words[0] == "exit") return std::stoi(words[1]);
    if (words[0] == "print") std::cout << words[1] << jobs;
    if (words[0] == "crash") {
      ::signal(SIGSEGV, SIG_DFL);  // a sanitizer's handler would exit
      ::raise(SIGSEGV);
    }
    if (words[0] == "kill_server") ::kill(::getppid(), SIGKILL);
    if (words[0] == "hang" || words[0] == "kill_server") ::pause();
    return words[0] == "thread" ? kInherited : 0;
  };
}

class ForkServerTest : public testing::Test {
 protected:
  static std::unique_ptr<ForkServer> start() {
    return std::make_unique<ForkServer>("/proc/self/exe", std::vector<std::string>{"serve"});
  }
  int run(ForkServer& server, const std::vector<std::string>& words) const {
    server.begin(words, log_);
    while (!server.ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return server.exitCode();
  }
  test::TemporaryFolder scratch_;
  std::filesystem::path log_ = scratch_.path() / "log.txt";
};

TEST_F(ForkServerTest, RunsJobsOneAfterAnotherAndKeepsWhatItLoaded) {
  const auto server = start();
  EXPECT_EQ(run(*server, {"exit", "0"}), 0);
  EXPECT_EQ(run(*server, {"exit", "3"}), 3);
  EXPECT_EQ(run(*server, {"print", "job "}), 0);
  EXPECT_EQ(readFile(log_, "log"), "job 3");
  EXPECT_EQ(run(*server, {"print", ""}), 0);
  EXPECT_EQ(readFile(log_, "log"), "4") << "an empty argument stays one, and the log is emptied";
}

TEST_F(ForkServerTest, LosesOnlyTheJobThatCrashes) {
  const auto server = start();
  EXPECT_EQ(run(*server, {"crash"}), 128 + SIGSEGV);
  EXPECT_TRUE(server->serves());
  EXPECT_EQ(run(*server, {"exit", "5"}), 5);
}

TEST_F(ForkServerTest, SaysHowAServerEndedThatDiesInAJob) {
  const auto server = start();
  EXPECT_EQ(run(*server, {"kill_server"}), 128 + SIGKILL);
  EXPECT_FALSE(server->serves());
}

// Its thread would be missing in a fork.
TEST_F(ForkServerTest, StartsTheProgramAfreshWhereAForkWouldBeUnsafe) {
  const auto server = start();
  EXPECT_EQ(run(*server, {"thread"}), kAfresh);
}

class ServedPool : public ForkServerTest {
 protected:
  /// Exit codes of jobs, one at a time.
  std::vector<int> run(const std::vector<std::vector<std::string>>& jobs) {
    std::vector<int> codes(jobs.size());
    PoolLimits limits;
    limits.timeout = 10.0;  // long enough for those that end by themselves
    std::deque<std::size_t> numbers;
    for (std::size_t i = 0; i < jobs.size(); ++i) numbers.push_back(i);
    const std::atomic<bool> stop{false};
    PoolCalls calls;
    calls.start = [&](std::size_t job) { return ProcessJob{"", jobs[job], log_}; };
    calls.ended = [&](const ProcessEnd& end) {
      codes[end.job] = end.exit_code;
      timed_out_.push_back(end.timed_out);
      return false;
    };
    runProcesses(numbers, limits, stop, calls, PoolServer{"/proc/self/exe", {"serve"}});
    return codes;
  }
  std::vector<bool> timed_out_;
};

TEST_F(ServedPool, KillsTheJobThatTakesTooLongAndKeepsTheServer) {
  EXPECT_EQ(run({{"hang"}, {"print", "job "}}), (std::vector<int>{128 + SIGKILL, 0}));
  EXPECT_EQ(timed_out_, (std::vector<bool>{true, false}));
  EXPECT_EQ(readFile(log_, "log"), "job 2") << "by the same server";
}

TEST_F(ServedPool, ReplacesAServerThatDies) {
  EXPECT_EQ(run({{"hang_early"}, {"kill_server"}, {"print", "job "}}),
            (std::vector<int>{128 + SIGKILL, 128 + SIGKILL, 0}));
  EXPECT_EQ(timed_out_, (std::vector<bool>{true, false, false}));
  EXPECT_EQ(readFile(log_, "log"), "job 1") << "by a server of its own";
}

TEST_F(ForkServerTest, TakesItsJobAlongWhenTheClientEnds) {
  pid_t job = 0;
  {
    const auto server = start();
    server->begin({"print", "under way"}, log_);
    while (!server->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    server->begin({"hang"}, log_);
    const std::string children = "/proc/" + std::to_string(server->id()) + "/task/" +
                                 std::to_string(server->id()) + "/children";
    while (job == 0) {
      const std::string text = readFile(children, "children");
      if (!text.empty()) job = std::stoi(text);
    }
  }
  for (int i = 0; i < 500 && test::isAlive(job); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(test::isAlive(job));
}

}  // namespace
}  // namespace cdiff::core

/// Also the server of its own tests, and what a server starts afresh.
int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "serve")
    return cdiff::core::serveForks(STDIN_FILENO, cdiff::core::preparation);
  if (argc > 1 && std::string(argv[1]) == "thread") return cdiff::core::kAfresh;
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
