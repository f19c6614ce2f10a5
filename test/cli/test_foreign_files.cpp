// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// No command touches a file that the program did not make, whatever it is called: real processes.
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <map>
#include <sstream>

#include "cli/evaluate_command.h"
#include "core/output_folder.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr int kVerdict = 1;  ///< exit codes up to this one are of sessions that ended
constexpr int kRefused = 3;

/// What a user would miss of an entry: kind, size, time of change, target, content.
std::string stateOf(const fs::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return "gone";
  std::ostringstream state;
  state << std::oct << status.st_mode << std::dec << " " << status.st_ino;
  if (S_ISDIR(status.st_mode)) return state.str();
  state << " " << status.st_size << " " << status.st_mtim.tv_sec << "." << status.st_mtim.tv_nsec;
  if (S_ISLNK(status.st_mode)) state << " " << fs::read_symlink(path).string();
  if (S_ISREG(status.st_mode)) state << " " << core::readFile(path, "file");
  return state.str();
}

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class ForeignFiles : public test::EvaluateCommand {
 protected:
  ForeignFiles() {
    fs::create_directories(folder("outside/folder"));
    write("outside/thesis", "mine");
    write("outside/folder/chapter", "mine");
  }

  fs::path results() const { return folder("results"); }

  /// An entry of the user's, whose parents are made.
  void addFile(const fs::path& path) {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << "mine " << path.filename();
    known_[path] = "";
  }
  void addLink(const fs::path& path, const std::string& target) {
    fs::create_directories(path.parent_path());
    fs::create_symlink(folder("outside/" + target), path);
    known_[path] = "";
  }
  void addPipe(const fs::path& path) {
    fs::create_directories(path.parent_path());
    ASSERT_EQ(::mkfifo(path.c_str(), 0644), 0);
    known_[path] = "";
  }

  /// Entries whose names are like the program's, but none of them.
  void addLikeOurs(const fs::path& folder) {
    for (const char* name :
         {"notes.tmp.txt", "thesis.tmp.docx", "plot.png.tmp.1", ".hidden", "mine.part",
          "mine.bag.active", "figures/mine.png", "tables/mine.tex", "runs/mine.log",
          "shards/mine.tmp.bak", "bags/raw.bag.active", "networks/mine.net.xml"})
      addFile(folder / name);
    addLink(folder / "link", "thesis");
    addLink(folder / "folder_link", "folder");
    addPipe(folder / "pipe");
  }

  /// To be called when everything is added.
  void remember() {
    for (const char* name : {"outside/thesis", "outside/folder", "outside/folder/chapter"})
      known_[this->folder(name)] = "";
    for (auto& [path, state] : known_) state = stateOf(path);
  }
  void expectUntouched(const std::string& after) const {
    for (const auto& [path, state] : known_)
      EXPECT_EQ(stateOf(path), state) << path << " after " << after;
    EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder("outside")),
                            fs::recursive_directory_iterator()),
              3)
        << after;
  }

  int session(const Words& more) const {
    return cdiff(Words{"run", "arterial_exit", "--cbv-planner", "pdm_lite", "--quiet", "--set",
                       "protocol.time_limit=1", "--results", results()} +
                 more);
  }
  std::string matrix() const {
    return write("matrix.yaml",
                 "name: small\nscenarios: [arterial_exit]\nseeds: [1]\nset:\n  - "
                 "protocol.time_limit=1\n  - cbv_planner=pdm_lite\n");
  }
  Words batch() const { return {"evaluate", matrix(), "--results", results()}; }

  /// Starts the command, waits until it has written `sign`, and kills it.
  void kill(const Words& words, const fs::path& sign) const {
    test::ProgramRun process(CDIFF_PROGRAM, words, scratch_.path() / "killed");
    for (int i = 0; i < 6000 && !fs::exists(sign); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ASSERT_TRUE(fs::exists(sign));
    process.signal(SIGKILL);
    process.wait();
  }

  std::map<fs::path, std::string> known_;
};

TEST_F(ForeignFiles, ASessionLeavesThemAlone) {
  addLikeOurs(results());
  remember();
  const Words video = {"--set", "video=true"};
  EXPECT_LE(session(video), kVerdict) << output();
  expectUntouched("a run");
  EXPECT_EQ(session({}), kRefused);
  expectUntouched("a refused run");
  EXPECT_LE(session({"--overwrite"}), kVerdict) << output();
  expectUntouched("an overwritten run");
  EXPECT_FALSE(fs::exists(results() / "session.mp4")) << "it was the program's";
  kill({"run", "arterial_exit", "--cbv-planner", "pdm_lite", "--results", results(), "--overwrite"},
       results() / "trace.csv.part");
  expectUntouched("a killed run");
  EXPECT_LE(session({"--overwrite"}), kVerdict) << output();
  expectUntouched("the run after it");
  EXPECT_FALSE(fs::exists(results() / "trace.csv.part"));
}

