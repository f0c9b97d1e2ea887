// The clock of the main job's skin: set, leaping, running wrong, and those of two senders.
//
// Promise: the main job survives a skin's clock that is set or leaps, or ends with exit code 4, and tells it
// Tried: in real time: set by 1 s and -5 s in a run, a press after it is felt; one datagram of the future,
// and one of 20 (exit code 4); a sender that starts again, by the same port or another; a second one, with
// another clock

#include <doctest/doctest.h>

#include <cstdlib>
#include <optional>
#include <utility>

#include "examples/compliant_ur5/tests/beside.hpp"
#include "examples/compliant_ur5/tests/skin_wire.hpp"

using namespace compliant_ur5;
using namespace std::chrono_literals;
using Parcel = SkinWire::Parcel;
using Parcels = std::vector<Parcel>;

namespace {

struct Told {
  Outcome outcome = Outcome::fine;
  RunLog log;
  [[nodiscard]] std::string fact(const std::string& name) const {
    for (const auto& f : log.result)
      if (f.name == name) return f.value;
    return "";
  }
  [[nodiscard]] std::string leaps() const { return fact("leaps of the skin's clock"); }
};

/// The job at rest, with a wire to its skin that changes datagrams from its 1.5 s on; at 2.5 s a cell is
/// pressed for half a second.
Told run_with_wire(SkinWire::Change change, bool pressed = true) {
  Settings s = settings();
  s.task.clear();
  s.cycles = 500;
  std::optional<SkinWire> wire;
  Beside beside(s, [&](auto& config) {
    wire.emplace(s.skin_port);
    config.skin_port = wire->port();
  });
  wire->set([&, change](const Parcel& p) {
    Parcel felt = p;
    const double t = beside.robot->snapshot().scenario_time;
    if (pressed && t > 2.5 && t < 3)
      for (auto& sample : felt.samples)
        if (sample.cell == 170) sample.force = {0.5f, 0.5f, 0.5f};
    return t > 1.5 && change ? change(felt) : Parcels{felt};
  });
  Told out;
  const std::atomic<bool> stop = false;
  out.outcome = run(s, stop, out.log);
  wire->set({});
  return out;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("main job: leaps of the skin's clock are told, and what is felt after them counts") {
  // At least: a machine that is busy makes more of them.
  const auto check = [](const Told& told, int leaps) {
    CAPTURE(leaps);
    CAPTURE(told.leaps());
    CAPTURE(told.log.words);
    CHECK(told.outcome == Outcome::fine);
    CHECK(told.log.touches.size() == 1);
    CHECK(std::atoi(told.leaps().c_str()) >= leaps);
    CHECK((leaps == 0 ||
           told.leaps().find("of the sender's clock: no reading counts for 100 ms") != std::string::npos));
    CHECK(told.fact("stray skin datagrams") == "0");
  };
  const Told healthy = run_with_wire({});
  check(healthy, 0);
  CHECK(healthy.leaps() == "none");
  for (const auto by : {std::chrono::seconds(1), std::chrono::seconds(-5)})
    check(run_with_wire([by](const Parcel& p) { return Parcels{p.later(by)}; }), 1);
  check(run_with_wire([sent = false](const Parcel& p) mutable {
          return Parcels{std::exchange(sent, true) ? p : p.later(1s)};
        }),
        2);  // there and back
}

TEST_CASE("main job: a skin whose datagrams come from the future again and again ends it, in words") {
  const Told told =
      run_with_wire([k = 0](const Parcel& p) mutable { return Parcels{++k % 20 == 0 ? p.later(1s) : p}; });
  CAPTURE(told.log.words);
  CHECK(told.outcome == Outcome::blind);
  CHECK(told.log.words.find("leaps of the sender's clock") != std::string::npos);
}

TEST_CASE("main job: a sender that starts again, and a second one with another clock") {
  // From the same port, as a microcontroller's, or from another one: it is taken once the old one is silent.
  for (const bool other_port : {false, true}) {
    const Told told = run_with_wire([other_port, from = std::optional<Parcel>()](const Parcel& p) mutable {
      if (!from) from = p;
      Parcel anew = p.later(-from->sent);
      anew.sequence = p.sequence - from->sequence;
      anew.stranger = other_port;
      return Parcels{anew};
    });
    CAPTURE(other_port);
    CAPTURE(told.log.words);
    CHECK(told.leaps().find("1 new beginning of the sender: ") != std::string::npos);
    CHECK(told.fact("skin datagrams refused").find(other_port ? "another address" : "repeated") !=
          std::string::npos);
    if (told.outcome == Outcome::fine) CHECK(told.log.touches.size() == 1);
  }
  const Told told = run_with_wire(
      [](const Parcel& p) {
        Parcel other = p.later(-3s);
        other.stranger = true;
        for (auto& s : other.samples) s.force = {1, 1, 1};
        return Parcels{p, other};
      },
      false);
  CHECK(told.outcome == Outcome::fine);
  CHECK(told.log.touches.empty());
  CHECK(told.fact("stray skin datagrams") != "0");
}
