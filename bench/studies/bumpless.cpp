// Changes between all ordered pairs of skills, at random instants, states and touches: does the torque jump?
//
//     bumpless [TRIALS = 1000]                          the worst of every pair, in double and float
//     bumpless --replay double|float FROM TO SEED       one of them again, cycle by cycle
//
// Prints the worst case of every bound with the command that replays it. Returns 1 if a bound is exceeded.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>

#include "tests/support/skilled_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double dt = 0.002;
struct Bound {
  const char* name;
  double Bump::* value;
};
constexpr Bound bounds[] = {
    {"jump", &Bump::jump}, {"kink", &Bump::kink}, {"rate", &Bump::rate}, {"time", &Bump::time}};
struct Case {
  unsigned from = 0, to = 0;
  unsigned long long seed = 0;
};

void print(const char* name, const char* other, const Bump& b) {
  std::printf("%-22s%s %-22s %8.4f %8.1f %8.1f %8.0f %8.2f %8.2f%s\n", name, *other ? " =>" : "   ", other,
              b.jump, b.kink, b.rate, b.before, b.carried, b.time, b.finite ? "" : "  NOT FINITE");
  std::fflush(stdout);
}

template <class T>
bool table(const char* scalar, std::uint64_t trials) {
  const auto set = skilled_arm<T>(T(dt));
  using Set = std::remove_const_t<decltype(set)>;
  std::printf("%s, %llu changes a pair\n%-48s %8s %8s %8s %8s %8s %8s\n%-48s %8s %8s %8s %8s %8s %8s\n",
              scalar, static_cast<unsigned long long>(trials), "", "jump", "kink", "rate", "before",
              "carried", "time", "", "[N m]", "[N m/s]", "[N m/s]", "[N m/s]", "[N m]", "[s]");
  Bump all;
  Case worst[std::size(bounds)];
  for (std::uint8_t from = 0; from < Set::skills; ++from)
    for (std::uint8_t to = 0; to < Set::skills; ++to) {
      if (from == to) continue;
      Bump pair;
      for (std::uint64_t seed = 0; seed < trials; ++seed) {
        const auto b = bump<T>(set, from, to, seed, T(dt));
        for (std::size_t i = 0; i < std::size(bounds); ++i)
          if (b.*bounds[i].value > all.*bounds[i].value) worst[i] = {from, to, seed};
        all.widen(b);
        pair.widen(b);
      }
      print(set.skill(from).name, set.skill(to).name, pair);
    }
  print("worst", "", all);
  print("allowed", "", bump_bounds);
  for (std::size_t i = 0; i < std::size(bounds); ++i)
    std::printf("largest %s: bumpless --replay %s %u %u %llu\n", bounds[i].name, scalar, worst[i].from,
                worst[i].to, worst[i].seed);
  return all.within(bump_bounds);
}

template <class T>
bool again(std::uint8_t from, std::uint8_t to, std::uint64_t seed) {
  const auto set = skilled_arm<T>(T(dt));
  const auto b = bump<T>(set, from, to, seed, T(dt), [&](double t, const auto& e, const auto& run) {
    std::printf("%7.3f s  status %10llx  N m (rad/s)", t, static_cast<unsigned long long>(e.status.bits()));
    for (std::size_t i = 0; i < 6; ++i)
      std::printf(" %8.2f (%5.2f)", static_cast<double>(e.torque[i]), static_cast<double>(run.state().dq[i]));
    std::printf("\n");
  });
  print(set.skill(from).name, set.skill(to).name, b);
  return b.within(bump_bounds);
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int i) { return static_cast<std::uint64_t>(std::strtoull(argv[i], nullptr, 10)); };
  if (argc == 6 && std::strcmp(argv[1], "--replay") == 0) {
    const auto from = static_cast<std::uint8_t>(number(3)), to = static_cast<std::uint8_t>(number(4));
    const bool single = std::strcmp(argv[2], "float") == 0;
    return (single ? again<float>(from, to, number(5)) : again<double>(from, to, number(5))) ? 0 : 1;
  }
  const std::uint64_t trials = argc > 1 ? number(1) : 1000;
  const bool good = table<double>("double", trials);
  return table<float>("float", trials) && good ? 0 : 1;
}
