// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff new`: writes a scenario that runs at once, with its network and a map.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/import/network_import.h"
#include "map/route_source.h"
#include "page/pictures/edge_map.h"
#include "session/scenario_review.h"
#include "session/session_request.h"
#include "suite/new_scenario.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;

struct NewArguments {
  std::string name;
  std::string network;
  std::string osm;
  bool grid = false;
  bool crossing = false;
  bool roundabout = false;
  suite::RouteEnds ends;
  std::size_t route = 1;  ///< of the suggested ones, from 1
  std::int64_t seed = 1;
  bool picture = false;
  bool overwrite = false;
};

/// The road network of a scenario that is being made.
struct NetworkChoice {
  std::string text;    ///< of the SUMO network
  std::string named;   ///< in the scenario file
  bool own = false;    ///< whether it has to be written beside the scenario
  std::string origin;  ///< for people
};

/// Writes the files of one new scenario.
class ScenarioMaker {
 public:
  explicit ScenarioMaker(const NewArguments& arguments)
      : arguments_(arguments), base_(fs::path(arguments.name)) {
    const std::string name = base_.filename().string();
    if (name.empty() || core::fileName(name) != name || fs::path(name).extension() == ".yaml") {
      throw InputError("NAME is '" + core::shortened(arguments.name) +
                       "'; expected letters, digits, '_', '-' and '.', without .yaml; a folder "
                       "may stand before it");
    }
    if (base_.has_parent_path() && !core::isFolder(base_.parent_path()))
      throw InputError("'" + base_.parent_path().string() + "' is no folder; make it first");
  }

  void make() {
    requireFree();
    choice_ = choose();
    const map::RoadNetwork network = map::RoadNetwork::fromText(choice_.text, choice_.origin);
    const map::LaneGraph graph(network);
    const std::vector<suite::SuggestedRoute> routes = suggestions(graph);
    printRoutes(network, routes);
    writeFiles(graph, routes);
    review();
  }

 private:
  fs::path file(const std::string& ending) const { return base_.string() + ending; }

  /// Whether the network is generated or converted, and so written beside the scenario.
  bool writesNetwork() const {
    const std::string& source = arguments_.osm.empty() ? arguments_.network : arguments_.osm;
    return source.empty() || (core::isFile(source) && !core::endsWith(source, ".net.xml"));
  }

  void requireFree() const {
    if (arguments_.overwrite) return;
    std::vector<std::string> endings = {".yaml"};
    if (writesNetwork()) endings.emplace_back(".net.xml");
    if (arguments_.picture) endings.emplace_back(".svg");
    std::vector<std::string> taken;
    for (const std::string& ending : endings) {
      if (fs::exists(file(ending))) taken.push_back("'" + file(ending).string() + "'");
    }
    if (taken.empty()) return;
    throw InputError(
        core::joinText(taken, " and ") + (taken.size() == 1 ? " is" : " are") +
        " there already; give another NAME, or --overwrite to replace " +
        (taken.size() == 1 ? "this file" : "these files") +
        (writesNetwork() ? "" : " (the network '" + arguments_.network + "' stays as it is)"));
  }

  NetworkChoice choose() const {
    for (const auto& [wanted, kind] :
         {std::pair{arguments_.grid, "grid"}, std::pair{arguments_.crossing, "crossing"},
          std::pair{arguments_.roundabout, "roundabout"}}) {
      if (!wanted) continue;
      const std::string own = file(".net.xml").filename().string();
      return {suite::generatedNetwork(kind, arguments_.seed), own, true,
              std::string(kind) + ", generated"};
    }
    return imported(arguments_.osm.empty() ? arguments_.network : arguments_.osm);
  }

  /// A SUMO network is used where it lies; what was converted is written beside the scenario, so
  /// that its names stay.
  NetworkChoice imported(const std::string& source) const {
    const map::ImportedNetwork network = map::importNetwork(source);
    NetworkChoice choice{network.text, source, false, "network '" + network.source.string() + "'"};
    if (!core::isFile(source)) return choice;
    choice.own = writesNetwork();
    const fs::path folder = fs::absolute(base_).parent_path();
    choice.named = choice.own ? file(".net.xml").filename().string()
                              : fs::relative(fs::absolute(source), folder).string();
    return choice;
  }

  std::vector<suite::SuggestedRoute> suggestions(const map::LaneGraph& graph) const {
    constexpr std::size_t kShown = 8;
    try {
      auto routes = longEnough(suite::suggestRoutes(graph, arguments_.ends, kShown));
      if (arguments_.route > routes.size()) {
        throw InputError("--route is " + std::to_string(arguments_.route) + "; expected 1 to " +
                         std::to_string(routes.size()));
      }
      return routes;
    } catch (const InputError& error) {
      throw InputError(choice_.origin + ": " + error.what());
    }
  }

