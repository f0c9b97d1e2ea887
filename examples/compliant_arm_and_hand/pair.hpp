// Two jobs in one process, each with its own loop at its own rate; when one ends badly both stop.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <string>
#include <thread>
#include <utility>

#include "examples/support/job.hpp"

namespace arm_and_hand {

using examples::job::Exit;

/// How one of the two ended.
struct End {
  Exit exit = Exit::fine;
  std::string words;                ///< of an exception
  bool stopped_with_other = false;  ///< it was stopped because the other one had ended badly
  int order = 0;                    ///< 1: it ended first
};

struct Pair {
  End arm, hand;
  /// Of the one that ended badly first: a hand that is lost makes the arm blind, too. One that was stopped
  /// because of the other is not the reason.
  [[nodiscard]] Exit exit() const noexcept {
    const auto reason = [](const End& e) { return e.exit != Exit::fine && !e.stopped_with_other; };
    if (reason(arm) && reason(hand)) return arm.order < hand.order ? arm.exit : hand.exit;
    if (reason(arm)) return arm.exit;
    if (reason(hand)) return hand.exit;
    return arm.exit != Exit::fine ? arm.exit : hand.exit;
  }
};

/// Runs `arm(stop)` and `hand(stop)`, each on a thread of its own; each gives an exit and stops its device by
/// itself when its flag is set. `asked` stops both; so does the end of one that is not `fine`. A job that is
/// done well leaves the other one to its work.
template <class Arm, class Hand>
Pair run_both(Arm&& arm, Hand&& hand, const std::atomic<bool>& asked) {
  Pair out;
  std::atomic<bool> stop{false};
  std::atomic<int> ended{0}, order{0};
  std::atomic<bool> failed{false};
  const auto one = [&](auto& job, End& end) {
    try {
      end.exit = job(stop);
    } catch (const std::exception& e) {
      end.exit = Exit::lost;
      end.words = e.what();
    }
    const bool interrupted = end.exit == Exit::interrupted;
    end.order = ++order;
    end.stopped_with_other = interrupted && failed;
    if (end.exit != Exit::fine && !interrupted) failed = true;
    if (end.exit != Exit::fine) stop = true;
    ++ended;
  };
  std::thread arm_thread([&] { one(arm, out.arm); }), hand_thread([&] { one(hand, out.hand); });
  while (ended < 2) {
    if (asked) stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  arm_thread.join();
  hand_thread.join();
  return out;
}

}  // namespace arm_and_hand
