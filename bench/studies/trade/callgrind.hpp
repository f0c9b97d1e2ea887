// Instructions of a cycle, and the lines of code that it touches, by callgrind.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace trade {

struct Counted {
  double instructions = std::nan("");  ///< a cycle
  double code = std::nan("");          ///< touched: bytes of lines of 64
};

inline std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Runs `program words... cycles` under callgrind, which collects only inside of `trade_step`. All NaN where
/// it fails.
inline Counted count(const std::string& valgrind, const std::string& program,
                     const std::vector<std::string>& words, std::size_t cycles) {
  Counted out;
  char name[] = "/tmp/skinctl_trade_XXXXXX";
  const int file = mkstemp(name);
  if (file < 0) return out;
  std::string command = quoted(valgrind) +
                        " --tool=callgrind --dump-instr=yes --compress-pos=no --compress-strings=no "
                        "--toggle-collect='trade::trade_step*' --callgrind-out-file=" +
                        name + " " + quoted(program);
  for (const std::string& w : words) command += " " + quoted(w);
  command += " " + std::to_string(cycles) + " >/dev/null 2>&1";
  if (std::system(command.c_str()) == 0) {
    // A line of costs is `0xADDRESS line cost`, behind `calls=` that of the calls, which is not its own.
    std::ifstream in(name);
    std::set<unsigned long> lines;
    double sum = 0;
    bool call = false;
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("0x", 0) == 0) {
        char* end = nullptr;
        const unsigned long address = std::strtoul(line.c_str(), &end, 16);
        std::strtoul(end, &end, 10);
        const double cost = std::strtod(end, nullptr);
        if (!call && cost > 0) lines.insert(address / 64), sum += cost;
        call = false;
      } else if (line.rfind("calls=", 0) == 0) {
        call = true;
      }
    }
    if (sum > 0) out = {sum / double(cycles), 64.0 * double(lines.size())};
  }
  std::remove(name);
  return out;
}

}  // namespace trade
