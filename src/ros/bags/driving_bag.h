// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>

#include "collection/training_samples.h"
#include "diffusion/network/architecture.h"

namespace cdiff::ros {

// A drive of one vehicle, read from a bag of another recorder, whatever its topics are
// called.

/// Images are cut to the aspect of the architecture's and made as small; they should see some 90
/// degrees. Stamps are those of the headers. Throws InputError, without the file's name, for: a
/// topic that the bag lacks (and what it has), one of another type, a message that is broken or has
/// no orientation, a path in another frame, an encoding that is no color.
collection::RecordedDrive readDrivingBag(const std::filesystem::path& file,
                                         const collection::DriveOptions& options,
                                         const diffusion::Architecture& architecture);

}  // namespace cdiff::ros
