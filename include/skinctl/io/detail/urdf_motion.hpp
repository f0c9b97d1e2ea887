// SPDX-License-Identifier: BSD-3-Clause
// Moving and fixed joints of a URDF: types, chains, locked joints, mimics.
#pragma once

#include <optional>

#include "skinctl/io/detail/urdf_text.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A joint as in the file.
struct UrdfFileJoint {
  const tinyxml2::XMLElement* xml;
  std::string name, type;
  std::size_t parent, child;  ///< indices of links
  bool inside = false;        ///< whether the base carries the joint, directly or not
  bool on_chain = true;       ///< whether the joint is between base and tip, if there is a tip
  bool carried = true;        ///< whether a joint of the chain carries this one, directly or not

  [[nodiscard]] bool fixed() const { return type == "fixed"; }
  [[nodiscard]] bool slides() const { return type == "prismatic"; }
};

class UrdfMotion {
 public:
  UrdfMotion(const UrdfText& text, const std::vector<UrdfFileJoint>& joints, const UrdfOptions& options)
      : text_(text), joints_(joints), options_(options) {
    for (std::size_t j = 0; j < joints.size(); ++j) index_.emplace(joints[j].name, j);
    for (const auto& [name, position] : options.locked) check_lock(name, position);
  }

  /// The position of joint `j` if it is fixed; nothing if it moves.
  [[nodiscard]] std::optional<double> stands(std::size_t j) const { return stands(j, 0); }

 private:
  using Element = tinyxml2::XMLElement;

  void check_lock(const std::string& name, double position) const {
    const auto found = index_.find(name);
    if (found == index_.end())
      text_.fail(0, "no joint \"" + name + "\" to lock; there are " +
                        listed(joints_, [](const UrdfFileJoint& j) { return j.name; }));
    const UrdfFileJoint& joint = joints_[found->second];
    if (joint.fixed()) text_.fail(*joint.xml, "locked by the options, but it is fixed already");
    if (!(position - position == 0))
      text_.fail(*joint.xml, "locked at " + urdf_number(position) + ": a finite position is needed");
    check_room(joint, position, "locked at ");
  }
  void check_room(const UrdfFileJoint& joint, double position, const std::string& how) const {
    const Element* limit = joint.xml->FirstChildElement("limit");
    if (limit == nullptr || joint.type == "continuous") return;
    const double lower = text_.number(*joint.xml, *limit, "lower", "0"),
                 upper = text_.number(*joint.xml, *limit, "upper", "0");
    const double rounding = 1e-9;
    if (position < lower - rounding || position > upper + rounding)
      text_.fail(*joint.xml, how + urdf_number(position) + ", outside of its limits " + urdf_number(lower) +
                                 " to " + urdf_number(upper) + ": lock it within");
  }

  [[nodiscard]] std::optional<double> stands(std::size_t j, std::size_t depth) const {
    const UrdfFileJoint& joint = joints_[j];
    if (joint.fixed()) return 0.0;
    const auto locked = options_.locked.find(joint.name);
    const Element* mimic = joint.xml->FirstChildElement("mimic");
    if (!joint.carried && locked == options_.locked.end()) return 0.0;  // on the fixed base, beside the chain
    if (mimic == nullptr) {
      if (locked != options_.locked.end()) return locked->second;
      if (!joint.inside) return 0.0;
      if (joint.on_chain) return std::nullopt;
      check_room(joint, 0, "off the way to the tip, it stands at ");
      return 0.0;
    }
    const std::string driver = mimic->Attribute("joint") ? mimic->Attribute("joint") : "";
    const auto found = index_.find(driver);
    if (found == index_.end()) text_.fail(*joint.xml, "<mimic>: its joint \"" + driver + "\" is unknown");
    if (depth >= joints_.size()) text_.fail(*joint.xml, "<mimic>: it mimics itself");
    const auto followed = stands(found->second, depth + 1);
    if (!followed) {
      if (locked != options_.locked.end()) return locked->second;
      text_.fail(*joint.xml, "<mimic>: it follows \"" + driver +
                                 "\", which moves; a joint of a model moves by itself. Lock \"" + driver +
                                 "\", and this one stands with it, or lock this one");
    }
    const double position = text_.number(*joint.xml, *mimic, "multiplier", "1") * *followed +
                            text_.number(*joint.xml, *mimic, "offset", "0");
    if (locked != options_.locked.end() && !(std::abs(locked->second - position) <= 1e-9))
      text_.fail(*joint.xml, "locked at " + urdf_number(locked->second) + ", but it follows \"" + driver +
                                 "\", which puts it at " + urdf_number(position));
    check_room(joint, position, "it follows \"" + driver + "\" to ");
    return position;
  }

  const UrdfText& text_;
  const std::vector<UrdfFileJoint>& joints_;
  const UrdfOptions& options_;
  std::map<std::string, std::size_t, std::less<>> index_;
};

/// Soft limits within the joint's own; makers write 0 to 0 for none.
inline void read_soft_limits(const UrdfText& text, const tinyxml2::XMLElement& xml, UrdfJoint& joint) {
  const auto* soft = xml.FirstChildElement("safety_controller");
  if (soft == nullptr || joint.continuous) return;
  const double lower = text.number(xml, *soft, "soft_lower_limit", "0"),
               upper = text.number(xml, *soft, "soft_upper_limit", "0");
  if (!(lower < upper && lower < joint.upper && upper > joint.lower)) return;
  if (lower > joint.lower) joint.soft_lower = lower;
  if (upper < joint.upper) joint.soft_upper = upper;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
