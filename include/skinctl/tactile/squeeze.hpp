// SPDX-License-Identifier: BSD-3-Clause
// The stiffness of what is squeezed between two fingers, or of what a cell is pressed against.
#pragma once

#include <limits>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The stiffness of a body from force and closing: least squares of closing on force while the force rises
/// within a range, less the compliance of the skin and the fingers, `1/k = dx/dF - 1/k_own`.
///
/// Closing on force, not force on closing: the noise of force sensors is small against the range, and
/// compliances in series add. Points below `from` are left out (seating, rounding), and those above `to` (a
/// peel or flesh stiffens). A fall of more than `swing` begins a squeeze anew.
template <Real T = double>
class Squeeze {
 public:
  struct Settings {
    T from = T(0.5), to = T(4);    ///< range of the forces that count [N]
    T finger_stiffness = T(5000);  ///< stiffness of skin and fingers in series, > 0 [N/m]
    T swing = T(0.5);              ///< fall of the force that begins anew [N]
    T min_span = T(1.5);           ///< smallest range of forces from which a result is given [N]
  };
  /// Sums over the points of the present squeeze. Trivially copyable; `Memory{}` has seen none.
  struct Memory {
    T count = T(0), force = T(0), closing = T(0);  ///< number of points; means of force [N], closing [m]
    T square = T(0), product = T(0);               ///< sums of deviations: force^2, force times closing
    T low = T(0), high = T(0);                     ///< least and largest force [N]
  };
  /// Stiffness found; `known` is false while the forces span less than `min_span`; `infinity` for a body
  /// stiffer than can be told.
  struct Result {
    bool known = false;
    T stiffness = T(0);  ///< stiffness of the body [N/m]
  };

  /// Throws `ConfigurationError` unless `0 <= from < to`, `finger_stiffness > 0`, `0 < swing <= 1e4`,
  /// `0 < min_span <= to - from`.
  SKINCTL_COLD explicit Squeeze(const Settings& s = {}) : s_(s) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(s.from >= T(0) && s.from < s.to, "Squeeze: from", number(s.from), ">= 0, < to N");
    require(s.to <= T(1e4), "Squeeze: to", number(s.to), "<= 1e4 N");
    require(s.finger_stiffness > T(0) && s.finger_stiffness <= T(1e9), "Squeeze: stiffness of the fingers",
            number(s.finger_stiffness), "> 0, <= 1e9 N/m");
    require(s.swing > T(0) && s.swing <= T(1e4), "Squeeze: swing", number(s.swing), "> 0, <= 1e4 N");
    require(s.min_span > T(0) && s.min_span <= s.to - s.from, "Squeeze: least span", number(s.min_span),
            "> 0, <= to - from N");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// Takes one reading: the force [N], and by how much the fingers have closed [m], from any origin. A
  /// reading that is not finite is ignored.
  void take(Memory& m, const T& force, const T& closing) const noexcept {
    if (!(force - force == T(0)) || !(closing - closing == T(0))) return;
    if (m.count > T(0) && force < m.high - s_.swing) m = {};
    if (!(force >= s_.from && force <= s_.to)) return;
    if (m.count == T(0)) m.low = m.high = force;
    m.low = force < m.low ? force : m.low;
    m.high = force > m.high ? force : m.high;
    m.count = m.count + T(1);
    const T f = force - m.force, x = closing - m.closing;
    m.force = m.force + f / m.count;
    m.closing = m.closing + x / m.count;
    m.square = m.square + f * (force - m.force);
    m.product = m.product + f * (closing - m.closing);
  }
  [[nodiscard]] Result result(const Memory& m) const noexcept {
    if (!(m.high - m.low >= s_.min_span) || !(m.square > T(0))) return {};
    const T give = m.product / m.square - T(1) / s_.finger_stiffness;
    return {true, give > T(0) ? T(T(1) / give) : std::numeric_limits<T>::infinity()};
  }

 private:
  Settings s_;
};

SKINCTL_END_NAMESPACE
