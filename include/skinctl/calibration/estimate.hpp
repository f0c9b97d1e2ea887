// SPDX-License-Identifier: BSD-3-Clause
// The result of an identification: a value, how well it is known, and what the data do not show of it.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A number and its standard deviation; infinite where the data say nothing about it.
struct Estimate {
  double value = 0;
  double deviation = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool known() const noexcept { return deviation < std::numeric_limits<double>::infinity(); }
};

/// Something that the data do not show, or not well enough to be used.
struct Unobservable {
  std::string name;  ///< name in the words of the domain: "height of the base"
  double deviation = std::numeric_limits<double>::infinity();  ///< predicted, in `unit`; infinite: not shown
  std::string unit{};                                          ///< unit of `deviation`: "m", "rad"
  std::string remedy{};  ///< remedy in words: "tilt the base"; empty: none that the method knows

  friend bool operator==(const Unobservable&, const Unobservable&) = default;
};

/// A value of any type with the covariance of its error, and what the data do not show of it.
///
/// @tparam Value  number, vector or pose; the docstring of the function that returns it says which error the
///                covariance is of (for a pose: position [m] in the outer frame, then rotation vector [rad]
///                in its own axes, unless said otherwise).
template <class Value, int N = Eigen::Dynamic>
struct EstimateOf {
  Value value{};
  Eigen::Matrix<double, N, N> covariance{};
  std::vector<Unobservable> unobservable{};  ///< parts of the value that the data do not show

  [[nodiscard]] bool known() const noexcept { return unobservable.empty(); }
};

SKINCTL_END_NAMESPACE
