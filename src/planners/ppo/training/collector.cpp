// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/training/collector.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <thread>

#include "e2e_cdiff/core/exceptions.h"
#include "session/closed_loop.h"
#include "simulation/lane_traffic.h"
#include "simulation/sumo_simulator.h"

namespace cdiff::planners {
namespace {

constexpr std::int64_t kMostSeeds = 2147483647;
constexpr int kMostSessions = 200;  // of an environment in one iteration

/// Ends a session when enough decisions were rewarded, or when everything is to stop.
class SessionEnd : public session::SessionObserver {
 public:
  SessionEnd(const PpoEpisodeLog& log, std::size_t most, const std::atomic<bool>& stop)
      : log_(log), most_(most), stop_(stop) {}
  void observe(const session::TickRecord& record) override {
    if (log_.steps() >= most_ || stop_) reached_ = true;
    for (const traffic::Fault& fault : record.snapshot->faults)
      fault_ = fault.source + ": " + fault.text;
  }
  const std::atomic<bool>& reached() const { return reached_; }
  const std::string& lastFault() const { return fault_; }

 private:
  const PpoEpisodeLog& log_;
  std::size_t most_;
  const std::atomic<bool>& stop_;
  std::atomic<bool> reached_{false};
  std::string fault_;
};

std::unique_ptr<session::World> makeWorld(const session::SessionSetup& setup,
                                          const std::string& simulator) {
  if (simulator == "sumo") return std::make_unique<session::World>(setup);
  return std::make_unique<session::World>(
      setup,
      std::make_unique<simulation::LaneTraffic>(setup.graph(), setup.options().simulation_step));
}

}  // namespace

std::vector<PpoEpisode> PpoCollector::session(std::size_t route, std::int64_t seed,
                                              const PpoPolicy& policy, std::size_t most) const {
  const std::unique_ptr<session::SessionSetup> setup = routes_.setup(route, seed);
  PpoEpisodeLog log(policy, setup->egoRoute());
  session::LoopParts parts = session::makeParts(*setup);
  parts.world = makeWorld(*setup, options_.simulator);
  parts.selector = std::make_unique<PpoEpisodeSelector>(std::move(parts.selector), log);
  parts.cbv_planner = {std::make_unique<PpoEpisodePlanner>(log)};
  SessionEnd end(log, most, stop_);
  session::ClosedLoop loop(*setup, std::move(parts));
  loop.addObserver(end);
  if (loop.run(end.reached()) == traffic::SessionStatus::kError) {
    throw core::SimulatorError("PPO: session '" + routes_.name(route) + "', seed " +
                               std::to_string(seed) + ", failed: " + end.lastFault());
  }
  return log.finish();
}

std::vector<PpoEpisode> PpoCollector::environment(const PpoActor& actor, std::int64_t iteration,
                                                  std::int64_t number) const {
  const auto seed = static_cast<std::uint64_t>(options_.seed);
  const core::RandomStream sessions(seed, "ppo sessions");
  const auto quota = static_cast<std::size_t>((options_.buffer + options_.environments - 1) /
                                              options_.environments);
  std::vector<PpoEpisode> episodes;
  std::size_t steps = 0;
  for (int i = 0; i < kMostSessions && steps < quota && !stop_; ++i) {
    const core::RandomKey key{static_cast<std::uint64_t>(number),
                              static_cast<std::uint32_t>(iteration), static_cast<std::uint16_t>(i)};
    const std::size_t route = routes_.training()[sessions.index(key, 0, routes_.training().size())];
    const auto session_seed = static_cast<std::int64_t>(sessions.index(key, 1, kMostSeeds));
    const PpoPolicy policy{actor, true, core::RandomStream(sessions.bits(key, 2), "ppo actions")};
    for (PpoEpisode& episode : session(route, session_seed, policy, quota - steps)) {
      steps += episode.steps.size();
      episodes.push_back(std::move(episode));
    }
  }
  if (steps >= quota || stop_) return episodes;
  throw core::Error("PPO: " + std::to_string(kMostSessions) + " sessions gave " +
                    std::to_string(steps) + " of " + std::to_string(quota) +
                    " decisions: the suite's routes have hardly any CBV");
}

std::vector<PpoEpisode> PpoCollector::run(const std::vector<Job>& jobs) const {
  std::vector<std::vector<PpoEpisode>> results(jobs.size());
  std::vector<std::exception_ptr> errors(jobs.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size(); i = next++) {
      try {
        results[i] = jobs[i]();
      } catch (...) {
        errors[i] = std::current_exception();
      }
    }
  };
  std::vector<std::thread> others;
  for (std::int64_t i = 1; i < options_.workers; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  if (stop_)
    throw core::Interrupted(
        "stopped while episodes were collected; --resume goes on from "
        "the last iteration that was finished");
  std::vector<PpoEpisode> all;
  for (std::vector<PpoEpisode>& result : results)
    std::move(result.begin(), result.end(), std::back_inserter(all));
  return all;
}

std::vector<PpoEpisode> PpoCollector::explore(const PpoActor& actor, std::int64_t iteration) const {
  std::vector<Job> jobs;
  for (std::int64_t i = 0; i < options_.environments; ++i)
    jobs.emplace_back([this, &actor, iteration, i] { return environment(actor, iteration, i); });
  return run(jobs);
}

std::vector<PpoEpisode> PpoCollector::evaluate(const PpoActor& actor, std::int64_t rounds) const {
  const core::RandomStream seeds(0, "ppo held-out seeds");
  std::vector<Job> jobs;
  for (std::int64_t round = 0; round < rounds; ++round) {
    for (const std::size_t route : routes_.heldOut()) {
      const core::RandomKey key{core::hashText(routes_.name(route)),
                                static_cast<std::uint32_t>(round), 0};
      const auto seed = static_cast<std::int64_t>(seeds.index(key, 0, kMostSeeds));
      jobs.emplace_back([this, &actor, route, seed] {
        const PpoPolicy policy{actor, false, core::RandomStream(0, "")};
        return session(route, seed, policy, std::numeric_limits<std::size_t>::max());
      });
    }
  }
  return run(jobs);
}

}  // namespace cdiff::planners
