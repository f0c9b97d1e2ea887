// Recorded presses: a force over time, from a table.
#include <algorithm>
#include <string_view>

#include "examples/simulated_ur5/contact.hpp"
#include "examples/support/text.hpp"
#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {

ForceProfile read_profile(std::istream& in, const std::string& name) {
  ForceProfile profile;
  std::string line;
  bool header_allowed = true;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const auto bad = [&](const std::string& why) {
      skinctl::refuse(name + ":" + std::to_string(number) + ": " + why + "; expected: time [s],force [N]");
    };
    if (const auto comment = line.find('#'); comment != std::string::npos) line.resize(comment);
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::string_view rest = line;
    double t = 0, f = 0;
    if (!examples::take_number(rest, t)) {
      if (!header_allowed) bad("no number");
      header_allowed = false;
      continue;
    }
    header_allowed = false;
    rest = rest.substr(std::min(rest.find_first_not_of(" \t"), rest.size()));
    if (!rest.starts_with(',') && !rest.starts_with(';')) bad("one column");
    rest.remove_prefix(1);
    if (!examples::take_number(rest, f)) bad("no force");
    if (rest.find_first_not_of(" \t\r,;") != std::string::npos) bad("more than two columns");
    if (!std::isfinite(t) || !std::isfinite(f) || t < 0 || f < 0 || f > 1e5 || t > 1e6)
      bad("a number out of range");
    if (!profile.time.empty() && t <= profile.time.back()) bad("time does not ascend");
    if (profile.time.size() >= 1'000'000) bad("more than 1000000 rows");
    profile.time.push_back(t);
    profile.force.push_back(f);
  }
  if (profile.time.size() < 2) skinctl::refuse(name + ": a profile needs two rows of time,force at least");
  const double first = profile.time.front();
  for (double& t : profile.time) t -= first;
  return profile;
}

}  // namespace simulated_ur5
