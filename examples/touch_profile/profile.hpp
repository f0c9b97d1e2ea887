// Force over time: from a recording, or computed.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "examples/touch_profile/recording.hpp"

namespace touch_profile {

/// Rows of a profile. Force is never negative, zero in the first and the last row.
struct Profile {
  std::vector<std::string> comments;  ///< source, scaling, copyright
  std::vector<double> time;           ///< [s], ascending from 0
  std::vector<double> force;          ///< [N]
};

/// How readings become newton. The taxels are not calibrated and the dataset does not state its rate: both
/// numbers are the user's choice.
struct Mapping {
  double peak = 40;       ///< largest force [N], 0.01 to 1000
  double rate = 10;       ///< slices per second, 0.1 to 1000
  double release = 0.5;   ///< recordings end in the grasp: seconds to let go, 0.01 to 60
  std::size_t rest = 1;   ///< so many slices at the start are the rest, 1 to one less than there are
  double threshold = 25;  ///< smallest rise of the sum over rest that counts as a touch [counts], > 0
  std::vector<std::size_t> taxels;  ///< which ones count; empty: all 60
};

/// With S_k the sum over taxels of (255 - reading) in slice k and S_0 its mean over the rest,
/// `f_k = peak max(0, S_k - S_0) / max_k(S_k - S_0)` at time k / rate; at rest 0. After the last slice the
/// force falls to 0 as `f (1 - x)^2 (1 + 2 x)`, `x` from 0 to 1 in `release` seconds, ten rows.
///
/// Throws `skinctl::ConfigurationError` for a number outside its range, a recording shorter than rest plus
/// one slice, or one whose sum never rises by the threshold: scaling it would turn noise into a touch.
Profile profile_of(const Recording& recording, const Mapping& mapping);

/// A push that no one recorded: minimum-jerk rise in 0.35 s, hold with a tremor of 4 % at 9 Hz, minimum-jerk
/// release in 0.45 s; 100 rows a second over 1.6 s. `f(t) = c s(t/0.35) (1 - s((t - 1.15)/0.45)) (1 + 0.04
/// sin(2 pi 9 t))`, `s(x) = x^3 (10 - 15 x + 6 x^2)` on [0, 1], held outside, `c` such that the largest row
/// is `peak` [N], 0.01 to 1000.
Profile synthetic_push(double peak);

/// CSV: comments with `#`, the header `time,force`, a row each.
void write_profile(std::ostream& out, const Profile& profile);

/// `thumb`, `index`, `middle`, `ring`, `little`, a number 0 to 59, or a range as 12-23; several with commas.
/// Throws `skinctl::ConfigurationError` with what was not understood.
std::vector<std::size_t> parse_taxels(const std::string& text);

}  // namespace touch_profile
