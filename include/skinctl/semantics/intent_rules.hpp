// SPDX-License-Identifier: BSD-3-Clause
// Activities as the person means them: the rules, with pauses and with what a tool does in one place.
#pragma once

#include "skinctl/semantics/rules.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Numbers of `IntentRules`.
struct IntentSettings {
  double pause_holding = 0.2;  ///< a hand that holds something and stands for less is on its way still [s]
  double pause_empty = 0.4;    ///< longest pause of an empty hand [s]
  double about = 0.1;          ///< a tool at work stays so near to where it was slow last [m]
  double near = 0.25;          ///< another object is nearer to a tool at work than this [m]
  double brought = 0.2;        ///< a tool at work is further than this from where it was taken [m]
};

/// What a person means by what the hand does: `Rules` say what it does now.
///
/// | | `Rules` | `IntentRules` |
/// |---|---|---|
/// | a hand that stops on its way | idle, hold | reach, put, until it has stood for a pause |
/// | a tool that moves near another object | use | use while it stays about a place; put where it comes or goes |
///
/// A pause is one only in a motion that began after contact, squeezing or leaving last changed. Whoever says
/// by a definition what holds (`moving`: faster than 0.03 m/s) takes `Rules`.
class IntentRules {
 public:
  IntentRules() noexcept = default;
  /// Throws `ConfigurationError` for a number that is not in [0, 10].
  SKINCTL_COLD explicit IntentRules(const IntentSettings& s) : s_(s) {
    const auto number = [](double x, const char* name) { require(x >= 0 && x <= 10, name, x, "0 to 10"); };
    number(s.pause_holding, "IntentRules: pause_holding");
    number(s.pause_empty, "IntentRules: pause_empty");
    number(s.about, "IntentRules: about");
    number(s.near, "IntentRules: near");
    number(s.brought, "IntentRules: brought");
  }
  [[nodiscard]] constexpr Activity operator()(const Features& f) const noexcept {
    if (!f.known) return Activity::unknown;
    if (f.in_hand) {
      if (f.squeezed) return Activity::squeeze;
      const bool at_work = f.wields && f.near_distance < s_.near && f.moved > s_.brought;
      if (f.moving) return at_work && f.way < s_.about ? Activity::use : Activity::put;
      if (!f.carried) return Activity::take;
      return f.paused && f.stood < s_.pause_holding && !at_work ? Activity::put : Activity::hold;
    }
    if (!f.left) return Activity::release;
    return f.moving || (f.paused && f.stood < s_.pause_empty) ? Activity::reach : Activity::idle;
  }

 private:
  IntentSettings s_{};
};

SKINCTL_END_NAMESPACE
