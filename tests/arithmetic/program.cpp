// Builds a scene and prints bits of its arithmetic: the flags that it was compiled with are refused by the
// headers or by the scene (exit 3 and the reason), or change no bit.
#include <cstdio>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/math/sum.hpp"
#include "skinctl/math/tanh.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

template <class T>
void print() {
  const volatile T start = T(-100), tenth = T(0.1), eighths = T(0.375);
  const T step = tenth, share = eighths;
  T sum = start, rest = 0;
  const auto put = [](T x) { std::printf("%a ", double(x)); };
  for (int k = 0; k < 1000; ++k) {
    JointPosition<6, T> q;
    T sines[6], cosines[6], slopes[6];
    for (T& x : q) x = sum * share, math::add_compensated(sum, rest, step);
    math::sincos<6>(q.data, sines, cosines);
    math::tanh<6>(q.data, slopes);
    for (int i = 0; i < 6; ++i) put(sines[i]), put(cosines[i]), put(slopes[i]);
    const auto torque = gravity_torque(ur5::Model{}, q);
    for (const T& x : torque) put(x);
  }
}

}  // namespace

int main() {
  try {
    const auto arm = by_torque(ur5::Model{},
                               {.limits = limits_of<ur5::Description>(/*acceleration*/ 15.0),
                                .period = 2ms,
                                .delay = 2ms,
                                .virtual_damping = 0},
                               RobotCompensatesFriction{});
    const Cycle scene(arm, GravityControl{});
    print<float>();
    print<double>();
  } catch (const ConfigurationError& refused) {
    std::fprintf(stderr, "%s\n", refused.what());
    return 3;
  }
}
