// Tasks from single demonstrations, by kind of people and sensing: found, wrong, refused.
// `teaching [first seed] [people of a kind]`
#include <cstdio>
#include <cstdlib>

#include "examples/worlds/demonstrations.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
TaskScore table(const char* title, const std::vector<Kind>& kinds, std::uint64_t first, int people) {
  TaskScore all;
  std::printf("| %s | found | wrong | refused | last refusal |\n|---|---|---|---|---|\n", title);
  for (const auto& kind : kinds) {
    TaskScore s;
    for (int i = 0; i < people; ++i)
      s.add(learn({packing_shown(kind, first + static_cast<std::uint64_t>(i))}, kitchen()));
    std::printf("| %s | %d | %d | %d | %s |\n", kind.name, s.found, s.wrong, s.refused,
                s.refused > 0 ? describe(s.last) : "");
    all.found += s.found, all.wrong += s.wrong, all.refused += s.refused;
  }
  std::printf("| **all** | %d | %d | %d | |\n\n", all.found, all.wrong, all.refused);
  return all;
}
}  // namespace

int main(int count, char** arguments) {
  const std::uint64_t first = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 5000;
  const int people = count > 2 ? std::atoi(arguments[2]) : 12;
  const auto ordinary = table("people", kinds_of_people(), first, people);
  const auto perturbed = table("signals", perturbed_signals(), first, people);
  const auto count_of = [&](const char* name, int of, auto&& one) {
    TaskScore s;
    for (int i = 0; i < of; ++i) s.add(one(first + static_cast<std::uint64_t>(i)));
    std::printf("%s: %d found, %d wrong, %d refused of %d (%s)\n", name, s.found, s.wrong, s.refused, of,
                describe(s.last));
    return s.wrong;
  };
  const Kind unsqueezed{"", [](Person& p, ShownBy& by) { p.squeeze = 1, by.wander = 0.1; }};
  const auto several = [&](std::uint64_t seed, std::uint64_t recordings) {
    const auto all = kinds_of_people();
    std::vector<Demonstration<>> shown;
    for (std::uint64_t k = 0; k < recordings; ++k)
      shown.push_back(packing_shown(all[seed % all.size()], recordings * seed + k));
    return learn(shown, kitchen());
  };
  int wrong = count_of("two demonstrations each", 8 * people, [&](auto seed) { return several(seed, 2); });
  wrong += count_of("three demonstrations each", 8 * people, [&](auto seed) { return several(seed, 3); });
  wrong += count_of("grip wanders by 10 %, no squeeze meant", 5 * people,
                    [&](std::uint64_t seed) { return learn({packing_shown(unsqueezed, seed)}, kitchen()); });
  const int alike = count_of("alike oranges treated unlike", 5 * people, [&](std::uint64_t seed) {
    return learn({alike_shown(kinds_of_people()[0], seed)}, kitchen());
  });
  wrong += count_of("dropped and taken again", 4 * people,
                    [&](std::uint64_t seed) { return learn({dropped_shown(seed)}, kitchen()); });
  for (const LedTask task : {LedTask::pancake, LedTask::sandwich})
    for (const auto& [tremor, noise] : {std::pair{0.0, 0.0}, {0.003, 0.0}, {0.0, 0.002}}) {
      int found = 0, refused = 0;
      std::string other;
      for (int i = 0; i < people; ++i) {
        const auto t =
            learn({kitchen_shown(task, first + static_cast<std::uint64_t>(i), tremor, noise)}, kitchen());
        refused += t.why != Refusal::none ? 1 : 0;
        if (t.why != Refusal::none) continue;
        if (in_line(t.task) == meant_in_line(task))
          ++found;
        else
          other = in_line(t.task);
      }
      std::printf("%s, tremor %.0f mm, camera %.0f mm: %d found, %d wrong, %d refused of %d\n%s",
                  task == LedTask::pancake ? "pancakes" : "sandwich", 1e3 * tremor, 1e3 * noise, found,
                  people - found - refused, refused, people, other.empty() ? "" : (other + "\n").c_str());
      wrong += people - found - refused;
    }
  std::printf("alike oranges treated unlike pass as a rule in %d of %d\n", alike, 5 * people);
  return wrong + ordinary.wrong + perturbed.wrong == 0 ? 0 : 1;
}
