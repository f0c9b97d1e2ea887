#include "skinctl/tracking/target_plan.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <type_traits>

#include "skinctl/testing/random.hpp"
#include "skinctl/tracking/joint_space.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Plan = TargetPlan<JointSpace<2>>;
using Settings = JointControlSettings<2>;
static_assert(std::is_trivially_copyable_v<Plan>);
}  // namespace

TEST_CASE("TargetPlan: a moving target goes on as it came, for its age") {
  const Settings s;
  const JointReference<2> sample{JointPosition<2>{0.1, 0.2}, JointVelocity<2>{0.5, -0.3},
                                 JointAcceleration<2>{1.0, 2.0}};
  const auto plan = Plan::standing({}, s).to(sample, {}, s).memory;
  for (const double x : {0.0, 0.01, 0.05}) {
    const auto r = plan.at(x, s);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(r.q_d[i] == doctest::Approx(sample.q_d[i] + x * sample.dq_d[i] + 0.5 * x * x * sample.ddq_d[i]));
      CHECK(r.dq_d[i] == doctest::Approx(sample.dq_d[i] + x * sample.ddq_d[i]));
      CHECK(r.ddq_d[i] == doctest::Approx(sample.ddq_d[i]));
    }
  }
}

TEST_CASE("TargetPlan: a source that falls silent leaves its target at rest, half of the age further") {
  const Settings s;
  const JointReference<2> sample{JointPosition<2>{0.1, 0.2}, JointVelocity<2>{0.5, -0.3}, {}};
  auto plan = Plan::standing({}, s).to(sample, {}, s).memory;
  auto last = plan.at(0, s);
  for (int i = 0; i < 1000; ++i) {
    plan = plan.advanced(1ms, s);
    const auto now = plan.at(0, s);
    CHECK(magnitude(now.dq_d[0] - last.dq_d[0]) <= 0.5 * 1.9e-2);
    CHECK(magnitude(now.q_d[0] - last.q_d[0]) <= 0.5e-3 * 1.001);
    last = now;
  }
  CHECK(last.dq_d == JointVelocity<2>{});
  CHECK(last.ddq_d == JointAcceleration<2>{});
  CHECK(last.q_d[0] == doctest::Approx(0.1 + 0.5 * 0.15).epsilon(1e-3));
}

TEST_CASE("TargetPlan: a target that is not finite or too fast is refused, the old one stands") {
  const Settings s;
  const auto plan = Plan::standing(JointPosition<2>{0.7, 0.8}, s);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const JointReference<2>& r) {
    const auto answer = plan.to(r, {}, s);
    return answer.status == Status(Reason::goal_refused) &&
           answer.memory.at(1, s).q_d == JointPosition<2>{0.7, 0.8};
  };
  CHECK(refused({JointPosition<2>{nan, 0.0}, {}, {}}));
  CHECK(refused({{}, JointVelocity<2>{0.0, nan}, {}}));
  CHECK(refused({{}, {}, JointAcceleration<2>{std::numeric_limits<double>::infinity(), 0.0}}));
  CHECK(refused({{}, JointVelocity<2>{1.0, 0.0}, {}}));
  CHECK_FALSE(refused({{}, JointVelocity<2>{0.99, 0.0}, {}}));
}
