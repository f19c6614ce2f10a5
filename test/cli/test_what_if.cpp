// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// `cdiff what_if` on real sessions: an ego that keeps 8 m/s runs into a vehicle of a roundabout.
#include <nlohmann/json.hpp>

#include "cli/evaluate_command.h"
#include "core/csv.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

constexpr int kRunTimeError = 2;
constexpr int kBadInput = 3;

class WhatIf : public test::EvaluateCommand {
 protected:
  static void SetUpTestSuite() { session_ = new test::TemporaryFolder(); }
  static void TearDownTestSuite() {
    delete session_;
    session_ = nullptr;
  }
  void SetUp() override {
    if (!fs::exists(recorded() / "summary.json")) {
      ASSERT_LE(record(recorded()), 1) << output();
    }
    fs::copy(recorded(), folder("run"), fs::copy_options::recursive);
  }
  static fs::path recorded() { return session_->path() / "run"; }
  int record(const fs::path& results, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run",           "roundabout_cross",
                                      "--cbv-planner", "pdm_lite",
                                      "--ego-planner", "constant",
                                      "--set",         "protocol.time_limit=15",
                                      "--set",         "report.front_view_rate=0",
                                      "--quiet",       "--results",
                                      results.string()};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  }
  int ask(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"what_if", folder("run")};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  }
  std::string text(const std::string& name) const {
    return core::readFile(folder("run/" + name), "file");
  }
  nlohmann::json answer(const std::string& name) const {
    return nlohmann::json::parse(text("what_if/" + name + ".json"));
  }
  /// Replaces the first `was` of a file of the run.
  void change(const std::string& name, const std::string& was, const std::string& now) const {
    std::string content = text(name);
    const std::size_t place = content.find(was);
    ASSERT_NE(place, std::string::npos) << was << " in " << name;
    content.replace(place, was.size(), now);
    write("run/" + name, content);
  }
  void expectRefused(const std::vector<std::string>& words, const std::string& part) const {
    EXPECT_EQ(ask(words), kBadInput) << output();
    expectOutput(part);
    EXPECT_FALSE(fs::exists(folder("run/what_if")));
  }

  static test::TemporaryFolder* session_;
};

test::TemporaryFolder* WhatIf::session_ = nullptr;

/// Whether the text is the beginning of the trace.
bool begins(const std::string& trace, const std::string& course) {
  return trace.compare(0, course.size(), course) == 0;
}

TEST_F(WhatIf, TheDriverOfTheSessionDrivesItAgainToTheLastByte) {
  ASSERT_EQ(ask({"--contact", "1", "--ego", "constant"}), 0) << output();
  const nlohmann::json found = answer("contact_1_constant");
  for (const std::string loop : {"closed", "open"}) {
    EXPECT_FALSE(found[loop]["avoids"].get<bool>());
    EXPECT_EQ(found[loop]["contact"]["with"], found["contact"]["with"]);
    EXPECT_EQ(found[loop]["contact"]["seconds"], found["contact"]["seconds"]);
    EXPECT_TRUE(found[loop]["latest_take_over_s"].is_null());
    // Both courses end with the tick of the contact.
    const std::string course = text("what_if/contact_1_constant_" + loop + ".csv");
    EXPECT_TRUE(begins(text("trace.csv"), course)) << loop;
    EXPECT_GT(core::splitText(course, '\n').size(), 1000U);
  }
}

TEST_F(WhatIf, TheLatestTakeOverAvoidsAndOneStepLaterDoesNot) {
  ASSERT_EQ(ask({"--contact", "1", "--ego", "pdm_lite"}), 0) << output();
  const nlohmann::json found = answer("contact_1_pdm_lite");
  EXPECT_TRUE(found["closed"]["avoids"].get<bool>());
  EXPECT_FALSE(begins(text("trace.csv"), text("what_if/contact_1_pdm_lite_closed.csv")));
  const double latest = found["closed"]["latest_take_over_s"];
  ASSERT_GT(latest, 0.1);
  const auto before = [](double seconds) { return core::formatFixed(seconds, 1); };
  ASSERT_EQ(ask({"--contact", "1", "--ego", "pdm_lite", "--before", before(latest)}), 0);
  EXPECT_TRUE(answer("contact_1_pdm_lite")["closed"]["avoids"].get<bool>());
  ASSERT_EQ(ask({"--contact", "1", "--ego", "pdm_lite", "--before", before(latest - 0.1)}), 0);
  EXPECT_FALSE(answer("contact_1_pdm_lite")["closed"]["avoids"].get<bool>());
  EXPECT_EQ(answer("contact_1_pdm_lite")["closed"]["latest_take_over_s"], latest);
}

