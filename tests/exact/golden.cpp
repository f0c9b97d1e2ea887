// Golden runs: twelve scenes of 4000 cycles, compared with what they commanded when they were recorded.
//
//     golden FOLDER            compares each scene with FOLDER/<scene>.txt; exit 1 if one differs by more than 1e-10
//     golden FOLDER --write    records them
//
// A file holds a hash over each commanded number and status of the run, and every 50th command. Where only
// the hash differs, the largest difference of those commands is printed: an operation that rounds otherwise.
//
// Promise: a change of the code that is to change nothing changes nothing
// Tried: 15 scenes of 4000 cycles: each interface, groups, passivity, limits, clearances, configurations,
// skills, faults; commands and statuses to the bit, or within 1e-10 where only rounding differs, which is
// printed

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "skinctl/core/command.hpp"
#include "tests/exact/golden_scenes.hpp"

namespace skinctl::golden {
namespace {

/// Bits of numbers, one after the other (FNV-1a).
struct Hash {
  std::uint64_t value = 1469598103934665603u;
  void add(std::uint64_t bits) noexcept {
    for (int k = 0; k < 8; ++k, bits >>= 8) value = (value ^ (bits & 255u)) * 1099511628211u;
  }
  void add(double x) noexcept { add(std::bit_cast<std::uint64_t>(x)); }
};

/// What a scene did.
struct Told {
  std::string name;
  std::uint64_t commands = 0, statuses = 0;  ///< hashes
  std::vector<std::vector<double>> rows;     ///< every 50th command
};

std::string as_text(const Told& told) {
  char text[64];
  std::snprintf(text, sizeof text, "commands %016llx\nstatuses %016llx\n",
                static_cast<unsigned long long>(told.commands),
                static_cast<unsigned long long>(told.statuses));
  std::string out = text;
  for (const auto& row : told.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::snprintf(text, sizeof text, "%s%.13g", i == 0 ? "" : " ", row[i]);
      out += text;
    }
    out += '\n';
  }
  return out;
}

/// Compares with the file, and says how they differ.
bool compare(const Told& told, const std::string& path) {
  std::ifstream file(path);
  std::string word, commands, statuses;
  if (!(file >> word >> commands >> word >> statuses)) {
    std::printf("%-22s no record: %s\n", told.name.c_str(), path.c_str());
    return false;
  }
  const bool same = std::stoull(commands, nullptr, 16) == told.commands;
  const bool same_status = std::stoull(statuses, nullptr, 16) == told.statuses;
  double largest = 0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < told.rows.size(); ++k)
    for (const double x : told.rows[k]) {
      double recorded = 0;
      if (!(file >> recorded)) recorded = 1e9;
      const double off = std::abs(x - recorded);
      if (!(off <= largest)) largest = off, at = k;
    }
  const char* told_status = same_status ? "statuses equal" : "STATUSES DIFFER";
  if (same && same_status) {
    std::printf("%-22s equal\n", told.name.c_str());
  } else if (same) {
    std::printf("%-22s commands equal, %s\n", told.name.c_str(), told_status);
  } else {
    std::printf("%-22s largest difference %.3g in cycle %zu, %s\n", told.name.c_str(), largest, 50 * at,
                told_status);
  }
  return same_status && largest <= 1e-10;
}

/// Runs a scene. `own(k, run)` changes input and robot of cycle k.
template <class Scene, class Own>
Told tell(const char* name, const Scene& scene, std::array<Interface, Scene::joints> takes,
          Nanoseconds period, const JointPosition<Scene::joints>& at, const Own& own) {
  Told told{.name = name, .rows = {}};
  auto run = std::make_unique<Run<Scene>>(scene, takes, period, at);
  Hash commands, statuses;
  for (int k = 1; k <= 4000; ++k) {
    own(k, *run);
    const auto out = run->cycle();
    std::vector<double> row;
    for (std::size_t i = 0; i < Scene::joints; ++i) row.push_back(run->asked(out.planned, i));
    for (const double x : row) commands.add(x);
    commands.add(std::uint64_t(out.planned.valid));
    statuses.add(out.status.bits());
    if (k % 50 == 0) told.rows.push_back(row);
  }
  told.commands = commands.value;
  told.statuses = statuses.value;
  return told;
}

}  // namespace
}  // namespace skinctl::golden

int main(int count, char** words) {
  using namespace skinctl::golden;
  if (count < 2) {
    std::fputs("golden FOLDER [--write]\n", stderr);
    return 2;
  }
  const bool write = count > 2 && std::strcmp(words[2], "--write") == 0;
  bool fine = true;
  each_scene([&](const char* name, const auto& scene, const auto& takes, auto period, const auto& at,
                 const auto& own) {
    const auto told = tell(name, scene, takes, period, at, own);
    const std::string path = std::string(words[1]) + "/" + name + ".txt";
    if (write) {
      std::ofstream(path) << as_text(told);
      std::printf("%-22s recorded\n", name);
    } else {
      fine = compare(told, path) && fine;
    }
  });
  return fine ? 0 : 1;
}
