#include "examples/compliant_ur5/results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "examples/compliant_ur5/summary.hpp"

namespace compliant_ur5 {

using namespace skinctl;

namespace {

Outcome told(const char* what, Outcome outcome, const RunLog& log) {
  std::fprintf(stderr, "\n%s: %s (exit code %d: %s)\n", what, log.words.c_str(), examples::job::code(outcome),
               examples::job::words(outcome));
  return outcome;
}

/// Words where this computer did not keep the pace, which then is the cause of what ended the run; else
/// empty. So much is two periods, or the 20 ms after which a UR's program counts a command as missing.
std::string too_slow(double behind, double load, double period) {
  const double most = std::max(2 * period, 0.02);
  if (std::max(behind, load) <= most) return {};
  return "; this computer is too slow, or busy with something else: " +
         (behind > load ? text("the simulated robot fell behind the clock by %.0f ms", 1000 * behind)
                        : text("a cycle took %.0f ms", 1000 * load));
}

bool promises_kept(const RunFigures& f, bool by_torque) {
  const double most = 1 + 1e-9;
  return f.allocations == 0 && f.largest.torque <= most &&
         (by_torque || (f.largest.velocity <= most && f.largest.acceleration <= most));
}

std::string or_none(const std::string& words) {
  return words.empty() ? "none" : words;
}

}  // namespace

double tell_touches(const TouchObserver& observer, Connection& connection, bool places_known, RunLog& log) {
  log.touches = observer.touches();
  if (!places_known)
    for (TouchSummary& t : log.touches) t.link = -1, t.place.fill(std::nan(""));
  log.peak_force = 0;
  for (const auto& t : log.touches) log.peak_force = std::max(log.peak_force, t.peak_force);
  if (!connection.simulation) return 0;
  const auto world = connection.simulation->snapshot();
  auto results = world.touches;
  std::erase_if(results, [](const auto& r) { return r.first_contact < 0; });  // it gave way before
  std::sort(results.begin(), results.end(),
            [](const auto& a, const auto& b) { return a.first_contact < b.first_contact; });
  if (results.size() == log.touches.size())
    for (std::size_t i = 0; i < results.size(); ++i) log.touches[i].true_peak_force = results[i].peak_force;
  log.peak_force = 0;
  for (const auto& r : results) log.peak_force = std::max(log.peak_force, r.peak_force);
  connection.simulation->stop();
  return world.behind;
}

void tell_figures(const Settings& s, const RunFigures& f, const adapters::ur5::Driver& driver, RunLog& log) {
  const bool by_torque = s.interface == Interface::torque;
  log.title = std::string(s.rigid ? "Rigid" : "Compliant") + " UR5, " + (s.robot ? *s.robot : "simulated") +
              ", " + text("%.0f Hz, ", s.rate) + in_words(s.interface) + " interface" +
              (s.sense == Sense::skin ? "" : ", by its " + std::string(in_words(s.sense)));
  log.laws = {"spline joint", "skin joint", by_torque ? "of these learnt friction" : "gravity"};
  const bool real_time = s.robot || s.speed == 1;
  log.result = {
      {"cycles", std::to_string(f.cycles)},
      {"samples from the skin", std::to_string(f.samples)},
      {"missed deadlines",
       real_time ? std::to_string(f.missed) + " of " + std::to_string(f.cycles) : "not at real-time pace"},
      {"allocations in the loop", std::to_string(f.allocations)},
      by_torque ? Fact{"largest torque", text("%.1f %% of its limit", 100 * f.largest.torque)}
                : Fact{"fastest command", text("%.1f %% of its limit", 100 * f.largest.velocity)},
      by_torque ? Fact{"fastest joint", text("%.1f %% of its limit", 100 * f.largest.velocity)}
                : Fact{"largest command step", text("%.1f %% of its limit", 100 * f.largest.acceleration)},
      {"lag beyond the declared one", f.lag ? text("%.1f ms", 1e3 * *f.lag) : "not known"},
      {"states repeated or out of order", std::to_string(driver.stood())},
      {"cycles without a new state", std::to_string(f.silent)},
      {"peak contact force", text("%.1f N", log.peak_force)},
  };
}

void tell_skin(const adapters::skin::Receiver& receiver, const std::string& cells, RunLog& log) {
  const auto& heard = receiver.statistics();
  log.result.push_back({"cells that report", cells});
  log.result.push_back({"skin datagrams lost", std::to_string(heard.lost)});
  log.result.push_back({"stray skin datagrams", std::to_string(heard.stray())});
  log.result.push_back({"skin datagrams refused", or_none(adapters::skin::refusals(heard))});
  log.result.push_back({"leaps of the skin's clock", or_none(receiver.leaps())});
  log.result.push_back({"frozen cells", or_none(receiver.frozen())});
}

Outcome tell_end(const Settings& s, Found found, const RunFigures& f, const adapters::ur5::Driver& driver,
                 RunLog& log) {
  if (f.ended == LoopEnd::displaced) found.ending = Ending::displaced;
  if (f.ended == LoopEnd::interrupted) found.ending = Ending::interrupted;
  if (found.ending == Ending::finished && f.ended == LoopEnd::finished &&
      !promises_kept(f, s.interface == Interface::torque))
    found.ending = Ending::broken;
  Outcome outcome = row(found.ending).exit;
  if (f.ended == LoopEnd::lost || f.ended == LoopEnd::no_state) {
    const auto& lost = adapters::ur5::row(driver.fault());
    log.ending = lost.name;
    log.words = driver.error();
    outcome = lost.exit;
  } else {
    log.ending = row(found.ending).name;
    log.words = row(found.ending).words + (found.detail.empty() ? "" : ": " + found.detail);
  }
  if (outcome == Outcome::fine) return outcome;
  const double pace = s.robot ? 1 : s.speed;
  if (outcome != Outcome::interrupted && outcome != Outcome::broken && pace > 0)
    log.words += too_slow(pace * f.behind, pace * f.load, 1 / s.rate);
  return told(found.ending == Ending::broken ? "failed" : "stopped", outcome, log);
}

Outcome not_tared(const char* why, RunLog& log) {
  const EndingRow& end = row(Ending::not_tared);
  log.ending = end.name;
  log.words = std::string(end.words) + ": " + why;
  return told("stopped", end.exit, log);
}

}  // namespace compliant_ur5