TEST_F(WhatIf, WithoutTheLatestTakeOverTheOtherAnswersAreTheSame) {
  ASSERT_EQ(ask({"--contact", "1", "--ego", "pdm_lite"}), 0) << output();
  nlohmann::json searched = answer("contact_1_pdm_lite");
  ASSERT_EQ(ask({"--contact", "1", "--ego", "pdm_lite", "--without-latest"}), 0) << output();
  nlohmann::json asked = answer("contact_1_pdm_lite");
  EXPECT_TRUE(searched["closed"]["avoids"].get<bool>());
  EXPECT_FALSE(asked.contains("earliest_take_over_s"));
  searched.erase("earliest_take_over_s");
  for (nlohmann::json* found : {&searched, &asked}) found->erase("text");
  for (const std::string loop : {"closed", "open"}) {
    EXPECT_FALSE(asked[loop].contains("latest_take_over_s"));
    searched[loop].erase("latest_take_over_s");
  }
  EXPECT_EQ(asked, searched);
}

TEST_F(WhatIf, TheReportHasARowForEachAnswerAndKeepsTheOthers) {
  const std::string report = text("report.html");
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(ask({"--contact", "1", "--ego", "pdm_lite"}), 0) << output();
  }
  ASSERT_EQ(ask({"--contact", "1", "--ego", "constant"}), 0) << output();
  const std::string now = text("report.html");
  for (const std::string driver : {"pdm_lite", "constant"}) {
    const std::string link = "href=\"what_if/contact_1_" + driver + ".html\"";
    ASSERT_NE(now.find(link), std::string::npos);
    EXPECT_EQ(now.find(link), now.rfind(link));
    EXPECT_TRUE(fs::exists(folder("run/what_if/contact_1_" + driver + ".html")));
  }
  const std::string place = "<div id=\"what-if\">";
  EXPECT_TRUE(begins(now, report.substr(0, report.find(place))));
  EXPECT_GT(now.size(), report.size());
}

TEST_F(WhatIf, ATakeOverAtATimeNeedsNoContact) {
  ASSERT_EQ(ask({"--at", "2", "--ego", "pdm_lite"}), 0) << output();
  const nlohmann::json found = answer("at_2.00_pdm_lite");
  EXPECT_FALSE(found.contains("contact"));
  EXPECT_EQ(found["take_over_seconds"], 2.0);
  EXPECT_FALSE(found["closed"].contains("latest_take_over_s"));
}

TEST_F(WhatIf, AnExternalEgoIsPlayedAsItWasRecorded) {
  change("session.yaml", "ego_planner: \"constant\"", "ego_planner: \"external\"");
  ASSERT_EQ(ask({"--contact", "1", "--ego", "pdm_lite"}), 0) << output();
  EXPECT_TRUE(answer("contact_1_pdm_lite")["closed"]["avoids"].get<bool>());
}

TEST_F(WhatIf, WhatIsNotAsItWasIsNamed) {
  const std::vector<std::string> question = {"--contact", "1", "--ego", "pdm_lite"};
  const std::string session = text("session.yaml");
  const std::pair<std::string, std::string> changes[] = {
      {"  version: \"0", "  version: \"9"},
      {"  revision: \"", "  revision: \"9"},
      {"  imported_sha256: \"", "  imported_sha256: \"9"},
      {"  eigen: \"", "  eigen: \"9"},
      {"\nscenario:\n", "\ninference:\n  cbv_model_files_sha256: \"9\"\nscenario:\n"}};
  const std::string named[] = {"package.version", "package.revision", "network.imported_sha256",
                               "libraries.eigen", "inference.cbv_model_files_sha256"};
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    change("session.yaml", changes[i].first, changes[i].second);
    expectRefused(question, "key '" + named[i] + "'");
    write("run/session.yaml", session);
  }
  expectRefused({"--contact", "1", "--ego", "pdm_lite", "--set", "seed=2"}, "key 'seed'");
}

