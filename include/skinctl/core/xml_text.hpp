// SPDX-License-Identifier: BSD-3-Clause
// Text inside XML, SVG and HTML.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `text` as it stands between tags or in an attribute's quotes, of XML and HTML: marks are escaped. Control
/// characters become spaces, but for tabs and new lines; bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] inline std::string xml_text(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x80) {
      switch (c) {
        case '&':
          out += "&amp;";
          break;
        case '<':
          out += "&lt;";
          break;
        case '>':
          out += "&gt;";
          break;
        case '"':
          out += "&quot;";
          break;
        case '\'':
          out += "&#39;";
          break;
        default:
          out += (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F ? ' ' : static_cast<char>(c);
      }
      ++i;
      continue;
    }
    const std::size_t length = c >= 0xF0 ? 4 : c >= 0xE0 ? 3 : 2;
    unsigned long code = c & (0x7Fu >> length);
    bool good = c >= 0xC2 && c <= 0xF4 && i + length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      good = (next & 0xC0) == 0x80;
      code = code << 6 | (next & 0x3Fu);
    }
    constexpr unsigned long smallest[] = {0, 0, 0x80, 0x800, 0x10000};
    good = good && code >= smallest[length] && code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF) &&
           (code < 0x80 || code > 0x9F) && code != 0xFFFE && code != 0xFFFF;
    out += good ? text.substr(i, length) : "\xEF\xBF\xBD";
    i += good ? length : 1;
  }
  return out;
}

SKINCTL_END_NAMESPACE
