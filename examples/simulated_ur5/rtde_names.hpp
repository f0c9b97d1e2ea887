// Names of numbered variables.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace simulated_ur5::rtde {

/// The number behind `prefix` in `name`, if there is one below `count`, written without leading zeros.
inline std::optional<std::size_t> number_behind(std::string_view name, std::string_view prefix,
                                                std::size_t count) {
  if (!name.starts_with(prefix)) return std::nullopt;
  const std::string_view digits = name.substr(prefix.size());
  if (digits.empty() || digits.size() > 3 || (digits.size() > 1 && digits[0] == '0')) return std::nullopt;
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || value >= count) return std::nullopt;
  return value;
}

}  // namespace simulated_ur5::rtde
