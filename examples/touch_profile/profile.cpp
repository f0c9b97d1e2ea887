#include "examples/touch_profile/profile.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>
#include <ostream>
#include <set>

#include "skinctl/core/contract.hpp"
#include "skinctl/io/formatted.hpp"

namespace touch_profile {
namespace {

using skinctl::require;

/// Rounded as it is written, so that what was checked is what is read.
double rounded(double v) {
  return std::round(v * 1e4) / 1e4;
}

/// The name without folders and control characters: it becomes a comment line.
std::string plain_name(const std::string& path) {
  std::string name = path.substr(path.find_last_of('/') + 1);
  for (char& c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return name;
}

double minimum_jerk(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 - 15 * x + 6 * x * x);
}

void check(const Recording& recording, const Mapping& m) {
  require(m.peak >= 0.01 && m.peak <= 1000, "peak", m.peak, "0.01 to 1000 N");
  require(m.rate >= 0.1 && m.rate <= 1000, "rate", m.rate, "0.1 to 1000 slices/s");
  require(m.release >= 0.01 && m.release <= 60, "release", m.release, "0.01 to 60 s");
  require(m.threshold > 0 && m.threshold < 1e6, "threshold", m.threshold, "above 0 to 1e6 counts");
  require(m.rest >= 1 && m.rest < recording.slices.size(), "rest", static_cast<double>(m.rest),
          ("1 to " + std::to_string(std::max<std::size_t>(recording.slices.size(), 1) - 1) +
           " slices, the recording has " + std::to_string(recording.slices.size()))
              .c_str());
  for (const std::size_t taxel : m.taxels)
    require(taxel < taxel_count, "taxel", static_cast<double>(taxel), "0 to 59");
}

}  // namespace

Profile profile_of(const Recording& recording, const Mapping& m) {
  check(recording, m);
  std::vector<std::size_t> taxels = m.taxels;
  if (taxels.empty()) {
    taxels.resize(taxel_count);
    std::iota(taxels.begin(), taxels.end(), std::size_t{0});
  }
  std::vector<double> rise;
  for (const Slice& slice : recording.slices) {
    double sum = 0;
    for (const std::size_t taxel : taxels) sum += 255 - slice.taxels[taxel];
    rise.push_back(sum);
  }
  const auto rest_end = rise.begin() + static_cast<std::ptrdiff_t>(m.rest);
  const double rest = std::accumulate(rise.begin(), rest_end, 0.0) / static_cast<double>(m.rest);
  for (double& r : rise) r -= rest;
  const double largest = *std::max_element(rest_end, rise.end());
  if (!(largest >= m.threshold))
    skinctl::refuse(recording.name + ": no touch: the sum over " + std::to_string(taxels.size()) +
                    " taxels rises by " + skinctl::formatted("%.4g", largest) + " counts, a touch needs " +
                    skinctl::formatted("%.4g", m.threshold) + " (--threshold)");

  Profile profile;
  profile.comments = {
      "Touch force made from " + plain_name(recording.name) + " of the iCub Grasp Dataset.",
      "Data: Copyright 2012 Harold Soh. Free to use and distribute as long as this copyright information is "
      "kept.",
      "Please cite: H. Soh, Y. Su, Y. Demiris, Online Spatio-Temporal Gaussian Process Experts with "
      "Application to",
      "Tactile Classification, IEEE/RSJ International Conference on Intelligent Robots and Systems, 2012.",
      "force = " + skinctl::formatted("%.6g", m.peak / largest) +
          " N per count: sum of (255 - reading) over " + std::to_string(taxels.size()) +
          " taxels, less the first " + std::to_string(m.rest) + " slice(s), scaled to a peak of " +
          skinctl::formatted("%g", m.peak) + " N. The taxels are not calibrated.",
      "time: " + skinctl::formatted("%g", m.rate) +
          " slices per second, assumed: the dataset does not state its rate.",
      "The recording ends in the grasp; the last " + skinctl::formatted("%g", m.release) +
          " s let go and are computed."};
  for (std::size_t k = 0; k < rise.size(); ++k) {
    profile.time.push_back(static_cast<double>(k) / m.rate);
    profile.force.push_back(k < m.rest ? 0 : rounded(m.peak * std::max(0.0, rise[k]) / largest));
  }
  const double end = profile.time.back(), held = profile.force.back();
  for (int i = 1; i <= 10; ++i) {
    const double x = i / 10.0;
    profile.time.push_back(end + x * m.release);
    profile.force.push_back(rounded(held * (1 - x) * (1 - x) * (1 + 2 * x)));
  }
  return profile;
}

Profile synthetic_push(double peak) {
  require(peak >= 0.01 && peak <= 1000, "peak", peak, "0.01 to 1000 N");
  constexpr int rows = 160;
  Profile profile;
  profile.comments = {
      "A push that was computed, not recorded: touch_profile --generate --peak " +
          skinctl::formatted("%g", peak),
      "f(t) = c s(t/0.35) (1 - s((t - 1.15)/0.45)) (1 + 0.04 sin(2 pi 9 t)), s(x) = x^3 (10 - 15 x + 6 x^2) "
      "on [0, 1]:",
      "minimum-jerk rise, hold with tremor, minimum-jerk release; c such that the largest row is the peak."};
  for (int k = 0; k <= rows; ++k) {
    const double t = k / 100.0;
    profile.time.push_back(t);
    profile.force.push_back(minimum_jerk(t / 0.35) * (1 - minimum_jerk((t - 1.15) / 0.45)) *
                            (1 + 0.04 * std::sin(2 * std::numbers::pi * 9 * t)));
  }
  const double largest = *std::max_element(profile.force.begin(), profile.force.end());
  for (double& f : profile.force) f = rounded(peak * f / largest);
  profile.force.front() = profile.force.back() = 0;
  return profile;
}

void write_profile(std::ostream& out, const Profile& profile) {
  for (const std::string& comment : profile.comments) out << "# " << comment << '\n';
  out << "time,force\n";
  for (std::size_t i = 0; i < profile.time.size(); ++i)
    out << skinctl::formatted("%.6f", profile.time[i]) << skinctl::formatted(",%.4f", profile.force[i])
        << '\n';
}

std::vector<std::size_t> parse_taxels(const std::string& list) {
  std::set<std::size_t> taxels;
  const auto number = [&](const std::string& word) {
    std::size_t value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || rest != word.data() + word.size() || value >= taxel_count)
      skinctl::refuse("taxels '" + list + "': '" + word +
                      "' is no finger (thumb, index, middle, ring, little) and no taxel (0 to 59)");
    return value;
  };
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    const std::string word = list.substr(at, end - at);
    at = end + 1;
    const auto finger = std::find(fingers.begin(), fingers.end(), word);
    const std::size_t dash = word.find('-');
    std::size_t first = 0, last = 0;
    if (finger != fingers.end()) {
      first = static_cast<std::size_t>(finger - fingers.begin()) * taxels_per_finger;
      last = first + taxels_per_finger - 1;
    } else if (dash != std::string::npos) {
      first = number(word.substr(0, dash)), last = number(word.substr(dash + 1));
      if (first > last) skinctl::refuse("taxels '" + list + "': the range " + word + " is empty");
    } else {
      first = last = number(word);
    }
    for (std::size_t t = first; t <= last; ++t) taxels.insert(t);
  }
  return {taxels.begin(), taxels.end()};
}

}  // namespace touch_profile
