#include "skinctl/safety/faults.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "tests/support/fault_injection.hpp"

using namespace skinctl;
using namespace skinctl::test;

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
  CHECK(std::string(name(Finder::loop)) == "loop");
  CHECK(std::string(name(Reaction(200))) == "unknown");
}

TEST_CASE_TEMPLATE(
    "faults: whenever one comes, it is reported, answered as the table says, and ends as it says", I,
    std::integral_constant<Interface, Interface::position>,
    std::integral_constant<Interface, Interface::torque>) {
  FaultInjection<I::value> injection;
  oracle::Random random(1);
  for (const Fault& f : faults) {
    if (!injection.possible(f)) continue;
    Injected sum;
    for (int k = 0; k < (sanitized ? 3 : 20); ++k) injection.run(f, random, sum);
    const std::string fault = describe(f.reason);
    CAPTURE(fault);
    CAPTURE(sum.first_bad);
    CAPTURE(sum.worst_step);
    CHECK(sum.reported == sum.runs);
    CHECK(sum.reacted == sum.runs);
    CHECK(sum.came_back == sum.runs);
    CHECK(sum.broken == 0);
  }
}
