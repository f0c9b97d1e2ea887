// Sines and cosines of as many angles as an arm and a hand have joints, beside the standard library and the
// blocks of the hand-written floor.
#include <array>

#include "bench/studies/floor/floor.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/math/sincos.hpp"

using namespace skinctl;
using bench::Numbers;

namespace {

template <std::size_t N, class T, class Policy>
void sincos_row(const std::string& implementation) {
  bench::row<N, T>("math/sincos/" + std::to_string(N) + "/" + implementation + "/" + bench::scalar_name<T>,
                   [](const auto& s) {
                     std::array<T, 2 * N> y;
                     math::sincos<N, Policy>(s.q.data, y.data(), y.data() + N);
                     return y;
                   });
}

template <class T>
void rows() {
  sincos_row<6, T, math::Fast>("skinctl");
  sincos_row<16, T, math::Fast>("skinctl");
  sincos_row<6, T, math::Libm>("libm");
  sincos_row<16, T, math::Libm>("libm");
}

const bool registered = [] {
  rows<double>();
  rows<float>();
  bench::row<6>("math/sincos/6/floor/double", [](const auto& s) {
    Numbers<12> y;
    const auto& q = s.q;
    bench_floor::sincos6(y.data, y.data + 6, q[0], q[1], q[2], q[3], q[4], q[5]);
    return y;
  });
  bench::row<16>("math/sincos/16/floor/double", [](const auto& s) {
    Numbers<32> y;
    const auto four = [&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      bench_floor::sincos4(y.data + i, y.data + 16 + i, s.q[i], s.q[i + 1], s.q[i + 2], s.q[i + 3]);
    };
    four(0), four(4), four(8), four(12);
    return y;
  });
  return true;
}();

}  // namespace
