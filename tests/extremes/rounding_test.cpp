// Other rounding modes, and processors that flush denormal numbers to zero: a library that shares the thread
// may have left either behind.
//
// Promise: no command changes with the thread's rounding mode, nor with denormal numbers flushed to zero
// Tried: all four modes, 50 cycles of a touched UR5 with 260 cells: within 64 epsilon, float and double;
// flushed: not by a bit

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "skinctl/math/sincos.hpp"
#include "skinctl/math/tanh.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;
namespace {

constexpr int modes[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

/// Sets a rounding mode while it lives.
class Rounding {
 public:
  explicit Rounding(int mode) { std::fesetround(mode); }
  ~Rounding() { std::fesetround(FE_TONEAREST); }
  Rounding(const Rounding&) = delete;
  Rounding& operator=(const Rounding&) = delete;
};

/// Six angles at once, as a robot has them, behind a call that no compiler moves.
template <class T>
[[gnu::noinline]] void turned(const std::array<T, 6>& x, std::array<T, 6>& sin, std::array<T, 6>& cos,
                              std::array<T, 6>& tanh) {
  math::sincos(x, sin, cos);
  math::tanh(x, tanh);
}

/// Where a touched arm is told to go, cycle by cycle.
template <class T>
std::vector<double> commanded(int cycles) {
  const auto scene = kinesthetic_scene<Interface::position, 260, T>();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  State<6, T> state;
  state.q = home_position<T>();
  auto memory = std::make_unique<typename Scene::Memory>(scene.start(state));
  auto input = std::make_unique<typename Scene::Input>();
  std::array<CellSample, 3> samples;
  std::vector<double> out;
  for (int k = 1; k <= cycles; ++k) {
    input->now = state.time = k * 8ms;
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = {.time = input->now - 1ms,
                    .cell = static_cast<std::uint32_t>(20 + 80 * i),
                    .force = {0.3f, 0.2f, 0.1f}};
    input->measured = state;
    input->samples = samples;
    const auto step = scene.step(*memory, *input);
    REQUIRE(step.command.valid);
    for (std::size_t i = 0; i < 6; ++i) out.push_back(static_cast<double>(step.command.position[i]));
    state.q = step.command.position;
    state.dq = step.planned.velocity;
  }
  return out;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = std::abs(a[i] - b[i]);
    if (!(d <= most)) most = d;
  }
  return most;
}

}  // namespace

TEST_CASE_TEMPLATE("rounding modes: sincos and tanh to a few units in the last place in each of them", T,
                   SKINCTL_EXTREME_SCALARS) {
  const double eps = static_cast<double>(std::numeric_limits<T>::epsilon());
  for (const int mode : modes) {
    CAPTURE(mode);
    double worst = 0;
    for (int k = 0; k < 3000; ++k) {
      std::array<T, 6> x, s, c, t;
      for (std::size_t i = 0; i < 6; ++i)
        x[i] = static_cast<T>(0.0041 * (k - 1500) * (k % 7 == 0 ? 20 : 1) + 0.3 * static_cast<double>(i));
      {
        const Rounding rounding(mode);
        turned(x, s, c, t);
      }
      for (std::size_t i = 0; i < 6; ++i) {
        const auto y = static_cast<long double>(x[i]);
        worst = std::max({worst, static_cast<double>(std::abs(static_cast<long double>(s[i]) - std::sin(y))),
                          static_cast<double>(std::abs(static_cast<long double>(c[i]) - std::cos(y))),
                          static_cast<double>(std::abs(static_cast<long double>(t[i]) - std::tanh(y)))});
      }
    }
    CHECK(worst <= 4 * eps);
  }
}

TEST_CASE_TEMPLATE("rounding modes: a touched arm is told the same in each of them", T,
                   SKINCTL_EXTREME_SCALARS) {
  const int cycles = sanitized ? 5 : 50;
  const auto nearest = commanded<T>(cycles);
  const double eps = static_cast<double>(std::numeric_limits<T>::epsilon());
  CHECK(largest_difference(nearest, std::vector<double>(nearest.size(), 0.0)) > 0.1);
  for (const int mode : modes) {
    CAPTURE(mode);
    std::vector<double> other;
    {
      const Rounding rounding(mode);
      other = commanded<T>(cycles);
    }
    const double difference = largest_difference(nearest, other);
    CHECK(difference <= 64 * eps);
    MESSAGE(std::string(sizeof(T) == 4 ? "float" : "double"), ", mode ", mode, ": command off by ",
            difference, " rad");
  }
}

#if defined(__SSE2__)
TEST_CASE_TEMPLATE("flush to zero: no command changes by a bit", T, SKINCTL_EXTREME_SCALARS) {
  const int cycles = sanitized ? 5 : 50;
  const auto usual = commanded<T>(cycles);
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040u);  // flush to zero, denormals are zero
  const auto flushed = commanded<T>(cycles);
  _mm_setcsr(before);
  CHECK(usual == flushed);
}
#endif
