// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What a session does to the folder that it writes into, whatever happens to it: real processes.
#include <signal.h>

#include <nlohmann/json.hpp>

#include "cli/evaluate_command.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "support/processes.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using test::isAlive;

/// Exit codes up to this one are of sessions that ended by their own rules.
constexpr int kVerdict = 1;

/// Content of every file below a folder, by its path there.
std::map<std::string, std::string> contentsOf(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), folder).string()] = core::readFile(entry.path(), "file");
  }
  return files;
}

class ResultFolder : public test::EvaluateCommand {
 protected:
  ResultFolder() { ::setenv("TMPDIR", made("temporary").c_str(), 1); }
  ~ResultFolder() override {
    for (const char* name : {"TMPDIR", "E2E_CDIFF_CACHE", "E2E_CDIFF_NETCONVERT_LIMIT"})
      ::unsetenv(name);
  }
  std::string made(const std::string& name) const {
    fs::create_directories(folder(name));
    return folder(name);
  }
  std::string results() const { return folder("results"); }
  /// Words of a short session; `more` follow.
  std::vector<std::string> run(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"run",       "arterial_exit", "--cbv-planner", "pdm_lite",
                                      "--results", results(),       "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static std::vector<std::string> seconds(int limit) {
    return {"--set", "protocol.time_limit=" + std::to_string(limit)};
  }
  static std::vector<std::string> watched() { return {"--set", "at_most=1"}; }
  nlohmann::json summary() const {
    return nlohmann::json::parse(core::readFile(results() + "/summary.json", "summary"));
  }
  /// Runs a shell script; its output is in output() afterward.
  int shell(const std::string& script, const std::vector<std::string>& wrapper = {}) const {
    std::vector<std::string> words = wrapper;
    words.insert(words.end(), {"/bin/sh", "-c", script});
    const std::string program = words.front();
    words.erase(words.begin());
    test::ProgramRun process(program, words, scratch_.path() / "output");
    return process.wait();
  }
  std::string line(const std::vector<std::string>& words) const {
    return std::string(CDIFF_PROGRAM) + " " + core::joinText(words, " ");
  }
  /// A program of this name, found first, that does `script`.
  void fakeProgram(const std::string& name, const std::string& script) const {
    const fs::path file = fs::path(made("bin")) / name;
    std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(file, fs::perms::owner_all);
    ::setenv("PATH", (folder("bin") + ":" + std::getenv("PATH")).c_str(), 1);
  }
  template <class Ready>
  static bool waitUntil(const Ready& ready) {
    for (int i = 0; i < 3000 && !ready(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return ready();
  }
  bool holds(const std::string& part) const {
    std::error_code none;
    for (const auto& entry : fs::recursive_directory_iterator(scratch_.path(), none)) {
      if (entry.path().filename().string().find(part) != std::string::npos) return true;
    }
    return false;
  }
};

TEST_F(ResultFolder, ClosedStandardStreamsDoNotReachTheTrace) {
  std::vector<std::string> words = run(seconds(1));
  words.erase(std::find(words.begin(), words.end(), "--quiet"));
  ASSERT_LE(shell("exec 1>&- 2>&-; exec " + line(words)), kVerdict);
  const std::string trace = core::readFile(results() + "/trace.csv", "trace");
  EXPECT_EQ(trace.substr(0, 8), "tick,id,");
  EXPECT_EQ(trace.find("simulated"), std::string::npos);
  EXPECT_EQ(summary()["trace_sha256"], core::sha256(trace));
}

TEST_F(ResultFolder, AnEarlierResultIsReplacedOnlyWhenAsked) {
  ASSERT_LE(cdiff(run(seconds(1))), kVerdict) << output();
  for (const char* name : {"session.bag", "session.mp4"})
    core::writeOwnFile(fs::path(results()) / name, name);
  std::ofstream(fs::path(results()) / "notes.txt") << "mine";
  const auto before = contentsOf(results());
  EXPECT_EQ(cdiff(run(seconds(1))), 3);
  expectOutput("holds an earlier result (session.yaml)");
  expectOutput("--overwrite");
  const std::string bag = write("other.bag", "no bag");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"replay", bag, "--results", results()},
        {"evaluate", "smoke", "--results", results(), "--overwrite"}}) {
    EXPECT_EQ(cdiff(words), 3) << words.front();
    expectOutput("result");
  }
  EXPECT_EQ(contentsOf(results()), before);
  std::vector<std::string> again = run(seconds(2));
  again.push_back("--overwrite");
  EXPECT_LE(cdiff(again), kVerdict) << output();
  EXPECT_DOUBLE_EQ(summary()["simulated_seconds"].get<double>(), 2.0);
  EXPECT_FALSE(fs::exists(results() + "/session.bag"));
  EXPECT_FALSE(fs::exists(results() + "/session.mp4"));
  EXPECT_TRUE(fs::exists(results() + "/notes.txt"));  // not ours
  EXPECT_FALSE(fs::exists(results() + "/.lock"));
}

