// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Networks and demands that SUMO refuses: bad input that is named with SUMO's own sentence, however
// late SUMO says it. Seeded mutants of a shipped network and its demand.
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "cli/evaluate_command.h"
#include "e2e_cdiff/core/random.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

struct Attribute {
  std::size_t begin;  ///< of its value
  std::size_t size;
};

std::vector<Attribute> attributesOf(const std::string& text) {
  static const std::regex pattern(" [a-zA-Z]+=\"([^\"]*)\"");
  std::vector<Attribute> found;
  for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i)
    found.push_back(
        {static_cast<std::size_t>(i->position(1)), static_cast<std::size_t>(i->length(1))});
  return found;
}

/// One change of a file, drawn from a seed.
class Mutation {
 public:
  Mutation(std::string text, std::uint64_t seed)
      : text_(std::move(text)), random_(seed, "mutants") {}

  std::string apply() {
    const std::vector<Attribute> attributes = attributesOf(text_);
    const Attribute at = attributes[draw(attributes.size())];
    const Attribute other = attributes[draw(attributes.size())];
    static const std::vector<std::string> values = {"-1", "1e308", "99999999999", "nan", "", "x"};
    switch (draw(5)) {
      case 0:
        return text_.replace(at.begin, at.size, values[draw(values.size())]);
      case 1:
        return text_.replace(at.begin, at.size, text_.substr(other.begin, other.size));
      case 2:
        return text_.substr(0, draw(text_.size()));
      case 3:
        return text_.insert(at.begin, "x");
      default:
        text_[draw(text_.size())] = static_cast<char>(32 + draw(95));
        return text_;
    }
  }

 private:
  std::size_t draw(std::size_t count) { return random_.index({}, next_++, count); }
  std::string text_;
  core::RandomStream random_;
  std::uint32_t next_ = 0;
};

class RefusedInput : public test::EvaluateCommand {
 protected:
  static fs::path shipped(const std::string& ending) {
    return fs::path(CDIFF_SHARE) / "networks/crossing_district" / ("crossing_district" + ending);
  }
  /// Exit code of a short session on this network and demand.
  int drive(const std::string& network, const std::string& demand) const {
    return cdiff({"run", "crossing_straight", "--cbv-planner", "pdm_lite", "--quiet", "--overwrite",
                  "--network", network, "--set", "demand=" + demand, "--set",
                  "protocol.time_limit=1", "--results", folder("results")});
  }
  void expectNamedOrHarmless(std::uint64_t seed) const {
    const bool of_network = seed % 2 == 0;
    const fs::path original = shipped(of_network ? ".net.xml" : ".rou.xml");
    const std::string mutant = write(of_network ? "mutant.net.xml" : "mutant.rou.xml",
                                     Mutation(core::readFile(original, "file"), seed).apply());
    const int code =
        of_network ? drive(mutant, shipped(".rou.xml")) : drive(shipped(".net.xml"), mutant);
    if (code == 0 || code == 1) return;
    EXPECT_EQ(code, 3) << "seed " << seed << "\n" << output();
    expectOutput("mutant.");
  }
  /// A command ended with `code`: bad input, named with its file and `part` of it; a user's file
  /// "notes" is as it was.
  void expectUnwritten(int code, const std::string& file, const std::string& part) const {
    EXPECT_EQ(code, 3) << output();
    expectOutput(file);
    expectOutput(part);
    EXPECT_EQ(core::readFile(folder("notes"), "notes"), "mine") << part;
    EXPECT_FALSE(fs::exists(folder("results")));
  }
};

TEST_F(RefusedInput, MutantsEndInOrder) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) expectNamedOrHarmless(seed);
}

TEST_F(RefusedInput, SixtyMutantsEndInOrder) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) expectNamedOrHarmless(seed);
}

/// SUMO aborts over a request without its place in the list.
TEST_F(RefusedInput, ANetworkThatSumoCrashesOverIsNamed) {
  std::string text = core::readFile(shipped(".net.xml"), "network");
  const std::string key = "<request index=\"";
  text.insert(text.find(key, text.find(key) + 1) + key.size(), "9");
  EXPECT_EQ(drive(write("crash.net.xml", text), shipped(".rou.xml")), 3);
  expectOutput("SUMO refuses the network '" + folder("crash.net.xml"));
  expectOutput("it crashed, signal 6 (Aborted)");
}

