// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/published_figures.h"

#include <map>
#include <optional>

#include "core/text.h"

namespace cdiff::evaluation {
namespace {

constexpr double kNotAtHand = -1.0;  // no value of the repository is negative

/// A value of the repository with its deviation.
struct RepositoryValue {
  double mean = kNotAtHand;
  double deviation = kNotAtHand;
};

/// A column of the repository's table, under its name here: PPO, Pluto and RIFT under ego planner
/// PDM-Lite, then under PlanT.
struct RepositoryColumn {
  const char* name;
  RepositoryValue values[6];
};

constexpr RepositoryColumn kRepository[] = {
    {"2D-TTC",
     {{2.59, 1.60}, {2.50, 1.48}, {2.74, 1.30}, {2.29, 2.33}, {2.55, 1.99}, {2.36, 1.82}}},
    {"ORR", {{9.17, 2.39}, {0.24, 0.15}, {0.36, 0.20}, {25.22}, {3.01}, {3.91, 0.89}}},
    {"S-SW", {{0.95}, {0.88}, {0.97}, {0.95}, {0.87}, {0.96}}},
    {"A-SW", {{0.89}, {0.90}, {0.93}, {0.92}, {0.82}, {0.92}}},
    {"S-WD", {{4.45}, {5.81}, {4.46, 0.43}, {3.84}, {5.96}, {4.58, 0.19}}},
    {"DS", {{76.26, 0.12}, {77.84, 2.20}, {94.78, 1.37}, {36.39}, {42.52}, {44.28, 3.15}}},
    {"RC", {{76.26}, {81.84, 2.20}, {94.78}, {58.30}, {52.53}, {61.94, 5.08}}},
    {"CPK", {{13.95, 2.34}, {5.06, 2.69}, {6.83, 2.62}, {16.43}, {7.22}, {11.48, 1.00}}},
    {"speed", {{6.60, 4.03}, {4.01, 3.69}, {5.38, 3.23}, {}, {}, {}}},
    {"acceleration", {{1.32, 1.01}, {0.94, 0.97}, {1.30}, {}, {}, {}}}};

std::optional<double> atHand(double value) {
  return value == kNotAtHand ? std::nullopt : std::optional<double>(value);
}

/// Place of a system among those of the same role; nullopt where the repository has none.
std::optional<std::size_t> placeOf(const PaperSystem& system,
                                   const std::vector<PaperSystem>& systems) {
  for (std::size_t i = 0; i < systems.size(); ++i) {
    if (std::string(systems[i].title) == system.title) return i;
  }
  return std::nullopt;
}

/// By title.
const std::map<std::string, std::string>& differenceTexts() {
  static const std::map<std::string, std::string> texts = {
      {paper::kPpo.title,
       "published: a policy that FREA trained in CARLA, fine-tuned there; it shifts into reverse "
       "where ours brakes, and CARLA's driver replaces it at its goal. Ours: trained from scratch "
       "in this simulator; PDM-Lite drives on from the goal."},
      {paper::kPluto.title,
       "published: 4.2 million weights trained on nuPlan, driven in CARLA without further training "
       "(zero-shot). Ours: a Pluto-style network of 0.5 million weights, trained by imitation in "
       "this simulator (in-domain); its distance to RIFT is not the published one."},
      {paper::kRift.title,
       "published: the score head of that nuPlan checkpoint, fine-tuned in CARLA. Ours: the same "
       "objective and reward on our own Pluto-style network, in this simulator."},
      {paper::kPlanT.title,
       "published: a checkpoint of CARLA's first leaderboard, trained to drive 4 m/s and in RIFT's "
       "framework driven at twice the speed that it plans: floor(4 |w1 - w0|) m/s in place of "
       "2 |w1 - w0|. Ours: a smaller network, trained on PDM-Lite's driving in this simulator, "
       "driven at the speed that it plans."},
      {paper::kUniAd.title,
       "published: Bench2Drive's checkpoint with six cameras of 1600 x 900 pixels, driven at no "
       "more "
       "than 5 m/s. Ours: a miniature of its structure and losses with 2.7 million weights and "
       "three cameras of 160 x 96 pixels, trained on renderings of this simulator, without that "
       "limit."},
      {paper::kVad.title,
       "published: Bench2Drive's checkpoint with six cameras of 1600 x 900 pixels. Ours: a "
       "miniature "
       "of its structure and losses with 2.2 million weights and three cameras of 160 x 96 pixels, "
       "trained on renderings of this simulator."},
      {paper::kPdmLite.title,
       "published: rules on CARLA's true states. Ours: a port of RIFT's variant, which has no "
       "scripts for CARLA's scenarios; v* bounds its speed, too."}};
  return texts;
}

}  // namespace

const char* const kPublishedProtocol =
    "The figures of the paper and of RIFT's repository come from CARLA: ten Bench2Drive routes, "
    "ten decisions a second, green lights, the end of a session after 3 s of standing or 40 s. The "
    "repository says so; that the paper's protocol and baselines are the same is inferred from its "
    "values. Ours come from SUMO's traffic on the routes and by the protocol of the batch. Where "
    "both print a figure, the two show how far evaluations of one system lie apart.";

PaperFigure repositoryFigure(const PaperSystem& ego, const PaperSystem& cbv,
                             const std::string& column) {
  const auto ego_place = placeOf(ego, {paper::kPdmLite, paper::kPlanT});
  const auto cbv_place = placeOf(cbv, {paper::kPpo, paper::kPluto, paper::kRift});
  if (!ego_place || !cbv_place) return {};
  for (const RepositoryColumn& printed : kRepository) {
    if (column != printed.name) continue;
    const RepositoryValue& value = printed.values[3 * *ego_place + *cbv_place];
    return {atHand(value.mean), atHand(value.deviation)};
  }
  return {};
}

std::string repositoryList(const PaperSystem& ego, const std::string& column,
                           const std::string& unit) {
  std::vector<std::string> parts;
  for (const PaperSystem& cbv : {paper::kPpo, paper::kPluto, paper::kRift})
    parts.push_back(std::string(cbv.name) + " " + paperText(repositoryFigure(ego, cbv, column)));
  return core::joinText(parts, ", ") + " " + unit;
}

std::vector<std::string> systemDifferences(const std::vector<PaperSystem>& systems) {
  std::vector<std::string> lines;
  for (const PaperSystem& system : systems) {
    const auto text = differenceTexts().find(system.title);
    if (text != differenceTexts().end())
      lines.push_back(std::string(system.title) + ": " + text->second);
  }
  return lines;
}

}  // namespace cdiff::evaluation
