// One evaluation of each law: torque and next memory. Beside it what its equations cost by hand (the surface
// with Eigen and libm, the dynamics as the floor) and what KDL takes for the dynamics alone.
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <memory>
#include <new>

#include "bench/studies/floor/ur5_task_floor.hpp"
#include "bench/support/rows.hpp"
#include "bench/tactile/skin_floor.hpp"
#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/skinctl.hpp"
#include "tests/support/kdl_oracle.hpp"

using namespace skinctl;

namespace {

template <class T>
using Touch = LinkWrenches<ur5::Model, 0b111111, T>;
using Joints = Eigen::Array<double, 6, 1>;

constexpr double dt = 0.002;

/// Joints near a pose and slow, as they are where a law tracks; a touch of a few newton. From a pool.
template <class T>
class Scenes {
 public:
  Scenes() : scenes_(1024) {
    oracle::Random random(1);
    const double home[6] = {0, -1.2, 1.4, -1.8, -1.57, 0.3};
    for (auto& s : scenes_) {
      for (std::size_t i = 0; i < 6; ++i) {
        s.state.q[i] = static_cast<T>(home[i] + random.uniform(-0.02, 0.02));
        s.state.dq[i] = static_cast<T>(random.uniform(-0.1, 0.1));
      }
      for (auto& wrench : s.touch.data)
        for (T& x : wrench) x = static_cast<T>(random.uniform(-0.3, 0.3));
    }
  }
  struct Scene {
    State<6, T> state;
    Touch<T> touch;
  };
  const Scene& operator[](std::size_t i) const { return scenes_[i % 1024]; }