TEST_F(ForeignFiles, ASessionIsRefusedWhereOneHasItsName) {
  const Words names = {"session.yaml",     "trace.csv", "plans.csv",   "vehicles.csv",
                       "summary.json",     "junit.xml", "report.html", "session.bag",
                       "session.mp4",      "exit_code", ".lock",       ".cdiff_files",
                       "summary.json.part"};
  for (const std::string& name : names) {
    fs::remove_all(results());
    known_.clear();
    addFile(results() / name);
    remember();
    for (const Words& more : {Words{}, Words{"--overwrite"}}) {
      EXPECT_EQ(session(more), kRefused) << name;
      expectOutput((results() / name).string());
      expectUntouched("a run beside " + name);
    }
  }
}

TEST_F(ForeignFiles, AFolderWithTheNameOfTheReserveIsRefused) {
  addFile(results() / ".reserve" / "thesis");
  remember();
  EXPECT_EQ(session({"--overwrite"}), kRefused);
  expectOutput(".reserve");
  expectUntouched("a run beside .reserve");
}

TEST_F(ForeignFiles, LogsAndTablesThatAreNotOursAreRefusedBeforeTheFirstRun) {
  for (const char* name : {"runs/arterial_exit/log.txt", "tables/table_1.csv"}) {
    fs::remove_all(results());
    known_.clear();
    addFile(results() / name);
    remember();
    EXPECT_EQ(cdiff(batch()), kRefused) << name;
    expectUntouched(name);
    EXPECT_FALSE(fs::exists(results() / "runs.csv")) << name;
  }
}

TEST_F(ForeignFiles, AnOverwrittenBatchLeavesNoRunsOfTheEarlierOneInAFolderOfTheUsers) {
  addFile(results() / "runs" / "mine.log");
  remember();
  const std::string two = write("two.yaml",
                                "name: two\nscenarios: [arterial_exit]\nseeds: [1, 2]\nset:\n  - "
                                "protocol.time_limit=1\n  - cbv_planner=pdm_lite\n");
  EXPECT_LE(cdiff({"evaluate", two, "--results", results()}), kVerdict) << output();
  EXPECT_TRUE(fs::exists(results() / "runs" / "arterial_exit__seed2"));
  EXPECT_LE(cdiff(batch() + Words{"--overwrite"}), kVerdict) << output();
  EXPECT_FALSE(fs::exists(results() / "runs" / "arterial_exit__seed2"));
  expectUntouched("an overwritten batch");
}

TEST_F(ForeignFiles, LinksPipesAndFoldersInPlaceOfItsFilesAreRefused) {
  for (const std::string name : {"trace.csv", "report.html", ".lock", ".cdiff_files"}) {
    for (const std::string kind : {"link", "folder link", "pipe", "folder"}) {
      fs::remove_all(results());
      known_.clear();
      const fs::path path = results() / name;
      if (kind == "link") addLink(path, "thesis");
      if (kind == "folder link") addLink(path, "folder");
      if (kind == "pipe") addPipe(path);
      if (kind == "folder") addFile(path / "mine");
      remember();
      EXPECT_EQ(session({"--overwrite"}), kRefused) << name << " " << kind;
      expectUntouched("a run beside " + name + " as a " + kind);
    }
  }
}

TEST_F(ForeignFiles, AFolderThatIsALinkIsRefusedByEveryCommand) {
  fs::create_directory_symlink(folder("outside/folder"), results());
  known_[results()] = "";
  remember();
  EXPECT_EQ(session({}), kRefused);
  expectOutput("symbolic link");
  for (const Words& words : {batch(), Words{"suite", "development", "--results", results()},
                             Words{"collect", "--scenarios", "arterial_exit", "--duration", "4",
                                   "--results", results()}}) {
    EXPECT_EQ(cdiff(words), kRefused) << words.front();
    expectUntouched(words.front());
  }
}

TEST_F(ForeignFiles, ABatchLeavesThemAlone) {
  addLikeOurs(results());
  remember();
  EXPECT_LE(cdiff(batch()), kVerdict) << output();
  expectUntouched("a batch");
  EXPECT_EQ(cdiff(batch()), kRefused);
  expectUntouched("a refused batch");
  EXPECT_LE(cdiff(batch() + Words{"--overwrite"}), kVerdict) << output();
  expectUntouched("an overwritten batch");
  ASSERT_FALSE(fs::exists(results() / "plan.json"));  // there while a batch runs
  kill(batch() + Words{"--overwrite"}, results() / "plan.json");
  expectUntouched("a killed batch");
  EXPECT_LE(cdiff(batch() + Words{"--resume"}), kVerdict) << output();
  expectUntouched("the batch after it");
  EXPECT_EQ(cdiff({"report", "--tables", results()}), 0) << output();
  expectUntouched("its tables");
}

