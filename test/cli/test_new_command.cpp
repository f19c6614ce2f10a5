// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// `cdiff new`, and what `cdiff validate` and `cdiff run` say of a scenario of one's own.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/cdiff_command.h"
#include "support/network_text.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

class NewCommand : public test::CdiffCommand {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
  }
  void expectNothing(const std::string& name) const {
    for (const char* ending : {".yaml", ".net.xml", ".svg"})
      EXPECT_FALSE(fs::exists(path(name + ending))) << name << ending;
  }
};

TEST_F(NewCommand, WritesAScenarioThatIsJudgedAtItsFirstRun) {
  ASSERT_EQ(cdiff({"new", path("town"), "--grid", "--picture"}), 0) << output();
  expectOutput("route   * 1  left");
  expectOutput("town.yaml: valid");
  EXPECT_EQ(output().find("warning"), std::string::npos) << output();
  for (const char* ending : {".yaml", ".net.xml", ".svg"})
    EXPECT_TRUE(fs::exists(path(std::string("town") + ending))) << ending;
  const int code = cdiff({"run", path("town.yaml"), "--results", path("results"), "--quiet",
                          "--set", "cbv_planner=pdm_lite"});
  EXPECT_TRUE(code == 0 || code == 1) << output();
  const auto summary =
      nlohmann::json::parse(core::readFile(path("results/summary.json"), "summary"));
  EXPECT_EQ(summary["scenario"], "town");
  EXPECT_NE(summary["verdict"]["outcome"], "not_judged");
  EXPECT_GT(summary["ego"]["route_completion_percent"].get<double>(), 90.0) << summary;
}

TEST_F(NewCommand, TakesTheRouteThatIsAskedFor) {
  ASSERT_EQ(cdiff({"new", path("way"), "--grid", "--from", "A0B0", "--to", "C1D1"}), 0) << output();
  EXPECT_NE(core::readFile(path("way.yaml"), "scenario").find("edges: [\"A0B0\", "),
            std::string::npos);
  EXPECT_EQ(cdiff({"new", path("other"), "--grid", "--route", "9"}), 3);
  expectOutput("--route is 9; expected 1 to 8");
  EXPECT_EQ(cdiff({"new", path("other"), "--grid", "--from", "A0B9"}), 3);
  expectOutput("the nearest name is 'A0B");
  expectNothing("other");
}

TEST_F(NewCommand, NeverReplacesAFileUnasked) {
  write("mine.yaml", "mine");
  EXPECT_EQ(cdiff({"new", path("mine"), "--crossing"}), 3);
  expectOutput("'" + path("mine.yaml") + "' is there already");
  expectOutput("to replace this file");
  write("mine.net.xml", "a network of mine");
  EXPECT_EQ(cdiff({"new", path("mine"), "--crossing"}), 3);
  expectOutput("'" + path("mine.yaml") + "' and '" + path("mine.net.xml") + "' are there already");
  EXPECT_EQ(cdiff({"new", path("mine"), "--network", path("mine.net.xml")}), 3);
  expectOutput("'" + path("mine.yaml") + "' is there already");
  expectOutput("the network '" + path("mine.net.xml") + "' stays as it is");
  EXPECT_EQ(core::readFile(path("mine.yaml"), "file"), "mine");
  fs::remove(path("mine.net.xml"));
  EXPECT_EQ(cdiff({"new", path("mine"), "--network", "roundabout", "--overwrite"}), 0) << output();
  EXPECT_FALSE(fs::exists(path("mine.net.xml"))) << "a shipped network is named";
  EXPECT_EQ(cdiff({"new", path("mine.yaml"), "--crossing"}), 3);
  expectOutput("without .yaml");
  EXPECT_EQ(cdiff({"new", path("no_folder/mine"), "--crossing"}), 3);
  expectOutput("is no folder");
  EXPECT_EQ(cdiff({"new", path("two"), "--crossing", "--grid"}), 3);
  EXPECT_EQ(cdiff({"new", path("two")}), 3);
  expectNothing("two");
}

// Ways of 40 m, 45 m and 12 m that lead nowhere.
TEST_F(NewCommand, RefusesANetworkWithoutARouteThatTestsAnything) {
  write("stubs.net.xml", test::NetworkText()
                             .edge("one", {"0,0 40,0"}, "a", "b")
                             .edge("two", {"0,50 45,50"}, "c", "d")
                             .edge("three", {"0,90 12,90"}, "e", "f")
                             .text());
  EXPECT_EQ(cdiff({"new", path("stub"), "--network", path("stubs.net.xml")}), 3);
  expectOutput("the best one, two, is only 35 m long, and 50 m are needed");
  expectNothing("stub");
}

/// A pond with a footpath.
constexpr const char* kLake = R"(<osm version="0.6">
 <node id="1" lat="48.0000" lon="11.0000"/><node id="2" lat="48.0010" lon="11.0000"/>
 <node id="3" lat="48.0010" lon="11.0010"/>
 <way id="1"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/><tag k="natural" v="water"/></way>
)";

TEST_F(NewCommand, SaysThatALakeHasNoRoads) {
  write("lake.osm", std::string(kLake) + "</osm>");
  EXPECT_EQ(cdiff({"new", path("lake"), "--osm", path("lake.osm")}), 3);
  expectOutput("network '" + path("lake.osm") + "': holds no road for cars");
  write("path.osm", std::string(kLake) +
                        "<way id=\"2\"><nd ref=\"1\"/><nd ref=\"2\"/><nd ref=\"3\"/>"
                        "<tag k=\"highway\" v=\"footway\"/></way></osm>");
  EXPECT_EQ(cdiff({"new", path("lake"), "--osm", path("path.osm")}), 3);
  expectOutput("holds no road for cars");
  expectNothing("lake");
}