TEST_F(ResultFolder, ASecondWriterIsRefusedAndHangUpInterruptsTheFirst) {
  test::ProgramRun first(CDIFF_PROGRAM, run(watched()), scratch_.path() / "first");
  ASSERT_TRUE(waitUntil([&] { return fs::exists(results() + "/session.yaml"); }));
  std::vector<std::string> second = run(seconds(1));
  second.push_back("--overwrite");
  EXPECT_EQ(cdiff(second), 3);
  expectOutput("is being written by 'cdiff run', process ");
  expectOutput(" on host ");
  ASSERT_FALSE(first.ended());
  first.signal(SIGHUP);
  EXPECT_EQ(first.wait(), 130);
  EXPECT_EQ(summary()["status"], "interrupted");
  EXPECT_EQ(summary()["trace_sha256"],
            core::sha256(core::readFile(results() + "/trace.csv", "trace")));
}

TEST_F(ResultFolder, WhatAKilledSessionLeavesEndsWithItOrIsRemovedByTheNext) {
  fakeProgram("ffmpeg", "echo $$ > " + folder("ffmpeg_process") + "; exec sleep 100");
  std::vector<std::string> words = run(watched());
  words.push_back("--video");
  {
    test::ProgramRun process(CDIFF_PROGRAM, words, scratch_.path() / "output");
    ASSERT_TRUE(waitUntil([&] {
      const fs::path file = folder("ffmpeg_process");
      return fs::exists(file) && fs::file_size(file) > 1 && holds("trace.csv.part");
    }));
    process.signal(SIGKILL);
    EXPECT_EQ(process.wait(), 128 + SIGKILL);
  }
  const pid_t encoder = std::stoi(core::readFile(folder("ffmpeg_process"), "process"));
  EXPECT_TRUE(waitUntil([&] { return !isAlive(encoder); })) << "ffmpeg outlives the session";
  std::ofstream(core::OutputFolder(results()).claim("session.bag.active")) << "half";
  ASSERT_TRUE(holds(".part"));
  ASSERT_TRUE(holds("e2e_cdiff_scratch_"));  // SUMO's log
  for (const auto& entry : fs::directory_iterator(folder("temporary")))
    fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - std::chrono::hours(1));
  std::vector<std::string> next = run(seconds(1));
  next.push_back("--overwrite");
  ASSERT_LE(cdiff(next), kVerdict) << output();
  for (const char* part : {".part", ".active", "e2e_cdiff_scratch_", ".lock"})
    EXPECT_FALSE(holds(part)) << part;
}

/// 30 s of traffic are some 500 kB of trace, of which 64 kB and more are written at a time.
TEST_F(ResultFolder, OnAFullDiskThereIsASummaryAndRoomAgain) {
  const std::vector<std::string> own_mounts = {"/usr/bin/unshare", "-rm"};
  const std::string mount = "mount -t tmpfs -o size=200k none " + made("results") + " && ";
  if (!fs::exists(own_mounts.front()) || shell(mount + "exit 0", own_mounts) != 0)
    GTEST_SKIP() << "no mounts of one's own on this machine";
  std::vector<std::string> words = run({});
#ifdef E2E_CDIFF_WITH_ROS
  words.push_back("--record");
#endif
  EXPECT_EQ(shell(mount + line(words) + "; code=$?; ls -A " + results() +
                      " | sed 's/^/has /'; cat " + results() + "/summary.json; exit $code",
                  own_mounts),
            2);
  expectOutput("\"status\": \"error\"");
  expectOutput("No space left on device");
  expectOutput("has summary.json");
  for (const char* part : {".part", "has trace.csv", "has session.bag", "has .lock"})
    EXPECT_EQ(output().find(part), std::string::npos) << part << "\nin\n" << output();
}

TEST_F(ResultFolder, AFileBeyondTheLimitOfTheShellIsNamedWithTheLimit) {
  // 200 blocks of 512 bytes.
  EXPECT_EQ(shell("ulimit -f 200; exec " + line(run({}))), 2);
  expectOutput("trace.csv': File too large: this process may write no file beyond 102400 bytes");
  EXPECT_EQ(summary()["status"], "error");
  EXPECT_NE(summary()["faults"].back()["text"].get<std::string>().find("ulimit -f"),
            std::string::npos);
  EXPECT_FALSE(holds(".part"));
}

