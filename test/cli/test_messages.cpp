// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cli/cdiff_command.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

/// What the user reads where the command line, the environment or a file is wrong.
class Messages : public test::CdiffCommand {
 protected:
  /// A variable of the environment for the life of a test.
  class Variable {
   public:
    Variable(const char* name, const std::string& value) : name_(name) {
      if (const char* before = std::getenv(name)) before_ = before;
      ::setenv(name, value.c_str(), 1);
    }
    ~Variable() {
      if (before_) ::setenv(name_, before_->c_str(), 1);
      if (!before_) ::unsetenv(name_);
    }

   private:
    const char* name_;
    std::optional<std::string> before_;
  };
};

TEST_F(Messages, AnUnknownCommandIsNamed) {
  EXPECT_EQ(cdiff({"evalute"}), 3);
  expectOutput("unknown command 'evalute'; did you mean 'evaluate'?");
  expectOutput("validate");
  EXPECT_EQ(cdiff({"drive"}), 3);
  expectOutput("unknown command 'drive'; known: run, ");
  EXPECT_EQ(output().find("collect_session"), std::string::npos) << output();  // for collect alone
}

// Address space and data: a program that is loaded all the same waits for ever.
TEST_F(Messages, ALimitThatLeavesNoMemoryIsNamed) {
  for (const std::string limit : {"-v 400000", "-d 60000"}) {
    const std::string command = "ulimit " + limit + "; exec timeout 60 " CDIFF_PROGRAM " --version";
    EXPECT_EQ(run("/bin/bash", {"-c", command}), 2) << limit;
    expectOutput("raise ulimit -v");
  }
}

TEST_F(Messages, ALimitThatLeavesNoOpenFileIsNamed) {
  const std::string command = "ulimit -n 12; exec " CDIFF_PROGRAM
                              " run crossing_straight --quiet --results '" +
                              path("results") + "'";
  EXPECT_EQ(run("/bin/bash", {"-c", command}), 2);
  expectOutput("`ulimit -n`");
}

// A reader that leaves early has what it wants.
TEST_F(Messages, OutputThatCannotBeWrittenIsAnError) {
  for (const std::string command : {"--version", "run --help", "validate crossing_straight"}) {
    EXPECT_EQ(run("/bin/bash", {"-c", "exec " CDIFF_PROGRAM " " + command + " >/dev/full"}), 2)
        << command;
    expectOutput("cdiff: cannot write to the standard output: No space left on device");
    EXPECT_EQ(run("/bin/bash", {"-c", "set -o pipefail; " CDIFF_PROGRAM " " + command + " | :"}), 0)
        << command << output();
  }
  EXPECT_EQ(run("/bin/bash", {"-c", "exec " CDIFF_PROGRAM " drive >/dev/full"}), 3);
}

TEST_F(Messages, AnUnknownOptionIsNamedWithTheNearest) {
  EXPECT_EQ(cdiff({"run", "roundabout_cross", "--sed", "3"}), 3);
  expectOutput(
      "cdiff: 'cdiff run' takes no argument '--sed'; did you mean '--seed'? (see cdiff run "
      "--help)");
  EXPECT_EQ(cdiff({"run", "roundabout_cross", "more"}), 3);
  expectOutput("cdiff: 'cdiff run' takes no argument 'more' (see cdiff run --help)");
  EXPECT_EQ(cdiff({"metric"}), 3);
  expectOutput("cdiff: metric is required (see cdiff metric --help)");
}

TEST_F(Messages, TheVersionNamesWhatResultsDependOn) {
  EXPECT_EQ(cdiff({"--version"}), 0);
  for (const char* part : {"cdiff 0.", "\nrevision ", "\nSUMO 1.", "\ninstruction set "})
    expectOutput(part);
}

TEST_F(Messages, ASumoHomeThatIsNoneIsReplaced) {
  const Variable variable("SUMO_HOME", path("none"));
  EXPECT_EQ(cdiff({"doctor"}), 0);
  expectOutput("SUMO_HOME: '" + path("none") + "' is no folder: SUMO's programs are started with ");
}

#ifdef CDIFF_SETUP
TEST_F(Messages, SourcingPutsCdiffInPathAndLeavesSumoHomeAlone) {
  const Variable variable("SUMO_HOME", path("none"));
  EXPECT_EQ(run("/bin/bash",
                {"-c", "set --; . '" CDIFF_SETUP "'; cdiff --version && echo \"is $SUMO_HOME\""}),
            0);
  expectOutput("instruction set");
  expectOutput("is " + path("none") + "\n");
}
#endif

TEST_F(Messages, ControlCharactersOfAFileDoNotReachTheTerminal) {
  const std::string file = path("loud.yaml");
  core::writeFileAtomically(file, "name: loud\nmode: \"\\e]0;mine\\a\\e[31mred\"\n");
  for (const char* command : {"validate", "run"}) {
    EXPECT_EQ(cdiff({command, file}), 3);
    expectOutput("\uFFFD[31mred");
    EXPECT_EQ(output().find('\x1b'), std::string::npos);
  }
}

TEST_F(Messages, NorDoThoseOfASessionThatBreaksInItsOwnProcess) {
  EXPECT_EQ(cdiff({"run", "crossing_straight", "--cbv-planner", "pdm_lite", "--quiet", "--results",
                   "/proc/none\x1b[31mred"}),
            3);
  expectOutput("\uFFFD[31mred");
  EXPECT_EQ(output().find('\x1b'), std::string::npos);
}

TEST_F(Messages, AModeThatIsNoneIsExplained) {
  EXPECT_EQ(cdiff({"run", "roundabout_cross", "--mode", "agressive"}), 3);
  expectOutput(
      "key 'mode' is 'agressive'; expected one of {naturalistic, challenging, safety_critical}: "
      "How CBVs behave: as in everyday traffic, attacking as a careful driver could still answer, "
      "or seeking a collision.");
}

