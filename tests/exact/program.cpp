// Prints a hash of what the library computes: equal bits are equal hashes, whoever compiled it. With
// SKINCTL_EXACT_WHOLE also of a whole closed loop.
#include <bit>
#include <cstdint>
#include <cstdio>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/math/tanh.hpp"
#include "skinctl/robots/ur5.hpp"
#if defined(SKINCTL_EXACT_WHOLE)
#include <memory>

#include "tests/support/scene.hpp"
#endif

using namespace skinctl;

namespace {

struct Hash {
  std::uint64_t value = 1469598103934665603u;
  template <class T>
  void add(T x) noexcept {
    std::uint64_t bits = 0;
    if constexpr (sizeof(T) == 8) {
      bits = std::bit_cast<std::uint64_t>(x);
    } else {
      bits = std::bit_cast<std::uint32_t>(x);
    }
    for (int k = 0; k < 8; ++k, bits >>= 8) value = (value ^ (bits & 255u)) * 1099511628211u;
  }
};

/// Complex products, as a user's own loop has them: GCC's vectorisers make fused pairs of them.
template <class T>
[[gnu::noinline]] void multiply(const T* __restrict a, const T* __restrict b, T* __restrict out,
                                std::size_t n) {
  for (std::size_t i = 0; i < 2 * n; i += 2) {
    out[i] = a[i] * b[i] - a[i + 1] * b[i + 1];
    out[i + 1] = a[i] * b[i + 1] + a[i + 1] * b[i];
  }
}

template <class T>
void quantities(Hash& hash) {
  const ur5::Model model;
  std::uint64_t state = 88172645463325252u;
  const auto next = [&] {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return static_cast<T>(static_cast<double>(state >> 40) * 0x1p-22 - 2);  // exact in both scalars
  };
  for (int k = 0; k < 2000; ++k) {
    JointPosition<6, T> q;
    JointVelocity<6, T> dq;
    JointTorque<6, T> tau;
    for (std::size_t i = 0; i < 6; ++i) q[i] = next(), dq[i] = next(), tau[i] = next();
    const auto poses = link_poses(model, q);
    const auto at = poses.template place<5>();
    hash.add(at.p.x), hash.add(at.p.y), hash.add(at.p.z), hash.add(at.x.x), hash.add(at.z.z);
    jacobian<5>(poses).for_each(
        [&](auto, const auto& column) { hash.add(column.linear.x), hash.add(column.linear.z); });
    for (const T& x : gravity_torque(model, q)) hash.add(x);
    for (const T& x : forward_dynamics(model, q, dq, tau).acceleration) hash.add(x);
    T y[6];
    math::tanh<6>(q.data, y);
    for (const T& x : y) hash.add(x);
    T products[6];
    multiply(q.data, y, products, 3);
    for (const T& x : products) hash.add(x);
  }
}

#if defined(SKINCTL_EXACT_WHOLE)
template <class T>
void whole(Hash& hash) {
  const auto scene = testing::reaching_scene<Interface::position, 260, T>();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  State<6, T> state;
  state.q = testing::home_position<T>();
  auto memory = std::make_unique<typename Scene::Memory>(scene.start(state));
  auto input = std::make_unique<typename Scene::Input>();
  CellSample sample;
  for (int k = 1; k <= 500; ++k) {
    input->now = state.time = k * 8ms;
    sample = {
        .time = input->now - 1ms, .cell = static_cast<std::uint32_t>(20 + k / 3), .force = {0.4f, 0, 0}};
    input->measured = state;
    input->samples = {&sample, 1};
    const auto out = scene.step(*memory, *input);
    for (const T& x : out.command.position) hash.add(x);
    state.q = out.command.position;
    state.dq = out.command.velocity;
  }
}
#endif

template <class T>
void print(const char* name) {
  Hash hash;
  quantities<T>(hash);
#if defined(SKINCTL_EXACT_WHOLE)
  whole<T>(hash);
#endif
  std::printf("%s %016llx\n", name, static_cast<unsigned long long>(hash.value));
}

}  // namespace

int main() {
  print<float>("float");
  print<double>("double");
}
