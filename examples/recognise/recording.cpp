#include "examples/recognise/recording.hpp"

#include <cmath>
#include <fstream>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace recognise {

using namespace skinctl;
using namespace skinctl::testing;

Recording record(const LedRun& run, std::uint64_t seed) {
  Recording out;
  auto random = seeded(seed);
  std::normal_distribution<double> noise(0, 1);
  const auto near = [&](const Xyz<double>& p, double s) {
    return Xyz<double>(p + Xyz<double>{s * noise(random), s * noise(random), s * noise(random)});
  };
  for (const auto& thing : run.things)
    if (thing.kind != 0) out.kinds.push_back(thing.kind);
  const auto defined = words_by_definition(run);
  const Person& person = run.hand.person();
  std::size_t k = 0;
  for (int i = 0; i / 250.0 < run.lasts(); ++i) {
    const double t = i / 250.0, w = 6.283185307179586 * person.tremor_rate * t;
    while (k + 1 < defined.size() && defined[k + 1].begin <= t) ++k;
    const auto now = run.hand.truth(t);
    const Xyz<double> tremor{person.tremor * std::sin(w), person.tremor * std::sin(w + 2),
                             person.tremor * std::sin(w + 4)};
    out.lines.push_back({t, near(now.p + tremor, 0.0002), now.force + 0.1 * noise(random), run.hand.intent(t),
                         defined[k].word});
  }
  for (int i = 0; i / 30.0 < run.lasts(); ++i)
    for (std::size_t j = 0; j < out.kinds.size(); ++j) {
      const double t = i / 30.0;
      if (uniform(random, 0.0, 1.0) < 0.05) continue;
      const auto p = run.place(j, t);
      if (norm(Xyz<double>(p - run.hand.truth(t).p)) < 0.08 && uniform(random, 0.0, 1.0) < 0.8) continue;
      out.seen.push_back({t, static_cast<std::uint8_t>(j), near(p, 0.005)});
    }
  return out;
}

void write(const Recording& recording, const std::string& file) {
  std::ofstream out(file);
  out.imbue(std::locale::classic());
  out.precision(9);
  for (const auto kind : recording.kinds) out << "thing " << int(kind) << '\n';
  for (const auto& l : recording.lines)
    out << "hand " << l.time << ' ' << l.p.x << ' ' << l.p.y << ' ' << l.p.z << ' ' << l.force << ' '
        << int(l.meant) << ' ' << int(l.defined) << '\n';
  for (const auto& s : recording.seen)
    out << "seen " << s.time << ' ' << int(s.thing) << ' ' << s.p.x << ' ' << s.p.y << ' ' << s.p.z << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

Recording read(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  Recording out;
  std::string text;
  std::size_t number = 0;
  const auto wrong = [&](const char* why) {
    throw std::runtime_error(file + ", line " + std::to_string(number) + ": " + why);
  };
  const auto finite = [](const Xyz<double>& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  };
  while (std::getline(in, text)) {
    if (++number > 10'000'000) wrong("too long a recording");
    if (text.empty() || text[0] == '#') continue;
    if (text.size() > 300) wrong("too long a line");
    std::istringstream words(text);
    words.imbue(std::locale::classic());
    std::string what;
    words >> what;
    if (what == "thing") {
      int kind = 0;
      if (!(words >> kind) || kind < 1 || kind > 250) wrong("a thing has a class from 1 to 250");
      if (out.kinds.size() == led_things) wrong("more than six things");
      out.kinds.push_back(static_cast<ObjectClass>(kind));
    } else if (what == "hand") {
      Line l;
      int meant = 0, defined = 0;
      if (!(words >> l.time >> l.p.x >> l.p.y >> l.p.z >> l.force >> meant >> defined) || !finite(l.p) ||
          !std::isfinite(l.force) || !(l.time >= 0 && l.time < 1e6))
        wrong("not: hand TIME X Y Z FORCE MEANT DEFINED");
      if (meant < 0 || defined < 0 || meant >= int(activities) || defined >= int(activities))
        wrong("no such activity");
      if (!out.lines.empty() && !(l.time > out.lines.back().time))
        wrong("its time is not after the last one's");
      l.meant = static_cast<Activity>(meant);
      l.defined = static_cast<Activity>(defined);
      out.lines.push_back(l);
    } else if (what == "seen") {
      Seen s;
      int thing = 0;
      if (!(words >> s.time >> thing >> s.p.x >> s.p.y >> s.p.z) || !finite(s.p) ||
          !(s.time >= 0 && s.time < 1e6))
        wrong("not: seen TIME THING X Y Z");
      if (thing < 0 || static_cast<std::size_t>(thing) >= out.kinds.size()) wrong("no such thing");
      if (!out.seen.empty() && s.time < out.seen.back().time) wrong("its time is before the last one's");
      s.thing = static_cast<std::uint8_t>(thing);
      out.seen.push_back(s);
    } else {
      wrong("neither thing, hand nor seen");
    }
  }
  if (out.lines.empty()) wrong("no line of the hand");
  return out;
}

}  // namespace recognise
