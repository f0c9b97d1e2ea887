// Random states from a pool, so that no benchmark learns its input by heart.
#pragma once

#include <array>
#include <vector>

#include "skinctl/core/joint.hpp"
#include "tests/support/robot_table.hpp"

namespace skinctl::bench {

template <std::size_t N, class T = double>
struct Motion {
  JointPosition<N, T> q;
  JointVelocity<N, T> dq, dq_r;
  JointAcceleration<N, T> ddq;
  JointTorque<N, T> tau;
};

/// 1024 states, positions within +-pi, everything else within +-3; the same in every run and for every
/// scalar.
template <std::size_t N, class T = double>
class States {
 public:
  static constexpr std::size_t count = 1024;

  States() : pool_(count) {
    oracle::Random random(1);
    for (auto& s : pool_) {
      for (auto& x : s.q) x = static_cast<T>(random.uniform(-3.14159, 3.14159));
      for (auto& x : s.dq) x = static_cast<T>(random.uniform(-3, 3));
      for (auto& x : s.dq_r) x = static_cast<T>(random.uniform(-3, 3));
      for (auto& x : s.ddq) x = static_cast<T>(random.uniform(-3, 3));
      for (auto& x : s.tau) x = static_cast<T>(random.uniform(-30, 30));
    }
  }
  /// The next state.
  const Motion<N, T>& next() noexcept { return pool_[i_++ % count]; }

 private:
  std::vector<Motion<N, T>> pool_;
  std::size_t i_ = 0;
};

/// Keeps the compiler from computing ahead with a model's numbers.
template <class M>
void hide(M& model) {
  asm volatile("" : "+m"(model));
}

}  // namespace skinctl::bench