TEST_F(ForeignFiles, ABatchIsRefusedWhereOneHasItsName) {
  for (const std::string name : {"summary.md", "index.html", "runs.csv", "matrix.yaml"}) {
    fs::remove_all(results());
    known_.clear();
    addFile(results() / name);
    for (const char* mine : {"figures/mine.png", "tables/mine.tex", "runs/mine.log"})
      addFile(results() / mine);
    remember();
    for (const Words& more : {Words{}, Words{"--overwrite"}, Words{"--resume"}}) {
      EXPECT_EQ(cdiff(batch() + more), kRefused) << name;
      expectUntouched("a batch beside " + name);
    }
  }
}

TEST_F(ForeignFiles, FoldersOfABatchThatAreLinksAreNotEntered) {
  for (const std::string name : {"runs", "tables", "figures"}) {
    fs::remove_all(results());
    known_.clear();
    addLink(results() / name, "folder");
    remember();
    EXPECT_GT(cdiff(batch()), kVerdict) << name;
    expectUntouched("a batch with a link " + name);
  }
}

TEST_F(ForeignFiles, ACollectionLeavesThemAlone) {
  addLikeOurs(results());
  remember();
  const Words collect = {"collect", "--scenarios", "arterial_exit", "--duration",
                         "6",       "--results",   results()};
  const int code = cdiff(collect);
  EXPECT_TRUE(code == 0 || code == kRefused) << output();  // a short one may give no sample
  expectUntouched("a collection");
  EXPECT_EQ(cdiff({"collect", "--scenarios", "nowhere", "--results", results()}), kRefused);
  expectUntouched("a refused collection");
  addFile(results() / "samples.html.part");
  remember();
  EXPECT_EQ(cdiff(collect), kRefused);
  expectUntouched("a collection beside a file of its name");
}

TEST_F(ForeignFiles, ASuiteLeavesThemAlone) {
  addFile(folder("results.part") + "/mine");
  remember();
  EXPECT_EQ(cdiff({"suite", "development", "--results", results()}), kRefused);
  expectOutput("results.part");
  expectUntouched("a refused suite");
  fs::remove_all(folder("results.part"));
  known_.clear();
  remember();
  EXPECT_EQ(cdiff({"suite", "development", "--results", results()}), 0) << output();
  for (const auto& entry : fs::recursive_directory_iterator(results()))
    EXPECT_NE(entry.path().filename(), core::OutputFolder::kRecord);
  EXPECT_FALSE(fs::exists(folder("results.part")));
}

TEST_F(ForeignFiles, AnImportReplacesNoDeviceAndFollowsNoLinkOut) {
  addPipe(results() / "pipe");
  addLink(results() / "link", "thesis");
  remember();
  for (const char* name : {"pipe", "link"}) {
    EXPECT_EQ(cdiff({"import", "roundabout", "--output", results() / name}), kRefused) << name;
    expectUntouched("an import");
  }
  EXPECT_EQ(cdiff({"import", "roundabout", "--output", "/dev/null"}), 0) << output();
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(ForeignFiles, AFolderThatIsRenamedOrDeletedMeanwhileGetsWhatCanBeSaved) {
  const Words words = {"run", "arterial_exit", "--cbv-planner", "pdm_lite", "--results", results()};
  for (const bool renamed : {true, false}) {
    fs::remove_all(results());
    test::ProgramRun process(CDIFF_PROGRAM, words, scratch_.path() / "output");
    while (!fs::exists(results() / "session.yaml"))
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    process.signal(SIGSTOP);
    siginfo_t stopped{};
    ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(process.id()), &stopped, WSTOPPED | WNOWAIT), 0);
    if (renamed) {
      fs::rename(results(), folder("moved"));
    } else {
      fs::remove_all(results());
    }
    process.signal(SIGCONT);
    const int code = process.wait();
    const fs::path place = renamed ? fs::path(folder("moved")) : results();
    EXPECT_TRUE(renamed ? code <= kVerdict : code == 2) << code << output();
    expectOutput(renamed ? "renamed" : "deleted");
    for (const char* name : {"summary.json", "trace.csv", "report.html", "session.yaml"})
      EXPECT_TRUE(fs::exists(place / name)) << name << output();
    EXPECT_EQ(fs::exists(results()), !renamed);
  }
}

}  // namespace
}  // namespace cdiff::cli
