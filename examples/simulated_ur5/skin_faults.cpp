#include "examples/simulated_ur5/skin_faults.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "examples/support/text.hpp"
#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {
namespace {

using skinctl::CellFault;
using skinctl::testing::FaultyCell;
using skinctl::testing::SkinFaults;

std::string names() {
  std::string all;
  for (std::size_t k = 0; k < skinctl::cell_faults; ++k)
    all += (k == 0 ? "" : ", ") + std::string(name(static_cast<CellFault>(k)));
  return all;
}

}  // namespace

std::vector<FaultyCell> read_skin_faults(const std::string& text, const std::vector<SkinCell>& cells,
                                         std::uint64_t seed) {
  std::vector<std::uint32_t> ids;
  for (const SkinCell& cell : cells) ids.push_back(cell.id);
  std::vector<FaultyCell> out;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const auto bad = [&](const std::string& why) {
      skinctl::refuse("skin faults: '" + word + "': " + why +
                      "; expected FAULT:CELL or FAULT:SHARE%, then @SECONDS and =LEVEL if wanted");
    };
    const auto number = [&](const std::string& digits, const char* what, double low, double high) {
      std::string_view rest = digits;
      double x = 0;
      if (!examples::take_number(rest, x) || !rest.empty() || !(x >= low && x <= high))
        bad(std::string(what) + " out of range");
      return x;
    };
    const auto colon = word.find(':');
    if (colon == std::string::npos) bad("no cells");
    FaultyCell fault;
    std::size_t kind = 0;
    while (kind < skinctl::cell_faults && word.substr(0, colon) != name(static_cast<CellFault>(kind))) ++kind;
    if (kind == skinctl::cell_faults) bad("the fault is one of " + names());
    fault.fault = static_cast<CellFault>(kind);
    std::string which = word.substr(colon + 1);
    if (const auto at = which.find('='); at != std::string::npos) {
      fault.level = number(which.substr(at + 1), "level", -1, 1);
      which.resize(at);
    }
    if (const auto at = which.find('@'); at != std::string::npos) {
      fault.from = skinctl::nanoseconds(number(which.substr(at + 1), "time", 0, 1e6));
      which.resize(at);
    }
    const bool share = !which.empty() && which.back() == '%';
    if (share) which.pop_back();
    const double chosen = number(which, share ? "share" : "cell", 0, share ? 100 : 4294967295.0);
    if (share) {
      for (const FaultyCell& one : SkinFaults::of_share(chosen / 100, ids, fault, seed + out.size()))
        out.push_back(one);
      continue;
    }
    fault.cell = static_cast<std::uint32_t>(chosen);
    const auto found = std::find(ids.begin(), ids.end(), fault.cell);
    if (chosen != std::floor(chosen) || found == ids.end()) bad("there is no such cell");
    // Cross-talk comes from a cell half the skin away.
    fault.source = ids[(static_cast<std::size_t>(found - ids.begin()) + ids.size() / 2) % ids.size()];
    out.push_back(fault);
  }
  return out;
}

}  // namespace simulated_ur5
