// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// Numbers of contacts of the ego in one or more complete runs, by partner and by its own motion.
struct ContactCounts {
  double all = 0.0;        ///< with anyone
  double with_cbvs = 0.0;  ///< of these, with CBVs
  double standing = 0.0;   ///< of all, with the ego standing

  double withBackground() const { return all - with_cbvs; }
  double moving() const { return all - standing; }
  ContactCounts& operator+=(const ContactCounts& other);
};

/// Of a run; a count that its record does not have is 0.
ContactCounts contactCountsOf(const RunRecord& record);

/// "2 with CBVs + 1 with background, 1 with the ego standing"; of no contact "".
std::string kindsText(const ContactCounts& counts);

}  // namespace cdiff::evaluation
