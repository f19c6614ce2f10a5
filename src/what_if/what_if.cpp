// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "what_if/what_if.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "page/html_report.h"
#include "record/result_folder.h"
#include "what_if/what_if_page.h"

namespace cdiff::what_if {
namespace {

/// How long after the recorded contact the driver must stay clear [s].
constexpr double kClear = 4.0;
/// How long a take-over without a recorded contact is followed [s].
constexpr double kFollowed = 8.0;

std::string contactList(const RecordedRun& run) {
  std::string text;
  for (const RecordedContact& contact : run.contacts()) {
    text += (text.empty() ? "" : ", ") + std::to_string(contact.number) + " (" + contact.partner +
            " at " + core::formatFixed(contact.seconds, 2) + " s)";
  }
  return text;
}

Question contactQuestion(const RecordedRun& run, std::size_t number, double before) {
  const std::string folder = "'" + run.folder().string() + "'";
  if (run.contacts().empty()) {
    throw core::InputError(folder +
                           " has no contact of the ego; give --at SECONDS for a take-over "
                           "at a time");
  }
  if (number < 1 || number > run.contacts().size()) {
    throw core::InputError("--contact " + std::to_string(number) + ": " + folder + " has " +
                           contactList(run) + "; expected one of these numbers");
  }
  const RecordedContact& contact = run.contacts()[number - 1];
  if (contact.seconds <= before) {
    throw core::InputError("--before " + core::formatNumber(before) + ": contact " +
                           std::to_string(number) + " of " + folder + " is at " +
                           core::formatFixed(contact.seconds, 2) +
                           " s; expected a take-over after the session's start");
  }
  return {contact, 0.0, before};
}

}  // namespace

Question questionOf(const RecordedRun& run, std::optional<std::size_t> contact,
                    std::optional<double> seconds, double before) {
  if (contact) return contactQuestion(run, *contact, before);
  const double end = static_cast<double>(run.lastTick()) * run.scenario().simulation_step;
  if (seconds && *seconds >= 0.0 && *seconds < end) return {std::nullopt, *seconds, 0.0};
  if (!seconds) {
    throw core::InputError("give --contact N, --at SECONDS or --all; '" + run.folder().string() +
                           "' has " +
                           (run.contacts().empty() ? "no contact of the ego" : contactList(run)));
  }
  throw core::InputError("--at " + core::formatNumber(*seconds) + ": '" + run.folder().string() +
                         "' lasts " + core::formatFixed(end, 2) +
                         " s; expected a time from 0 on before its end");
}

namespace {

/// One question, asked of one run and driver: plans take-overs and remembers what they came to.
class Inquiry {
 public:
  Inquiry(const RecordedRun& run, const session::SessionSetup& setup, const Driver& driver,
          const Question& question, const std::atomic<bool>& stop)
      : run_(run), setup_(setup), driver_(driver), question_(question), stop_(stop) {}

  Answer find() {
    const TakeOver asked = takeOver(question_.before);
    recorded_ = repeatRecorded(run_, setup_, asked);
    const double step = setup_.options().simulation_step;
    Answer answer{question_,
                  driver_.choice().label(),
                  std::round(static_cast<double>(asked.tick) * step * 1e9) / 1e9,
                  std::nullopt,
                  recorded_.course,
                  {open(asked, 0.0), std::nullopt},
                  {closed(asked), std::nullopt},
                  {}};
    for (const double shift : kShifts)
      answer.shifted.emplace_back(shift, !open(asked, shift).contact.has_value());
    if (!question_.contact || !question_.latest) return answer;
    answer.earliest = earliestSteps() * period();
    answer.open.latest = latest(answer.open, [&](const TakeOver& at) { return open(at, 0.0); });
    answer.closed.latest = latest(answer.closed, [&](const TakeOver& at) { return closed(at); });
    return answer;
  }

 private:
  double period() const { return setup_.options().decision_period; }

  /// The decision at or before that time before the contact.
  TakeOver takeOver(double before) const {
    const double step = setup_.options().simulation_step;
    const std::uint64_t every = setup_.ticksPerDecision();
    const auto& contact = question_.contact;
    const double seconds = contact ? contact->seconds - before : question_.seconds;
    const auto tick = static_cast<std::uint64_t>(std::max(0.0, std::floor(seconds / step + 1e-6)));
    const auto after =
        static_cast<std::uint64_t>(std::llround((contact ? kClear : kFollowed) / step));
    return {tick / every * every, (contact ? contact->tick : tick) + after,
            contact ? contact->partner : ""};
  }

