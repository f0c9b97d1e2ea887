// SPDX-License-Identifier: BSD-3-Clause
// Which scene and which build a recording is of: what makes a replay comparable to the bit.
#pragma once

#include <map>
#include <string>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/version.hpp"
#include "skinctl/recording/cycle_bytes.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Everything that decides on rounding: version, compiler, instruction set and optimisation of this
/// translation unit.
[[nodiscard]] inline std::string build_text() {
#define SKINCTL_AS_TEXT_OF(x) #x
#define SKINCTL_AS_TEXT(x) SKINCTL_AS_TEXT_OF(x)
  std::string text = "skinctl " SKINCTL_VERSION ", ";
#if defined(__clang__)
  text += "Clang " __clang_version__;
#elif defined(__GNUC__)
  text += "GCC " __VERSION__;
#else
  text += "another compiler";
#endif
  text += ", " SKINCTL_AS_TEXT(SKINCTL_ABI);
#if defined(__FMA__)
  text += " with fused multiply-add";
#endif
#if defined(__OPTIMIZE__)
  text += ", optimised";
#endif
  return text;
#undef SKINCTL_AS_TEXT
#undef SKINCTL_AS_TEXT_OF
}

/// The identity of the run in a file. `scene` is the program's own text: everything that its scene is built
/// from, such as the contents of its configuration file; recordings of another text are refused.
struct RunIdentity {
  std::string scene;
  std::string build = build_text();

  /// The name of the metadata in a file.
  static constexpr const char* name = "skinctl";

  /// The identity as metadata of a file that records `C`.
  template <class C>
  [[nodiscard]] std::map<std::string, std::string> facts() const {
    return {{"scene", scene}, {"build", build}, {"inputs", inputs<C>()}};
  }
  /// Throws `ConfigurationError` with both sides where the facts of a file are not of this scene, build and
  /// kind.
  template <class C>
  void check(const std::string& source, const std::map<std::string, std::string>& facts) const {
    for (const auto& [fact, ours] : this->facts<C>()) {
      const auto theirs = facts.find(fact);
      if (theirs == facts.end()) refuse("skinctl: " + source + " does not say its " + fact);
      if (theirs->second != ours)
        refuse("skinctl: " + source + " was recorded with another " + fact + ":\n  there " + theirs->second +
               "\n  here  " + ours);
    }
  }

 private:
  /// The kind of inputs in words: what decides how a cycle's bytes are read.
  template <class C>
  [[nodiscard]] static std::string inputs() {
    const auto [order, kind, joints, scalar, goal] = CycleBytes<C>::kind();
    return std::to_string(joints) + " joints, " + std::to_string(8 * scalar) + "-bit numbers, goals of " +
           std::to_string(goal) + " bytes, cells of " + std::to_string(CycleBytes<C>::sample_size) +
           " bytes" + ((kind & 8) != 0 ? ", a gripper" : "") + ((kind & 32) != 0 ? ", surroundings" : "") +
           ((kind & 4) != 0 ? ", configurations" : "") + ((kind & 2) != 0 ? ", motor torques" : "") +
           ((kind & 1) != 0 ? ", wrenches" : "");
  }
};

SKINCTL_END_NAMESPACE
