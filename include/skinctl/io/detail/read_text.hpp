// SPDX-License-Identifier: BSD-3-Clause
// A whole file as text, of a size that is bounded.
#pragma once

#include <fstream>
#include <string>
#include <string_view>

#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

inline constexpr std::size_t text_size_limit = std::size_t(1) << 28;

inline void require_text_size(std::string_view text, const std::string& source) {
  if (text.size() > text_size_limit)
    refuse("skinctl: " + source + ": " + std::to_string(text.size()) + " bytes, allowed: up to 256 MiB");
}

/// The text of a file. Throws `ConfigurationError` for one that cannot be read or is larger than 256 MiB.
[[nodiscard]] inline std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text, part(std::size_t(1) << 16, '\0');
  while (file && text.size() <= text_size_limit) {
    file.read(part.data(), static_cast<std::streamsize>(part.size()));
    text.append(part, 0, static_cast<std::size_t>(file.gcount() > 0 ? file.gcount() : 0));
  }
  if (file.bad() || (!file.eof() && text.size() <= text_size_limit))
    refuse("skinctl: " + path + ": cannot be read");
  require_text_size(text, path);
  return text;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
