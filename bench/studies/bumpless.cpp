// Changes between all ordered pairs of skills, at random instants, states and touches: does the torque jump?
//
//     bumpless [TRIALS = 1000]                 the worst of every pair, in float and double
//     bumpless float|double FROM TO SEED       one of them again, cycle by cycle
//
// Returns 1 if a bound is exceeded.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>

#include "tests/skills/skilled_arm.hpp"

using namespace skinctl;
using namespace skinctl::test;

namespace {

constexpr double dt = 0.002;

template <class T>
bool table(const char* scalar, std::uint64_t trials) {
  const auto set = skilled_arm<T>(T(dt));
  using Set = std::remove_const_t<decltype(set)>;
  std::printf("%s, %llu changes a pair; jump [N m], kink, moved, rate, before [N m/s]\n", scalar,
              static_cast<unsigned long long>(trials));
  Bump all;
  std::uint64_t worst[2][3] = {};  // of jump and of what the change moves: from, to, seed
  for (std::uint8_t from = 0; from < Set::skills; ++from)
    for (std::uint8_t to = 0; to < Set::skills; ++to) {
      if (from == to) continue;
      Bump pair;
      for (std::uint64_t seed = 0; seed < trials; ++seed) {
        const auto b = bump<T>(set, from, to, seed, T(dt));
        const auto note = [&](int i) { worst[i][0] = from, worst[i][1] = to, worst[i][2] = seed; };
        if (b.jump > all.jump) note(0);
        if (b.moved > all.moved) note(1);
        all.widen(b);
        pair.widen(b);
      }
      std::printf("%-22s => %-22s %8.3f %8.1f %8.1f %8.0f %8.0f%s\n", set.skill(from).name,
                  set.skill(to).name, pair.jump, pair.kink, pair.moved, pair.rate, pair.before,
                  pair.finite ? "" : "  NOT FINITE");
      std::fflush(stdout);
    }
  std::printf("%-48s %8.3f %8.1f %8.1f %8.0f %8.0f\n", "worst", all.jump, all.kink, all.moved, all.rate,
              all.before);
  std::printf("%-48s %8.3f %8.1f %8.1f\n", "allowed", bump_bounds.jump, bump_bounds.kink, bump_bounds.moved);
  for (const auto& w : worst)
    std::printf("again: bumpless %s %llu %llu %llu\n", scalar, static_cast<unsigned long long>(w[0]),
                static_cast<unsigned long long>(w[1]), static_cast<unsigned long long>(w[2]));
  return all.finite && all.jump <= bump_bounds.jump && all.kink <= bump_bounds.kink &&
         all.moved <= bump_bounds.moved;
}

template <class T>
int again(std::uint8_t from, std::uint8_t to, std::uint64_t seed) {
  const auto set = skilled_arm<T>(T(dt));
  const auto b = bump<T>(set, from, to, seed, T(dt), [&](double t, const auto& e, const auto& run) {
    std::printf("%7.3f s  status %llx  ", t, static_cast<unsigned long long>(e.status.bits()));
    for (std::size_t i = 0; i < 6; ++i)
      std::printf(" %8.2f (%5.2f)", static_cast<double>(e.torque[i]), static_cast<double>(run.state().dq[i]));
    std::printf("\n");
  });
  std::printf("%s => %s: jump %g N m, kink %g, moved %g, rate %g, before %g N m/s\n", set.skill(from).name,
              set.skill(to).name, b.jump, b.kink, b.moved, b.rate, b.before);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int i) { return static_cast<std::uint64_t>(std::strtoull(argv[i], nullptr, 10)); };
  if (argc == 5) {
    const auto from = static_cast<std::uint8_t>(number(2)), to = static_cast<std::uint8_t>(number(3));
    return std::strcmp(argv[1], "float") == 0 ? again<float>(from, to, number(4))
                                              : again<double>(from, to, number(4));
  }
  const std::uint64_t trials = argc > 1 ? number(1) : 1000;
  const bool good = table<double>("double", trials);
  return table<float>("float", trials) && good ? 0 : 1;
}
