// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Batches on a cluster of one machine (scripts/slurm_cluster), whose nodes and jobs are ended
/// under way. It keeps no accounts, and its arrays have at most five tasks.
#include <arpa/inet.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <iterator>
#include <set>

#include "cli/evaluate_command.h"
#include "cli/wall_clock.h"
#include "core/file_descriptor.h"
#include "core/guarded_process.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

bool isFree(int port) {
  const core::FileDescriptor server(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  return ::bind(server.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
}

/// The first of three free ports, looked for from a place of this process's own on.
int freePorts() {
  int port = 20000 + static_cast<int>(::getpid() % 9000);
  while (!isFree(port) || !isFree(port + 1) || !isFree(port + 2)) port += 3;
  return port;
}

std::vector<pid_t> allProcesses() {
  std::vector<pid_t> all;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos) all.push_back(std::stoi(name));
  }
  return all;
}

/// A file of /proc/PID; empty where the process has ended.
std::string stateOf(pid_t process, const std::string& name) {
  std::ifstream file("/proc/" + std::to_string(process) + "/" + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// 0 where it has ended.
pid_t parentOf(pid_t process) {
  const std::string text = stateOf(process, "stat");
  if (text.rfind(')') == std::string::npos) return 0;
  return std::stoi(core::splitText(text.substr(text.rfind(')') + 2), ' ').at(1));
}

/// A process and all that descend from it.
std::vector<pid_t> treeOf(pid_t root) {
  std::vector<pid_t> tree = {root};
  for (std::size_t i = 0; i < tree.size(); ++i) {
    for (const pid_t process : allProcesses())
      if (parentOf(process) == tree[i]) tree.push_back(process);
  }
  return tree;
}

/// What Slurm runs on a node for workers on these results: its step daemons, which are no children
/// of the node's daemon.
std::set<pid_t> stepsOn(const std::string& node, const std::string& results) {
  std::set<pid_t> steps;
  for (const pid_t process : allProcesses()) {
    const std::string words = stateOf(process, "cmdline");
    if (words.find(std::string("worker\0", 7) + results) == std::string::npos) continue;
    const std::string variable = "SLURMD_NODENAME=" + node + std::string(1, '\0');
    if (stateOf(process, "environ").find(variable) == std::string::npos) continue;
    if (stateOf(parentOf(process), "comm") == "slurmstepd\n") steps.insert(parentOf(process));
  }
  return steps;
}

class SlurmEngine : public test::EvaluateCommand {
 protected:
  void SetUp() override {
    for (const char* program : {"sbatch", "squeue"}) {
      if (!core::programInPath(program))
        GTEST_SKIP() << "no Slurm on this machine (scripts/packages_slurm.txt)";
    }
    if (::geteuid() == 0 && std::ifstream("/proc/self/setgroups").get() == 'd')
      GTEST_SKIP() << "slurmd needs setgroups(), which is denied to this name space's root";
    ::setenv("MAX_ARRAY_SIZE", "5", 1);
    ASSERT_EQ(cluster({"start", folder("cluster"), std::to_string(freePorts())}), 0) << output();
    ::setenv("SLURM_CONF", (folder("cluster") + "/slurm.conf").c_str(), 1);
    started_ = true;
  }
  void TearDown() override {
    if (started_) cluster({"stop", folder("cluster")});
    ::unsetenv("SLURM_CONF");
    ::unsetenv("MAX_ARRAY_SIZE");
  }
  int cluster(const std::vector<std::string>& arguments) const {
    return test::ProgramRun(CDIFF_CLUSTER, arguments, folder("output")).wait();
  }
  int shell(const std::string& script) const {
    return test::ProgramRun("/bin/sh", {"-c", script}, folder("shell")).wait();
  }
  /// Short sessions; `paced` ones last as long as their 3 simulated seconds.
  std::string matrix(int seeds, bool paced) const {
    std::string list = "1";
    for (int seed = 2; seed <= seeds; ++seed) list += ", " + std::to_string(seed);
    return write("matrix.yaml", "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\nseeds: [" +
                                    list + "]\nset: [protocol.time_limit=3, verdict.judge=false" +
                                    (paced ? ", at_most=1" : "") + "]\n");
  }
  std::vector<std::string> onSlurm(const std::string& file, const std::string& results) const {
    return {"evaluate", file,      "--results", results,   "--engine",
            "slurm",    "--slurm", "poll=0.5",  "--slurm", "runs_per_task=2"};
  }
  void expectSameAsLocal(const std::string& file, const std::string& results) const {
    const std::string local = folder("local");
    ASSERT_EQ(cdiff({"evaluate", file, "--results", local, "--jobs", "4"}), 0) << output();
    EXPECT_EQ(test::differences(test::filesOfAnyEngine(results), test::filesOfAnyEngine(local)),
              std::vector<std::string>());
  }
  static std::size_t doneIn(const std::string& results) {
    std::size_t count = 0;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(fs::path(results) / "runs", none)) {
      const auto record = readRecord(entry.path() / "record.json");
      count += record && record->complete();
    }
    return count;
  }
  static bool isLeased(const std::string& results) {
    std::error_code none;
    const fs::directory_iterator leases(fs::path(results) / ".leases", none);
    return begin(leases) != end(leases);
  }
  void waitForFirst(test::ProgramRun& driver, const std::string& results) const {
    while (doneIn(results) == 0 || !isLeased(results)) {
      ASSERT_FALSE(driver.ended()) << output();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  /// Whether Slurm has queued a task again.
  bool queuedAgain() const { return shell("scontrol show job | grep -q 'Restarts=[1-9]'") == 0; }
  /// By default Slurm holds a task back for two minutes when it queues it again.
  int waitWithoutDelays(test::ProgramRun& driver) const {
    constexpr int kMostSeconds = 300;
    for (int i = 0; i < kMostSeconds && !driver.waitForEnd(1.0); ++i) {
      shell(
          "for job in $(squeue -h -r -t PD -o %i); do scontrol update JobId=$job StartTime=now; "
          "done");
    }
    EXPECT_TRUE(driver.ended()) << "it did not end within " << kMostSeconds << " s\n" << output();
    return driver.ended() ? driver.exitCode() : -1;
  }
  bool started_ = false;
};

TEST_F(SlurmEngine, GivesTheBytesOfALocalBatchInMoreThanOneArray) {
  const std::string file = matrix(24, false);
  const std::string results = folder("results");
  ASSERT_EQ(cdiff(onSlurm(file, results)), 0) << output();  // 12 tasks: arrays of 5, 5 and 2
  expectOutput("submitted 1, ");
  expectOutput("24/24 done, 0 broken");
  EXPECT_EQ(lines(fs::path(results) / "runs.csv"), 25U);
  EXPECT_FALSE(isLeased(results));
  expectSameAsLocal(file, results);
}

TEST_F(SlurmEngine, LosesNothingWhenANodeIsKilled) {
  const std::string file = matrix(8, true);
  const std::string results = folder("results");
  test::ProgramRun driver(CDIFF_PROGRAM, onSlurm(file, results), folder("output"));
  waitForFirst(driver, results);
  std::set<pid_t> roots = stepsOn("n1", results);
  while (roots.empty()) {
    ASSERT_FALSE(driver.waitForEnd(0.02)) << "the node had no work\n" << output();
    roots = stepsOn("n1", results);
  }
  roots.insert(std::stoi(core::readFile(folder("cluster") + "/n1.pid", "node")));
  for (const pid_t root : roots)
    for (const pid_t process : treeOf(root)) ::kill(process, SIGKILL);
  fs::remove(folder("cluster") + "/n1.pid");
  EXPECT_EQ(waitWithoutDelays(driver), 0) << output();
  EXPECT_TRUE(queuedAgain());
  EXPECT_EQ(lines(fs::path(results) / "runs.csv"), 9U);
  expectSameAsLocal(file, results);
}

TEST_F(SlurmEngine, LosesNothingWhenItsTasksArePreempted) {
  const std::string file = matrix(8, true);
  const std::string results = folder("results");
  test::ProgramRun driver(CDIFF_PROGRAM, onSlurm(file, results), folder("output"));
  waitForFirst(driver, results);
  ASSERT_EQ(shell("sbatch -p high -N 2 --exclusive -o /dev/null --wrap true"), 0);
  EXPECT_EQ(waitWithoutDelays(driver), 0) << output();
  EXPECT_TRUE(queuedAgain());
  expectSameAsLocal(file, results);
}

TEST_F(SlurmEngine, IsCanceledAndResumed) {
  const std::string file = matrix(8, true);
  const std::string results = folder("results");
  test::ProgramRun driver(CDIFF_PROGRAM, onSlurm(file, results), folder("driver"));
  waitForFirst(driver, results);
  EXPECT_EQ(cdiff({"evaluate", file, "--results", folder("other"), "--cancel"}), 3);
  expectOutput("has no engine.json");
  ASSERT_EQ(cdiff({"evaluate", "--results", results, "--cancel"}), 0) << output();
  EXPECT_EQ(driver.wait(), 2);
  EXPECT_LT(doneIn(results), 8U);
  EXPECT_FALSE(isLeased(results)) << "workers return their runs";
  ASSERT_EQ(cdiff({"evaluate", file, "--results", results, "--resume", "--jobs", "2"}), 0)
      << output();
  expectSameAsLocal(file, results);
}

TEST_F(SlurmEngine, GoesOnWithoutItsCommandWhichMayComeBack) {
  const std::string file = matrix(6, true);
  const std::string results = folder("results");
  {
    test::ProgramRun driver(CDIFF_PROGRAM, onSlurm(file, results), folder("output"));
    waitForFirst(driver, results);
    EXPECT_EQ(cdiff(onSlurm(file, results)), 3) << "a second driver is refused";
    driver.signal(SIGINT);
    EXPECT_EQ(driver.wait(), 130);
  }
  for (const char* option : {"--overwrite", "--resume"}) {
    EXPECT_EQ(cdiff({"evaluate", file, "--results", results, option}), 3) << option;
    expectOutput("wait or run on the cluster (");
  }
  ASSERT_EQ(cdiff({"evaluate", "--results", results, "--attach", "--slurm", "poll=0.5"}), 0)
      << output();
  expectSameAsLocal(file, results);
}

TEST_F(SlurmEngine, RefusalsAreOneSentenceAndLeaveNothingQueued) {
  const std::string file = matrix(1, false);
  auto words = onSlurm(file, folder("results"));
  words.insert(words.end(), {"--slurm", "partition=nowhere"});
  EXPECT_EQ(cdiff(words), 3);
  expectOutput("Slurm refused sbatch: ");
  expectOutput("invalid partition");
  ASSERT_EQ(shell("squeue -h"), 0);
  EXPECT_EQ(core::readFile(folder("shell"), "queue"), "");
}

/// A cluster of four scripts: sbatch takes until the file `go` is there, and its task stays queued
/// as long as the file `queued` is.
class PlayedSlurm : public test::EvaluateCommand {
 protected:
  PlayedSlurm() : path_(std::getenv("PATH")) {
    fs::create_directories(folder("bin"));
    play("sbatch", "touch $D/queued $D/asked\nwhile [ ! -e $D/go ]; do sleep 0.01; done\necho 7");
    play("squeue", "[ ! -e $D/queued ] || echo 7_0");
    play("scancel", "rm -f $D/queued");
    play("scontrol", "echo 'MaxArraySize = 1001'");
    ::setenv("PATH", (folder("bin") + ":" + path_).c_str(), 1);
  }
  ~PlayedSlurm() override { ::setenv("PATH", path_.c_str(), 1); }
  void play(const std::string& name, const std::string& script) const {
    const fs::path file = fs::path(folder("bin")) / name;
    std::ofstream(file) << "#!/bin/sh\nD='" << folder("") << "'\n" << script << "\n";
    fs::permissions(file, fs::perms::owner_all);
  }
  std::string path_;
};

TEST_F(PlayedSlurm, KeepsTheJobsOfACommandThatIsStoppedWhileTheyAreSubmitted) {
  const std::string results = folder("results");
  const std::vector<std::string> words = {"evaluate", "smoke", "--results", results};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  {
    test::ProgramRun driver(CDIFF_PROGRAM, with({"--engine", "slurm"}), folder("output"));
    while (!fs::exists(folder("asked"))) ASSERT_FALSE(driver.waitForEnd(0.01)) << output();
    driver.signal(SIGINT);
    EXPECT_FALSE(driver.waitForEnd(0.5)) << "sbatch is not left alone\n" << output();
    std::ofstream(folder("go")) << "now";
    EXPECT_EQ(driver.wait(), 130) << output();
  }
  expectOutput("submitted 7 as cdiff-");
  expectOutput("the jobs go on without this command");
  for (const char* option : {"--resume", "--overwrite"}) {
    EXPECT_EQ(cdiff(with({option})), 3) << option;
    expectOutput("wait or run on the cluster (1)");
  }
  ASSERT_EQ(cdiff({"evaluate", "--results", results, "--cancel"}), 0) << output();
  EXPECT_EQ(cdiff(with({"--resume", "--engine", "print"})), 0) << output();
}

TEST_F(PlayedSlurm, EndsAJobThatWasTakenThoughItsSubmissionFailed) {
  play("sbatch", "touch $D/queued\nexit 1");
  EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("results"), "--engine", "slurm"}), 3);
  EXPECT_FALSE(fs::exists(folder("queued"))) << output();
}

