// compiled alone: it runs Gappa and Sollya
// by night: rounding proofs
//
// Promise: the errors of sincos and tanh are proven, fused or not
// Tried: scripts for Gappa and Sollya written from the kernels' tables: sines and cosines 2.1e-16 (float
// 1.13e-7) up to the limit, tanh 2.9e-16 (1.54e-7); skipped, loudly, without the provers

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "bench/studies/proofs/rounding_unit.hpp"
#include "tests/math/kernel_scripts.hpp"

using namespace skinctl;
using namespace skinctl::testing;
namespace {

constexpr std::array<double, 6> ends = {0, 0.125, 0.25, 0.5, 0.65, 0.7856};

bool provers() {
  for (const char* name : {"gappa", "sollya"})
    if (!has_program(name)) {
      MESSAGE("SKIPPED: no ", std::string(name), ": the kernels' errors are not proven here");
      return false;
    }
  return true;
}
double gappa(const std::string& script) {
  const std::string answer = proved("gappa", script);
  const double end = upper_end(answer);
  if (!(end < 1)) MESSAGE(script, answer);
  return end;
}
double sollya(const std::string& script) {
  return std::strtod(proved("sollya --warnonstderr", script).c_str(), nullptr);
}

}  // namespace

TEST_CASE_TEMPLATE("kernels: the errors of sincos are proven, by the size of the result", T, float, double) {
  if (!provers()) return;
  using Table = math::detail::SinCosTable<T>;
  using Proven = math::detail::kernel_error<T>;
  const double high = ends.back();
  const double sine_method = sollya(method_error(Table::sin, "sin(x)", "x", 3, high, true));
  const double cosine_method = sollya(method_error(Table::cos, "cos(x)", "1", 2, high, false));
  REQUIRE(sine_method > 0);
  REQUIRE(cosine_method > 0);
  CHECK(sollya(rest_of_constant(Table::half_pi, "pi/2")) <= (sizeof(T) == 8 ? -121 : -54));
  for (const Fused fused : {Fused::no, Fused::yes}) {
    CHECK(gappa(sincos_quarter<T>(fused)) < 0.7856);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double from = ends[i], to = ends[i + 1];
      const double reduced = gappa(sincos_reduction<T>(to, fused));
      const double sine = gappa(sincos_polynomial<T>(true, from, to, fused)) + sine_method * std::sin(to) +
                          reduced * std::cos(from);
      const double cosine =
          gappa(sincos_polynomial<T>(false, from, to, fused)) + cosine_method + reduced * std::sin(to);
      CAPTURE(from);
      CAPTURE(sine);
      CAPTURE(cosine);
      CHECK(sine <=
            math::detail::turning_error(Proven::turning, std::sin(from) + 0.001, std::sin(to) - 0.001));
      CHECK(cosine <=
            math::detail::turning_error(Proven::turning, std::cos(to) + 0.001, std::cos(from) - 0.001));
      CHECK(std::max(sine, cosine) <= Proven::sine);
      MESSAGE(std::string(sizeof(T) == 4 ? "float" : "double"),
              std::string(fused == Fused::yes ? ", fused, " : ", "), from, " to ", to, ": sine ", sine,
              ", cosine ", cosine);
    }
  }
}

TEST_CASE_TEMPLATE("kernels: the errors of tanh are proven", T, float, double) {
  if (!provers()) return;
  using Table = math::detail::TanhTable<T>;
  const double method = sollya(method_error(Table::tanh, "tanh(x)", "x", 3, 0.1734, true));
  REQUIRE(method > 0);
  CHECK(sollya(rest_of_constant(Table::half_ln2, "log(2)/2")) <= (sizeof(T) == 8 ? -98 : -45));
  double worst = 0;
  const int most = static_cast<int>(static_cast<double>(Table::saturated) / 0.34657 + 1);
  for (const Fused fused : {Fused::no, Fused::yes}) {
    const double polynomial = gappa(tanh_polynomial<T>(fused)) + method * 0.1718;
    const double reduced = gappa(tanh_reduction<T>(fused));
    for (int k = 0; k <= most; k = k < 4 ? k + 1 : 2 * k) {
      // The formula's slope over w, and that of w over h is at most 1.
      const double a = std::ldexp(1.0, k), at = (a + 1) - (a - 1) * 0.1718,
                   slope = k == 0 ? 1 : 4 * a / (at * at);
      const double error =
          (k == 0 ? 0 : gappa(tanh_formula<T>(k, fused))) + (polynomial + (k == 0 ? 0 : reduced)) * slope;
      CAPTURE(k);
      CAPTURE(error);
      CHECK(error <= math::detail::kernel_error<T>::tanh);
      worst = std::max(worst, error);
    }
  }
  MESSAGE(std::string(sizeof(T) == 4 ? "float" : "double"), ": tanh ", worst);
}