TEST_F(ResultFolder, NetconvertEndsWithUsWhateverEndsUs) {
  fakeProgram("netconvert", "echo $$ > " + folder("converter") + "; exec sleep 100");
  ::setenv("E2E_CDIFF_CACHE", made("cache").c_str(), 1);
  const std::string network = write("road.xodr", "<OpenDRIVE/>");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGKILL}) {
    fs::remove(folder("converter"));
    std::vector<std::string> words = run({"--network", network});
    test::ProgramRun process(CDIFF_PROGRAM, words, scratch_.path() / "output");
    ASSERT_TRUE(waitUntil(
        [&] { return fs::exists(folder("converter")) && fs::file_size(folder("converter")) > 1; }));
    const pid_t converter = std::stoi(core::readFile(folder("converter"), "process"));
    process.signal(signal);
    EXPECT_EQ(process.wait(), signal == SIGKILL ? 128 + SIGKILL : 130) << signal;
    EXPECT_TRUE(waitUntil([&] { return !isAlive(converter); })) << signal;
  }
  EXPECT_FALSE(fs::exists(results()));
}

TEST_F(ResultFolder, NetconvertThatHangsOrCrashesIsNamed) {
  const std::string network = write("road.xodr", "<OpenDRIVE/>");
  ::setenv("E2E_CDIFF_CACHE", made("cache").c_str(), 1);
  ::setenv("E2E_CDIFF_NETCONVERT_LIMIT", "0.5", 1);
  fakeProgram("netconvert", "exec sleep 100");
  EXPECT_EQ(cdiff({"import", network}), 3);
  expectOutput(
      "road.xodr': netconvert did not end within 0.5 s and was ended; set "
      "E2E_CDIFF_NETCONVERT_LIMIT to more");
  ::setenv("E2E_CDIFF_NETCONVERT_LIMIT", "20", 1);
  fakeProgram("netconvert", "echo broken; kill -SEGV $$");
  EXPECT_EQ(cdiff({"import", network}), 3);
  expectOutput("netconvert crashed: signal 11 (Segmentation fault): broken");
  ::setenv("E2E_CDIFF_NETCONVERT_LIMIT", "soon", 1);
  EXPECT_EQ(cdiff({"import", network}), 3);
  expectOutput("E2E_CDIFF_NETCONVERT_LIMIT is 'soon'; expected seconds above 0");
  ::unsetenv("E2E_CDIFF_NETCONVERT_LIMIT");
}

TEST_F(ResultFolder, AComparisonWithRecordedTrafficIsReplacedWhereAskedTo) {
  made("session");
  write("session/session.yaml", "scenario:\n  simulation_step: 0.1\n");
  write("session/trace.csv",
        "tick,id,role,x,y,heading,speed,throttle,steer,brake\n0,ego,ego,0,0,0,"
        "1,0,0,0\n");
  const std::string log = write("log.csv",
                                "recording,vehicle,t,x,y,heading,length,width\n"
                                "Main-1,7,0,0,0,0,4,2\n");
  std::vector<std::string> words = {"realism", "pooled", folder("session"), "--log",
                                    log,       "--out",  results()};
  EXPECT_EQ(cdiff(words), 0) << output();
  const auto before = contentsOf(results());
  write("log.csv", "recording,vehicle,t,x,y,heading,length,width\nSide-1,7,0,0,0,0,4,2\n");
  EXPECT_EQ(cdiff(words), 3);
  expectOutput("holds an earlier comparison (realism.json); replace it (--overwrite) or give");
  EXPECT_EQ(contentsOf(results()), before);
  words.emplace_back("--overwrite");
  EXPECT_EQ(cdiff(words), 0) << output();
  EXPECT_NE(contentsOf(results()), before);
}

TEST_F(ResultFolder, ABatchIsResumedReplacedOrRefused) {
  const std::string network = folder("town.net.xml");
  fs::copy(fs::path(CDIFF_SHARE) / "networks/arterial_merge/arterial_merge.net.xml", network);
  const std::string matrix = write("matrix.yaml",
                                   "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\n"
                                   "set: [protocol.time_limit=1, network=" +
                                       network + "]\n");
  const std::vector<std::string> evaluate = {"evaluate", matrix, "--results", results()};
  ASSERT_LE(cdiff(evaluate), kVerdict) << output();
  const auto before = contentsOf(results());
  EXPECT_EQ(cdiff(evaluate), 3);
  expectOutput("holds the results of a batch (matrix.yaml); go on with it (--resume), replace it");
  EXPECT_EQ(cdiff(run(seconds(1))), 3);
  expectOutput("holds the results of a batch");
  EXPECT_EQ(contentsOf(results()), before);
  const auto with = [&](const std::string& option) {
    std::vector<std::string> words = evaluate;
    words.push_back(option);
    return cdiff(words);
  };
  EXPECT_LE(with("--resume"), kVerdict);
  expectOutput("1 runs were complete already");
  std::ofstream(network, std::ios::app) << "<!-- another hash -->\n";
  EXPECT_LE(with("--resume"), kVerdict);
  expectOutput("1 run to do: network changed: arterial_exit");
  EXPECT_LE(with("--overwrite"), kVerdict);
  EXPECT_EQ(output().find("complete already"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::evaluation