TEST_F(WhatIf, ASessionThatDoesNotRepeatIsAnError) {
  const std::string was = "\n7,ego,ego,";
  change("trace.csv", was, was + "1");
  expectRefused({"--contact", "1", "--ego", "pdm_lite"}, "trace_sha256");
  const std::string sha256 = nlohmann::json::parse(text("summary.json"))["trace_sha256"];
  change("summary.json", sha256, core::sha256(text("trace.csv")));
  EXPECT_EQ(ask({"--contact", "1", "--ego", "pdm_lite"}), kRunTimeError) << output();
  expectOutput("at tick 7 its trace has '7,ego,ego,1");
}

TEST_F(WhatIf, RefusesQuestionsThatTheRunCannotAnswer) {
  expectRefused({"--contact", "2"}, "--contact 2: ");
  expectRefused({"--contact", "0"}, "--contact 0: ");
  expectRefused({"--at", "1000"}, "--at 1000: ");
  expectRefused({}, "give --contact N, --at SECONDS or --all");
  expectRefused({"--contact", "1", "--ego", "external"}, "--ego external: ");
  expectRefused({"--contact", "1", "--ego", "nobody"}, "--ego nobody: an unknown planner");
  expectRefused({"--contact", "1", "--at", "1"}, "excludes");
  change("session.yaml", "deterministic: true", "deterministic: false");
  expectRefused({"--contact", "1"}, "paced by the wall clock");
  EXPECT_EQ(cdiff({"what_if", folder("nothing"), "--all"}), kBadInput);
  expectOutput("no session.yaml");
}

TEST_F(WhatIf, ARunWithoutContactHasNoneToAvoid) {
  std::string summary = text("summary.json");
  nlohmann::json content = nlohmann::json::parse(summary);
  content["ego"]["contacts"] = nlohmann::json::array();
  write("run/summary.json", content.dump());
  expectRefused({"--contact", "1"}, "has no contact of the ego");
}

TEST_F(WhatIf, AllContactsOfABatchAreOneTable) {
  const std::string matrix = write("matrix.yaml",
                                   "name: two\n"
                                   "scenarios: [roundabout_cross]\n"
                                   "ego_planners: [constant, pdm_lite]\n"
                                   "cbv_planners: [pdm_lite]\n"
                                   "seeds: [1]\n"
                                   "set: [protocol.time_limit=15, report.front_view_rate=0]\n");
  const std::string results = folder("batch");
  ASSERT_LE(cdiff({"evaluate", matrix, "--results", results}), 1) << output();
  ASSERT_EQ(cdiff({"what_if", results, "--all", "--ego", "pdm_lite"}), 0) << output();
  std::size_t contacts = 0;
  for (const auto& run : fs::directory_iterator(results + "/runs")) {
    if (!run.is_directory()) continue;
    contacts += nlohmann::json::parse(core::readFile(run.path() / "summary.json", "summary"))
                    .at("ego")
                    .at("contacts")
                    .size();
  }
  EXPECT_GE(contacts, 1U);
  EXPECT_EQ(lines(results + "/what_if_pdm_lite.csv"), 1 + contacts);
  // A session of it cannot be repeated: it is named, and the table holds the others.
  for (const auto& run : fs::directory_iterator(results + "/runs")) {
    if (run.path().filename().string().find("pdm_lite") != std::string::npos)
      write("batch/runs/" + run.path().filename().string() + "/summary.json", "{}");
  }
  EXPECT_EQ(cdiff({"what_if", results, "--all", "--ego", "pdm_lite"}), kBadInput);
  expectOutput("summary.json' is no summary of a session");
  EXPECT_GE(lines(results + "/what_if_pdm_lite.csv"), 2U);
  ASSERT_LE(cdiff({"evaluate", matrix, "--results", results, "--overwrite"}), 1) << output();
  EXPECT_FALSE(fs::exists(results + "/what_if_pdm_lite.csv"));
}

TEST_F(WhatIf, AnotherSessionInTheFolderRemovesTheAnswers) {
  ASSERT_EQ(ask({"--contact", "1", "--ego", "constant"}), 0) << output();
  ASSERT_LE(record(folder("run"), {"--overwrite"}), 1) << output();
  EXPECT_FALSE(fs::exists(folder("run/what_if")));
}

}  // namespace
}  // namespace cdiff::evaluation
