// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/sumo_start.h"

#include <pugixml.hpp>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "simulation/in_process_link.h"
#include "simulation/sumo_input_rules.h"
#include "simulation/traci_link.h"

namespace cdiff::simulation {
namespace {

void requireFile(const std::filesystem::path& file, const char* what) {
  if (std::filesystem::is_regular_file(file)) return;
  throw core::InputError(std::string(what) + " '" + file.string() + "' is not a file");
}

/// SUMO's seed is a 32-bit signed number.
std::string sumoSeed(std::uint64_t seed) { return std::to_string(seed % 2147483647ULL); }

SumoCommand commandFor(const SumoOptions& options, const SumoSession& session) {
  SumoCommand command;
  command.binary = options.binary;
  command.log_folder = session.log_folder;
  command.start_timeout = options.start_timeout;
  command.arguments = {"--net-file",
                       session.network_file.string(),
                       "--begin",
                       core::formatNumber(session.begin_time),
                       "--step-length",
                       core::formatNumber(session.simulation_step),
                       "--seed",
                       sumoSeed(session.seed),
                       "--xml-validation",
                       "never",
                       "--xml-validation.net",
                       "never",
                       "--xml-validation.routes",
                       "never",
                       "--no-step-log",
                       "true",
                       "--no-warnings",
                       "true",
                       "--duration-log.disable",
                       "true",
                       "--collision.action",
                       "none",
                       "--time-to-teleport",
                       "-1",
                       "--lanechange.duration",
                       "3"};
  if (!session.demand_file.empty()) {
    // All at once, so that what is wrong with it shows before the first step.
    command.arguments.insert(command.arguments.end(),
                             {"--route-files", session.demand_file.string(), "--route-steps", "0"});
  }
  return command;
}

/// The network as the user knows it.
std::string sourceOf(const SumoSession& session) {
  const std::filesystem::path& source = session.network_source;
  return (source.empty() ? session.network_file : source).string();
}

/// Once more before SUMO reads them, however the session was made.
void requireHarmless(const SumoSession& session) {
  requireFile(session.network_file, "the network for SUMO");
  const std::string network = "network '" + sourceOf(session) + "'";
  requirePlainPath(session.network_file, network);
  requireHarmlessNetwork(core::readFile(session.network_file, "network"), network);
  if (session.demand_file.empty()) return;
  requireFile(session.demand_file, "the demand for SUMO");
  const std::string demand = "demand file '" + session.demand_file.string() + "'";
  requirePlainPath(session.demand_file, demand);
  requireHarmlessDemand(core::readFile(session.demand_file, "demand"), demand);
}

/// Again, with a port of its own, where another program is faster to connect.
std::unique_ptr<SumoLink> linkToProcess(const SumoCommand& command, double call_timeout) {
  constexpr int kAttempts = 5;
  for (int left = kAttempts; left > 1; --left) {
    try {
      return std::make_unique<TraciLink>(command, call_timeout);
    } catch (const OtherClient&) {
      continue;
    }
  }
  return std::make_unique<TraciLink>(command, call_timeout);
}

std::unique_ptr<SumoLink> linkTo(const SumoOptions& options, const SumoSession& session) {
  const SumoCommand command = commandFor(options, session);
  if (session.link == "libsumo")
    return std::make_unique<InProcessLink>(command.arguments, command.log_folder);
  return linkToProcess(command, options.step_timeout);
}

/// Whether SUMO refuses the network even without a demand.
bool refusesNetwork(const SumoOptions& options, const SumoSession& session) {
  SumoSession network_alone = session;
  network_alone.demand_file.clear();
  network_alone.log_folder.clear();
  try {
    linkTo(options, network_alone);
    return false;
  } catch (const SumoRefusal&) {
    return true;
  }
}

}  // namespace

void refuseDemand(const SumoSession& session, const std::string& sentence) {
  throw core::InputError("SUMO refuses the demand '" + session.demand_file.string() +
                         "': " + sentence);
}

std::unique_ptr<SumoLink> startSumo(const SumoOptions& options, const SumoSession& session) {
  requireHarmless(session);
  try {
    return linkTo(options, session);
  } catch (const SumoRefusal& refusal) {
    if (!session.demand_file.empty() && !refusesNetwork(options, session))
      refuseDemand(session, refusal.what());
    throw core::InputError("SUMO refuses the network '" + sourceOf(session) +
                           "': " + refusal.what());
  }
}

bool namesDemand(const std::string& sentence, const SumoSession& session) {
  if (session.demand_file.empty()) return false;
  const std::string demand = core::readFile(session.demand_file, "demand");
  pugi::xml_document document;
  document.load_buffer(demand.data(), demand.size());
  const std::vector<std::string> parts = core::splitText(" " + sentence, '\'');
  for (std::size_t i = 1; i < parts.size(); i += 2) {
    const std::string flow = parts[i].substr(0, parts[i].rfind('.'));
    const auto has_name = [&](const pugi::xml_node& node) {
      const std::string id = node.attribute("id").value();
      return !id.empty() && (id == parts[i] || id == flow);
    };
    if (document.find_node(has_name)) return true;
  }
  return false;
}

}  // namespace cdiff::simulation
