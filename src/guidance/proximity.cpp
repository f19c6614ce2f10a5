// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/proximity.h"

#include <algorithm>
#include <cmath>

namespace cdiff::guidance {
namespace {

constexpr double kSmallDistance = 0.1;  // [m] gives the distance a derivative where centers meet

/// Derivative of softplus.
double logistic(double x) {
  if (x >= 0.0) return 1.0 / (1.0 + std::exp(-x));
  const double power = std::exp(x);
  return power / (1.0 + power);
}

double halfDiagonal(const traffic::VehicleDimensions& box) {
  return 0.5 * std::hypot(box.length, box.width);
}

}  // namespace

double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

void Proximity::describe(core::OptionsVisitor& visitor) {
  visitor.number({"buffer", "m", "Distance kept beyond the boxes' half diagonals."}, buffer, 0.0,
                 50.0);
  visitor.number({"kappa", "m", "Softness of the safety distance; the pull reaches some of it."},
                 kappa, 0.05, 50.0);
  visitor.number({"lambda", "", "Height of the bump around the other vehicle."}, lambda, 0.0,
                 1000.0);
  visitor.number({"sigma", "m", "Width of the bump."}, sigma, 0.1, 100.0);
}

double Proximity::safeDistance(const GuidanceScene& scene) const {
  return halfDiagonal(scene.dimensions) + halfDiagonal(scene.other->dimensions) + buffer;
}

double Proximity::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                           double factor, traffic::Rollout& gradient) const {
  if (scene.other == nullptr) return 0.0;
  if (traffic::onDifferentLevels(scene.other->now.elevation, scene.state.elevation)) return 0.0;
  const double safe_distance = safeDistance(scene);
  const auto known = static_cast<Eigen::Index>(scene.other->predicted.size());
  double sum = 0.0;
  for (Eigen::Index row = 0; row < std::min(rollout.rows(), known); ++row) {
    const Eigen::Vector2d away = positionOnMap(scene, rollout, row) -
                                 scene.other->predicted[static_cast<std::size_t>(row)].position;
    const double squared = away.squaredNorm() + kSmallDistance * kSmallDistance;
    const double distance = std::sqrt(squared);
    const double closeness = (safe_distance - distance) / kappa;
    const double bump = lambda * std::exp(-squared / (2.0 * sigma * sigma));
    sum += softplus(closeness) + bump;
    const double by_distance = -logistic(closeness) / kappa - bump * distance / (sigma * sigma);
    addPositionGradient(scene, factor * by_distance / distance * away, row, gradient);
  }
  return factor * sum;
}

}  // namespace cdiff::guidance
