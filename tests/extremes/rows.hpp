// Tables of functions at the ends of what a number holds: a row says how large an argument may be, and what
// becomes of one that is no number.
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/triple.hpp"
#include "tests/support/by_day.hpp"

namespace skinctl::extremes {

/// The results of a function, as numbers.
template <class T>
class Results {
 public:
  template <class... X>
  explicit Results(const X&... x) {
    (put(x), ...);
  }
  [[nodiscard]] bool finite() const {
    for (std::size_t i = 0; i < count_; ++i)
      if (!std::isfinite(numbers_[i])) return false;
    return true;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }

 private:
  template <class X>
  void put(const X& x) {
    if constexpr (std::is_arithmetic_v<X>) {
      if (count_ < numbers_.size()) numbers_[count_++] = static_cast<T>(x);
    } else if constexpr (requires { x.x, x.y, x.z; }) {
      put(x.x), put(x.y), put(x.z);
      if constexpr (requires { x.xy; }) put(x.xy), put(x.xz), put(x.yz);
    } else if constexpr (requires { x.xx, x.yy; }) {
      put(x.xx), put(x.yy), put(x.zz), put(x.xy), put(x.xz), put(x.yz);
    } else if constexpr (requires { x.linear, x.angular; }) {
      put(x.linear), put(x.angular);
    } else if constexpr (requires { x.phi, x.theta, x.psi; }) {
      put(x.phi), put(x.theta), put(x.psi);
    } else if constexpr (requires { x.force, x.moment; }) {
      put(x.force), put(x.moment);
    } else {
      for (const auto& each : x) put(each);
    }
  }
  std::array<T, 160> numbers_{};
  std::size_t count_ = 0;
};

/// What becomes of an argument that is NaN or infinite.
enum class Wrong {
  shows,  ///< a result is not finite either
  safe    ///< the results are finite: the docstring says which
};

template <class T>
struct Row {
  const char* name;
  double
      power;  ///< arguments below the largest number to 1 / power give finite results; 0: all finite ones do
  Wrong nan, infinite;
  Results<T> (*at)(T);
};

/// 0, denormal numbers, every tenth of the exponents, the largest number; not negative.
template <class T>
std::array<T, 27> sizes() {
  using L = std::numeric_limits<T>;
  std::array<T, 27> out{T(0), L::denorm_min(), L::min(), L::epsilon(), T(1), L::max()};
  for (int k = -10; k <= 10; ++k)
    out[static_cast<std::size_t>(16 + k)] = std::ldexp(T(1), k * (L::max_exponent / 10 - 1));
  return out;
}

template <class T, std::size_t N>
void check_rows(const Row<T> (&rows)[N]) {
  using L = std::numeric_limits<T>;
  for (const Row<T>& row : rows) {
    CAPTURE(std::string(row.name));
    const T most = row.power == 0 ? L::max() : std::pow(L::max(), static_cast<T>(1 / row.power)) / T(1e4);
    for (const T size : sizes<T>())
      for (const T x : {size, -size}) {
        if (size > most) continue;
        CAPTURE(x);
        const Results<T> found = row.at(x);
        CHECK_FALSE(found.empty());
        CHECK(found.finite());
      }
    const T inf = L::infinity();
    CHECK(row.at(L::quiet_NaN()).finite() == (row.nan == Wrong::safe));
    CHECK(row.at(inf).finite() == (row.infinite == Wrong::safe));
    CHECK(row.at(-inf).finite() == (row.infinite == Wrong::safe));
  }
}

/// Whether `make(settings)` throws a `ConfigurationError` that names the number.
template <class Make>
bool refused(Make&& make) {
  try {
    make();
  } catch (const ConfigurationError& error) {
    return std::string(error.what()).find(" = ") != std::string::npos;
  }
  return false;
}

/// The number in a field of settings, which may be left out.
template <class Field>
struct NumberIn {
  using type = Field;
};
template <class Number>
struct NumberIn<std::optional<Number>> {
  using type = Number;
};

/// A class whose settings hold numbers: none of them may be NaN, infinite or beyond any range; the defaults
/// are fine.
template <class Make, class Settings, class... Field>
void check_refusals(const char* name, const Settings& defaults, Make&& make, Field Settings::*... field) {
  CAPTURE(std::string(name));
  CHECK_NOTHROW(make(defaults));
  int at = 0;
  const auto one = [&](auto member) {
    using F = typename NumberIn<std::remove_cvref_t<decltype(defaults.*member)>>::type;
    CAPTURE(at);
    ++at;
    Settings s = defaults;
    const auto wrong = [&](F x) {
      s.*member = x;
      CHECK(refused([&] { make(s); }));
    };
    if constexpr (std::is_floating_point_v<F>) {
      using L = std::numeric_limits<F>;
      for (const F x : {L::quiet_NaN(), L::infinity(), -L::infinity(), L::max(), -L::max()}) {
        CAPTURE(x);
        wrong(x);
      }
      // Whatever else is allowed builds.
      for (const F x : {F(0), L::denorm_min(), L::min(), L::epsilon(), F(1)}) {
        s.*member = x;
        try {
          make(s);
        } catch (const ConfigurationError&) {
        }
      }
    } else {
      wrong(F::min()), wrong(F(-1)), wrong(F::max());
    }
  };
  (one(field), ...);
}

}  // namespace skinctl::extremes
