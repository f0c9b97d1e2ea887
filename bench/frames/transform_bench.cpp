// What a typed pose costs: nothing over twelve plain numbers, and less than Eigen's isometry.
#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "bench/support/bench.hpp"
#include "skinctl/frames/wrench.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;

namespace {

/// A pose as a C programmer writes it: columns, then the origin.
template <class T>
struct Plain {
  T R[9], p[3];
};
template <class T>
struct PlainWrench {
  T f[3], m[3];
};

template <class T>
inline Plain<T> compose(const Plain<T>& a, const Plain<T>& b) {
  Plain<T> c;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      c.R[3 * j + i] = a.R[i] * b.R[3 * j] + a.R[3 + i] * b.R[3 * j + 1] + a.R[6 + i] * b.R[3 * j + 2];
  for (int i = 0; i < 3; ++i) c.p[i] = a.p[i] + a.R[i] * b.p[0] + a.R[3 + i] * b.p[1] + a.R[6 + i] * b.p[2];
  return c;
}
template <class T>
inline Plain<T> inverse(const Plain<T>& a) {
  Plain<T> c;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) c.R[3 * j + i] = a.R[3 * i + j];
  for (int i = 0; i < 3; ++i)
    c.p[i] = -(a.R[3 * i] * a.p[0] + a.R[3 * i + 1] * a.p[1] + a.R[3 * i + 2] * a.p[2]);
  return c;
}
template <class T>
inline PlainWrench<T> carry(const Plain<T>& a, const PlainWrench<T>& w) {
  PlainWrench<T> c;
  T m[3];
  for (int i = 0; i < 3; ++i) {
    c.f[i] = a.R[i] * w.f[0] + a.R[3 + i] * w.f[1] + a.R[6 + i] * w.f[2];
    m[i] = a.R[i] * w.m[0] + a.R[3 + i] * w.m[1] + a.R[6 + i] * w.m[2];
  }
  c.m[0] = m[0] + (a.p[1] * c.f[2] - a.p[2] * c.f[1]);
  c.m[1] = m[1] + (a.p[2] * c.f[0] - a.p[0] * c.f[2]);
  c.m[2] = m[2] + (a.p[0] * c.f[1] - a.p[1] * c.f[0]);
  return c;
}

template <class T>
using Isometry = Eigen::Transform<T, 3, Eigen::Isometry>;
template <class T>
struct EigenWrench {
  Vec3<T> f, m;
};

/// The same 1024 random poses and wrenches, as each implementation stores them.
template <class T>
struct Pool {
  static constexpr std::size_t count = 1024;
  std::vector<Transform<World, World, T>> typed;
  std::vector<Wrench<Tool, World, World, T>> wrench;
  std::vector<Plain<T>> plain;
  std::vector<PlainWrench<T>> plain_wrench;
  std::vector<Isometry<T>, Eigen::aligned_allocator<Isometry<T>>> eigen;
  std::vector<EigenWrench<T>, Eigen::aligned_allocator<EigenWrench<T>>> eigen_wrench;

  Pool() {
    auto rng = testing::seeded(1);
    for (std::size_t i = 0; i < count; ++i) {
      const auto X = testing::random_transform<World, World>(rng, T(1));
      const auto f = testing::random_xyz(rng, T(1)), m = testing::random_xyz(rng, T(1));
      typed.push_back(X);
      wrench.push_back({f, m});
      const auto &x = X.axis_x(), &y = X.axis_y(), &z = X.axis_z(), &p = X.origin();
      plain.push_back({{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}, {p.x, p.y, p.z}});
      plain_wrench.push_back({{f.x, f.y, f.z}, {m.x, m.y, m.z}});
      eigen.push_back(as_eigen(X));
      eigen_wrench.push_back({as_eigen(f), as_eigen(m)});
    }
  }
};
template <class T>
const Pool<T>& pool() {
  static const Pool<T> poses;
  return poses;
}

/// `evaluate(i, j)` of two changing places in the pool.
template <class F>
void row(const std::string& name, F evaluate) {
  benchmark::RegisterBenchmark(name.c_str(), [evaluate](benchmark::State& state) {
    static_cast<void>(evaluate(0, 1));
    std::size_t i = 0;
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      auto result = evaluate(i % 1024, (i + 7) % 1024);
      ++i;
      benchmark::DoNotOptimize(result);
    }
  });
}

template <class T>
void rows(const std::string& scalar) {
  const Pool<T>& p = pool<T>();
  const std::string compose_of = "frames/compose/transform/", inverse_of = "frames/inverse/transform/",
                    wrench_of = "frames/carry/wrench/", exp_of = "frames/exp/rotation/",
                    log_of = "frames/log/rotation/";
  row(compose_of + "skinctl/" + scalar,
      [&p](std::size_t i, std::size_t j) { return p.typed[i] * p.typed[j]; });
  row(compose_of + "eigen/" + scalar,
      [&p](std::size_t i, std::size_t j) { return Isometry<T>(p.eigen[i] * p.eigen[j]); });
  row(compose_of + "floor/" + scalar,
      [&p](std::size_t i, std::size_t j) { return compose(p.plain[i], p.plain[j]); });

  row(inverse_of + "skinctl/" + scalar, [&p](std::size_t i, std::size_t) { return p.typed[i].inverse(); });
  row(inverse_of + "eigen/" + scalar,
      [&p](std::size_t i, std::size_t) { return Isometry<T>(p.eigen[i].inverse()); });
  row(inverse_of + "floor/" + scalar, [&p](std::size_t i, std::size_t) { return inverse(p.plain[i]); });

  row(wrench_of + "skinctl/" + scalar,
      [&p](std::size_t i, std::size_t j) { return p.typed[i] * p.wrench[j]; });
  row(wrench_of + "eigen/" + scalar, [&p](std::size_t i, std::size_t j) {
    EigenWrench<T> w;
    w.f.noalias() = p.eigen[i].linear() * p.eigen_wrench[j].f;
    w.m.noalias() = p.eigen[i].linear() * p.eigen_wrench[j].m;
    w.m += p.eigen[i].translation().cross(w.f);
    return w;
  });
  row(wrench_of + "floor/" + scalar,
      [&p](std::size_t i, std::size_t j) { return carry(p.plain[i], p.plain_wrench[j]); });

  row(exp_of + "skinctl/" + scalar,
      [&p](std::size_t i, std::size_t) { return exp_so3(p.typed[i].origin()); });
  row(exp_of + "eigen/" + scalar, [&p](std::size_t i, std::size_t) {
    const Vec3<T> phi = p.eigen[i].translation();
    const T angle = phi.norm();
    return Mat3<T>(Eigen::AngleAxis<T>(angle, phi / angle).toRotationMatrix());
  });
  row(log_of + "skinctl/" + scalar, [&p](std::size_t i, std::size_t) { return log_so3(p.typed[i].axes()); });
  row(log_of + "eigen/" + scalar, [&p](std::size_t i, std::size_t) {
    const Eigen::Quaternion<T> q(p.eigen[i].linear());
    const T length = q.vec().norm();
    return Vec3<T>(T(2) * std::atan2(length, q.w()) / length * q.vec());
  });
}

const bool registered = (rows<double>("double"), rows<float>("float"), true);

}  // namespace
