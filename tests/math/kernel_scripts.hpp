// Scripts for Gappa and Sollya, written from the tables of the kernels: what each rounding and each
// polynomial may be off, for a proof by machine.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <type_traits>

#include "skinctl/math/detail/sincos_kernel.hpp"
#include "skinctl/math/detail/tanh_kernel.hpp"

namespace skinctl::testing {

inline std::string hex(double x) {
  char text[64];
  std::snprintf(text, sizeof text, "%a", x);
  return text;
}

/// A product whose sum is rounded once (a fused multiplication and addition), or twice.
enum class Fused : bool { no, yes };

template <class T>
std::string rounding() {
  return std::string("@rnd = float<") + (sizeof(T) == 8 ? "ieee_64" : "ieee_32") + ", ne>;\n";
}
/// Horner's scheme as `polynomial` has it, rounded into `name` and exact into its capital.
template <class T, std::size_t N>
std::string horner(const T (&c)[N], const char* name, const char* exact, const char* z, const char* Z,
                   Fused fused) {
  std::string text, y = hex(static_cast<double>(c[N - 1])), Y = y;
  for (std::size_t i = N - 1; i-- > 0;) {
    const std::string next = std::string(name) + std::to_string(i);
    text += next + (fused == Fused::yes ? " = rnd(" + y + " * " + z : " = rnd(rnd(" + y + " * " + z + ")");
    text += " + " + hex(static_cast<double>(c[i])) + ");\n";
    Y = "(" + Y + " * " + Z + " + " + hex(static_cast<double>(c[i])) + ")";
    y = next;
  }
  return text + name + " = " + y + ";\n" + exact + " = " + Y + ";\n";
}
inline std::string interval(double low, double high) {
  return "[" + hex(low) + ", " + hex(high) + "]";
}

/// `sin_r` or `cos_r` of `sincos_kernel` against its polynomial without rounding, for |r| from `low` to
/// `high`.
template <class T>
std::string sincos_polynomial(bool sine, double low, double high, Fused fused) {
  using Table = math::detail::SinCosTable<T>;
  std::string s = rounding<T>() + "r = rnd(r_);\nz rnd= r * r;\nZ = r * r;\n";
  if (sine) {
    s += horner(Table::sin, "p", "P", "z", "Z", fused) + "rz rnd= r * z;\n";
    s += fused == Fused::yes ? "y = rnd(r + rz * p);\n" : "y = rnd(r + rnd(rz * p));\n";
    s += "Y = r + (r * Z) * P;\n";
  } else {
    s += horner(Table::cos, "p", "P", "z", "Z", fused);
    s += fused == Fused::yes ? "y = rnd(1 + z * p);\n" : "y = rnd(1 + rnd(z * p));\n";
    s += "Y = 1 + Z * P;\n";
  }
  return s + "{ r in " + interval(low, high) + " -> |y - Y| in ? }\n";
}

/// The reduced argument against `x - k pi/2`, where it is at most `high` in magnitude and k is not 0. (For k
/// = 0 it is x.) Also shows that the first two products, and the first difference, are exact.
template <class T>
std::string sincos_reduction(double high, Fused fused) {
  using Table = math::detail::SinCosTable<T>;
  const auto h = [](int i) { return hex(static_cast<double>(Table::half_pi[i])); };
  const std::string product = fused == Fused::yes ? " = " : " rnd= ";
  const double most = std::floor(static_cast<double>(Table::limit) / 1.5707963 + 1);
  std::string s =
      rounding<T>() + "h0 = " + h(0) + ";\nh1 = " + h(1) + ";\nh2 = " + h(2) + ";\nx = rnd(x_);\n";
  s += "kh0" + product + "k * h0;\nr1 rnd= x - kh0;\n";
  s += "kh1" + product + "k * h1;\nr2 rnd= r1 - kh1;\n";
  s += "kh2" + product + "k * h2;\nr3 rnd= r2 - kh2;\n";
  s += "R = (((x - k * h0) - k * h1) - k * h2) - k * d;\n";
  // From pi/4 on, x is a multiple of its last place there.
  s += "{ @FIX(k, 0) /\\ |k| in [1, " + std::to_string(static_cast<long>(most)) + "] /\\ @FIX(x, " +
       std::to_string(-std::numeric_limits<T>::digits) +
       ") /\\ |x - k * h0| <= 0.8 /\\ |r1 - kh1| <= " + hex(high) + " /\\ |r2 - kh2| <= " + hex(high) +
       " /\\ |d| <= " + (sizeof(T) == 8 ? "1b-121" : "1b-54") +
       "\n  -> |r3 - R| in ? /\\ kh0 - k * h0 in [0, 0] /\\ kh1 - k * h1 in [0, 0] /\\ r1 - (x - kh0) in [0, "
       "0] }\n";
  s += "r3 - R -> (r3 - (r2 - kh2)) + (r2 - (r1 - kh1)) + (r1 - (x - kh0)) - (kh0 - k * h0) - (kh1 - k * h1)"
       " - (kh2 - k * h2) + k * d;\n";
  return s;
}
/// That the reduced argument stays within the polynomials' range.
template <class T>
std::string sincos_quarter(Fused fused) {
  using Table = math::detail::SinCosTable<T>;
  const std::string turns = fused == Fused::yes ? "(x * tp)" : "rnd(x * tp)";
  return rounding<T>() + "x = rnd(x_);\ntp = " + hex(static_cast<double>(Table::two_over_pi)) +
         ";\nk = int<ne>(" + turns + ");\nR = x - k * H;\n{ |x| in [0.5, " +
         std::to_string(static_cast<long>(Table::limit)) + "] /\\ |tp * H - 1| <= 1b-" +
         std::to_string(std::numeric_limits<T>::digits) +
         " /\\ H in [1.57079632, 1.57079633] -> |R| in ? }\nR -> x * (1 - tp * H) - ((k - " + turns +
         ") + (" + turns + " - x * tp)) * H;\n";
}

/// The `w` of `tanh_kernel` against its polynomial without rounding.
template <class T>
std::string tanh_polynomial(Fused fused) {
  using Table = math::detail::TanhTable<T>;
  return rounding<T>() + "h = rnd(h_);\nz rnd= h * h;\nZ = h * h;\n" +
         horner(Table::tanh, "p", "P", "z", "Z", fused) + "hz rnd= h * z;\n" +
         (fused == Fused::yes ? "w = rnd(h + hz * p);\n" : "w = rnd(h + rnd(hz * p));\n") +
         "W = h + (h * Z) * P;\n{ h in [-0.1734, 0.1734] -> |w - W| in ? }\n";
}
/// The formula of `tanh_kernel` for k halves of ln 2, against the same without rounding, for any w. For k = 0
/// it is w.
template <class T>
std::string tanh_formula(int k, Fused fused) {
  const bool far = k >= 3;
  std::string s =
      rounding<T>() + "w = rnd(w_);\na = 1b" + std::to_string(k) + ";\nb rnd= a + 1;\nc rnd= a - 1;\n";
  const auto sum = [&](const char* product, const char* other) {
    return std::string(fused == Fused::yes ? "rnd(" : "rnd(rnd(") + product +
           (fused == Fused::yes ? "" : ")") + other + ");\n";
  };
  s += "n = " + (far ? sum("2 * w", " - 2") : sum("b * w", " + c"));
  s += "m = " + sum("c * w", " + b");
  s += far ? "N = 2 * w - 2;\n" : "N = (a + 1) * w + (a - 1);\n";
  s += "M = (a - 1) * w + (a + 1);\n";
  s += far ? "y = rnd(1 + rnd(n / m));\nY = 1 + N / M;\n" : "y = rnd(n / m);\nY = N / M;\n";
  return s + "{ w in [-0.1718, 0.1718] -> |y - Y| in ? }\n";
}
/// The reduced argument of `tanh_kernel` against `x - k ln(2)/2`, k > 0.
template <class T>
std::string tanh_reduction(Fused fused) {
  using Table = math::detail::TanhTable<T>;
  const std::string product = fused == Fused::yes ? " = " : " rnd= ";
  const double most = std::floor(static_cast<double>(Table::saturated) / 0.34657 + 1);
  return rounding<T>() + "h0 = " + hex(static_cast<double>(Table::half_ln2[0])) +
         ";\nh1 = " + hex(static_cast<double>(Table::half_ln2[1])) + ";\nx = rnd(x_);\nkh0" + product +
         "k * h0;\nr1 rnd= x - kh0;\nkh1" + product +
         "k * h1;\nr2 rnd= r1 - kh1;\nR = ((x - k * h0) - k * h1) - k * d;\n{ @FIX(k, 0) /\\ |k| in [1, " +
         std::to_string(static_cast<long>(most)) + "] /\\ @FIX(x, " +
         std::to_string(-std::numeric_limits<T>::digits - 2) +
         ") /\\ |x - k * h0| <= 0.18 /\\ |r1 - kh1| <= 0.1734 /\\ |d| <= " +
         (sizeof(T) == 8 ? "1b-98" : "1b-45") +
         "\n  -> |r2 - R| in ? }\nr2 - R -> (r2 - (r1 - kh1)) + (r1 - (x - kh0)) - (kh0 - k * h0) - (kh1 - k "
         "* h1) + k * d;\n";
}

/// Sollya: the largest difference of a polynomial and its function, an upper limit, relative or absolute.
template <class T, std::size_t N>
std::string method_error(const T (&c)[N], const char* function, const char* head, int power, double high,
                         bool relative) {
  std::string p = hex(static_cast<double>(c[N - 1]));
  for (std::size_t i = N - 1; i-- > 0;) p = hex(static_cast<double>(c[i])) + " + x^2 * (" + p + ")";
  return std::string("prec = 200!;\nprint(round(sup(supnorm(") + head + " + x^" + std::to_string(power) +
         " * (" + p + "), " + function + ", [1b-40; " + hex(high) + "], " +
         (relative ? "relative" : "absolute") + ", 1b-20)), D, RU));\n";
}

/// Sollya: the logarithm to base 2 of what the parts of a constant leave out.
template <class T, std::size_t N>
std::string rest_of_constant(const T (&parts)[N], const char* constant) {
  std::string sum;
  for (const T part : parts) sum += " - " + hex(static_cast<double>(part));
  return std::string("prec = 300!;\nprint(round(log2(abs(") + constant + sum + ")), D, RU));\n";
}

/// Whether this computer has the program.
inline bool has_program(const char* name) {
  return std::system((std::string("command -v ") + name + " > /dev/null 2>&1").c_str()) == 0;
}
/// What a prover prints about a script.
inline std::string proved(const char* program, const std::string& script) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("skinctl_proof_" + std::to_string(std::rand()));
  std::filesystem::create_directory(folder);
  const auto in = folder / "script", out = folder / "answer";
  std::ofstream(in) << script;
  const std::string line = std::string(program) + " " + in.string() + " > " + out.string() + " 2>&1";
  const int code = std::system(line.c_str());
  std::ifstream file(out);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::filesystem::remove_all(folder);
  return code == 0 || std::strncmp(program, "gappa", 5) != 0 ? text
                                                             : "failed: " + text;  // Sollya exits with 4
}
/// The upper end of the first interval with two ends in Gappa's answer; infinite where it proves nothing.
inline double upper_end(const std::string& answer) {
  const auto at = answer.find(" in [");
  if (answer.find("failed") != std::string::npos || answer.find("not satisfied") != std::string::npos ||
      at == std::string::npos)
    return std::numeric_limits<double>::infinity();
  const auto comma = answer.find(", ", at), brace = answer.find('{', comma), line = answer.find('\n', comma);
  if (brace != std::string::npos && brace < line)
    return std::strtod(answer.c_str() + brace + 1, nullptr) * (1 + 1e-5);
  const auto first = answer.find(", ", at) + 2;
  return std::strtod(answer.c_str() + first, nullptr) * (1 + 1e-5);
}

}  // namespace skinctl::testing
