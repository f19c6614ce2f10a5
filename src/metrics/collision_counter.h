// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Counts the ego's collisions as CARLA's CollisionTest does: contacts with the same partner within
/// a time [s], or within a distance of the last collision [m], are one; those of a standing ego are
/// not charged.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "e2e_cdiff/metrics/infraction_options.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::metrics {

class CollisionCounter {
 public:
  explicit CollisionCounter(const InfractionOptions& options) : options_(options) {}

  /// A contact of the ego that began at `time` [s]; times ascending.
  void observe(double time, const traffic::VehicleState& ego, const std::string& partner);
  std::size_t count() const { return count_; }
  /// Contacts seen, counted or not.
  std::size_t contacts() const { return contacts_; }

 private:
  struct Collision {
    double time;
    Eigen::Vector2d position;  ///< of the ego
    std::string partner;
  };
  bool repeats(double time, const traffic::VehicleState& ego, const std::string& partner) const;

  InfractionOptions options_;
  std::optional<Collision> last_;
  std::size_t count_ = 0;
  std::size_t contacts_ = 0;
};

}  // namespace cdiff::metrics
