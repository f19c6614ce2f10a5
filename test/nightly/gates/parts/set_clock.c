// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Preloaded: the time of day is that of the machine plus the seconds in the file $CDIFF_CLOCK_OFFSET.
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static double offset(void) {
  const char* path = getenv("CDIFF_CLOCK_OFFSET");
  FILE* file = path ? fopen(path, "r") : NULL;
  double seconds = 0.0;
  if (file && fscanf(file, "%lf", &seconds) != 1) seconds = 0.0;
  if (file) fclose(file);
  return seconds;
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  const long failed = syscall(SYS_clock_gettime, clock, now);
  if (failed || clock != CLOCK_REALTIME) return (int)failed;
  const double seconds = offset();
  const long long whole = (long long)seconds;
  long long nanoseconds = now->tv_nsec + (long long)((seconds - (double)whole) * 1e9);
  now->tv_sec += whole + (nanoseconds < 0 ? -1 : nanoseconds / 1000000000);
  now->tv_nsec = (nanoseconds + 1000000000) % 1000000000;
  return 0;
}

int gettimeofday(struct timeval* now, void* zone) {
  struct timespec time;
  (void)zone;
  if (clock_gettime(CLOCK_REALTIME, &time)) return -1;
  now->tv_sec = time.tv_sec;
  now->tv_usec = time.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* now) {
  struct timespec read;
  if (clock_gettime(CLOCK_REALTIME, &read)) return -1;
  if (now) *now = read.tv_sec;
  return read.tv_sec;
}