// A word of the site on any stream is neither a task nor the id of a job.
TEST_F(PlayedSlurm, TakesNoWarningForATask) {
  play("sbatch", "touch $D/asked\necho 7\necho 'sbatch: warning: be quick' >&2");
  play("squeue", "echo 'squeue: warning: maintenance soon' >&2\n[ ! -e $D/queued ] || echo 7_0");
  const std::vector<std::string> words = {"evaluate", "smoke", "--results", folder("results")};
  std::vector<std::string> all = words;
  all.insert(all.end(), {"--engine", "slurm", "--slurm", "poll=0.1"});
  EXPECT_EQ(cdiff(all), 2) << output();  // the job has ended, and did nothing
  expectOutput("submitted 7 as cdiff-");
  expectOutput("their jobs ended before");
}

TEST_F(PlayedSlurm, ACopyOfABatchHasNoJobs) {
  play("sbatch", "touch $D/queued\necho 7");
  const std::string results = folder("results");
  {
    test::ProgramRun driver(
        CDIFF_PROGRAM,
        {"evaluate", "smoke", "--results", results, "--engine", "slurm", "--slurm", "poll=0.1"},
        folder("output"));
    while (!fs::exists(folder("queued"))) ASSERT_FALSE(driver.waitForEnd(0.01)) << output();
    driver.signal(SIGINT);
    EXPECT_EQ(driver.wait(), 130) << output();
  }
  fs::copy(results, folder("copy"), fs::copy_options::recursive);
  EXPECT_EQ(cdiff({"evaluate", "--results", folder("copy"), "--cancel"}), 3);
  expectOutput("is a copy");
  EXPECT_TRUE(fs::exists(folder("queued")));
  EXPECT_EQ(cdiff({"evaluate", "--results", results, "--cancel"}), 0) << output();
  EXPECT_FALSE(fs::exists(folder("queued")));
}

