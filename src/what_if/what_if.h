// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "what_if/take_over.h"

namespace cdiff::what_if {

// "What if another driver had taken the ego over?": the question, its answer, and the files that
// keep it.

/// Shifts of the partner that the open answer is tried with as well [s].
inline constexpr std::array<double, 2> kShifts = {-0.5, 0.5};
/// Earliest take-over that is searched for, before the contact [s].
inline constexpr double kEarliest = 5.0;

/// When a driver takes over.
struct Question {
  std::optional<RecordedContact> contact;  ///< that is to be avoided; nullopt: `seconds` counts
  double seconds = 0.0;                    ///< time of the take-over, where no contact is named
  double before = 3.0;                     ///< time of the take-over before the contact [s]
  bool latest = true;                      ///< whether the latest take-over is searched for
};

/// What a driver comes to with everyone else as recorded (open) or answering to it (closed).
struct LoopAnswer {
  Course course;  ///< with the take-over that the question names
  /// Latest take-over that avoids, before the contact [s]; nullopt also where none was searched
  /// for.
  std::optional<double> latest;

  bool avoids() const { return !course.contact.has_value(); }
};

/// The answer to a question.
struct Answer {
  Question question;
  std::string driver;      ///< label of the driver
  double take_over = 0.0;  ///< time of the take-over [s]
  /// Earliest take-over that was tried, before the contact [s]; nullopt: none was searched for.
  std::optional<double> earliest;
  Course recorded;
  LoopAnswer open;
  LoopAnswer closed;
  std::vector<std::pair<double, bool>> shifted;  ///< (shift [s], whether the open answer avoids)
};

/// A contact by number, or what follows a time. Throws InputError for a number that the run does
/// not have, a time outside the session, and a take-over before the session's first tick.
Question questionOf(const RecordedRun& run, std::optional<std::size_t> contact,
                    std::optional<double> seconds, double before);

/// Answers; asks for a stop between runs. Throws as repeatRecorded does, and core::Interrupted when
/// it was stopped.
Answer answer(const RecordedRun& run, const session::SessionSetup& setup, const Driver& driver,
              const Question& question, const std::atomic<bool>& stop);

/// A sentence: "contact 1 (bg_55, 16.10 s): avoidable: careful_driver taking over 1.4 s before the
/// contact avoids it".
std::string answerText(const Answer& answer);

/// The row of a table of answers, and its head.
std::vector<std::string> answerCells(const Answer& answer);
const std::vector<std::string>& answerHead();

/// Name of the answer's files, without ending: "contact_1_careful_driver".
std::string answerName(const Answer& answer);

/// Writes NAME.json, NAME.html, NAME_open.csv and NAME_closed.csv into the folder `what_if` of the
/// run, and the answers that lie there into the run's report. Returns the page's path. Throws
/// InputError naming a file that cannot be written.
std::filesystem::path writeAnswer(const RecordedRun& run, const session::SessionSetup& setup,
                                  const Answer& answer);

}  // namespace cdiff::what_if