TEST_F(Messages, ALoopOfSymbolicLinksIsNamed) {
  fs::create_symlink("loop", path("loop"));
  const std::vector<std::vector<std::string>> commands = {
      {"run", path("loop")},
      {"run", "roundabout_cross", "--set", "network=" + path("loop")},
      {"run", "roundabout_cross", "--set", "guidance_profile=" + path("loop")},
      {"run", "roundabout_cross", "--results", path("loop")},
      {"evaluate", path("loop"), "--results", path("results")},
      {"import", path("loop")},
      {"report", "--training", path("loop")},
      {"metric", "ttc_2d", path("loop")},
      {"suite", "development", "--results", path("loop")}};
  for (const std::vector<std::string>& command : commands) {
    EXPECT_EQ(cdiff(command), 3) << command.front();
    expectOutput("'" + path("loop"));
    expectOutput("Too many levels of symbolic links");
    EXPECT_EQ(output().find("filesystem error"), std::string::npos) << output();
  }
}

TEST_F(Messages, AMissingTemporaryFolderIsNamed) {
  const Variable variable("TMPDIR", path("none"));
  EXPECT_EQ(cdiff({"run", "roundabout_cross", "--quiet", "--results", path("results")}), 3);
  expectOutput("environment variable TMPDIR is '" + path("none") + "'");
}

TEST_F(Messages, AFolderWhosePathSumoTakesApartIsNamed) {
  std::string text = core::readFile(
      core::shareFolder() / "networks" / "crossing_district" / "crossing_district.net.xml", "road");
  text.replace(text.find("<lane "), 6, "<lane disallow=\"drone\" ");  // which the cache is without
  std::ofstream(path("own.net.xml")) << text;
  const std::vector<std::string> command = {
      "run", "crossing_straight", "--network", path("own.net.xml"), "--results", path("results")};
  for (const char* name : {"TMPDIR", "E2E_CDIFF_CACHE"}) {
    for (const std::string folder : {"a,b", "${HOME}"}) {
      fs::create_directory(path(folder));
      const Variable variable(name, path(folder));
      EXPECT_EQ(cdiff(command), 3) << name;
      expectOutput(name);
      expectOutput("'" + path(folder) + "'");
    }
  }
}

TEST_F(Messages, WithoutATemporaryFolderNoBatchStartsAndTheDoctorSaysSo) {
  const Variable variable("TMPDIR", path("none"));
  std::ofstream(path("matrix.yaml")) << "scenarios: [arterial_exit]\ncbv_planners: [pdm_lite]\n"
                                        "set: [protocol.time_limit=1]\n";
  EXPECT_EQ(cdiff({"evaluate", path("matrix.yaml"), "--results", path("results")}), 3);
  expectOutput("environment variable TMPDIR is '" + path("none") +
               "', which is no folder that can be written to; set it to one, or unset it");
  EXPECT_FALSE(fs::exists(path("results")));
  EXPECT_NE(cdiff({"doctor"}), 0);
  expectOutput("wrong temporary folder: environment variable TMPDIR is '" + path("none") + "'");
}

TEST_F(Messages, AFileThatIsWrongIsNamedOnce) {
  std::ofstream(path("large.yaml")) << "#" << std::string(9000000, 'x');
  EXPECT_EQ(cdiff({"validate", path("large.yaml")}), 3);
  const std::string who = "cdiff: ";
  EXPECT_EQ(output().rfind(who + path("large.yaml") + ": holds 9000001 bytes of YAML", 0), 0U)
      << output();
  EXPECT_EQ(output().rfind(path("large.yaml")), who.size())
      << "the path is there twice: " << output();
}

TEST_F(Messages, TheKeysExplanationNamesEveryKindOfNetwork) {
  EXPECT_EQ(cdiff({"validate", "arterial_exit", "--print"}), 0);
  expectOutput("OpenStreetMap (*.osm)");
}

TEST_F(Messages, AShareFolderThatIsNoneIsNamed) {
  const Variable variable("E2E_CDIFF_SHARE", path("none"));
  EXPECT_EQ(cdiff({"validate", "roundabout_cross"}), 3);
  expectOutput("environment variable E2E_CDIFF_SHARE is '" + path("none") + "'");
}

TEST_F(Messages, AFolderOfPathThatCannotBeReadIsPassedOver) {
  fs::create_symlink("loop", path("loop"));
  const Variable variable("PATH", path("loop") + ":" + std::getenv("PATH"));
  EXPECT_EQ(cdiff({"run", "roundabout_cross", "--quiet", "--results", path("results"), "--set",
                   "protocol.time_limit=0.5", "--set", "verdict.minimum_route_completion=0"}),
            0)
      << output();
}

TEST_F(Messages, AMatrixOfTooManyRunsIsRefusedAtOnce) {
  std::ofstream matrix(path("many.yaml"));
  matrix << "scenarios: [no_such_scenario]\nseeds: [0";
  for (int seed = 1; seed < 1000; ++seed) matrix << ", " << seed;
  matrix << "]\nrepetitions: 101\n";
  matrix.close();
  // 1 scenario x 1 combination x 1 variant x 1000 seeds x 101 repetitions; nothing was resolved,
  // or the scenario would be named.
  EXPECT_EQ(cdiff({"evaluate", path("many.yaml"), "--results", path("results")}), 3);
  expectOutput("101000 runs would be planned");
  expectOutput("at most 100000");
  EXPECT_FALSE(fs::exists(path("results")));
}

}  // namespace
}  // namespace cdiff::cli
