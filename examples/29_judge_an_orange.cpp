// 29 Judge an orange: a gripper with skin squeezes it, and its stiffness says whether it is good (section 6).
//
//   k      least squares of closing on force from 0.5 to 4 N, less the skin's own compliance [N/m]
//   drawn  force over closing of a good and of a bad orange, and k while they are squeezed
#include "examples/worlds/squeezed_body.hpp"
#include "skinctl/tactile/squeeze.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const Squeeze<> squeeze({.finger_stiffness = 5000});
  constexpr double border = 800;  // between bad, about 400 N/m, and good, about 1500 N/m
  auto rng = skinctl::testing::seeded(5);
  Curve force[2]{{"good"}, {"bad"}}, k[2]{{"good"}, {"bad"}};
  double told[2] = {};
  for (int bad = 0; bad < 2; ++bad) {
    const skinctl::testing::SqueezedBody orange{
        .stiffness = bad ? 400.0 : 1500.0, .stiffening = 0.05, .speed = 0.005};
    Squeeze<>::Memory memory;
    double t = 0;
    orange.squeeze(rng, [&](double newton, double closing) {
      squeeze.take(memory, newton, closing);
      const auto now = squeeze.result(memory);
      t += 1 / orange.rate;
      force[bad].add(t, newton);
      k[bad].add(t, now.known ? now.stiffness : NAN);
    });
    told[bad] = squeeze.result(memory).stiffness;
  }
  int wrong = 0;
  constexpr int oranges = 500;
  for (int n = 0; n < oranges; ++n) {
    const bool bad = n % 2 == 1;
    Squeeze<>::Memory memory;
    const skinctl::testing::SqueezedBody orange{.stiffness = bad ? 400.0 : 1500.0, .stiffening = 0.05};
    orange.squeeze(rng, [&](double newton, double closing) { squeeze.take(memory, newton, closing); });
    wrong += (squeeze.result(memory).stiffness < border) != bad;
  }
  std::printf("good: %.0f N/m, bad: %.0f N/m; %d of %d oranges judged wrongly\n", told[0], told[1], wrong,
              oranges);
  return draw(argc, argv, "29_judge_an_orange.svg", "A good orange is stiff, a bad one is soft",
              {Panel("force [N]", {force[0], force[1]}), Panel("stiffness [N/m]", {k[0], k[1]})}) ||
         wrong != 0;
}