 private:
  std::vector<Scene> scenes_;
};

template <class T>
JointControlSettings<6, T> settings() {
  JointControlSettings<6, T> s;
  s.dt = nanoseconds(dt);
  s.lambda = T(25);
  s.K_c = T(5);
  s.tb = 4s;
  return s;
}

std::string name_of(const std::string& law, const char* end) {
  return "control/" + law + "/ur5/" + end;
}

/// `begin(law, known)` is the memory from which every 1024 evaluations start. Each evaluation is built where
/// it stays, in one of two places: a copy of its memory right after it was written would wait until all of it
/// has left for the cache.
template <class T, class L, class Begin>
void law_row(const std::string& name, const L& law, Begin begin) {
  benchmark::RegisterBenchmark(
      name_of(name, (std::string("skinctl/") + bench::scalar_name<T>).c_str()).c_str(),
      [law, begin](benchmark::State& state) {
        const Scenes<T> scenes;
        const ur5::Model model;
        using Known = Quantities<ur5::Model, L::needs, T, Touch<T>>;
        using Memory = typename L::Memory;
        const Memory first = bench::prepared(
            [&] { return begin(law, Known(model, scenes[0].state, T(dt), scenes[0].touch)); });
        const auto evaluated = [&](const Memory& memory, const auto& scene) SKINCTL_INLINE_LAMBDA {
          return evaluate(law, memory, Known(model, scene.state, T(dt), scene.touch), T(dt));
        };
        using Out = decltype(evaluated(first, scenes[0]));
        detail::Unwritten<Out, 2> places;
        const Memory* memory = &first;
        std::size_t k = 0;
        const bench::CountAllocations counted(state);
        for (auto _ : state) {
          if (++k % 1024 == 0) memory = &first;
          const Out* const out = new (&places.data[k % 2]) Out(evaluated(*memory, scenes[k]));
          memory = &out->memory;
          benchmark::DoNotOptimize(*out);
        }
      });
}

template <class T>
void skinctl_rows() {
  const auto stand = [](const auto& law, const auto& known) { return law.start(known); };
  const auto target = [](const auto& law, const auto& known) {
    auto q = known.q();
    q[0] += T(0.1);
    return law.receive(law.start(known), known, JointReference<6, T>{q, {}, {}}).memory;
  };
  const auto goal = [](const auto& law, const auto& known) {
    auto q = known.q();
    q[0] += T(0.5);
    return law.receive(law.start(known), known, JointGoal<6, T>{q, 4s}).memory;
  };
  const SplineJoint<6, T> spline(settings<T>());
  law_row<T>("joint_control", JointControl<6, T>(settings<T>()), target);
  law_row<T>("spline_joint", spline, goal);
  law_row<T>("gravity_control", GravityControl{}, stand);
  law_row<T>("skin_joint_control", SkinJointControl{}, stand);
  law_row<T>("spline_joint+skin+gravity", spline + SkinJointControl{} + GravityControl{}, goal);

  const auto X_LT = Transform<Link<5>, Tool, T>::translation_xyz(T(0), T(0), T(0.15));
  OperationalSettings<6, T> pose{.tracking = settings<T>()};
  const auto lift = [](const auto& law, const auto& known) {
    const auto X =
        known.template pose<5>() * Transform<Link<5>, Tool, T>::translation_xyz(T(0), T(0), T(0.15));
    const Transform<Base, Tool, T> above(X.axes(), X.origin() + Xyz<T>{T(0), T(0), T(0.1)});
    return law.receive(law.start(known), known, PoseGoal<Tool, T>{above, 4s}).memory;
  };
  using Pose = OperationalSpace<6, 5, Tool, T>;
  using Place = OperationalSpace<6, 5, Tool, T, TaskSpace::position>;
  const SplineOperational<6, 5, Tool, T> operational(Pose(X_LT, pose), pose);
  law_row<T>("spline_operational", operational, lift);
  law_row<T>("spline_operational-position",
             SplineOperational<6, 5, Tool, T, TaskSpace::position>(Place(X_LT, pose), pose), lift);
  law_row<T>("reactive_joint", ReactiveJoint<6, T>(settings<T>()), target);
  law_row<T>("skin_cartesian_control", SkinCartesianControl<5, Tool, T>(X_LT), stand);
  law_row<T>("force_control", ForceControl<6, 5, Tool, T>(X_LT, {.pose = pose}), stand);
  law_row<T>("joint_impedance", JointImpedance<6, T>(), stand);
  law_row<T>("cartesian_impedance", CartesianImpedance<6, 5, Tool, T>(Pose(X_LT, pose), {}), stand);
  law_row<T>("joint_limits", JointLimitLaw<6, T>(), stand);
  law_row<T>("null_space_posture",
             NullSpacePosture<6, 5, Tool, T>(X_LT, JointPosition<6, T>::constant(T(0.5))), stand);
  law_row<T>("adaptive_joint_control",
             Adaptive<JointControl<6, T>>(JointControl<6, T>(settings<T>()),
                                          {T(2), deviations<T>(ur5::Model{}, T(0.3))}),
             target);
  law_row<T>("spline_operational+skin+gravity", operational + SkinJointControl{} + GravityControl{}, lift);

  std::array<T, 36> K_d{};
  for (std::size_t i = 0; i < 6; ++i) K_d[7 * i] = T(0.02);
  auto gentle = settings<T>();
  gentle.lambda = T(1);
  law_row<T>("spline_joint-constant-K_d",
             SplineJoint<6, T, ConstantDamping<6, T>>(gentle, ConstantDamping<6, T>(ur5::Model{}, K_d)),
             goal);
}

/// Eqs. (9)-(14) as they stand, at a fixed target, then `Y_r Theta - K_d S_q`.
void tracking_by_hand(const State<6>& x, Joints& I1, Joints& I2, double* tau) {
  const Eigen::Map<const Joints> q(x.q.data), dq(x.dq.data);
  static const Joints q_d = (Joints() << 0.1, -1.2, 1.4, -1.8, -1.57, 0.3).finished();
  const Joints e = q - q_d, S = dq + 5 * e;
  const Joints sign = (10 * S).unaryExpr([](double v) { return std::tanh(v); });
  const Joints dq_r = -5 * e - I1 - 0.1 * I2;
  const Joints ddq_r = -5 * dq - S - 0.1 * sign - 25 * (dq - dq_r);
  I1 += dt * S, I2 += dt * sign;
  bench_floor::ur5::floor_yr_theta(x.q.data, x.dq.data, dq_r.data(), ddq_r.data(), tau);
}
/// A surface of the same equations. In rows of eight, two of which are of no joint: whole registers.
using Row = Eigen::Array<double, 8, 1>;
struct SurfaceByHand {
  Row S, sign, dq_r, ddq_r;
  SurfaceByHand(const Row& q, const Row& dq, const Row& I1, const Row& I2) {
    static const Row q_d = (Row() << 0.1, -1.2, 1.4, -1.8, -1.57, 0.3, 0, 0).finished();
    const Row e = q - q_d;
    S = dq + 5 * e;
    const Row scaled = 10 * S;
    math::tanh<8>(scaled.data(), sign.data());
    dq_r = -5 * e - I1 - 0.1 * I2;
    ddq_r = -5 * dq - S - 0.1 * sign;
  }
};
/// As the law reads them: the surface now, then in the middle of the interval that it predicts from it, and
/// the state there once more with what came out.
void tracking_ahead_by_hand(const Row& q, const Row& dq, Row& I1, Row& I2, double* tau) {
  constexpr double h = 0.5 * dt;
  const SurfaceByHand now(q, dq, I1, I2);
  const Row damped = 25 * (dq - now.dq_r), a = now.ddq_r - damped;
  const Row q_h = q + h * (dq + 0.5 * h * a), dq_h = dq + h * a;
  const SurfaceByHand ahead(q_h, dq_h, I1 + h * now.S, I2 + h * now.sign);
  const Row dv = h * (ahead.ddq_r - damped - a), dx = 0.5 * h * dv;
  const Row q_m = q_h + dx, dq_m = dq_h + dv, dq_r = ahead.dq_r - 5 * dx;
  const Row ddq_r = ahead.ddq_r - 5 * dv - damped;
  I1 += dt * now.S, I2 += dt * now.sign;
  bench_floor::ur5::floor_yr_theta(q_m.data(), dq_m.data(), dq_r.data(), ddq_r.data(), tau);
}
void skin_by_hand(const State<6>& x, const Touch<double>& touch, double* tau) {
  double s[6], c[6];
  math::sincos<6>(x.q.data, s, c);
  bench_floor::ur5_backward(s, c, touch.data, tau);
}

template <class F>
void twin_row(const std::string& law, const char* end, F evaluate) {
  benchmark::RegisterBenchmark(name_of(law, end).c_str(), [evaluate](benchmark::State& state) mutable {
    const Scenes<double> scenes;
    Joints I1 = Joints::Zero(), I2 = Joints::Zero();
    std::size_t k = 0;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      if (++k % 1024 == 0) I1.setZero(), I2.setZero();
      double tau[6] = {};
      evaluate(scenes[k], I1, I2, tau);
      benchmark::DoNotOptimize(tau);
    }
  });
}

