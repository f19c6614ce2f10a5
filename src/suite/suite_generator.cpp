// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/suite_generator.h"

#include <unistd.h>

#include <array>
#include <memory>
#include <set>

#include "core/file.h"
#include "core/folder_access.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "suite/network_generator.h"

namespace cdiff::suite {
namespace {

const std::array<const char*, 3> kControls = {"priority", "right_before_left", "traffic_light"};

std::string numbered(const std::string& name, int i) { return name + "_" + std::to_string(i + 1); }

/// Every combination of control, arms and lanes comes up; one network in four has elevation.
std::vector<NetworkSpec> trainingNetworks() {
  constexpr int kCrossings = 18;
  constexpr int kRoundabouts = 6;
  constexpr int kMerges = 8;
  constexpr int kDistricts = 6;
  std::vector<NetworkSpec> specs;
  for (int i = 0; i < kCrossings; ++i) {
    const std::string control = kControls[static_cast<std::size_t>(i % 3)];
    const int lanes = control == "right_before_left" ? 1 : 1 + (i / 3) % 3;
    specs.push_back({numbered("crossing", i), NetworkKind::kCrossing, 4 - (i / 3) % 2, lanes,
                     control, i % 4 == 3});
  }
  for (int i = 0; i < kRoundabouts; ++i)
    specs.push_back({numbered("roundabout", i), NetworkKind::kRoundabout, 3 + i % 3, 1 + i / 3, "",
                     i % 4 == 3});
  for (int i = 0; i < kMerges; ++i)
    specs.push_back({numbered("merge", i), NetworkKind::kMerge, 0, 1 + i % 3, "", i % 4 == 3});
  for (int i = 0; i < kDistricts; ++i)
    specs.push_back(
        {numbered("district", i), NetworkKind::kDistrict, 0, 1 + i % 2, "", i % 4 == 3});
  return specs;
}

std::vector<NetworkSpec> developmentNetworks() {
  const auto crossing = NetworkKind::kCrossing;
  return {{"development_crossing", crossing, 4, 1, "priority", false},
          {"development_t_junction", crossing, 3, 1, "priority", true},
          {"development_signals", crossing, 4, 2, "traffic_light", false},
          {"development_right_before_left", crossing, 4, 1, "right_before_left", false},
          {"development_district", NetworkKind::kDistrict, 0, 1, "", false},
          {"development_roundabout", NetworkKind::kRoundabout, 4, 1, "", false},
          {"development_merge", NetworkKind::kMerge, 0, 2, "", false}};
}

std::vector<RouteWish> developmentRoutes() {
  return {{"left", "medium", "development_crossing"},
          {"left", "medium", "development_t_junction"},
          {"left", "medium", "development_signals"},
          {"right", "high", "development_t_junction"},
          {"right", "medium", "development_right_before_left"},
          {"right", "low", "development_district"},
          {"straight", "medium", "development_crossing"},
          {"straight", "medium", "development_signals"},
          {"roundabout", "low", "development_roundabout"},
          {"merge", "high", "development_merge"}};
}

}  // namespace

const std::vector<std::string>& suiteKinds() {
  static const std::vector<std::string> kinds = {"development", "train"};
  return kinds;
}

std::int64_t defaultSeed(const std::string&) { return 1; }

std::map<std::string, int> routeCounts(const std::string& kind) {
  if (kind == "train")
    return {{"left", 66}, {"right", 66}, {"straight", 44}, {"roundabout", 22}, {"merge", 22}};
  std::map<std::string, int> counts;
  for (const RouteWish& wish : developmentRoutes()) ++counts[wish.manoeuvre];
  return counts;
}

std::vector<NetworkSpec> networkSpecs(const std::string& kind) {
  return kind == "train" ? trainingNetworks() : developmentNetworks();
}

std::vector<RouteWish> routeWishes(const std::string& kind) {
  if (kind != "train") return developmentRoutes();
  std::vector<RouteWish> wishes;
  for (const auto& [manoeuvre, count] : routeCounts(kind)) {
    for (int i = 0; i < count; ++i)
      wishes.push_back({manoeuvre, densities()[static_cast<std::size_t>(i) % 3], ""});
  }
  return wishes;
}

namespace {

namespace fs = std::filesystem;
using core::InputError;

constexpr std::uint32_t kFirstRouteCounter = 1000;  ///< networks have the counters below

/// A drawn network with its paths, ready for routes.
struct BuiltNetwork {
  RoadPlan plan;
  map::RoadNetwork network;
};

/// Name of a suite's stream of draws. The development suite was drawn under its earlier name.
std::string streamOf(const std::string& kind) {
  return kind == "development" ? "suite test" : "suite " + kind;
}

class Generator {
 public:
  Generator(const std::string& kind, std::int64_t seed, const fs::path& folder)
      : kind_(kind), random_(static_cast<std::uint64_t>(seed), streamOf(kind)), folder_(folder) {
    suite_.name = kind;
    suite_.seed = seed;
    suite_.folder = folder;
  }

  Suite generate() {
    const std::vector<NetworkSpec> specs = networkSpecs(kind_);
    for (std::size_t i = 0; i < specs.size(); ++i) {
      Draws draws(random_, static_cast<std::uint32_t>(i));
      const RoadPlan plan = drawNetwork(specs[i], draws);
      core::OutputFolder networks(core::OutputFolder(folder_).subfolder("networks"));
      const std::string text = buildNetwork(plan, networks.subfolder(plan.name));
      networks_.push_back({plan, map::RoadNetwork::fromText(text, plan.name)});
    }
    for (const RouteWish& wish : routeWishes(kind_)) addRoute(wish);
    writeFiles();
    return suite_;
  }

