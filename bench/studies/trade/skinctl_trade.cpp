// Speed against accuracy: what each choice costs, and how far it is off at the task.
//
//     skinctl_trade [--csv FILE] [--page FILE] [--pictures FOLDER] [--readme] [--only TEXT] [--valgrind PROGRAM]
//                   [--proven FILE]         what `bounds --csv FILE` proved: on the page, beside what is measured
//     skinctl_trade --cycles POINT COUNT      runs one point's cycles: what callgrind counts
//     skinctl_trade --from FILE --page FILE   the page of an earlier run's CSV
//
// Each point runs in a world of stiff joints, once pressed by forces that are given and once by a stiff
// finger, beside a reference with everything unabridged. Its cycles are then run again from their record:
// hot, and with code and data flushed from the caches; callgrind counts their instructions and the lines of
// code that they touch.
#include <cstdio>
#include <cstdlib>
#include <map>

#include "bench/studies/trade/callgrind.hpp"
#include "bench/studies/trade/page.hpp"
#include "bench/studies/trade/point.hpp"

using namespace trade;

namespace {

std::vector<Point> all_points() {
  auto points = arm_points();
  for (auto* more : {&study_points, &hand_points})
    for (Point& p : more()) points.push_back(std::move(p));
  return points;
}
std::string name_of(const Point& p) {
  return p.scene + "|" + p.policy + "|" + p.value;
}

/// How far the tool was from where it began [m].
double travel(const Course& c) {
  double far = 0;
  for (const auto& p : c.tool) far = std::max(far, std::sqrt(dot(p - c.tool.front(), p - c.tool.front())));
  return far;
}

int run_cycles(const std::string& name, std::size_t count) {
  for (const Point& p : all_points()) {
    if (name_of(p) != name) continue;
    const auto runner = p.make(p.choices);
    static_cast<void>(runner->given());
    runner->cycles(count);
    return 0;
  }
  std::fprintf(stderr, "skinctl_trade: no point \"%s\"\n", name.c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  std::string csv, page, pictures, only, valgrind, from, proven;
  bool readme = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto next = [&]() -> std::string {
      if (i + 1 >= argc) {
        std::fprintf(stderr, "skinctl_trade: %s needs a value\n", word.c_str());
        std::exit(2);
      }
      return argv[++i];
    };
    if (word == "--csv")
      csv = next();
    else if (word == "--page")
      page = next();
    else if (word == "--pictures")
      pictures = next();
    else if (word == "--only")
      only = next();
    else if (word == "--valgrind")
      valgrind = next();
    else if (word == "--proven")
      proven = next();
    else if (word == "--from")
      from = next();
    else if (word == "--readme")
      readme = true;
    else if (word == "--cycles") {
      const std::string name = next();
      return run_cycles(name, std::strtoul(next().c_str(), nullptr, 10));
    } else {
      std::fprintf(stderr,
                   "skinctl_trade: %s: see the first lines of bench/studies/trade/skinctl_trade.cpp\n",
                   word.c_str());
      return 2;
    }
  }
  std::vector<Row> rows;
  if (!from.empty()) {
    rows = read_csv(from);
    judge(rows);
  } else {
    if (valgrind.empty())
      std::fprintf(stderr, "skinctl_trade: no --valgrind: instructions and code are not counted\n");
    std::map<std::string, std::pair<Course, Course>> references;
    for (const Point& p : all_points()) {
      const bool reference = p.policy == "reference",
                 asked = only.empty() || name_of(p).find(only) != std::string::npos;
      if (!asked && !(reference && only.rfind(p.scene, 0) == 0)) continue;
      const auto runner = p.make(p.choices);
      const Course given = runner->given(), stiff = runner->stiff();
      if (reference) references[p.scene] = {given, stiff};
      if (!asked) continue;
      const auto& exact = references.at(p.scene);
      Row r{.scene = p.scene, .policy = p.policy, .value = p.value, .preset = p.preset};
      const Distance a = distance(given, exact.first), b = distance(stiff, exact.second);
      r.mm = a.mm;
      if (!stiff.tool.empty()) r.mm_stiff = b.mm, r.N = b.N, r.J = std::max(a.J, b.J);
      r.hot = runner->hot();
      r.cold = runner->cold();
      r.bytes = double(runner->bytes());
      r.samples = double(given.samples) / double(given.tool.size());
      if (!valgrind.empty()) {
        const Counted counted = count(valgrind, argv[0], {"--cycles", name_of(p)}, runner->count());
        if (!(counted.instructions > 0))
          std::fprintf(
              stderr,
              "skinctl_trade: callgrind gave no count for \"%s\" (an instruction that it does not know?)\n",
              name_of(p).c_str());
        r.instructions = counted.instructions;
        r.code = counted.code;
      }
      r.command = "skinctl_trade --only '" + name_of(p) + "'";
      rows.push_back(r);
      std::printf(
          "%-26s %-12s %-28s %-9s hot %6.2f us  cold %6.2f us  %7.0f instructions  %5.1f KB code  %6.0f B  "
          "%5.1f samples  "
          "%.3g mm  %.3g mm  %.3g N  %.3g J  (peak %.0f, %.0f N, travel %.0f, %.0f mm)\n",
          r.scene.c_str(), r.policy.c_str(), r.value.c_str(), r.preset.c_str(), r.hot, r.cold, r.instructions,
          r.code / 1024, r.bytes, r.samples, r.mm, r.mm_stiff, r.N, r.J, given.peak, stiff.peak,
          1e3 * travel(given), 1e3 * travel(stiff));
      std::fflush(stdout);
    }
    judge(rows);
  }
  if (!csv.empty()) write_csv(rows, csv);
  if (!page.empty())
    write_page(
        rows,
        proven.empty() ? std::vector<skinctl::bounds::Bracket>{} : skinctl::bounds::read_brackets(proven),
        page);
  if (!pictures.empty()) write_pictures(rows, pictures);
  if (readme) std::fputs(as_markdown(rows).c_str(), stdout);
  return 0;
}
