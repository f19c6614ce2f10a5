// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "record/result_folder.h"

namespace cdiff::evaluation {

/// How the other vehicle came to a contact with the ego, by the angle of its heading to the ego's
/// one second before.
enum class ContactKind {
  kCutIn,      ///< within 30 degrees, out of the ego's way at some time in the last 3 s
  kMerge,      ///< 30 to 60 degrees
  kCrossing,   ///< 60 to 120 degrees
  kOncoming,   ///< beyond 120 degrees
  kLead,       ///< within 30 degrees, in the ego's way all the time
  kFromBehind  ///< it touched the ego's rear
};

/// In the order of tables.
inline constexpr std::array<ContactKind, 6> kContactKinds = {
    ContactKind::kCutIn,    ContactKind::kMerge, ContactKind::kCrossing,
    ContactKind::kOncoming, ContactKind::kLead,  ContactKind::kFromBehind};

/// "cut_in", "merge", "crossing", "oncoming", "lead" or "from_behind".
const char* toText(ContactKind kind);

/// A contact of the ego as a trace shows it.
struct TracedContact {
  ContactKind kind = ContactKind::kLead;
  double impact_speed = 0.0;   ///< of the two relative to each other, at the tick before [m/s]
  double partner_speed = 0.0;  ///< then [m/s]
  bool with_cbv = false;       ///< whether a CBV touched it
};

/// `tick`: first tick with overlap; `partner`: id of the other; `ego_side`: side of the ego that
/// was touched; `step`: time between ticks [s]. Throws InputError where the trace lacks one of the
/// two.
TracedContact traceContact(const std::vector<record::TraceRow>& trace, std::uint64_t tick,
                           const std::string& partner, const std::string& ego_side, double step);

}  // namespace cdiff::evaluation
