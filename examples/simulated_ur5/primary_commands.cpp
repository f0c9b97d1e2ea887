#include "examples/simulated_ur5/primary_commands.hpp"

#include <algorithm>
#include <iterator>

namespace simulated_ur5::primary {
namespace {

struct Command {
  std::string_view line;
  void (*act)(Controller&);
};
constexpr Command commands[] = {
    {"power on", [](Controller& c) { c.power_on(); }},
    {"power off", [](Controller& c) { c.power_off(); }},
    {"set robotmode run", [](Controller& c) { c.brake_release(); }},
    {"set robotmode power on", [](Controller& c) { c.power_on(); }},
    {"set robotmode power off", [](Controller& c) { c.power_off(); }},
    {"set unlock protective stop", [](Controller& c) { c.unlock_when_allowed(); }},
    {"set real", [](Controller&) {}},  // this robot takes itself for real
    {"set sim", [](Controller&) {}},
    {"stop program", [](Controller& c) { c.stop_program(); }},
    {"pause program", [](Controller& c) { c.pause(); }},
    {"resume program", [](Controller& c) { c.play(); }},
};

std::string_view trimmed(std::string_view s) {
  constexpr std::string_view blanks = " \t\r\n";
  const auto first = s.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

}  // namespace

bool obey(std::string_view line, Controller& controller) {
  if (line.size() > 64) return false;
  const std::string_view words = trimmed(line);
  const auto found = std::find_if(std::begin(commands), std::end(commands),
                                  [&](const Command& c) { return c.line == words; });
  if (found == std::end(commands)) return false;
  found->act(controller);
  return true;
}

}  // namespace simulated_ur5::primary