  int earliestSteps() const {
    const double most = std::min(kEarliest, question_.contact->seconds);
    return std::max(1, static_cast<int>(std::floor(most / period() + 1e-6)));
  }

  void requireGoOn() const {
    if (stop_) throw core::Interrupted("interrupted; the answers so far are kept");
  }
  Course open(const TakeOver& at, double shift) const {
    requireGoOn();
    return driveOpen(run_, driver_, setup_, at, recorded_, shift);
  }
  Course closed(const TakeOver& at) const {
    requireGoOn();
    return driveClosed(run_, driver_, setup_, at);
  }

  std::optional<double> latest(const LoopAnswer& asked,
                               const std::function<Course(const TakeOver&)>& drive) const {
    const int known = static_cast<int>(std::lround(question_.before / period()));
    const auto found = latestAvoiding(earliestSteps(), [&](int steps) {
      return steps == known ? asked.avoids() : !drive(takeOver(steps * period())).contact;
    });
    if (found) return *found * period();
    return asked.avoids() ? std::optional<double>(question_.before) : std::nullopt;
  }

  const RecordedRun& run_;
  const session::SessionSetup& setup_;
  const Driver& driver_;
  Question question_;
  const std::atomic<bool>& stop_;
  RecordedCourse recorded_{{}, Course(0.05)};
};

}  // namespace

Answer answer(const RecordedRun& run, const session::SessionSetup& setup, const Driver& driver,
              const Question& question, const std::atomic<bool>& stop) {
  return Inquiry(run, setup, driver, question, stop).find();
}

namespace {

/// The meaning of the word in this package (docs/what_if.md): "avoidable: "; empty for other
/// drivers and times.
std::string avoidableText(const Answer& answer) {
  constexpr double kBefore = 3.0;  // [s]
  if (answer.driver != DriverChoice().planner || answer.question.before != kBefore) return "";
  return answer.closed.avoids() ? "avoidable: " : "not avoidable: ";
}

/// "taking over 1.4 s before the contact avoids it", and that the take-over that was asked for does
/// not, where one at another time does.
std::string latestText(const Answer& answer) {
  const LoopAnswer& loop = answer.closed;
  const std::string asked = core::formatNumber(answer.question.before) + " s before";
  if (!answer.earliest)
    return "taking over " + asked + (loop.avoids() ? " avoids it" : " does not avoid it");
  if (!loop.latest)
    return "does not avoid it, not even taking over " + core::formatFixed(*answer.earliest, 1) +
           " s before";
  const std::string text =
      "taking over " + core::formatFixed(*loop.latest, 1) + " s before the contact avoids it";
  return loop.avoids() ? text : text + ", taking over " + asked + " does not";
}

/// "1.4 s before", or whether the take-over that was asked for avoids it.
std::string openText(const LoopAnswer& open) {
  if (open.latest) return core::formatFixed(*open.latest, 1) + " s before";
  return open.avoids() ? "it avoids it" : "it does not";
}

/// "clear for 8 s", "contact with a at 3.20 s".
std::string courseText(const Course& course) {
  if (!course.contact) return "no contact";
  return "contact with " + course.contact->partner + " at " +
         core::formatFixed(course.contact->seconds, 2) + " s";
}

std::string yesNo(bool yes) { return yes ? "yes" : "no"; }

std::string secondsText(const std::optional<double>& seconds) {
  return seconds ? core::formatFixed(*seconds, 1) : "";
}

}  // namespace

std::string answerText(const Answer& answer) {
  const auto& contact = answer.question.contact;
  if (!contact) {
    return answer.driver + " taking over at " + core::formatFixed(answer.take_over, 2) +
           " s: " + courseText(answer.closed.course) +
           "; others as recorded: " + courseText(answer.open.course);
  }
  return "contact " + std::to_string(contact->number) + " (" + contact->partner + ", " +
         core::formatFixed(contact->seconds, 2) + " s): " + avoidableText(answer) + answer.driver +
         " " + latestText(answer) + "; others as recorded: " + openText(answer.open);
}

const std::vector<std::string>& answerHead() {
  static const std::vector<std::string> head = {"contact",       "seconds",         "with",
                                                "ego_side",      "driver",          "before_s",
                                                "closed_avoids", "closed_latest_s", "open_avoids",
                                                "open_latest_s", "earlier_avoids",  "later_avoids"};
  return head;
}

std::vector<std::string> answerCells(const Answer& answer) {
  const RecordedContact contact = answer.question.contact.value_or(RecordedContact());
  std::vector<std::string> cells = {std::to_string(contact.number),
                                    core::formatFixed(contact.seconds, 2),
                                    contact.partner,
                                    contact.ego_side,
                                    answer.driver,
                                    core::formatNumber(answer.question.before),
                                    yesNo(answer.closed.avoids()),
                                    secondsText(answer.closed.latest),
                                    yesNo(answer.open.avoids()),
                                    secondsText(answer.open.latest)};
  for (const auto& [shift, avoids] : answer.shifted) cells.push_back(yesNo(avoids));
  return cells;
}

std::string answerName(const Answer& answer) {
  const auto& contact = answer.question.contact;
  const std::string when = contact ? "contact_" + std::to_string(contact->number)
                                   : "at_" + core::formatFixed(answer.take_over, 2);
  return core::fileName(when + "_" + answer.driver);
}

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kFolder = record::kWhatIfFolder;

Json loopJson(const LoopAnswer& loop, const std::optional<double>& earliest) {
  Json json = {{"avoids", loop.avoids()}, {"contact", nullptr}};
  if (const auto& contact = loop.course.contact) {
    json["contact"] = {{"seconds", contact->seconds},
                       {"with", contact->partner},
                       {"ego_side", contact->ego_side},
                       {"ego_speed_mps", contact->ego_speed}};
  }
  json["struck_behind"] = loop.course.struck_behind;
  if (!earliest) return json;
  json["latest_take_over_s"] = loop.latest ? Json(*loop.latest) : Json(nullptr);
  return json;
}

Json answerJson(const RecordedRun& run, const Answer& answer) {
  Json json = {{"schema_version", 1},
               {"trace_sha256", run.traceSha256()},
               {"driver", answer.driver},
               {"take_over_seconds", answer.take_over},
               {"text", answerText(answer)}};
  if (const auto& contact = answer.question.contact) {
    json["contact"] = {{"number", contact->number},
                       {"seconds", contact->seconds},
                       {"with", contact->partner},
                       {"ego_side", contact->ego_side}};
    json["before_s"] = answer.question.before;
    if (answer.earliest) json["earliest_take_over_s"] = *answer.earliest;
  }
  json["closed"] = loopJson(answer.closed, answer.earliest);
  json["open"] = loopJson(answer.open, answer.earliest);
  json["open_shifted"] = Json::array();
  for (const auto& [shift, avoids] : answer.shifted)
    json["open_shifted"].push_back({{"shift_s", shift}, {"avoids", avoids}});
  return json;
}

/// Sentence by page of the answers that the folder holds for this trace.
std::map<std::string, std::string> answersOf(const RecordedRun& run, const fs::path& folder) {
  std::map<std::string, std::string> answers;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const Json json = Json::parse(core::readFile(entry.path(), "answer"), nullptr, false);
    if (!json.is_object() || json.value("trace_sha256", "") != run.traceSha256()) continue;
    answers[std::string(kFolder) + "/" + entry.path().stem().string() + ".html"] =
        json.value("text", "");
  }
  return answers;
}

/// The report with the answers in it; as it was where it is no longer the program's own.
void updateReport(const RecordedRun& run, const fs::path& folder) {
  const fs::path file = run.folder() / "report.html";
  if (!core::isFile(file)) return;
  const auto page = page::withWhatIf(core::readFile(file, "report"), answersOf(run, folder));
  if (page) core::writeOwnFile(file, *page);
}

}  // namespace

fs::path writeAnswer(const RecordedRun& run, const session::SessionSetup& setup,
                     const Answer& answer) {
  core::OutputFolder result(run.folder());
  core::OutputFolder folder(result.subfolder(kFolder));
  const std::string name = answerName(answer);
  folder.write(name + ".json", answerJson(run, answer).dump(2) + "\n");
  folder.write(name + "_open.csv", answer.open.course.trace);
  folder.write(name + "_closed.csv", answer.closed.course.trace);
  folder.write(name + ".html", whatIfPage(setup, answer));
  updateReport(run, folder.path());
  return folder.path() / (name + ".html");
}

}  // namespace cdiff::what_if
