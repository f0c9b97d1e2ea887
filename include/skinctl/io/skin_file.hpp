// SPDX-License-Identifier: BSD-3-Clause
// Skin files in JSON, `skinctl-skin-1`. Optional: needs nlohmann-json (Debian: nlohmann-json3-dev).
#pragma once

#include <fstream>

#include "skinctl/io/detail/read_text.hpp"
#include "skinctl/io/detail/skin_json.hpp"
#include "skinctl/io/detail/skin_json_writer.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Reads a skin file from memory. `source` is its name in error texts. All numbers are in SI units.
///
/// | table | fields |
/// |---|---|
/// | file | `format` = "skinctl-skin-1", `links`, `patches`, `regions`? |
/// | link | `name`, `radius`, `length`, `joint_axis`? |
/// | patch | `name`, `link`, `X_LinkRoot`, `gains` {`force`, `proximity`}, `covariance`?, `cells` |
/// | cell | `id`, `X_RootCell`, `neighbours`? (ids at ports 1 to 4, null: nobody), `group`?, `threshold`?, `gain`?, `covariance`?, `masked`? (why) |
/// | region | `name`, `cells` (ids), `weight`?, `force_limit`? |
/// | pose | `p` [x, y, z], `q` [x, y, z, w] |
///
/// Throws `ConfigurationError`, with source, line, patch, cell, field, value and allowed range, for:
/// - text that is no JSON, exceeds 256 MiB, is more than 8 levels deep;
/// - a field that is missing, unknown, given twice or of another type;
/// - what `SkinFile::check` refuses.
[[nodiscard]] inline SkinFile parse_skin_file(std::string_view text, std::string source = "skin file") {
  detail::require_text_size(text, source);
  return detail::SkinJsonReader(text, std::move(source)).take();
}

/// Reads a skin file; see `parse_skin_file`. Also throws `ConfigurationError` for a file that cannot be read.
[[nodiscard]] inline SkinFile read_skin_file(const std::string& path) {
  return parse_skin_file(detail::read_text(path), path);
}

/// The text of a skin file, for `parse_skin_file`: what that returns is equal but for the lines. Throws
/// `ConfigurationError` where `SkinFile::check` does.
[[nodiscard]] inline std::string skin_file_text(const SkinFile& file) {
  file.check();
  return detail::SkinJsonWriter(file).take();
}

/// Writes a skin file. Also throws `ConfigurationError` where it cannot be written.
inline void write_skin_file(const SkinFile& file, const std::string& path) {
  const std::string text = skin_file_text(file);
  std::ofstream out(path, std::ios::binary);
  out << text << std::flush;
  if (!out) refuse("skinctl: " + path + ": cannot be written");
}

SKINCTL_END_NAMESPACE
