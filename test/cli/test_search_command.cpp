// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// `cdiff search` with short sessions of planners that need no network.
#include <signal.h>

#include <algorithm>
#include <map>

#include "cli/evaluate_command.h"
#include "cli/wall_clock.h"
#include "core/csv.h"

namespace cdiff {
namespace {

namespace fs = std::filesystem;

class SearchCommand : public test::EvaluateCommand {
 protected:
  /// Short sessions of planners without a network, in batches of two.
  std::vector<std::string> words(const std::string& results, const std::string& budget) {
    const std::string space = write("space.yaml",
                                    "keys: [\"begin_time: 0.0 .. 40.0\", \"route.start_speed: "
                                    "0.0 .. 8.0\"]\nbatch: 2\ndraws: 2\n");
    return {"search",    "t_junction_left",
            "--budget",  budget,
            "--results", folder(results),
            "--space",   space,
            "--ego",     "constant constant.speed=8",
            "--set",     "cbv_planner=pdm_lite",
            "--set",     "verdict.judge=false",
            "--set",     "protocol.time_limit=3"};
  }
  static std::vector<std::string> with(std::vector<std::string> words,
                                       const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// A column of cases.csv by the id of the case.
  std::map<std::string, std::string> column(const std::string& results,
                                            const std::string& name) const {
    const std::string text = core::readFile(fs::path(folder(results)) / "cases.csv", "cases");
    const auto rows = core::csvRows(text);
    const auto head = core::csvCells(rows.front().text);
    const auto place =
        static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
    std::map<std::string, std::string> values;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const auto cells = core::csvCells(rows[i].text);
      values[cells.front()] = cells.at(place);
    }
    return values;
  }
  std::map<std::string, std::string> files(const std::string& results) const {
    return test::filesWithoutWallClock(folder(results));
  }
};

TEST_F(SearchCommand, FindsCasesThatRunAgainWithTheSameBytes) {
  // An ego that brakes for nobody, among attackers at a junction.
  ASSERT_EQ(cdiff(with(words("results", "4"),
                       {"--mode", "safety_critical", "--set", "cbv_planner=diffusion", "--set",
                        "protocol.time_limit=20"})),
            0)
      << output();
  expectOutput("4 cases have a contact of the moving ego");
  const auto traces = column("results", "trace_sha256");
  EXPECT_EQ(traces.size(), 4U);
  const fs::path found = fs::path(folder("results")) / "found";
  std::size_t count = 0;
  for (const auto& [id, answer] : column("results", "found")) {
    const fs::path scenario = found / (id + ".yaml");
    ASSERT_EQ(fs::exists(scenario), answer == "yes") << id;
    if (answer != "yes" || ++count > 1) continue;
    ASSERT_EQ(cdiff({"run", scenario.string(), "--quiet", "--results", folder("again")}), 0)
        << output();
    const auto summary =
        nlohmann::json::parse(core::readFile(folder("again") + "/summary.json", "summary"));
    EXPECT_EQ(summary.at("trace_sha256"), traces.at(id));
  }
  EXPECT_GT(count, 0U) << "an ego that brakes for nobody is hit in one of four cases";
}

TEST_F(SearchCommand, GivesTheSameFilesWhenItIsCutOffAndResumed) {
  ASSERT_EQ(cdiff(words("through", "6")), 0) << output();
  {
    test::ProgramRun search(CDIFF_PROGRAM, words("cut", "6"), folder("output"));
    while (!fs::exists(folder("cut") + "/runs/case_0003/log.txt")) {
      ASSERT_FALSE(search.ended()) << output();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    search.signal(SIGINT);
    EXPECT_EQ(search.wait(), 130) << output();
  }
  EXPECT_EQ(cdiff(words("cut", "6")), 3);
  expectOutput("holds the results of a search");
  ASSERT_EQ(cdiff(with(words("cut", "6"), {"--resume"})), 0) << output();
  EXPECT_EQ(test::differences(files("cut"), files("through")), std::vector<std::string>());
  EXPECT_EQ(cdiff(with(words("cut", "6"), {"--resume", "--seed", "2"})), 3);
  expectOutput("holds the results of another search");
}

TEST_F(SearchCommand, GoesOnByWorkersOfAnyEngine) {
  ASSERT_EQ(cdiff(words("through", "4")), 0) << output();
  const auto print = with(words("parts", "4"), {"--engine", "print", "--resume"});
  for (int batch = 0; batch < 2; ++batch) {
    ASSERT_EQ(cdiff(print), 0) << output();
    expectOutput(" worker ");
    ASSERT_EQ(cdiff({"worker", folder("parts")}), 0) << output();
  }
  ASSERT_EQ(cdiff(with(words("parts", "4"), {"--resume"})), 0) << output();
  EXPECT_EQ(column("parts", "trace_sha256"), column("through", "trace_sha256"));
}

TEST_F(SearchCommand, RefusesWrongInputAndWritesNothing) {
  const auto refused = [&](const std::vector<std::string>& more, const std::string& part) {
    EXPECT_EQ(cdiff(with({"search", "t_junction_left", "--results", folder("results")}, more)), 3)
        << part;
    expectOutput(part);
  };
  refused({}, "--budget");
  refused({"--budget", "4", "--set", "no_such_key=1"}, "no_such_key");
  refused({"--budget", "4", "--mode", "fierce"}, "fierce");
  refused({"--budget", "4", "--ego", "nobody"}, "nobody");
  refused({"--budget", "4", "--space", write("bad.yaml", "keys: [\"max_cbv: 1 .. 1000\"]")},
          "max_cbv");
  refused({"--budget", "4", "--space", write("none.yaml", "keys: []")}, "no key is left");
  refused({"--budget", "4", "--space", "nowhere"}, "search space");
  EXPECT_FALSE(fs::exists(folder("results")));
}

}  // namespace
}  // namespace cdiff
