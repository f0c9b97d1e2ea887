// Faults between the hand's job and an Allegro hand, by CAN and by UDP, in real time.
#include "examples/compliant_allegro/tests/fault_rows.hpp"
#include "examples/fault_table/row.hpp"

namespace fault_table {
namespace {

using namespace compliant_allegro;
namespace hand = compliant_allegro::faults;
using examples::job::Exit;

Row suffer(const hand::Row& of) {
  const hand::Ran ran = hand::run_row(of);
  Row row{.device = of.udp ? "Allegro V5 Sense, UDP" : "Allegro V4, CAN", .fault = of.name};
  row.exit = ran.thrown.empty() ? examples::job::code(ran.exit) : 1;
  row.reaction = !ran.thrown.empty() ? ran.thrown : (ran.exit == Exit::fine ? "goes on" : ran.log.reason);
  if (ran.log.incomplete > 0)
    row.reaction +=
        text(", %llu sets of positions lost", static_cast<unsigned long long>(ran.log.incomplete));
  if (ran.exit != Exit::fine && of.most > 0) row.rest_ms = 1e3 * hand::rest_of(ran.log);
  row.recovery = "-";
  if (ran.exit != Exit::fine) {
    hand::Row well = of;
    well.faults = {};
    row.recovery = hand::run_row(well).exit == Exit::fine ? "start again" : "none";
  }
  row.expected = ran.thrown.empty() && row.recovery != "none" &&
                 (ran.exit == of.expected || (of.or_fine && ran.exit == Exit::fine)) &&
                 (of.most <= 0 || ran.exit == Exit::fine || row.rest_ms < 1e3 * of.most);
  row.otherwise = text("exit %d within %.0f ms", examples::job::code(of.expected), 1e3 * of.most);
  return row;
}

Row mute() {
  Settings s;
  default_task(s);
  s.quiet = true;
  s.generation = Generation::v4;
  s.speed = 1;
  s.faults.mute = true;
  RunLog log;
  Row row{.device = "Allegro V4, CAN", .fault = "killed before the start: it answers nothing", .exit = 1};
  try {
    row.exit = examples::job::code(run(s, false, log));
  } catch (const std::exception& e) {
    row.reaction = e.what();
  }
  row.rest_ms = 0;
  row.recovery = "start again";
  row.expected = !row.reaction.empty();
  return row;
}

}  // namespace

Cases allegro_cases() {
  Cases out;
  for (const hand::Row& r : hand::rows())
    if (std::string_view(r.name) != "nothing") out.push_back({"Allegro", [r] { return suffer(r); }});
  out.push_back({"Allegro", mute});
  return out;
}

}  // namespace fault_table
