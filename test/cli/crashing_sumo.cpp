// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Takes the place of one call of libsumo for the tests (LD_PRELOAD): it crashes in the middle of a
/// session.
#include <dlfcn.h>
#include <libsumo/Vehicle.h>

#include <csignal>

void libsumo::Vehicle::setSpeed(const std::string& id, double speed) {
  using Call = void (*)(const std::string&, double);
  static void* const library = ::dlopen("libsumocpp.so", RTLD_NOW | RTLD_NOLOAD);
  static const auto original = reinterpret_cast<Call>(
      ::dlsym(library,
              "_ZN7libsumo7Vehicle8setSpeedERKNSt7__cxx1112basic_stringIcSt11char_"
              "traitsIcESaIcEEEd"));
  constexpr int kCallsBefore = 100;  // more than 30 ticks of at most three vehicles
  static int calls = 0;
  if (++calls > kCallsBefore) std::raise(SIGSEGV);
  original(id, speed);
}
