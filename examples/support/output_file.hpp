// A program's output that must not be one of its inputs.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

#include "skinctl/core/contract.hpp"

namespace examples {

/// To be called before `output` is opened, which would empty it. Throws `ConfigurationError` if it is one of
/// the files `inputs`, by whatever name: relative, a symbolic link, a hard link. Empty names, devices and
/// pipes pass.
inline void refuse_own_input(const std::string& output, std::initializer_list<std::string> inputs) {
  std::error_code none;  // a file that is not there is no input
  if (!std::filesystem::is_regular_file(output, none)) return;
  for (const std::string& input : inputs)
    if (std::filesystem::equivalent(output, input, none))
      skinctl::refuse(output + ": is the input '" + input +
                      "' itself, which would be lost; give another name");
}

}  // namespace examples
