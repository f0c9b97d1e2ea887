#include "skinctl/trajectory/pose_spline.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<PoseSpline<Tool>>);

TEST_CASE(
    "PoseSpline: a straight line and one turn, at rest at both ends, its derivatives being derivatives") {
  Seeded rng(4);
  const auto vector = [&] { return Xyz<double>{rng(), rng(), rng()}; };
  for (int k = 0; k < 50; ++k) {
    const Transform<Base, Tool> X_i(exp_so3(vector()), vector()),
        X_g(exp_so3(vector()) * X_i.axes(), vector());
    const PoseSpline<Tool> spline(X_i, X_g, 2.0);
    CHECK(spline.at(-1).X_BP == X_i);
    CHECK(spline.at(0).X_BP == X_i);
    CHECK(spline.at(2).X_BP == X_g);
    CHECK(spline.at(9).V.linear == Xyz<double>{0, 0, 0});
    for (double t = 0.1; t < 2; t += 0.2) {
      const double h = 1e-5;
      const auto now = spline.at(t), ahead = spline.at(t + h), behind = spline.at(t - h);
      const auto close = [&](const Xyz<double>& a, const Xyz<double>& b) {
        CHECK(std::sqrt(dot(a - b, a - b)) < 1e-7);
      };
      close((0.5 / h) * (ahead.X_BP.origin() - behind.X_BP.origin()), now.V.linear);
      close((0.5 / h) * log_so3(ahead.X_BP.axes() * behind.X_BP.axes().transpose()), now.V.angular);
      close((0.5 / h) * (ahead.V.linear - behind.V.linear), now.A.linear);
      close((0.5 / h) * (ahead.V.angular - behind.V.angular), now.A.angular);
      const auto along = cross(now.X_BP.origin() - X_i.origin(), X_g.origin() - X_i.origin());
      close(along, {0, 0, 0});
    }
  }
  CHECK(PoseSpline<Tool>(Transform<Base, Tool>(), Transform<Base, Tool>::translation_xyz(1, 0, 0), 0)
            .at(0)
            .X_BP.origin()
            .x == 1);
}