/// `text` with `insertion` before the last `mark`.
std::string withBefore(std::string text, const std::string& mark, const std::string& insertion) {
  return text.insert(text.rfind(mark), insertion);
}

// The demand and the network run as they are, and SUMO would write over the notes.
TEST_F(RefusedInput, WhatMakesSumoWriteAFileIsNamedAndTheFileIsKept) {
  const std::string notes = write("notes", "mine");
  const std::string parameters =
      "\n<vType id=\"spy\"><param key=\"has.ssm.device\" value=\"true\"/>\n<param "
      "key=\"device.ssm.file\" value=\"" +
      notes + "\"/></vType>";
  const std::string demand = core::readFile(shipped(".rou.xml"), "demand");
  const std::string network = core::readFile(shipped(".net.xml"), "network");
  const std::string detector =
      "<inductionLoop id=\"d\" lane=\"a1_a2_0\" pos=\"1\" period=\"1\" file=\"" + notes + "\"/>";
  write("types.xml", "<routes>" + parameters + "</routes>");
  const std::string included = "<include href=\"" + folder("types.xml") + "\"/>";
  for (const auto& [insertion, part] :
       std::map<std::string, std::string>{{parameters, "has.ssm.device"},
                                          {included, "<include>"},
                                          {detector, "<inductionLoop>"}}) {
    const std::string bad_demand = write("bad.rou.xml", withBefore(demand, "</routes>", insertion));
    const std::string bad_network = write("bad.net.xml", withBefore(network, "</net>", insertion));
    expectUnwritten(drive(shipped(".net.xml"), bad_demand), bad_demand, part);
    expectUnwritten(drive(bad_network, shipped(".rou.xml")), bad_network,
                    part == "has.ssm.device" ? "<vType>" : part);
    const std::string scenario =
        write("scenario.yaml", "network: " + bad_network + "\nroute: {edges: [a2_b2, b2_c2]}\n");
    expectUnwritten(cdiff({"validate", scenario}), bad_network, "line ");
    write("scenario.yaml", "network: crossing_district\nroute: {edges: [a2_b2, b2_c2]}\ndemand: " +
                               bad_demand + "\n");
    expectUnwritten(cdiff({"validate", scenario}), bad_demand, "line ");
  }
}

TEST_F(RefusedInput, APlannerInARoleThatItDoesNotHave) {
  EXPECT_EQ(
      cdiff({"run", "crossing_straight", "--ego-planner", "ppo", "--results", folder("results")}),
      3);
  expectOutput(
      "key 'ego_planner' is 'ppo', a planner that does not drive the ego; expected one of "
      "careful_driver, constant, diffusion, pdm_lite, plant, pluto, rift, two_stage_pid, "
      "uniad_mini, "
      "vad_mini, external");
  EXPECT_FALSE(fs::exists(folder("results")));
}

TEST_F(RefusedInput, ABatchDoesNotTryAgain) {
  const std::string demand =
      write("bad.rou.xml",
            "<routes><trip id=\"t\" depart=\"900\" from=\"nowhere\" to=\"sb_b1\"/></routes>");
  const std::string matrix =
      write("matrix.yaml",
            "scenarios: [crossing_straight]\ncbv_planners: [pdm_lite]\nretries: 3\n"
            "set: [\"demand=" +
                demand + "\"]\n");
  EXPECT_EQ(cdiff({"evaluate", matrix, "--results", folder("results")}), 3) << output();
  const RunRecord record = readRecords(folder("results")).front();
  EXPECT_EQ(record.attempts, 1);
  EXPECT_EQ(record.exit_code, 3);
  EXPECT_NE(record.cause.find("SUMO refuses the demand '" + demand + "': "), std::string::npos)
      << record.cause;
  EXPECT_NE(record.cause.find("nowhere"), std::string::npos) << record.cause;
}

}  // namespace
}  // namespace cdiff::evaluation
