// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "realism/recording.h"

namespace cdiff::realism {

/// realism_pooled: how likely recorded drivers are under the histogram of simulated ones, all steps
/// of all vehicles pooled. Bins, weights and pseudo-counts are those of the challenge, but this is
/// not its metric: nothing starts from the same situation, features of the map are left out, and
/// the weights of the others (0.65 together) are scaled to 1. Both sides are differentiated by the
/// same filter (smoothedMotion); a step counts while the vehicle moves (> 1 m/s); tracks are cut
/// into courses of at most 8 s, so that "any collision" means the same on both sides, from their
/// ends backward, since a CBV's contact is the last that is known of it.
struct PooledOptions {
  double moving_speed = 1.0;         ///< slower steps do not count [m/s]
  std::size_t course_steps = 80;     ///< longest course
  std::size_t shortest_course = 20;  ///< what remains below, at a track's beginning, is dropped
};

/// Courses of the vehicles of one role (all where it is empty) in recordings. Features of the map
/// are empty.
std::vector<Course> pooledCourses(std::vector<Recording> recordings, const std::string& role,
                                  const PooledOptions& options = {});

/// Likelihood of each feature of the logged courses under the simulated ones. Absent where there is
/// nothing simulated or logged.
Likelihoods pooledLikelihoods(const std::vector<Course>& logged,
                              const std::vector<Course>& simulated);

/// Courses of recorded drivers of a site, and the same in two halves that share no vehicle,
/// whatever recordings it is in: vehicles in the order of their names (by length, then by letters,
/// so that numbers count up, as NGSIM's do with time) up to half of all states, and the others.
struct RecordedSite {
  std::vector<Course> all;
  std::vector<Course> halves[2];
  std::set<std::string> vehicles[2];  ///< of the halves, by name
};
std::map<std::string, RecordedSite> recordedSites(const std::vector<Recording>& recordings,
                                                  const PooledOptions& options = {});

/// The highest that can be expected: each half of the recordings under the other, the mean of both.
/// Absent features where a half is empty.
Likelihoods pooledCeiling(const RecordedSite& site);

/// Steps at which a feature has a value.
std::size_t countValues(const std::vector<Course>& courses, Feature feature);

/// Courses with a collision at any step.
std::size_t countCollided(const std::vector<Course>& courses);

/// One row of the comparison: who drove, and the likelihoods at each site.
struct PooledRow {
  std::string driver;
  std::size_t courses = 0;
  std::size_t steps = 0;                       ///< with a speed
  std::size_t collided = 0;                    ///< courses with a collision
  std::map<std::string, Likelihoods> at_site;  ///< by site
};

/// Simulated courses by driver, in the order of rows.
using PooledDrivers = std::vector<std::pair<std::string, std::vector<Course>>>;

/// The comparison of drivers with recorded traffic.
struct PooledResult {
  std::string headline;  ///< site of the table's first part
  std::map<std::string, RecordedSite> sites;
  std::vector<PooledRow> rows;  ///< the ceiling is the last
};

/// `headline`: a site, or empty: the signalized arterial "Lanker" where it is there, else the first
/// by name. Throws InputError for a site that is not there.
PooledResult comparePooled(const std::vector<Recording>& log, const PooledDrivers& drivers,
                           const std::string& headline);

}  // namespace cdiff::realism
