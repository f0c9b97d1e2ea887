// Factors of a square matrix and one solution with them, beside Eigen's.
#include <Eigen/LU>

#include "bench/support/matrices.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/math/lu.hpp"

using namespace skinctl;

namespace {

template <std::size_t N, class T>
void rows() {
  const std::string name = "math/lu/" + std::to_string(N);
  const std::string end = std::string("/") + bench::scalar_name<T>;
  bench::matrix_row<N, T>(name + "/skinctl" + end,
                          [](const auto& system, T* x) { math::Lu<N, T>(system.square).solve(system.b, x); });
  using Matrix = Eigen::Matrix<T, int(N), int(N), Eigen::RowMajor>;
  using Vector = Eigen::Matrix<T, int(N), 1>;
  bench::matrix_row<N, T>(name + "/eigen" + end, [](const auto& system, T* x) {
    Eigen::Map<Vector>{x} =
        Eigen::Map<const Matrix>(system.square).partialPivLu().solve(Eigen::Map<const Vector>(system.b));
  });
}

const bool registered = [] {
  rows<3, double>();
  rows<6, double>();
  rows<16, double>();
  rows<22, double>();
  rows<6, float>();
  rows<16, float>();
  return true;
}();

}  // namespace
