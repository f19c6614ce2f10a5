// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The ranking of egos that a batch, its tables again, and a user's sessions give.
#include "cli/evaluate_command.h"

namespace cdiff::evaluation {
namespace {

class EgoRankingCommand : public test::EvaluateCommand {
 protected:
  std::string matrix() const {
    return write("matrix.yaml",
                 "name: egos\n"
                 "scenarios: [roundabout_cross]\n"
                 "cbv_planners: [pdm_lite]\n"
                 "variants: [\"rules: ego_planner=pdm_lite\"]\n"
                 "seeds: [1, 2]\n"
                 "set: [protocol.time_limit=12, report.front_view_rate=0]\n"
                 "ego_ranking: true\n");
  }
  std::size_t rows(const std::string& batch) const {
    return lines(folder(batch) + "/ego_ranking.csv") - 1;
  }
};

TEST_F(EgoRankingCommand, OneMoreEgoJoinsByOneArgument) {
  ASSERT_LE(cdiff({"evaluate", matrix(), "--results", folder("batch"), "--ego",
                   "constant constant.speed=8"}),
            1)
      << output();
  EXPECT_EQ(rows("batch"), 2U);
  const std::string csv = core::readFile(folder("batch") + "/ego_ranking.csv", "table");
  EXPECT_NE(csv.find(",rules,2,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",constant,2,"), std::string::npos) << csv;
  expectOutput("| constant |");
  // A session of the user's, of the same route and seed, wherever it was run.
  ASSERT_LE(cdiff({"run", "roundabout_cross", "--seed", "1", "--cbv-planner", "pdm_lite", "--set",
                   "protocol.time_limit=12", "--quiet", "--results", folder("mine/1")}),
            1)
      << output();
  ASSERT_EQ(cdiff({"report", "--ego-ranking", folder("batch"), folder("mine")}), 0) << output();
  EXPECT_EQ(rows("batch"), 3U);
  expectOutput("| mine |");
  const std::string page = core::readFile(folder("batch") + "/ego_ranking.html", "page");
  EXPECT_NE(page.find("mine"), std::string::npos);
}

TEST_F(EgoRankingCommand, RefusesFoldersWithoutSessions) {
  EXPECT_EQ(cdiff({"report", "--ego-ranking", folder("nothing")}), 3);
  expectOutput("neither a batch");
}

TEST_F(EgoRankingCommand, AnEgoMustBeAPlanner) {
  EXPECT_EQ(cdiff({"evaluate", matrix(), "--results", folder("batch"), "--ego", "nobody"}), 3);
  expectOutput("nobody");
  const std::string combined =
      write("combined.yaml",
            "name: combined\nscenarios: [roundabout_cross]\n"
            "combinations: [\"ego_planner=pdm_lite cbv_planner=pdm_lite\"]\n");
  EXPECT_EQ(cdiff({"evaluate", combined, "--results", folder("other"), "--ego", "constant"}), 3);
  expectOutput("names combinations");
}

}  // namespace
}  // namespace cdiff::evaluation
