// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>

#include "collection/drive_samples.h"
#include "diffusion/network/architecture.h"

namespace cdiff::node_graph {

/// Reads the drive of one vehicle from a bag that another system recorded, whatever its topics are
/// called (the names are in `options`); for `cdiff collect`. Images are cropped to the aspect ratio
/// of the architecture's and scaled down to their size; their field of view should be about 90
/// degrees. Times are the stamps of the headers. Throws InputError, without the file's name, for a
/// topic that the bag lacks (and which it has) or that has another type, a message that is broken
/// or has no orientation, a path in another frame, and an image encoding that is not a color
/// format.
collection::RecordedDrive readDrivingBag(const std::filesystem::path& file,
                                         const collection::DriveOptions& options,
                                         const diffusion::Architecture& architecture);

}  // namespace cdiff::node_graph
