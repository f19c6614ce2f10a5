// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Times [s] and floating-point operations of the two networks of the planner on one core.
#pragma once

#include <cstddef>
#include <vector>

#include "diffusion/network/cpu_denoiser.h"
#include "inference/precision.h"

namespace cdiff::benchmark {

/// Of one image each, ascending.
std::vector<double> encoderTimes(const diffusion::Model& model, inference::Precision precision);
/// Two per multiply-add of convolutions and projection; zeros at the border count.
double encoderOperations(const diffusion::Architecture& sizes);

struct DenoiserTimes {
  double forward = 0.0;  ///< [s]
  double both = 0.0;     ///< [s], with the backward pass
};

/// Of a batch of `samples`, medians over the diffusion steps.
DenoiserTimes denoiserTimes(diffusion::CpuDenoiser& denoiser, std::size_t samples);
/// Of the U-Net's convolutions for one sample; its backward pass has as many.
double unetOperations(const diffusion::Model& model);

}  // namespace cdiff::benchmark