TEST_F(NewCommand, KeepsTheNamesOfAConvertedNetwork) {
  // Two streets of some 220 m and 300 m that cross in the middle.
  write("street.osm", R"(<osm version="0.6">
 <node id="1" lat="48.000" lon="11.000"/><node id="2" lat="48.001" lon="11.000"/>
 <node id="3" lat="48.002" lon="11.000"/><node id="4" lat="48.001" lon="10.998"/>
 <node id="5" lat="48.001" lon="11.002"/>
 <way id="10"><nd ref="1"/><nd ref="2"/><nd ref="3"/><tag k="highway" v="residential"/></way>
 <way id="11"><nd ref="4"/><nd ref="2"/><nd ref="5"/><tag k="highway" v="residential"/></way>
</osm>)");
  ASSERT_EQ(cdiff({"new", path("street"), "--osm", path("street.osm"), "--picture"}), 0)
      << output();
  expectOutput("3 conflicts");
  EXPECT_NE(core::readFile(path("street.yaml"), "file").find("network: \"street.net.xml\""),
            std::string::npos);
  EXPECT_EQ(cdiff({"import", path("street.osm"), "--picture", path("map.svg")}), 0) << output();
  EXPECT_TRUE(fs::exists(path("map.svg")));
}

TEST_F(NewCommand, AScenarioOfNetworkAndRouteSaysLoudlyThatItCannotFail) {
  ASSERT_EQ(cdiff({"new", path("town"), "--grid"}), 0) << output();
  write("bare.yaml", "name: barely\nnetwork: town.net.xml\nroute: {edges: [A1B1, B1B2]}\n");
  EXPECT_EQ(cdiff({"validate", path("bare.yaml"), "--fast"}), 0);
  expectOutput("barely: valid");
  expectOutput("traffic not tried on SUMO (--fast)");
  expectOutput("NO VERDICT RULES");
  EXPECT_EQ(cdiff({"run", path("bare.yaml"), "--results", path("results"), "--quiet", "--set",
                   "cbv_planner=pdm_lite", "--set", "protocol.time_limit=1"}),
            0);
  expectOutput("cdiff: NOT JUDGED");
  EXPECT_NE(core::readFile(path("results/report.html"), "report").find("the session cannot fail"),
            std::string::npos);
}

TEST_F(NewCommand, ASessionWithoutCbvsSaysThatNothingWasTested) {
  ASSERT_EQ(cdiff({"new", path("town"), "--grid"}), 0) << output();
  std::vector<std::string> run = {
      "run",       path("town.yaml"), "--quiet", "--overwrite",
      "--results", path("results"),   "--set",   "cbv_planner=pdm_lite",
      "--set",     "demand=none",     "--set",   "protocol.time_limit=1"};
  cdiff(run);
  expectOutput("0 CBVs: nothing was tested");
  const auto summary = core::readFile(path("results/summary.json"), "summary");
  EXPECT_TRUE(nlohmann::json::parse(summary)["cbv"].contains("untested")) << summary;
  EXPECT_NEAR(nlohmann::json::parse(summary)["simulated_seconds"].get<double>(), 1.0, 1e-6)
      << "the limit that was given";
  EXPECT_NE(
      core::readFile(path("results/report.html"), "report").find("0 CBVs: nothing was tested"),
      std::string::npos);
  run.insert(run.end(), {"--set", "max_cbv=0"});
  cdiff(run);
  EXPECT_EQ(output().find("nothing was tested"), std::string::npos) << output();
}

TEST_F(NewCommand, ADemandThatSumoRefusesIsRefusedByValidate) {
  ASSERT_EQ(cdiff({"new", path("town"), "--grid"}), 0) << output();
  write("bad.rou.xml",
        "<routes><flow id=\"f\" from=\"A1B1\" to=\"nowhere\" begin=\"0\" end=\"9\" number=\"2\"/>"
        "</routes>");
  write("bad.yaml", "network: town.net.xml\nroute: {edges: [A1B1, B1B2]}\ndemand: bad.rou.xml\n");
  EXPECT_EQ(cdiff({"validate", path("bad.yaml"), "--fast"}), 0) << output();
  EXPECT_EQ(cdiff({"validate", path("bad.yaml")}), 3);
  expectOutput("bad.rou.xml");
  expectOutput("nowhere");
}

TEST_F(NewCommand, ValidatePrintsOneGroupAndMarksWhatDiffers) {
  EXPECT_EQ(cdiff({"validate", "crossing_left_turn", "--fast", "--group", "traffic"}), 0);
  expectOutput("  density: 18  # default: 30\n");
  expectOutput("  warm_up: 30\n");
  EXPECT_EQ(cdiff({"validate", "crossing_left_turn", "--fast", "--group", "traffic", "--set",
                   "traffic.density=7", "--set", "traffic.warm_up=4"}),
            0);
  expectOutput("  density: 7  # default: 30\n");
  expectOutput("  warm_up: 4");
  EXPECT_EQ(cdiff({"validate", "crossing_left_turn", "--fast", "--set", "traffic.densiti=7"}), 3);
  expectOutput("the nearest known key is 'traffic.density'");
  EXPECT_EQ(output().find("protocol:"), std::string::npos) << output();
  EXPECT_EQ(cdiff({"validate", "crossing_left_turn", "--fast", "--group", "traffik"}), 3);
  expectOutput("no group 'traffik'; did you mean 'traffic'?");
}

}  // namespace
}  // namespace cdiff::cli
