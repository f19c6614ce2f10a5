// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/statistics.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

namespace cdiff::evaluation {

Statistics statisticsOf(const std::vector<double>& samples) {
  Statistics result;
  result.n = samples.size();
  if (samples.empty()) return result;
  const auto n = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  result.mean = mean;
  if (samples.size() < 2) return result;
  double squares = 0.0;
  for (const double sample : samples) squares += (sample - mean) * (sample - mean);
  const double deviation = std::sqrt(squares / (n - 1.0));
  const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
  result.standard_deviation = deviation;
  result.half_width = t * deviation / std::sqrt(n);
  return result;
}

}  // namespace cdiff::evaluation
