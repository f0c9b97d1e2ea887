// Prints how exact the library is: for every robot that ships, and for chains at the edge, the errors of
// poses, Jacobians and dynamics in units of the last place, float and double, against 50 digits.
//
//     accuracy [states per robot, 10000 by default]
#include "tests/support/accuracy.hpp"

#include <cstdio>
#include <cstdlib>
#include <functional>

#include "skinctl/robots/universal_robots.hpp"
#include "skinctl/robots/ur5_allegro.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Sets a state as it likes, after it was filled with random numbers: q within +-pi, dq and ddq within +-3.
using Choose = std::function<void(oracle::Random&, double* q, double* dq, double* ddq)>;

std::string cell(double ulps) {
  char text[32];
  if (ulps >= 1e300) return "-";
  std::snprintf(text, sizeof text, ulps < 100 ? "%.1f" : ulps < 1e5 ? "%.0f" : "%.0e", ulps);
  return text;
}
void print(const std::string& what, const char* scalar, int states, const Ulps& u) {
  std::printf("| %s | %s | %d | %s | %s | %s | %s | %s | %s | %s |\n", what.c_str(), scalar, states,
              cell(u.pose).c_str(), cell(u.jacobian).c_str(), cell(u.inverse_dynamics).c_str(),
              cell(u.gravity).c_str(), cell(u.mass).c_str(), cell(u.acceleration).c_str(),
              cell(u.explained).c_str());
  std::fflush(stdout);
}

template <class T, RobotModel M>
Ulps worst(const M& model, const Exact& exact, int states, const Choose& choose) {
  constexpr std::size_t N = M::joints;
  oracle::Random random(1);
  Ulps all;
  for (int k = 0; k < states; ++k) {
    double q[N], dq[N], ddq[N];
    for (std::size_t i = 0; i < N; ++i) {
      q[i] = random.uniform(-3.14159, 3.14159);
      dq[i] = random.uniform(-3, 3);
      ddq[i] = random.uniform(-3, 3);
    }
    choose(random, q, dq, ddq);
    JointPosition<N, T> Q;
    JointVelocity<N, T> V;
    JointAcceleration<N, T> A;
    for (std::size_t i = 0; i < N; ++i) {
      Q[i] = static_cast<T>(q[i]);
      V[i] = static_cast<T>(dq[i]);
      A[i] = static_cast<T>(ddq[i]);
    }
    all.note(ulps_at<T>(model, exact, Q, V, A));
  }
  return all;
}

void as_it_comes(oracle::Random&, double*, double*, double*) {}

/// One robot in both scalars.
template <RobotModel D, RobotModel F>
void row(const std::string& what, const D& in_double, const F& in_float, int states,
         const Choose& choose = as_it_comes) {
  const Exact exact = exact_tree(in_double);
  print(what, "double", states, worst<double>(in_double, exact, states, choose));
  print(what, "float", states, worst<float>(in_float, exact, states, choose));
}
template <RobotModel M>
void row(const std::string& what, const M& model, int states, const Choose& choose = as_it_comes) {
  row(what, model, model, states, choose);
}

/// An arm with its numbers at run time: one type for all of them.
template <class Description>
void arm_row(const std::string& what, int states) {
  typename CalibratedModel<Chain<6>, float>::Links narrow;
  for (std::size_t i = 0; i < 6; ++i) narrow[i] = Description::links[i].template cast<float>();
  row(what, CalibratedModel<Chain<6>>(Description::links, {0, 0, -9.81}, makers_density),
      CalibratedModel<Chain<6>, float>(narrow, {0, 0, -9.81f}, makers_density), states);
}

/// A chain of seven whose links `make` says.
template <class F>
void chain_row(const std::string& what, int states, F make, const Choose& choose = as_it_comes) {
  const auto links = [&](auto zero) {
    using T = decltype(zero);
    typename CalibratedModel<Chain<7>, T>::Links numbers;
    for (std::size_t i = 0; i < 7; ++i) numbers[i] = LinkParameters<double>(make(i)).template cast<T>();
    return CalibratedModel<Chain<7>, T>(numbers);
  };
  row(what, links(0.0), links(0.0f), states, choose);
}