  /// Those on which an ego can be tested; all where the user says where the route starts or ends.
  std::vector<suite::SuggestedRoute> longEnough(std::vector<suite::SuggestedRoute> routes) const {
    constexpr double kLeast = 50.0;  // some 6 s at 8 m/s, the last 10 m of which count as complete
    if (!arguments_.ends.from.empty() || !arguments_.ends.to.empty()) return routes;
    const auto longest = *std::max_element(
        routes.begin(), routes.end(),
        [](const auto& left, const auto& right) { return left.length < right.length; });
    if (longest.length < kLeast) {
      throw InputError("no route to test an ego on: the best one, " +
                       core::joinText(longest.edges, " ") + ", is only " +
                       core::formatFixed(longest.length, 0) + " m long, and " +
                       core::formatFixed(kLeast, 0) +
                       " m are needed from the ego's start, 5 m behind the start of the first "
                       "edge, to its goal, 5 m before the end of the last; give a network whose "
                       "edges connect to such a way, or --from and --to if this one is meant");
    }
    const auto too_short = [](const suite::SuggestedRoute& route) { return route.length < kLeast; };
    routes.erase(std::remove_if(routes.begin(), routes.end(), too_short), routes.end());
    return routes;
  }

  void printRoutes(const map::RoadNetwork& network,
                   const std::vector<suite::SuggestedRoute>& routes) const {
    std::cout << "network   " << choice_.origin << ": " << network.edgeIds().size() << " edges, "
              << network.junctions().size() << " junctions\n";
    for (std::size_t i = 0; i < routes.size(); ++i) {
      std::cout << (i + 1 == arguments_.route ? "route   * " : "          ") << i + 1 << "  "
                << suite::routeText(routes[i]) << ": " << core::joinText(routes[i].edges, " ")
                << "\n";
    }
    if (routes.size() > 1) std::cout << "          (*: chosen; --route N takes another)\n";
    if (routes[arguments_.route - 1].conflicts == 0) {
      std::cerr << "cdiff: warning: no other traffic crosses or joins this route, so no vehicle "
                   "becomes a CBV\n";
    }
  }

  void writeFiles(const map::LaneGraph& graph, std::vector<suite::SuggestedRoute> routes) const {
    suite::NewScenario scenario;
    scenario.name = base_.filename().string();
    scenario.network = choice_.named;
    scenario.seed = arguments_.seed;
    scenario.route = routes[arguments_.route - 1];
    routes.erase(routes.begin() + static_cast<std::ptrdiff_t>(arguments_.route) - 1);
    scenario.others = routes;
    if (choice_.own) core::writeFileAtomically(file(".net.xml"), choice_.text);
    core::writeFileAtomically(file(".yaml"), suite::newScenarioText(scenario));
    if (!arguments_.picture) return;
    const suite::SuggestedRoute& route = scenario.route;
    core::writeFileAtomically(
        file(".svg"), page::edgeMapSvg(graph.network(),
                                       map::routeAlongEdges(graph, route.edges, route.start_offset,
                                                            route.end_offset)));
    std::cout << "picture   " << file(".svg").string() << " (open it in a browser)\n";
  }

  /// As `cdiff validate` does.
  void review() const {
    constexpr double kPatience = 10.0;  // [s]
    session::SessionRequest request;
    request.scenario = file(".yaml").string();
    const session::SessionSetup setup(session::resolveRequest(request));
    const session::TrafficTrial trial = session::tryTraffic(setup, kPatience);
    std::vector<std::string> warnings = session::scenarioWarnings(setup);
    for (const std::string& text : session::trialWarnings(setup.options(), trial))
      warnings.push_back(text);
    for (const std::string& warning : warnings) std::cerr << "cdiff: warning: " << warning << "\n";
    std::cout << "scenario  " << request.scenario << ": valid, " << trial.most
              << " vehicles at the start\nnext      cdiff run " << request.scenario
              << " --results results/" << base_.filename().string() << "\n";
  }

  const NewArguments& arguments_;
  fs::path base_;  ///< of the files, without an ending
  NetworkChoice choice_;
};

}  // namespace

void addNewCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<NewArguments>();
  CLI::App* command = program.add_subcommand(
      "new", "Write a scenario that runs at once: network, route, traffic, protocol and rules");
  command->add_option("name", arguments->name, "Writes NAME.yaml, in a folder where one is given")
      ->required();
  auto* source = command->add_option_group("roads");
  source->add_option("--network", arguments->network,
                     "*.net.xml, *.xodr, *.osm, or a shipped network");
  source->add_option("--osm", arguments->osm, "An OpenStreetMap file (*.osm)");
  source->add_flag("--grid", arguments->grid, "A grid of 4 x 4 crossings");
  source->add_flag("--crossing", arguments->crossing, "One crossing, drawn from the seed");
  source->add_flag("--roundabout", arguments->roundabout, "A roundabout, drawn from the seed");
  source->require_option(1);
  command->add_option("--from", arguments->ends.from, "First edge of the ego's route");
  command->add_option("--to", arguments->ends.to, "Last edge of the ego's route");
  command->add_option("--route", arguments->route, "Take this one of the routes that are listed")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--seed", arguments->seed, "Root seed of the scenario and of drawn roads")
      ->capture_default_str()
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{2147483647}));
  command->add_flag("--picture", arguments->picture,
                    "Also write NAME.svg: a map with the names of all edges");
  command->add_flag(
      "--overwrite", arguments->overwrite,
      "Replace NAME.yaml, NAME.svg with --picture, and NAME.net.xml where the roads are "
      "generated or converted; a SUMO network of yours stays");
  command->callback([arguments, &exit_code] {
    ScenarioMaker(*arguments).make();
    exit_code = ExitCode::kPassed;
  });
}

}  // namespace cdiff::cli