TEST_F(PlayedSlurm, RefusesAnArraySizeThatIsNone) {
  for (const char* size : {"0", "1e30", "many"}) {
    play("scontrol", std::string("echo 'MaxArraySize = ") + size + "'");
    EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("results"), "--engine", "slurm"}), 3);
    expectOutput(std::string("MaxArraySize is ") + size);
  }
}

class WithoutSlurm : public test::EvaluateCommand {};

TEST_F(WithoutSlurm, NamesTheProgramThatIsMissing) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", folder("empty").c_str(), 1);
  EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("results"), "--engine", "slurm"}), 3);
  ::setenv("PATH", path.c_str(), 1);
  expectOutput("sbatch");
  expectOutput("slurm-client");
  EXPECT_FALSE(fs::exists(folder("results")));
}

TEST_F(WithoutSlurm, PrintsTheJobsAndSubmitsNothing) {
  const fs::path results = folder("results");
  ASSERT_EQ(cdiff({"evaluate", "smoke", "--results", results.string(), "--engine", "print",
                   "--slurm", "account=it's", "--slurm", "setup=[module load sumo]", "--slurm",
                   "extra_args=[--licenses=a]", "--jobs", "2"}),
            0)
      << output();
  for (const char* part : {"#!/bin/bash\n", "\nmodule load sumo\n", " worker ", "--part $(($1 + ",
                           "'--account=it'\\''s'", "'--licenses=a'", "'--cpus-per-task=2'"})
    expectOutput(part);
  EXPECT_TRUE(fs::exists(results / "slurm" / "job.sh"));
  EXPECT_TRUE(fs::exists(results / "plan.json"));
  EXPECT_FALSE(fs::exists(results / "engine.json"));
}

TEST_F(WithoutSlurm, NamesItsLogsInAnyFolder) {
  ASSERT_EQ(cdiff({"evaluate", "smoke", "--results", folder("50%j"), "--engine", "print"}), 0);
  expectOutput("/50%%j/slurm/%A_%a.log");
  EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("a\\b"), "--engine", "print"}), 3);
  expectOutput("backslash");
}

TEST_F(WithoutSlurm, RefusesWrongOptions) {
  for (const auto& [option, expected] :
       std::vector<std::pair<std::string, std::string>>{{"partitoin=x", "'partition'"},
                                                        {"runs_per_task=0", "runs_per_task"},
                                                        {"nothing.yaml", "nothing.yaml"},
                                                        {"extra_args=[--job-name=a]", "extra_args"},
                                                        {"extra_args=[-Ja]", "extra_args"},
                                                        {"account=\"a\\nb\"", "line break"}}) {
    EXPECT_EQ(cdiff({"evaluate", "smoke", "--results", folder("results"), "--engine", "print",
                     "--slurm", option}),
              3)
        << option;
    expectOutput(expected);
  }
  EXPECT_FALSE(fs::exists(folder("results")));
}

}  // namespace
}  // namespace cdiff::evaluation
