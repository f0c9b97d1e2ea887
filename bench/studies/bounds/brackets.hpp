// What is proven of each robot and quantity, as a file: written by `bounds --csv`, read by the trade page and
// by tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/studies/trade/csv.hpp"

namespace skinctl::bounds {

/// The largest error of a quantity over all states: found and proven, in float and in double.
struct Bracket {
  std::string robot, quantity, unit;
  double velocity = 0, acceleration = 0;  ///< of the states, at most [rad/s], [rad/s^2]
  double float_found = 0, float_proven = 0, double_found = 0, double_proven = 0;
  double seconds = 0;  ///< of processor time, for the proof
};

inline constexpr const char* bracket_columns =
    "robot,quantity,unit,velocity,acceleration,float_found,float_proven,double_found,double_proven,seconds";

/// Throws `std::runtime_error` where it is no such file.
[[nodiscard]] inline std::vector<Bracket> read_brackets(const std::string& file) {
  std::vector<Bracket> out;
  trade::read_table(file, bracket_columns, "bounds", [&](const auto& words, const std::string& place) {
    Bracket b{.robot = words[0], .quantity = words[1], .unit = words[2]};
    std::size_t k = 3;
    for (double* x : {&b.velocity, &b.acceleration, &b.float_found, &b.float_proven, &b.double_found,
                      &b.double_proven, &b.seconds})
      *x = trade::number_in(words[k++], HUGE_VAL, place);
    out.push_back(b);
  });
  return out;
}
/// `x` in three digits, not less than it; what has three digits stays.
[[nodiscard]] inline double rounded_up(double x) {
  if (!(x > 0) || !std::isfinite(x)) return x;
  const double step = std::pow(10.0, std::floor(std::log10(x)) - 2);
  return std::ceil(x / step * (1 - 1e-12)) * step;
}
/// In place of those of the same robot, if the file is there.
inline void write_brackets(const std::string& file, const std::vector<Bracket>& rows) {
  std::vector<Bracket> all;
  if (std::ifstream(file).good()) all = read_brackets(file);
  const auto same_robot = [&](const Bracket& b) { return !rows.empty() && b.robot == rows.front().robot; };
  const auto place = std::find_if(all.begin(), all.end(), same_robot) - all.begin();
  std::erase_if(all, same_robot);
  all.insert(all.begin() + place, rows.begin(), rows.end());
  std::ofstream out(file);
  out << bracket_columns << '\n';
  for (const Bracket& b : all) {
    char line[320];
    std::snprintf(line, sizeof line, "%s,%s,%s,%g,%g,%.3g,%.3g,%.3g,%.3g,%.1f\n", b.robot.c_str(),
                  b.quantity.c_str(), b.unit.c_str(), b.velocity, b.acceleration, b.float_found,
                  rounded_up(b.float_proven), b.double_found, rounded_up(b.double_proven), b.seconds);
    out << line;
  }
  out.flush();
  if (!out) throw std::runtime_error("cannot write " + file);
}

}  // namespace skinctl::bounds
