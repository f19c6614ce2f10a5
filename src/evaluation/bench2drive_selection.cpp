// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/bench2drive_selection.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/bench2drive_file.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::InputError;

/// What `routes:` names: all routes, or these.
struct Wish {
  std::set<std::string> ids;    ///< those of dev10 too
  std::set<std::string> named;  ///< one by one; each must be there

  explicit Wish(const std::vector<std::string>& routes) {
    for (const std::string& route : routes) {
      if (route == kDev10) {
        ids.insert(dev10Routes().begin(), dev10Routes().end());
      } else {
        ids.insert(route);
        named.insert(route);
      }
    }
  }
  bool has(const std::string& id) const { return ids.empty() || ids.count(id) != 0; }
};

void requireAll(std::set<std::string> named, const Bench2DriveSelection& selection,
                const Bench2DriveOptions& options) {
  for (const auto& [id, network] : selection.routes) named.erase(id);
  for (const auto& [id, kept] : selection.repeated) named.erase(id);
  if (!named.empty()) {
    throw InputError("routes " + core::joinText({named.begin(), named.end()}, ", ") +
                     " are not in '" + options.file +
                     "', or the network of their town is not in '" + options.networks + "'");
  }
  if (selection.routes.empty()) {
    throw InputError("no route of '" + options.file +
                     "' lies in a town whose TOWN.net.xml is in '" + options.networks + "'");
  }
}

}  // namespace

const std::vector<std::string>& dev10Routes() {
  static const std::vector<std::string> routes = {"17569", "2091",  "25378", "25381", "25424",
                                                  "26405", "27494", "28198", "3255",  "3514"};
  return routes;
}

Bench2DriveSelection selectBench2Drive(const Bench2DriveOptions& options) {
  const map::Bench2DriveFile file(options.file);
  const auto repeated = file.repeatedRoutes();
  const Wish wish(options.routes);
  Bench2DriveSelection selection;
  for (const map::Bench2DriveEntry& entry : file.entries()) {
    const fs::path network = fs::path(options.networks) / (entry.town + ".net.xml");
    if (!wish.has(entry.id) || !core::isFile(network)) continue;
    const auto twin = repeated.find(entry.id);
    if (twin != repeated.end() && wish.has(twin->second)) {
      selection.repeated.insert(*twin);
    } else {
      selection.routes.emplace_back(entry.id, network.string());
    }
  }
  requireAll(wish.named, selection, options);
  return selection;
}

std::string repeatedText(const Bench2DriveSelection& selection) {
  if (selection.repeated.empty()) return "";
  std::vector<std::string> texts;
  for (const auto& [id, kept] : selection.repeated) texts.push_back(id + " (as " + kept + ")");
  return "left out, waypoints equal to those of another route: " + core::joinText(texts, ", ") +
         "; " + std::to_string(selection.routes.size()) + " of " +
         std::to_string(selection.routes.size() + selection.repeated.size()) + " routes are run\n";
}

}  // namespace cdiff::evaluation
