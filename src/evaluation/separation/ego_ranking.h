// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/intervals/intervals.h"
#include "evaluation/separation/contact_kind.h"

namespace cdiff::evaluation {

// How well a test tells good egos from bad (docs/evaluation.md, "Ego ranking"): contacts per km and
// per minute of each ego with 95 % intervals, their order, and what each ego fails at.

/// One session of an ego.
struct EgoRun {
  std::string ego;      ///< its name in the ranking
  std::string setting;  ///< what it was tested in: "challenging, CBVs diffusion"
  std::string scenario;
  std::string seed;
  std::string report;             ///< address of its report from the folder of the ranking
  double kilometers = 0.0;        ///< driven by the ego
  double minutes = 0.0;           ///< simulated
  double standing_minutes = 0.0;  ///< of these at less than 0.1 m/s
  double completion_percent = 0.0;
  double driving_score = 0.0;
  std::size_t near_misses = 0;  ///< measure ego_near_misses
  std::size_t challenges = 0;   ///< decisions of CBVs in mode challenging
  std::size_t withdrawn = 0;    ///< of these, without an attack that could be answered
  /// A contact of the ego.
  struct Contact {
    double seconds = 0.0;
    TracedContact traced;
    bool standing = false;  ///< the ego stood
    /// What `cdiff what_if` found, by driver: avoided with the others answering to it, with the
    /// others as recorded, and that also with the partner shifted.
    std::map<std::string, std::array<bool, 3>> avoided;
  };
  std::vector<Contact> contacts;
};

/// Complete runs of a batch (matrix.yaml), or of a folder of sessions, each in a folder of its own;
/// egos of sessions are named after that folder. `base`: where the ranking will lie. Throws
/// InputError naming a folder without either, and a damaged file.
std::vector<EgoRun> readEgoRuns(const std::filesystem::path& folder,
                                const std::filesystem::path& base);

/// How many of an ego's contacts a driver avoids.
struct AvoidedShare {
  std::array<std::size_t, 3> avoided = {};  ///< as in EgoRun::Contact
  std::size_t asked = 0;
};

/// What one ego did in one setting.
struct EgoFigures {
  std::string ego;
  std::size_t runs = 0;
  double kilometers = 0.0;
  double minutes = 0.0;
  std::size_t contacts = 0;
  double per_km = 0.0;
  double per_minute = 0.0;
  Interval per_km_interval;      ///< Poisson; from kLeastRoutes on wider where the bootstrap is
  Interval per_minute_interval;  ///< likewise
  std::map<ContactKind, std::size_t> kinds;
  std::map<ContactKind, const EgoRun*> worst;   ///< with the fastest impact of that kind
  std::map<ContactKind, double> worst_speed;    ///< of that impact [m/s]
  std::map<ContactKind, double> worst_seconds;  ///< when it was [s]
  std::size_t standing = 0;                     ///< contacts with the ego standing
  std::size_t slow = 0;                         ///< contacts with a partner slower than 1 m/s
  std::size_t near_misses = 0;
  std::optional<double> withdrawn_percent;  ///< of the CBVs' decisions in mode challenging
  double standing_percent = 0.0;            ///< of its time
  double completion_percent = 0.0;
  double driving_score = 0.0;
  std::map<std::string, AvoidedShare> avoided;  ///< by driver
};

/// The egos of one setting, fewest contacts per km first.
struct EgoRanking {
  std::string setting;
  std::vector<EgoFigures> egos;
  /// Rank correlation of the egos' rates on odd and on even seeds; absent below three egos, or
  /// where one half is missing or all rates are equal.
  std::optional<double> odd_even;
  /// Rate of the ego with constant speed minus that of the careful driver [1/km], where both are.
  std::optional<double> separation;
  std::optional<Interval> separation_interval;  ///< bootstrap by routes; from kLeastRoutes on
  /// Probability that a session of the former has more contacts than one of the latter.
  std::optional<double> area_under_curve;
  std::vector<std::string> remarks;  ///< on the order of the reference family
};

/// Names of the egos of known quality, best first.
inline constexpr std::array<const char*, 5> kReferenceFamily = {
    "careful", "careful_half_second_late", "careful_second_late", "careful_weak_brakes",
    "constant_speed"};

/// One ranking for each setting, in order of appearance. `runs` must outlive them.
std::vector<EgoRanking> rankEgos(const std::vector<EgoRun>& runs);

// The rankings as files and text.

/// Ranks the egos of all folders and writes ego_ranking.csv and ego_ranking.html into the first;
/// returns the tables for a terminal. Throws as readEgoRuns does, and InputError naming a file that
/// cannot be written.
std::string writeEgoRanking(const std::vector<std::filesystem::path>& folders,
                            const std::string& name);

/// A row per setting and ego.
std::string rankingCsv(const std::vector<EgoRanking>& rankings);
/// Tables for a terminal.
std::string rankingMarkdown(const std::vector<EgoRanking>& rankings);
/// The page "ego ranking": bars with intervals, order, what each ego fails at with a link to its
/// worst case.
std::string rankingPage(const std::string& name, const std::vector<EgoRanking>& rankings);

}  // namespace cdiff::evaluation
