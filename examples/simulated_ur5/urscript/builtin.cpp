#include "examples/simulated_ur5/urscript/builtin.hpp"

#include <map>

namespace simulated_ur5::urscript {

const Builtin* find_builtin(std::string_view name, const Version& version) {
  static const auto all = [] {
    std::map<std::string_view, const Builtin*> out;
    for (const auto table :
         {arithmetic_functions(), text_functions(), pose_functions(), socket_functions(), state_functions(),
          setting_functions(), motion_functions(), unsimulated_functions()})
      for (const Builtin& b : table) out[b.name] = &b;
    return out;
  }();
  const auto found = all.find(name);
  return found == all.end() || version < found->second->since ? nullptr : found->second;
}

std::vector<std::string> parameters_of(const Builtin& builtin) {
  std::vector<std::string> out;
  for (std::string_view rest = builtin.parameters; !rest.empty();) {
    const std::size_t blank = std::min(rest.find(' '), rest.size());
    out.emplace_back(rest.substr(0, blank));
    rest.remove_prefix(std::min(blank + 1, rest.size()));
  }
  return out;
}

}  // namespace simulated_ur5::urscript
