// Every fault of the table, put into every skill at random instants, by position, velocity and torque:
// `fault_injection [runs [interface fault skill seed]]`, the last four from the list of what went wrong.
//
// A UR5 with 260 cells, pushed now and then; the fault lasts 6 to 60 cycles and comes while the skill works,
// while another hands over to it, or as it is asked for. Counted: runs in which it was reported with its
// reason, answered as the table says (brakes and stops checked joint by joint; what is refused leaves the
// command as it is without it, to the bit), and ended as the table says with the skill that was asked for;
// and commands beyond a limit, not finite, or further than a cycle may step.
#include "bench/studies/worlds/fault_injection.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t count = faults.size();

/// What was seen of one fault at one interface.
struct Cell {
  long runs = 0, good = 0;
  long seen[reaction_count] = {};
};
struct Sheet {
  Cell cells[count];
  std::vector<long> runs, wrong;  // of each skill
  long listed = 0, all_wrong = 0, broken = 0;
  double worst_step = 0;
};

template <Interface I>
void study(const char* interface, std::vector<const char*>& names, Sheet& sheet, long runs) {
  FaultInjection<I> injection;
  constexpr std::size_t skills = FaultInjection<I>::skills;
  names.clear();
  for (std::size_t s = 0; s < skills; ++s) names.push_back(injection.name(s));
  sheet.runs.assign(skills, 0);
  sheet.wrong.assign(skills, 0);
  long possible = 0;
  for (const Fault& f : faults) possible += injection.possible(f);
  const long each = (runs + possible * long(skills) - 1) / (possible * long(skills));
  for (std::size_t k = 0; k < count; ++k) {
    if (!injection.possible(faults[k])) continue;
    for (std::size_t s = 0; s < skills; ++s)
      for (long n = 1; n <= each; ++n) {
        const auto seed = static_cast<std::uint64_t>(n);
        const auto run = injection.run(faults[k], static_cast<std::uint8_t>(s), seed);
        Cell& cell = sheet.cells[k];
        ++cell.runs;
        cell.good += run.good();
        ++cell.seen[static_cast<unsigned>(run.seen)];
        ++sheet.runs[s];
        sheet.wrong[s] += !run.good();
        sheet.all_wrong += !run.good();
        sheet.broken += run.broken;
        sheet.worst_step = std::max(sheet.worst_step, run.worst_step);
        if (!run.good() && sheet.listed++ < 20)
          std::printf("wrong: %s %zu %zu %ld (%s, %s): %s\n", interface, k, s, n, faults[k].text, names[s],
                      run.wrong.c_str());
      }
  }
}

void print(const Cell& c) {
  std::string text;
  for (unsigned r = 0; r < reaction_count; ++r) {
    if (c.seen[r] == 0) continue;
    if (!text.empty()) text += ", ";
    text += std::string(name(static_cast<Reaction>(r))) + " " + std::to_string(c.seen[r]);
  }
  std::printf(" %-20s |", text.empty() ? "-" : text.c_str());
}

template <Interface I>
int replay(char** argv) {
  FaultInjection<I> injection;
  const auto fault = std::strtoul(argv[3], nullptr, 10);
  if (fault >= count) return 2;
  const auto skill = static_cast<std::uint8_t>(std::strtoul(argv[4], nullptr, 10));
  injection.watch = [](int k, bool faulty, const auto& out) {
    std::printf("%4d %c", k, faulty ? '!' : ' ');
    for (const double x : I == Interface::position ? out.planned.position.data : out.planned.torque.data)
      std::printf(" %8.4f", x);
    for (const double x : out.planned.velocity.data) std::printf(" %7.4f", x);
    out.status.for_each([](Reason r) { std::printf(", %s", describe(r)); });
    std::printf("\n");
  };
  const auto run = injection.run(faults[fault], skill, std::strtoull(argv[5], nullptr, 10));
  std::printf("%s, %s: %s, largest step %.9f: %s\n", faults[fault].text, injection.name(skill),
              name(run.seen), run.worst_step, run.good() ? "as documented" : run.wrong.c_str());
  return run.good() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 5) {
    if (std::strcmp(argv[2], "position") == 0) return replay<Interface::position>(argv);
    if (std::strcmp(argv[2], "velocity") == 0) return replay<Interface::velocity>(argv);
    return replay<Interface::torque>(argv);
  }
  const long runs = argc > 1 ? std::atol(argv[1]) : 100'000;
  Sheet sheets[3];
  std::vector<const char*> names;
  study<Interface::position>("position", names, sheets[0], runs / 3);
  study<Interface::velocity>("velocity", names, sheets[1], runs / 3);
  study<Interface::torque>("torque", names, sheets[2], runs - 2 * (runs / 3));
  std::printf("\n| %-20s | found by | documented: motion, torque | way back   | position             | %s",
              "fault", "velocity             | torque               |\n|---|---|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < count; ++k) {
    const Fault& f = faults[k];
    if (sheets[0].cells[k].runs + sheets[1].cells[k].runs + sheets[2].cells[k].runs == 0) continue;
    std::printf("| %-20s | %-8s | %-6s, %-18s | %-10s |", f.name, name(f.finder), name(f.motion),
                name(f.torque), name(f.way_back));
    for (const Sheet& s : sheets) print(s.cells[k]);
    std::printf("\n");
  }
  std::printf("\n| skill | wrong of runs by position | velocity | torque |\n|---|---|---|---|\n");
  for (std::size_t s = 0; s < names.size(); ++s) {
    std::printf("| %s |", names[s]);
    for (const Sheet& sheet : sheets) std::printf(" %ld of %ld |", sheet.wrong[s], sheet.runs[s]);
    std::printf("\n");
  }
  long wrong = 0, done = 0, broken = 0;
  double worst = 0;
  for (const Sheet& s : sheets) {
    wrong += s.all_wrong;
    broken += s.broken;
    worst = std::max(worst, s.worst_step);
    for (const long n : s.runs) done += n;
  }
  std::printf(
      "\n%ld runs: %ld wrong, %ld commands beyond a limit, largest step %.9f of what a cycle may "
      "change\n",
      done, wrong, broken, worst);
  return wrong == 0 ? 0 : 1;
}