void ahead_row() {
  benchmark::RegisterBenchmark(
      name_of("joint_control", "floor_ahead/double").c_str(), [](benchmark::State& state) {
        const Scenes<double> scenes;
        std::vector<std::array<Row, 2>> states(1024, {Row::Zero(), Row::Zero()});
        for (std::size_t k = 0; k < states.size(); ++k)
          for (std::size_t i = 0; i < 6; ++i) {
            const auto at = static_cast<Eigen::Index>(i);
            states[k][0][at] = scenes[k].state.q[i], states[k][1][at] = scenes[k].state.dq[i];
          }
        Row I1 = Row::Zero(), I2 = Row::Zero();
        std::size_t k = 0;
        const bench::CountAllocations counted(state);
        for (auto _ : state) {
          if (++k % 1024 == 0) I1.setZero(), I2.setZero();
          double tau[6] = {};
          tracking_ahead_by_hand(states[k % 1024][0], states[k % 1024][1], I1, I2, tau);
          benchmark::DoNotOptimize(tau);
        }
      });
}

void twin_rows() {
  ahead_row();
  for (const char* law : {"joint_control", "spline_joint"})
    twin_row(law, "floor/double", [](const auto& s, Joints& I1, Joints& I2, double* tau) {
      tracking_by_hand(s.state, I1, I2, tau);
    });
  twin_row("gravity_control", "floor/double", [](const auto& s, Joints&, Joints&, double* tau) {
    bench_floor::ur5::floor_gravity(s.state.q.data, tau);
  });
  twin_row("skin_joint_control", "floor/double",
           [](const auto& s, Joints&, Joints&, double* tau) { skin_by_hand(s.state, s.touch, tau); });
  twin_row("spline_joint+skin+gravity", "floor/double",
           [](const auto& s, Joints& I1, Joints& I2, double* tau) {
             double skin[6];
             tracking_by_hand(s.state, I1, I2, tau);
             skin_by_hand(s.state, s.touch, skin);
             for (std::size_t i = 0; i < 6; ++i) tau[i] += skin[i];
           });

  static const std::array<double, 12> target = [] {
    const Scenes<double> scenes;
    std::array<double, 12> X;
    double J[36];
    bench_floor::ur5::detail::tool_at(scenes[0].state.q.data, X.data(), J);
    X[11] += 0.01;
    return X;
  }();
  twin_row("spline_operational", "floor/double", [](const auto& s, Joints& I1, Joints& I2, double* tau) {
    bench_floor::ur5::floor_operational(s.state.q.data, s.state.dq.data, target.data(), dt, I1.data(),
                                        I2.data(), tau);
  });
  twin_row("force_control", "floor/double", [](const auto& s, Joints& I1, Joints& I2, double* tau) {
    double skin[6];
    skin_by_hand(s.state, s.touch, skin);
    const double v = 0.002 * (10 + bench_floor::ur5::floor_tool_force(s.state.q.data, skin));
    std::array<double, 12> moved = target;
    moved[11] += dt * v;
    bench_floor::ur5::floor_operational(s.state.q.data, s.state.dq.data, moved.data(), dt, I1.data(),
                                        I2.data(), tau);
  });

#if SKINCTL_HAS_KDL
  const auto robot = std::make_shared<oracle::KdlOracle>(oracle::ur5());
  const auto dynamics = [robot](const auto& s, double* tau) {
    robot->inverse_dynamics(s.state.q.data, s.state.dq.data, s.state.dq.data, tau);
  };
  const auto skin = [robot](const auto& s, double* tau) {
    double J[36];
    const double origin[3] = {0, 0, 0};
    for (int link = 0; link < 6; ++link) {
      robot->jacobian(link, origin, s.state.q.data, J);
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t j = 0; j < 6; ++j) tau[j] += J[6 * r + j] * s.touch.data[link][r];
    }
  };
  for (const char* law : {"joint_control", "spline_joint"})
    twin_row(law, "kdl/double", [=](const auto& s, Joints&, Joints&, double* tau) { dynamics(s, tau); });
  twin_row("gravity_control", "kdl/double",
           [=](const auto& s, Joints&, Joints&, double* tau) { robot->gravity(s.state.q.data, tau); });
  twin_row("skin_joint_control", "kdl_per_link/double",
           [=](const auto& s, Joints&, Joints&, double* tau) { skin(s, tau); });
  twin_row("spline_joint+skin+gravity", "kdl_per_link/double",
           [=](const auto& s, Joints&, Joints&, double* tau) { dynamics(s, tau), skin(s, tau); });
#endif
}

const bool registered = (skinctl_rows<double>(), skinctl_rows<float>(), twin_rows(), true);

}  // namespace
