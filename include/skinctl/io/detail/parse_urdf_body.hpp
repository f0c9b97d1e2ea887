// SPDX-License-Identifier: BSD-3-Clause
// Reads a URDF: the parser.
#pragma once

#include <algorithm>
#include <fstream>

#include "skinctl/io/detail/compiled.hpp"
#include "skinctl/io/detail/urdf_reader.hpp"
#include "skinctl/io/parse_urdf.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

[[noreturn]] SKINCTL_IO void fail_urdf(const Urdf& urdf, const UrdfJoint& joint, const std::string& what) {
  refuse("skinctl: " + urdf.source + ":" + std::to_string(joint.line) + ": <joint name=\"" + joint.name +
         "\">: " + what);
}
SKINCTL_IO std::string urdf_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

}  // namespace detail

SKINCTL_IO Urdf parse_urdf(std::string_view text, std::string source, const UrdfOptions& options) {
  return detail::UrdfReader(text, std::move(source), options).take();
}

SKINCTL_IO Urdf read_urdf(const std::string& path, const UrdfOptions& options) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  if (file) {
    text.resize(detail::urdf_size_limit + 1);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  }
  if (file.bad() || (!file.eof() && text.size() <= detail::urdf_size_limit))
    refuse("skinctl: " + path + ": cannot be read");
  return parse_urdf(text, path, options);
}

SKINCTL_IO UrdfLinks model_links(const Urdf& urdf) {
  const std::size_t n = urdf.joints.size();
  std::vector<int> parents;
  std::vector<JointKind> kinds;
  std::vector<PlacedLink> placed;
  for (const UrdfJoint& j : urdf.joints)
    parents.push_back(j.parent), kinds.push_back(j.kind), placed.push_back(j.placed);
  UrdfLinks out{std::vector<LinkParameters<double>>(n), std::vector<double>(n)};
  detail::canonicalise(n, parents.data(), kinds.data(), placed.data(), out.links.data(), out.turn.data());
  for (std::size_t i = 0; i < n; ++i) {
    try {
      check_link(out.links[i], makers_density);
    } catch (const ConfigurationError& e) {
      detail::fail_urdf(urdf, urdf.joints[i], e.what());
    }
  }
  return out;
}

SKINCTL_END_NAMESPACE
