// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/run_order.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include "core/file.h"
#include "evaluation/system_names.h"

namespace cdiff::evaluation {

std::vector<std::size_t> runOrder(const std::vector<PlannedRun>& runs) {
  std::map<std::string, std::size_t> by_hash;
  for (std::size_t i = 0; i < runs.size(); ++i) by_hash[core::sha256(runs[i].id)] = i;
  std::map<std::pair<Factors, std::string>, std::size_t> turns;  // of a system and a scenario
  std::map<Factors, std::vector<std::tuple<std::size_t, std::string, std::size_t>>> by_system;
  for (const auto& [hash, index] : by_hash) {
    const Factors system = systemFactors(runs[index].factors);
    const std::size_t turn = turns[{system, runs[index].factors.at("scenario")}]++;
    by_system[system].emplace_back(turn, hash, index);
  }
  std::vector<std::tuple<std::size_t, std::string, std::size_t>> order;
  for (auto& [system, sequence] : by_system) {
    std::sort(sequence.begin(), sequence.end());
    for (std::size_t place = 0; place < sequence.size(); ++place)
      order.emplace_back(place, std::get<1>(sequence[place]), std::get<2>(sequence[place]));
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> indices;
  for (const auto& [place, hash, index] : order) indices.push_back(index);
  return indices;
}

}  // namespace cdiff::evaluation
