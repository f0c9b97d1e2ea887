// SPDX-License-Identifier: BSD-3-Clause
// Requests from Linux a real-time priority and memory that is never paged out.
#pragma once

#include <string>

#include "skinctl/core/config.hpp"

#if defined(__linux__)
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#endif

SKINCTL_BEGIN_NAMESPACE

/// The granted requests, and a report of refusals with their remedy.
struct Scheduling {
  bool real_time = false;      ///< SCHED_FIFO for the calling thread
  bool memory_locked = false;  ///< all pages, present and future, stay in memory
  std::string report;          ///< line for each request, for the log
};

/// Requests SCHED_FIFO at `priority` (1 to 99; others are cut to that range) for the calling thread and locks
/// the process's memory. Threads that it starts later are ordinary ones: a writer of files must not displace
/// the loop. A refusal is not an error: the loop runs, with occasional delays, and `report` says so. Call
/// before the loop: it makes system calls and allocates.
inline Scheduling request_real_time(int priority = 80) {
  Scheduling got;
#if defined(__linux__)
  sched_param wanted{};
  const int low = sched_get_priority_min(SCHED_FIFO), high = sched_get_priority_max(SCHED_FIFO);
  wanted.sched_priority = priority < low ? low : priority > high ? high : priority;
  int policy = SCHED_FIFO;
#if defined(SCHED_RESET_ON_FORK)
  policy |= SCHED_RESET_ON_FORK;
#endif
  if (sched_setscheduler(0, policy, &wanted) == 0) {
    got.real_time = true;
    got.report = "real-time priority " + std::to_string(wanted.sched_priority) + " granted\n";
  } else {
    got.report = std::string("no real-time priority (") + std::strerror(errno) +
                 "): cycles may be late. Allow it with `ulimit -r`, /etc/security/limits.conf (rtprio) or "
                 "CAP_SYS_NICE\n";
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    got.memory_locked = true;
    got.report += "memory locked\n";
  } else {
    got.report += std::string("memory not locked (") + std::strerror(errno) +
                  "): a page fault may delay a cycle. Allow it with `ulimit -l unlimited` or CAP_IPC_LOCK\n";
  }
#else
  static_cast<void>(priority);
  got.report = "no real-time scheduling on this system: cycles may be late\n";
#endif
  return got;
}

SKINCTL_END_NAMESPACE
