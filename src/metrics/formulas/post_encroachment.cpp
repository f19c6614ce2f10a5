// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/post_encroachment.h"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>

namespace cdiff::metrics {
namespace {

using geometry::OrientedBox;

/// Convex set of (s, u): the first box has covered the share s of its path, the second the share u.
/// Each of the eight cuts adds at most one corner to the unit square.
using Shares = boost::container::static_vector<Eigen::Vector2d, 16>;

/// The part with normal . (s, u) <= bound.
Shares cut(const Shares& shares, const Eigen::Vector2d& normal, double bound) {
  Shares kept;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const Eigen::Vector2d& corner = shares[i];
    const Eigen::Vector2d& next = shares[(i + 1) % shares.size()];
    const double over = normal.dot(corner) - bound;
    const double next_over = normal.dot(next) - bound;
    if (over <= 0.0) kept.push_back(corner);
    if ((over < 0.0 && next_over > 0.0) || (over > 0.0 && next_over < 0.0))
      kept.push_back(corner + over / (over - next_over) * (next - corner));
  }
  return kept;
}

/// Where the shadows of both boxes on an axis overlap.
void cutByAxis(Shares& shares, const SweptBox& first, const SweptBox& second,
               const Eigen::Vector2d& axis) {
  const double offset = (second.box.center - first.box.center).dot(axis);
  const Eigen::Vector2d rate{-first.offset.dot(axis), second.offset.dot(axis)};
  const double both =
      geometry::halfExtent(first.box, axis) + geometry::halfExtent(second.box, axis);
  shares = cut(shares, rate, both - offset);
  shares = cut(shares, -rate, both + offset);
}

}  // namespace

bool farApart(const SweptBox& first, const SweptBox& second) {
  const auto radius = [](const SweptBox& sweep) {
    return 0.5 * (std::hypot(sweep.box.length, sweep.box.width) + sweep.offset.norm());
  };
  const Eigen::Vector2d between =
      second.box.center + 0.5 * second.offset - first.box.center - 0.5 * first.offset;
  const double sum = radius(first) + radius(second);
  return between.squaredNorm() > sum * sum;
}

std::optional<TimeRange> timesBetween(const SweptBox& first, const SweptBox& second) {
  Shares shares = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  for (const OrientedBox* box : {&first.box, &second.box}) {
    const Eigen::Vector2d forward = geometry::direction(box->heading);
    cutByAxis(shares, first, second, forward);
    cutByAxis(shares, first, second, geometry::leftNormal(forward));
    if (shares.empty()) return std::nullopt;
  }
  const auto time = [&](const Eigen::Vector2d& share) {
    return second.begin - first.begin + share.y() * second.duration - share.x() * first.duration;
  };
  TimeRange range{time(shares.front()), time(shares.front())};
  for (const Eigen::Vector2d& share : shares) {
    range.shortest = std::min(range.shortest, time(share));
    range.longest = std::max(range.longest, time(share));
  }
  return range;
}

}  // namespace cdiff::metrics
