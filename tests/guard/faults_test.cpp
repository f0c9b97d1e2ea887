#include "skinctl/guard/faults.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "skinctl/testing/fault_injection.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("faults: each stands in the table once, with a reaction and a way back that fit") {
  std::set<Reason> seen;
  for (const Fault& f : faults) {
    CHECK(seen.insert(f.reason).second);
    CHECK(f.motion != Reaction::none);
    CHECK((f.motion == Reaction::stop) == (f.way_back == WayBack::on_request));
    CHECK(std::string(f.what).size() > 10);
  }
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
        CAPTURE(f.what);
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
