// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/pooled_realism.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "realism/recording.h"

namespace cdiff::realism {
namespace {

constexpr const char* kDefaultSite = "Lanker";
constexpr const char* kCeiling =
    "recorded drivers, one half of the vehicles against the other (ceiling)";

/// Only steps at which the vehicle moves.
void keepMoving(double moving_speed, Course& course) {
  const Series speed = course[kLinearSpeed];
  for (Series& values : course) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(speed[i] > moving_speed)) values[i] = kNoValue;
    }
  }
}

bool hasValue(const Series& values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return !std::isnan(value); });
}

/// The courses that a track is cut into, the last first.
void addCourses(const Recording& recording, const std::vector<Motion>& motions, std::size_t track,
                const PooledOptions& options, std::vector<Course>& courses) {
  const Track& self = recording.tracks[track];
  if (self.states.size() < kSmoothingWindow) return;
  std::size_t begin = self.end();
  for (std::size_t end = begin; end > self.first; end = begin) {
    begin = end - std::min(options.course_steps, end - self.first);
    if (end - begin < options.shortest_course) return;
    Course course = courseOf(recording, motions, track, begin, end);
    keepMoving(options.moving_speed, course);
    if (hasValue(course[kLinearSpeed])) courses.push_back(std::move(course));
  }
}

/// Courses of the tracks that `wanted` is true of. The headings of all become those of their
/// motion.
template <class Wanted>
void addRecording(Recording recording, const PooledOptions& options, const Wanted& wanted,
                  std::vector<Course>& courses) {
  std::vector<Motion> motions;
  for (Track& track : recording.tracks) motions.push_back(smoothedMotion(track));
  for (std::size_t i = 0; i < recording.tracks.size(); ++i) {
    if (wanted(recording.tracks[i])) addCourses(recording, motions, i, options, courses);
  }
}

/// Puts numbers in order: 99 before 100.
struct ByNumber {
  bool operator()(const std::string& left, const std::string& right) const {
    return left.size() != right.size() ? left.size() < right.size() : left < right;
  }
};

/// Names of a site's vehicles in two halves of about as many states.
void halveVehicles(const std::vector<const Recording*>& recordings, RecordedSite& site) {
  std::map<std::string, std::size_t, ByNumber> states;  // by vehicle
  std::size_t all = 0;
  for (const Recording* recording : recordings) {
    for (const Track& track : recording->tracks) {
      states[track.id] += track.states.size();
      all += track.states.size();
    }
  }
  std::size_t before = 0;
  for (const auto& [vehicle, count] : states) {
    site.vehicles[2 * before < all ? 0 : 1].insert(vehicle);
    before += count;
  }
}

double indicatorOf(const Course& course, std::size_t feature) {
  return anyStep(course[feature], course[feature]) ? 1.0 : 0.0;
}

/// Values of a feature: those of all steps, or one for each course.
template <class Take>
void forEachValue(const std::vector<Course>& courses, std::size_t feature, Take take) {
  for (const Course& course : courses) {
    if (!hasValue(course[feature])) continue;
    if (featureDefinitions()[feature].indicator) {
      take(indicatorOf(course, feature));
      continue;
    }
    for (const double value : course[feature]) {
      if (!std::isnan(value)) take(value);
    }
  }
}

std::string headlineOf(const std::map<std::string, RecordedSite>& sites,
                       const std::string& wanted) {
  if (wanted.empty()) return sites.count(kDefaultSite) > 0 ? kDefaultSite : sites.begin()->first;
  if (sites.count(wanted) > 0) return wanted;
  std::vector<std::string> names;
  for (const auto& [name, site] : sites) names.push_back(name);
  throw core::InputError("--site '" + wanted + "' is not in the log" +
                         core::didYouMean(wanted, names) +
                         "; its sites: " + core::joinText(names, ", "));
}

}  // namespace

std::vector<Course> pooledCourses(std::vector<Recording> recordings, const std::string& role,
                                  const PooledOptions& options) {
  std::vector<Course> courses;
  for (Recording& recording : recordings) {
    addRecording(
        std::move(recording), options,
        [&](const Track& track) { return role.empty() || track.role == role; }, courses);
  }
  return courses;
}

Likelihoods pooledLikelihoods(const std::vector<Course>& logged,
                              const std::vector<Course>& simulated) {
  Likelihoods likelihoods;
  for (std::size_t i = 0; i < kFeatures; ++i) {
    Histogram histogram(featureDefinitions()[i]);
    forEachValue(simulated, i, [&](double value) { histogram.add(value); });
    if (histogram.samples() == 0) continue;
    LikelihoodSum sum;
    forEachValue(logged, i, [&](double value) { sum.add(histogram.logProbability(value)); });
    likelihoods[i] = sum.likelihood();
  }
  return likelihoods;
}

std::map<std::string, RecordedSite> recordedSites(const std::vector<Recording>& recordings,
                                                  const PooledOptions& options) {
  std::map<std::string, std::vector<const Recording*>> recordings_at;
  for (const Recording& recording : recordings) recordings_at[recording.site].push_back(&recording);
  std::map<std::string, RecordedSite> sites;
  for (const auto& [name, own] : recordings_at) {
    RecordedSite& site = sites[name];
    halveVehicles(own, site);
    for (std::size_t half = 0; half < std::size(site.halves); ++half) {
      const auto in_half = [&](const Track& track) {
        return site.vehicles[half].count(track.id) != 0;
      };
      for (const Recording* recording : own)
        addRecording(*recording, options, in_half, site.halves[half]);
      site.all.insert(site.all.end(), site.halves[half].begin(), site.halves[half].end());
    }
  }
  return sites;
}

Likelihoods pooledCeiling(const RecordedSite& site) {
  return meanOf({pooledLikelihoods(site.halves[0], site.halves[1]),
                 pooledLikelihoods(site.halves[1], site.halves[0])});
}

std::size_t countValues(const std::vector<Course>& courses, Feature feature) {
  std::size_t count = 0;
  forEachValue(courses, feature, [&](double) { ++count; });
  return count;
}

std::size_t countCollided(const std::vector<Course>& courses) {
  return static_cast<std::size_t>(
      std::count_if(courses.begin(), courses.end(),
                    [](const Course& course) { return indicatorOf(course, kCollision) == 1.0; }));
}

PooledResult comparePooled(const std::vector<Recording>& log, const PooledDrivers& drivers,
                           const std::string& headline) {
  PooledResult result;
  result.sites = recordedSites(log);
  if (result.sites.empty()) throw core::InputError("the log holds no recording");
  result.headline = headlineOf(result.sites, headline);
  for (const auto& [driver, courses] : drivers) {
    PooledRow row{
        driver, courses.size(), countValues(courses, kLinearSpeed), countCollided(courses), {}};
    for (const auto& [name, site] : result.sites)
      row.at_site[name] = pooledLikelihoods(site.all, courses);
    result.rows.push_back(row);
  }
  const RecordedSite& recorded = result.sites.at(result.headline);
  PooledRow ceiling{kCeiling,
                    recorded.all.size(),
                    countValues(recorded.all, kLinearSpeed),
                    countCollided(recorded.all),
                    {}};
  for (const auto& [name, site] : result.sites) ceiling.at_site[name] = pooledCeiling(site);
  result.rows.push_back(ceiling);
  return result;
}

}  // namespace cdiff::realism