 private:
  /// Networks in which the wish has not been looked for longest come first.
  void addRoute(const RouteWish& wish) {
    std::size_t& next = next_network_[wish.manoeuvre];
    for (std::size_t tried = 0; tried < networks_.size(); ++tried) {
      const BuiltNetwork& built = networks_[next++ % networks_.size()];
      if (!wish.network.empty() && wish.network != built.plan.name) continue;
      const std::optional<SuiteRoute> route = findRoute(built, wish);
      if (!route) continue;
      suite_.routes.push_back(*route);
      return;
    }
    throw InputError("suite " + kind_ + " with seed " + std::to_string(suite_.seed) +
                     ": no route for manoeuvre " + wish.manoeuvre +
                     (wish.network.empty() ? "" : " on network " + wish.network) +
                     "; try another seed");
  }

  /// The first path that fits, from a drawn one on.
  std::optional<SuiteRoute> findRoute(const BuiltNetwork& built, const RouteWish& wish) {
    const map::LaneGraph graph(built.network);
    const auto number = static_cast<std::uint32_t>(suite_.routes.size());
    Draws order(random_, kFirstRouteCounter + 2 * number);
    const std::size_t count = built.plan.paths.size();
    const int first = order.whole(0, static_cast<int>(count) - 1);
    for (std::size_t i = 0; i < count; ++i) {
      const PlannedPath& path = built.plan.paths[(static_cast<std::size_t>(first) + i) % count];
      if (path.purpose != purposeOf(wish.manoeuvre)) continue;
      Draws draws(random_, kFirstRouteCounter + 2 * number + 1);
      std::optional<SuiteRoute> route = planRoute(graph, path, draws);
      if (!route || route->manoeuvre != wish.manoeuvre) continue;
      if (!places_.insert(placeOf(*route, built.plan.name)).second) continue;
      route->name = kind_ + "_" + wish.manoeuvre + "_" + std::to_string(++named_[wish.manoeuvre]);
      route->network = built.plan.name;
      route->density = wish.density;
      route->seed = number + 1;
      return route;
    }
    return std::nullopt;
  }

  /// Equal for routes that are the same.
  static std::string placeOf(const SuiteRoute& route, const std::string& network) {
    return network + " " + core::joinText(route.edges, " ") + " " +
           core::formatNumber(route.start_offset) + " " + core::formatNumber(route.end_offset);
  }

  static std::string purposeOf(const std::string& manoeuvre) {
    return manoeuvre == "roundabout" || manoeuvre == "merge" ? manoeuvre : "";
  }

  void writeFiles() const {
    core::OutputFolder(folder_).subfolder("scenarios");
    for (const SuiteRoute& route : suite_.routes)
      core::writeOwnFile(suite_.scenarioFile(route), scenarioText(route));
    core::writeOwnFile(folder_ / "suite.yaml", manifestText(suite_));
  }

  std::string kind_;
  core::RandomStream random_;
  fs::path folder_;
  Suite suite_;
  std::vector<BuiltNetwork> networks_;
  std::map<std::string, std::size_t> next_network_;  ///< for each maneuver
  std::set<std::string> places_;                     ///< of the routes so far
  std::map<std::string, int> named_;                 ///< routes of each maneuver so far
};

void requireEmpty(const fs::path& folder) {
  core::OutputFolder::requireFree(folder, {});  // no file, no link
  if (!fs::exists(folder) || fs::is_empty(folder)) return;
  throw InputError("'" + folder.string() +
                   "' is there already; give --results a folder that is new or empty");
}

/// Removes what an earlier run that was killed left. Throws InputError for anything else.
void requireOwnContent(core::OutputFolder& work) {
  work.clear();
  for (const auto& entry : fs::directory_iterator(work.path())) {
    if (entry.path().filename() == core::FolderLock::kFile) continue;
    throw InputError("'" + entry.path().string() +
                     "' is in the folder that the suite is made in, and not this program's; move "
                     "it away, or give another --results");
  }
}

/// Gives the finished suite its name; what has taken it meanwhile stays.
void place(const fs::path& work, const fs::path& target) {
  ::rmdir(target.c_str());  // refused where it holds anything, or is no folder
  const int reason = core::placeUnlessThere(work, target);
  if (reason == 0) return;
  throw InputError("cannot give the suite the name '" + target.string() +
                   "': " + core::writeErrorText(reason) + "; it is in '" + work.string() + "'");
}

/// A suite is complete or not there; its files are the user's from now on.
void endRecords(const fs::path& folder) {
  std::vector<fs::path> folders = {folder};
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) folders.push_back(entry.path());
  }
  for (const fs::path& place : folders) core::OutputFolder(place).forget();
}

}  // namespace

Suite generateSuite(const std::string& kind, std::int64_t seed, const fs::path& folder) {
  const fs::path target = fs::absolute(folder).lexically_normal();
  requireEmpty(target);
  const fs::path work = target.string() + ".part";
  auto output = std::make_unique<core::OutputFolder>(work, "cdiff suite");
  requireOwnContent(*output);
  Suite suite = Generator(kind, seed, work).generate();
  endRecords(work);
  output.reset();
  place(work, target);
  suite.folder = target;
  return suite;
}

}  // namespace cdiff::suite