LinkParameters<double> link(std::size_t i, const LinkInertia& inertia) {
  return make_link({.p = {i % 2 == 0 ? 0.3 : 0.0, 0.1, 0.2}, .alpha = Angle::quarter(i % 2 == 0 ? 1 : -1)},
                   inertia);
}
/// A link of 0.3 m with the given mass.
LinkInertia rod(double m) {
  return {m, {0.15, 0.02, 0.05}, 0.002 * m, 0.009 * m, 0.0085 * m, 0.0004 * m, 0.0001 * m, -0.0002 * m};
}

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::max(1, std::atoi(argv[1])) : 10000;
  const int some = std::max(1, n / 10);
  std::printf(
      "Largest error in units of the last place, against 50 digits. The unit is that of the result's scale: "
      "1 for axes, the reach for\norigins, the largest element for Jacobians, M and accelerations, the sum "
      "of "
      "the links' shares for torques. Last column: the error in torque\nthat explains the error of the "
      "acceleration, which itself grows with the condition of M.\n\n");
  std::printf(
      "| robot, states | scalar | states | poses | J | inverse dynamics | G | M | ddq | as torque |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|\n");

  row("UR5", ur5::Model{}, n);
  arm_row<ur3::Description>("UR3", n);
  arm_row<ur5::Description>("UR5, numbers at run time", n);
  arm_row<ur10::Description>("UR10", n);
  arm_row<ur3e::Description>("UR3e", n);
  arm_row<ur5e::Description>("UR5e", n);
  arm_row<ur10e::Description>("UR10e", n);
  row("Allegro, right", allegro::right_hand(), allegro::right_hand<float>(), n);
  row("Allegro, left", allegro::left_hand(), allegro::left_hand<float>(), n);
  row("UR5 + Allegro", ur5_allegro::arm_with_hand(), ur5_allegro::arm_with_hand<float>(), n);
  const Stand right{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {0, -0.2, 1.1}};
  const Stand left{{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {0, 0.2, 1.1}};
  row("two UR5 + Allegro", ur5_allegro::two_arms_with_hands(right, left),
      ur5_allegro::two_arms_with_hands<float>(right, left), n);

  const double pi = 3.14159265358979323846;
  const ur5::Model arm;
  row("UR5 straight, q = 0", arm, some, [](auto&, double* q, double*, double*) { std::fill(q, q + 6, 0.0); });
  row("UR5 upright", arm, some, [=](auto&, double* q, double*, double*) {
    std::fill(q, q + 6, 0.0);
    q[1] = q[3] = -pi / 2;
  });
  row("UR5, elbow stretched or folded", arm, some,
      [=](auto& random, double* q, double*, double*) { q[2] = random.index(2) == 0 ? 0 : pi; });
  row("UR5, wrist singular", arm, some,
      [=](auto& random, double* q, double*, double*) { q[4] = random.index(2) == 0 ? 0 : pi; });
  row("UR5, wrist above the base", arm, some, [=](auto&, double* q, double*, double*) {
    // Where the axes 4 and 5 meet has no distance from axis 0 in the plane of the arm: a2 c2 + a3 c23 = d5 s.
    using D = ur5::Description;
    const double s234 = 0.5 * q[3];
    double low = 0, high = pi;
    const auto away = [&](double q1) {
      return D::a2 * std::cos(q1) + D::a3 * std::cos(q1 + q[2]) + D::d5 * std::sin(s234);
    };
    if ((away(low) < 0) == (away(high) < 0)) return;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      ((away(middle) < 0) == (away(low) < 0) ? low : high) = middle;
    }
    q[1] = low;
    q[3] = s234 - q[1] - q[2];
  });
  const Choose turned = [](auto& random, double* q, double*, double*) {
    for (int i = 0; i < 6; ++i) q[i] += (random.index(2) == 0 ? 1 : -1) * 1e6;
  };
  row("UR5, q = 1e6 rad", arm, some, turned);
  row("UR5, dq = 1e3 rad/s", arm, some, [](auto& random, double*, double* dq, double*) {
    for (int i = 0; i < 6; ++i) dq[i] = random.uniform(-1e3, 1e3);
  });
  row("UR5, q = 1e-8 rad", arm, some, [](auto&, double* q, double*, double*) {
    for (int i = 0; i < 6; ++i) q[i] *= 1e-8;
  });
  row("Allegro, fingers straight", allegro::right_hand(), allegro::right_hand<float>(), some,
      [](auto&, double* q, double*, double*) { std::fill(q, q + 16, 0.0); });

  chain_row("masses 1e6 to 1e-6 kg, tip light", some,
            [](std::size_t i) { return link(i, rod(std::pow(10.0, 6 - 2 * static_cast<double>(i)))); });
  chain_row("masses 1e-6 to 1e6 kg, tip heavy", some,
            [](std::size_t i) { return link(i, rod(std::pow(10.0, 2 * static_cast<double>(i) - 6))); });
  chain_row("masses 1e6 and 1e-6 kg in turns", some,
            [](std::size_t i) { return link(i, rod(i % 2 == 0 ? 1e6 : 1e-6)); });
  chain_row("flat links (s_zz = 0)", some,
            [](std::size_t i) { return link(i, {1, {0.15, 0.02, 0}, 0.003, 0.004, 0.007}); });
  chain_row("links on a line (two moments 0)", some,
            [](std::size_t i) { return link(i, {1, {0.15, 0, 0}, 0, 0.0075, 0.0075}); });
  chain_row("point masses", some, [](std::size_t i) { return link(i, {1, {0.15, 0.02, 0.1}, 0, 0, 0}); });
}
