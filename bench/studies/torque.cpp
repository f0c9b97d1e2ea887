// Arms by torque with the gains of `tracking_settings`: whether they run away behind a delay, with dry
// friction and with a payload that is not as told; and what friction and a lost payload cost.
// `torque [SEED] [SCENES]`, a minute.
#include <cstdio>
#include <cstdlib>

#include "tests/support/torque_loop.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
struct Count {
  int scenes = 0, too_light = 0, too_heavy = 0, ran = 0, ran_before = 0;
  double off = 0, off_before = 0;  ///< largest distance from the goal at the end [rad]
};

/// Integrals and gain as they were before they followed lambda.
template <class Settings>
Settings weak(Settings s) {
  s.K_c = std::min(10.0, 0.65 * s.lambda - 2);
  s.K_i1 = 1, s.K_i2 = 0.1;
  s.tb = nanoseconds(std::max(1.0, s.base.peak_gain() / s.K_c));
  return s;
}

template <class Robot>
void look(Count& c, const Truth& t) {
  ++c.scenes;
  const Tried<Robot> now(t);
  if (!now.refused.empty()) {
    ++(now.refused.find("mass ratio") != std::string::npos ? c.too_light : c.too_heavy);
    return;
  }
  const Seen before = reach<Robot>(t, weak(default_gains<Robot>(t)));
  c.ran += now.seen.ran_away(), c.ran_before += before.ran_away();
  c.off = std::max(c.off, now.seen.off), c.off_before = std::max(c.off_before, before.off);
}

void scenes(unsigned seed, int count) {
  std::printf(
      "%d scenes a row, seed %u: period 1 to 8 ms, delay 0 to 20 ms, payload 0, half or all of 5 / 3 kg "
      "told, and "
      "as much\ncarried, friction 0 or 4 N m. Refused: mass ratio above 4; gravity of the lost payload\n\n"
      "%-28s %8s %9s %10s %10s %22s\n",
      count, seed, "arm", "refused:", "too light", "gravity", "run away", "with K_i1 1, K_i2 0.1");
  const auto row = [&]<class Robot>(const char* name, double rated, double rotors, Robot) {
    auto random = seeded(seed);
    Count c;
    for (int k = 0; k < count; ++k) look<Robot>(c, random_truth(random, rated, rotors));
    std::printf("%-28s %8s %9d %10d %10d %22d\n", name, "", c.too_light, c.too_heavy, c.ran, c.ran_before);
    std::printf("%-28s %8s %9s %10s %6.0f mrad %17.0f mrad\n", "  furthest from the goal", "", "", "",
                1e3 * c.off, 1e3 * c.off_before);
  };
  row("UR5, rotors 0.1 kg m^2", 5, 0.1, Ur5{});
  row("7 joints, rotors 0.1 kg m^2", 3, 0.1, Seven{});
  row("7 joints, no rotors", 3, 0, Seven{});
}

void costs() {
  std::printf(
      "\nUR5, rotors 0.1 kg m^2, a spline of 1.5 s, worst / 2 s after its end [mrad]; friction 4 N m but in "
      "the "
      "first column,\nthe last: half of 5 kg lost instead\n\n%-24s %16s %16s %16s %16s %16s %16s\n",
      "period, delay (lambda)", "exact", "no integral", "1, 0.1", "lambda/4, 0", "and lambda/80",
      "half lost");
  for (const auto& loop : {Loop{2ms, 2ms}, {2ms, 8ms}, {8ms, 8ms}}) {
    Truth t{.loop = loop, .rotors = 0.1, .real_rotors = 0.1, .end = 3600ms + 50 * loop.period};
    const auto gains = default_gains<Ur5>(t);
    std::printf("%g, %g ms (%.0f 1/s)%*s", milliseconds(loop.period), milliseconds(loop.delay), gains.lambda,
                4, "");
    const auto cell = [&](const Truth& truth, double K_i1, double K_i2) {
      auto s = gains;
      s.K_i1 = K_i1, s.K_i2 = K_i2;
      const Seen seen = reach<Ur5>(truth, s);
      std::printf(" %7.1f / %6.1f", 1e3 * seen.worst, 1e3 * seen.off);
    };
    cell(t, gains.K_i1, gains.K_i2);
    Truth rubs = t;
    rubs.friction = 4;
    cell(rubs, 0, 0), cell(rubs, 1, 0.1), cell(rubs, gains.K_i1, 0), cell(rubs, gains.K_i1, gains.K_i2);
    Truth lost = t;
    lost.told = 2.5;
    cell(lost, gains.K_i1, gains.K_i2);
    std::printf("\n");
  }
}
}  // namespace

int main(int count, char** arguments) {
  const unsigned seed = count > 1 ? static_cast<unsigned>(std::atoi(arguments[1])) : 33;
  scenes(seed, count > 2 ? std::atoi(arguments[2]) : 300);
  costs();
}
