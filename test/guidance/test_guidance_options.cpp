// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/guidance/guidance_options.h"
#include "guidance/collision_avoidance_objective.h"
#include "guidance/collision_seeking_objective.h"
#include "guidance/objective_registry.h"

namespace cdiff::guidance {
namespace {

GuidanceOptions optionsFrom(const std::string& yaml) {
  GuidanceOptions options;
  core::loadOptions({"profile.yaml", yaml}, options);
  options.validate();
  return options;
}

std::string errorOf(const std::string& yaml) {
  try {
    optionsFrom(yaml);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

void expectParts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
  }
}

std::set<std::string> activeOf(const GuidanceOptions& options) {
  std::set<std::string> names;
  for (const WeightedObjective& entry : options.objectives) {
    if (entry.weight > 0.0) names.insert(entry.name);
  }
  return names;
}

TEST(GuidanceOptions, HoldsEveryObjectiveSwitchedOff) {
  const GuidanceOptions options;
  ASSERT_EQ(options.objectives.size(), objectiveNames().size());
  for (std::size_t i = 0; i < options.objectives.size(); ++i) {
    EXPECT_EQ(options.objectives[i].name, objectiveNames()[i]);
  }
  EXPECT_TRUE(activeOf(options).empty());
}

TEST(GuidanceOptions, ReadsWeightWindowCapAndOwnKeys) {
  GuidanceOptions options = optionsFrom(
      "collision_seeking:\n  weight: 2\n  first_step: 80\n  last_step: 5\n  gradient_cap: 3\n"
      "  gate: hard\n  kappa: 7\n");
  const WeightedObjective& entry = options.find("collision_seeking");
  EXPECT_EQ(entry.weight, 2.0);
  EXPECT_EQ(entry.gradient_cap, 3.0);
  EXPECT_FALSE(entry.actsAt(81));
  EXPECT_TRUE(entry.actsAt(80));
  EXPECT_TRUE(entry.actsAt(5));
  EXPECT_FALSE(entry.actsAt(4));
  const auto& seeking = dynamic_cast<const CollisionSeekingObjective&>(*entry.objective);
  EXPECT_EQ(seeking.gate, "hard");
  EXPECT_EQ(seeking.proximity.kappa, 7.0);
}

TEST(GuidanceOptions, AnObjectiveWithAWeightIsActive) {
  const GuidanceOptions options = optionsFrom("speed:\n  weight: 1\nroute:\n  free_offset: 1\n");
  EXPECT_TRUE(options.isActive("speed"));
  EXPECT_FALSE(options.isActive("route"));
  EXPECT_FALSE(options.isActive("no_such_objective"));
}

TEST(GuidanceOptions, WindowFromZeroActsFromTheFirstStepOn) {
  GuidanceOptions options = optionsFrom("speed:\n  weight: 1\n  last_step: 3\n");
  EXPECT_TRUE(options.find("speed").actsAt(100));
  EXPECT_FALSE(options.find("speed").actsAt(2));
  EXPECT_FALSE(options.find("route").actsAt(50));
}

TEST(GuidanceOptions, CopiesAreIndependent) {
  GuidanceOptions options = optionsFrom("speed:\n  weight: 1\n  factor: 0.5\n");
  GuidanceOptions copy = options;
  copy.find("speed").weight = 4.0;
  core::overrideOption("speed.factor=2", "--set", copy);
  EXPECT_EQ(options.find("speed").weight, 1.0);
  EXPECT_EQ(core::dumpOptions(options),
            core::dumpOptions(optionsFrom("speed:\n  weight: 1\n  factor: 0.5\n")));
  EXPECT_NE(core::dumpOptions(options), core::dumpOptions(copy));
  options = copy;
  EXPECT_EQ(core::dumpOptions(options), core::dumpOptions(copy));
}

TEST(GuidanceOptions, DumpReadsBack) {
  const GuidanceOptions options = loadProfile("safety_critical");
  const std::string dump = core::dumpOptions(options, true);
  EXPECT_EQ(core::dumpOptions(optionsFrom(dump), true), dump);
}

TEST(GuidanceOptions, UnknownNamesPointToTheNearest) {
  expectParts(errorOf("# two lines\nsped:\n  weight: 1\n"),
              {"profile.yaml:2", "unknown key 'sped'", "'speed'"});
  expectParts(errorOf("speed:\n  wieght: 1\n"), {"profile.yaml:2", "'speed.wieght'", "'weight'"});
  EXPECT_THROW(GuidanceOptions().find("sped"), core::InputError);
}

TEST(GuidanceOptions, ValuesOutOfRangeAreRefused) {
  expectParts(errorOf("speed:\n  weight: -1\n"), {"profile.yaml:2", "speed.weight", "'-1'", "[0,"});
  expectParts(errorOf("speed:\n  last_step: 0\n"), {"profile.yaml:2", "speed.last_step"});
  GuidanceOptions options;
  options.find("route").weight = -0.5;
  EXPECT_THROW(options.validate(), core::InputError);
  options.find("route").weight = std::nan("");
  EXPECT_THROW(options.validate(), core::InputError);
}

TEST(GuidanceOptions, AWindowThatEndsBeforeItStartsIsRefused) {
  expectParts(errorOf("speed:\n  weight: 1\n  first_step: 5\n  last_step: 20\n"),
              {"speed.first_step", "5", "20", "count down"});
  EXPECT_EQ(errorOf("speed:\n  first_step: 20\n  last_step: 20\n"), "no error");
}

std::string windowError(std::int64_t first_step, std::int64_t last_step,
                        const std::vector<int>& visited) {
  GuidanceOptions options;
  WeightedObjective& speed = options.find("speed");
  speed.weight = 1.0;
  speed.first_step = first_step;
  speed.last_step = last_step;
  try {
    options.validateWindows(100, visited, "guidance.");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(GuidanceOptions, AWindowThatCannotActIsRefused) {
  const std::vector<int> visited = {98, 50, 10};
  EXPECT_EQ(windowError(0, 1, visited), "no error");
  EXPECT_EQ(windowError(20, 5, visited), "no error");
  expectParts(windowError(101, 1, visited), {"guidance.speed.first_step", "101", "at most 100"});
  expectParts(windowError(0, 150, visited), {"guidance.speed.last_step", "150", "at most 100"});
  expectParts(windowError(9, 1, visited), {"guidance.speed.last_step", "98, 50, 10"});
  expectParts(windowError(49, 11, visited), {"98, 50, 10"});
}

TEST(GuidanceOptions, TheLastStepOfAllIsReadCheckedAndCopied) {
  const GuidanceOptions options = optionsFrom("last_step: 8\nspeed:\n  weight: 1\n");
  EXPECT_EQ(options.last_step, 8);
  EXPECT_EQ(GuidanceOptions(options).last_step, 8);
  GuidanceOptions assigned;
  EXPECT_EQ(assigned.last_step, 1);
  assigned = options;
  EXPECT_EQ(assigned.last_step, 8);
  expectParts(errorOf("last_step: 0\n"), {"last_step", "0"});
  EXPECT_NO_THROW(options.validateWindows(100, {98, 10, 5}, "guidance."));
  try {
    options.validateWindows(100, {7, 5}, "guidance.");
    FAIL() << "no step from 8 on is visited";
  } catch (const core::InputError& error) {
    expectParts(error.what(), {"'guidance.last_step' is 8", "of 'speed'", "7, 5"});
  }
  EXPECT_THROW(options.validateWindows(7, {7, 5}, "guidance."), core::InputError);
}

TEST(Profiles, EveryShippedOneLoadsAndIsWhatItsNameSays) {
  const std::map<std::string, std::set<std::string>> expected = {
      {"ablation_all", {"speed", "drivable_area", "collision_avoidance"}},
      {"ablation_collision", {"collision_avoidance"}},
      {"ablation_drivable", {"drivable_area"}},
      {"ablation_speed", {"speed"}},
      {"challenging", {"speed", "drivable_area", "collision_seeking", "traffic_avoidance"}},
      {"naturalistic",
       {"speed", "drivable_area", "collision_avoidance", "traffic_avoidance", "yielding",
        "comfort"}},
      {"none", {}},
      {"paper_ablation_collision", {"collision_avoidance"}},
      {"paper_ablation_drivable", {"drivable_area"}},
      {"paper_ablation_speed", {"speed"}},
      {"paper_literal_naturalistic", {"speed", "drivable_area", "collision_avoidance"}},
      {"paper_literal_safety_critical", {"speed", "drivable_area", "collision_seeking"}},
      {"paper_naturalistic", {"speed", "drivable_area", "collision_avoidance"}},
      {"paper_safety_critical", {"speed", "drivable_area", "collision_seeking"}},
      {"safety_critical", {"speed", "drivable_area", "collision_seeking", "traffic_avoidance"}}};
  std::vector<std::string> names;
  for (const auto& [name, active] : expected) {
    names.push_back(name);
    EXPECT_EQ(activeOf(loadProfile(name)), active) << name;
    EXPECT_EQ(loadProfile(name).noise_correlation, name == "naturalistic" ? 1.0 : 0.0) << name;
    EXPECT_EQ(loadProfile(name).candidates,
              name == "safety_critical" || name == "challenging" ? 8 : 1)
        << name;
    EXPECT_EQ(loadProfile(name).challenge, name == "challenging" ? "medium" : "off") << name;
  }
  EXPECT_EQ(shippedProfiles(), names);
}

TEST(Profiles, NoiseCorrelationAndCandidatesAreCopiedAndInRange) {
  GuidanceOptions options;
  options.noise_correlation = 0.5;
  options.candidates = 3;
  options.road_horizon = 1.5;
  options.challenge = "hard";
  GuidanceOptions assigned;
  assigned = options;
  for (const GuidanceOptions& copy : {GuidanceOptions(options), assigned}) {
    EXPECT_EQ(copy.noise_correlation, 0.5);
    EXPECT_EQ(copy.candidates, 3);
    EXPECT_EQ(copy.road_horizon, 1.5);
    EXPECT_EQ(copy.challenge, "hard");
    EXPECT_NO_THROW(copy.validate());
  }
  for (const double bad : {-0.1, 1.1, std::nan("")}) {
    assigned.noise_correlation = bad;
    EXPECT_THROW(assigned.validate("guidance."), core::InputError) << bad;
  }
  for (const double bad : {-0.1, 10.1, std::nan("")}) {
    GuidanceOptions changed(options);
    changed.road_horizon = bad;
    EXPECT_THROW(changed.validate("guidance."), core::InputError) << bad;
  }
  for (const std::int64_t bad : {0, 65}) {
    options.candidates = bad;
    EXPECT_THROW(options.validate("guidance."), core::InputError) << bad;
  }
}

TEST(Profiles, ThePapersSeekAndAvoidByOneShape) {
  for (const std::string method : {"paper", "paper_literal"}) {
    GuidanceOptions nat = loadProfile(method + "_naturalistic");
    GuidanceOptions critical = loadProfile(method + "_safety_critical");
    const WeightedObjective& avoids = nat.find("collision_avoidance");
    const WeightedObjective& seeks = critical.find("collision_seeking");
    EXPECT_EQ(seeks.weight, method == "paper" ? 3.0 * avoids.weight : avoids.weight);
    const auto& safe =
        dynamic_cast<const CollisionAvoidanceObjective&>(*avoids.objective).proximity;
    const auto& risk = dynamic_cast<const CollisionSeekingObjective&>(*seeks.objective).proximity;
    EXPECT_EQ(std::tie(safe.buffer, safe.kappa, safe.lambda, safe.sigma),
              std::tie(risk.buffer, risk.kappa, risk.lambda, risk.sigma));
    for (const std::string name : {"speed", "drivable_area"})
      EXPECT_EQ(nat.find(name).weight, critical.find(name).weight) << name;
  }
}

/// All values of an objective as YAML.
std::string fieldsOf(WeightedObjective& entry) {
  struct Fields {
    WeightedObjective* entry;
    void describe(core::OptionsVisitor& visitor) { entry->describe(visitor); }
  };
  return core::dumpOptions(Fields{&entry});
}

TEST(Profiles, ThePapersAblationsUseTheValuesOfItsNaturalistic) {
  GuidanceOptions whole = loadProfile("paper_naturalistic");
  for (const std::string name : {"collision", "drivable", "speed"}) {
    GuidanceOptions alone = loadProfile("paper_ablation_" + name);
    for (WeightedObjective& entry : alone.objectives) {
      if (entry.weight == 0.0) continue;
      EXPECT_EQ(fieldsOf(entry), fieldsOf(whole.find(entry.name))) << name;
    }
  }
}

TEST(Profiles, AblationsUseTheWeightsOfNaturalistic) {
  GuidanceOptions naturalistic = loadProfile("naturalistic");
  for (const std::string name :
       {"ablation_all", "ablation_collision", "ablation_drivable", "ablation_speed"}) {
    const GuidanceOptions ablation = loadProfile(name);
    for (const WeightedObjective& entry : ablation.objectives) {
      if (entry.weight == 0.0) continue;
      EXPECT_EQ(entry.weight, naturalistic.find(entry.name).weight) << name;
      EXPECT_EQ(entry.gradient_cap, naturalistic.find(entry.name).gradient_cap) << name;
    }
  }
}

TEST(Profiles, UnknownNameAndBrokenFileAreNamed) {
  try {
    loadProfile("naturalstic");
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    expectParts(error.what(), {"'naturalstic'", "'naturalistic'"});
  }
  const std::string file =
      testing::TempDir() + "cdiff_profile_" + std::to_string(::getpid()) + ".yaml";
  core::writeFileAtomically(file, "speed:\n  weight: 1\n  first_step: 1\n  last_step: 2\n");
  try {
    loadProfile(file);
    ADD_FAILURE() << "no error";
  } catch (const core::InputError& error) {
    expectParts(error.what(), {file, "speed.first_step"});
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace cdiff::guidance
