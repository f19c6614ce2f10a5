// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
//
// To be preloaded: this process sees caches of FAKE_L1_KIB and FAKE_L2_KIB, through the CPUID
// faulting of Intel's processors (arch_prctl, ARCH_SET_CPUID). Where that is missing nothing is
// changed. Linked with -z initfirst, since oneDNN asks while it is loaded.
#include <asm/prctl.h>
#include <cpuid.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace {

bool allowCpuid(bool on) { return ::syscall(SYS_arch_prctl, ARCH_SET_CPUID, on ? 1 : 0) == 0; }

unsigned kibibytes(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? 0 : static_cast<unsigned>(std::atoi(text));
}

/// Leaf 4, the caches one after another: ecx is the number of sets less one.
void fake(unsigned eax, unsigned ebx, unsigned& ecx) {
  const unsigned type = eax & 31U;
  const unsigned level = (eax >> 5U) & 7U;
  const bool data = type == 1 || type == 3;
  const unsigned size =
      !data || level > 2 ? 0 : kibibytes(level == 1 ? "FAKE_L1_KIB" : "FAKE_L2_KIB");
  const unsigned bytes_a_set =
      ((ebx >> 22U) + 1) * (((ebx >> 12U) & 1023U) + 1) * ((ebx & 4095U) + 1);
  if (size != 0) ecx = size * 1024 / bytes_a_set - 1;
}

void answerCpuid(int signal, siginfo_t* /*about*/, void* state) {
  greg_t* registers = static_cast<ucontext_t*>(state)->uc_mcontext.gregs;
  const auto* code = reinterpret_cast<const unsigned char*>(registers[REG_RIP]);
  if (code[0] != 0x0F || code[1] != 0xA2) {  // no cpuid: a fault like any other
    std::signal(signal, SIG_DFL);
    return;
  }
  unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
  allowCpuid(true);
  __cpuid_count(static_cast<unsigned>(registers[REG_RAX]),
                static_cast<unsigned>(registers[REG_RCX]), eax, ebx, ecx, edx);
  allowCpuid(false);
  if (registers[REG_RAX] == 4) fake(eax, ebx, ecx);
  registers[REG_RAX] = eax;
  registers[REG_RBX] = ebx;
  registers[REG_RCX] = ecx;
  registers[REG_RDX] = edx;
  registers[REG_RIP] += 2;
}

__attribute__((constructor)) void start() {
  struct sigaction action = {};
  action.sa_sigaction = answerCpuid;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  ::sigaction(SIGSEGV, &action, nullptr);
  if (!allowCpuid(false)) std::signal(SIGSEGV, SIG_DFL);
}

}  // namespace
