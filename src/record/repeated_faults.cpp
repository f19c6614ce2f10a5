// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/repeated_faults.h"

#include <algorithm>

namespace cdiff::record {

std::string RepeatedFault::text() const {
  if (times == 1) return fault.text;
  return fault.text + " (" + std::to_string(times) + " times, ticks " + std::to_string(fault.tick) +
         " to " + std::to_string(last_tick) + ")";
}

std::vector<RepeatedFault> repeatedFaults(const std::vector<traffic::Fault>& faults) {
  std::vector<RepeatedFault> repeated;
  for (const traffic::Fault& fault : faults) {
    const auto same =
        std::find_if(repeated.begin(), repeated.end(), [&](const RepeatedFault& earlier) {
          return earlier.fault.source == fault.source && earlier.fault.text == fault.text;
        });
    if (same == repeated.end()) {
      repeated.push_back({fault, fault.tick, 1});
      continue;
    }
    ++same->times;
    same->last_tick = fault.tick;
    std::rotate(same, same + 1, repeated.end());
  }
  return repeated;
}

}  // namespace cdiff::record
