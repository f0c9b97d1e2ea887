// Lines on the script ports that are no URScript: they steer the controller and leave the running program
// alone, but for those that stop it.
#pragma once

#include <string_view>

#include "examples/simulated_ur5/controller.hpp"

namespace simulated_ur5::primary {

/// Obeys `line` if it is a command; blanks around it do not count. False: it is URScript.
bool obey(std::string_view line, Controller& controller);

}  // namespace simulated_ur5::primary
