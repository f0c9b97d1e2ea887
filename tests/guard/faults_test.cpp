// Promise: every fault has a reason, a reaction and a way back; a stop waits for your `resume`
// Tried: one table; 100 280 faults put into ten skills, also as they change, by position, velocity and
// torque: no command outside a limit, none not finite, no step above the bound. Also: study
// `fault_injection`

#include "skinctl/guard/faults.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "bench/studies/worlds/fault_injection.hpp"

using namespace skinctl;
using namespace skinctl::testing;

// Who says what the guard must do: a row that moves from one stage to another must not change it silently.
static_assert(detail::guard_brakes_on ==
              (Status(Reason::packets_lost) | Reason::budget_overrun | Reason::contact_force |
               Reason::contact_power | Reason::skin_held | Reason::skin_stopped));
static_assert(detail::guard_waits_after == (Status(Reason::budget_overrun) | Reason::contact_force |
                                            Reason::contact_power | Reason::skin_stopped));

TEST_CASE("faults: each reason has a reaction and a way back that fit, and a text of its own") {
  std::set<std::string> texts, names;
  for (const Fault& f : faults) {
    CAPTURE(f.name);
    CHECK(f.motion != Reaction::none);
    CHECK((f.motion == Reaction::stop) == (f.way_back == WayBack::on_request));
    CHECK((f.torque == Reaction::none || (f.torque == Reaction::stop) == (f.motion == Reaction::stop)));
    CHECK(f.torque != Reaction::brake);  // by torque nothing brakes at once
    CHECK(std::string(f.text).size() > 10);
    CHECK(texts.insert(f.text).second);
    CHECK(names.insert(f.name).second);
    CHECK(describe(f.reason) == std::string(f.text));
    CHECK(name(f.reason) == std::string(f.name));
  }
  CHECK(describe(static_cast<Reason>(255)) == std::string("unknown"));
  CHECK(name(static_cast<Reason>(255)) == std::string("unknown"));
  CHECK(std::string(name(Reaction::brake)) == "brake");
  CHECK(std::string(name(WayBack::on_request)) == "on request");
  CHECK(std::string(name(FaultFinder::loop)) == "loop");
  CHECK(std::string(name(Reaction(200))) == "unknown");
}

namespace {
template <Interface I>
void put_in() {
  FaultInjection<I> injection;
  for (const Fault& f : faults) {
    if (!injection.possible(f)) continue;
    for (std::uint8_t skill = 0; skill < injection.skills; ++skill)
      for (std::uint64_t seed = 1; seed <= (sanitized ? 1 : 2); ++seed) {
        const auto run = injection.run(f, skill, seed);
        CAPTURE(f.text);
        CAPTURE(injection.name(skill));
        CAPTURE(seed);
        CAPTURE(run.wrong);
        CAPTURE(run.worst_step);
        CHECK(run.good());
      }
  }
}
}  // namespace

// A part of bench/studies/fault_injection.cpp; under sanitizers one interface and one skill: each takes them
// long to compile.
TEST_CASE(
    "faults: whenever one comes, whatever skill it meets, it is reported, answered as the table says, and "
    "ends as it says") {
  put_in<Interface::torque>();
  if constexpr (!sanitized) put_in<Interface::position>();
}
