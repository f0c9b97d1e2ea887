// The newest session of an authenticated skin that earlier runs heard.
#pragma once

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

#include "skinctl/core/contract.hpp"

namespace compliant_ur5 {

/// The newest session of the skin that earlier runs heard, beside its key: a recording of it is refused.
inline std::string session_file(const std::string& key) {
  return key + ".session";
}
inline std::uint64_t read_session(const std::string& key) {
  std::ifstream in(session_file(key));
  std::uint64_t session = 0;
  if (in && !(in >> session)) skinctl::refuse("skinctl: " + session_file(key) + ": no whole number");
  return session;
}
inline void write_session(const std::string& key, std::uint64_t session) {
  std::ofstream out(session_file(key));
  out << session << '\n' << std::flush;
  if (!out) std::fprintf(stderr, "compliant_ur5: cannot write %s\n", session_file(key).c_str());
}

}  // namespace compliant_ur5
