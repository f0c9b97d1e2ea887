// SPDX-License-Identifier: BSD-3-Clause
// Links and joints of a URDF as its file has them, and the part of the tree that is asked for.
#pragma once

#include "skinctl/io/detail/urdf_motion.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

class UrdfLinks {
 public:
  using Element = tinyxml2::XMLElement;
  struct Link {
    const Element* xml;
    std::string name;
    int joint = -1;  ///< index into `joints()` of the joint that carries it
  };

  UrdfLinks(const UrdfText& text, const Element& robot, const UrdfOptions& options)
      : text_(text), options_(options) {
    read_tree(robot);
    base_ = choose_base(root());
    choose_chain(base_);
  }
  [[nodiscard]] std::size_t base() const { return base_; }
  [[nodiscard]] const Link& operator[](std::size_t link) const { return links_[link]; }
  [[nodiscard]] const std::vector<UrdfFileJoint>& joints() const { return joints_; }
  [[nodiscard]] const std::vector<std::size_t>& below(std::size_t link) const { return below_[link]; }

 private:
  void read_tree(const Element& robot) {
    for (auto* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
      const std::string name = text_.text_of(*e, "name");
      if (!link_index_.emplace(name, links_.size()).second) text_.fail(*e, "a second link of this name");
      links_.push_back({e, name});
    }
    if (links_.empty()) text_.fail(robot, "no <link>");
    std::map<std::string, int> names;
    for (auto* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
      UrdfFileJoint joint{e, text_.text_of(*e, "name"), text_.text_of(*e, "type"), link_of(*e, "parent"),
                          link_of(*e, "child")};
      if (!names.emplace(joint.name, 0).second) text_.fail(*e, "a second joint of this name");
      Link& child = links_[joint.child];
      if (child.joint >= 0)
        text_.fail(*e, "its child link \"" + child.name + "\" hangs on joint \"" +
                           joints_[std::size_t(child.joint)].name + "\" already");
      child.joint = static_cast<int>(joints_.size());
      joints_.push_back(joint);
    }
    below_.resize(links_.size());
    for (const UrdfFileJoint& j : joints_) below_[j.parent].push_back(j.child);
  }
  std::size_t link_of(const Element& joint, const char* end) const {
    const Element* e = joint.FirstChildElement(end);
    if (e == nullptr) text_.fail(joint, std::string("no <") + end + ">");
    const char* link = e->Attribute("link");
    const auto found = link_index_.find(link ? link : "");
    if (found == link_index_.end())
      text_.fail(joint, std::string("its ") + end + " link \"" + (link ? link : "") + "\" is unknown");
    return found->second;
  }
  /// The only link that no joint carries; it carries all others.
  std::size_t root() const {
    std::size_t root = links_.size();
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (links_[i].joint >= 0) continue;
      if (root < links_.size())
        text_.fail(*links_[i].xml, "hangs on no joint, and neither does \"" + links_[root].name +
                                       "\": one link only is the base");
      root = i;
    }
    if (root == links_.size())
      text_.fail(*joints_[0].xml, "a loop: every link is the child of a joint, so there is no base");
    const auto reached = carried_by(root);
    for (std::size_t i = 0; i < links_.size(); ++i)
      if (!reached[i])
        text_.fail(*joints_[std::size_t(links_[i].joint)].xml,
                   "a loop: its child link \"" + links_[i].name + "\" carries itself");
    return root;
  }
  /// The links below one, itself included; by a stack of its own, because a file may nest deeper than the
  /// program's stack.
  std::vector<bool> carried_by(std::size_t link) const {
    std::vector<bool> reached(links_.size());
    std::vector<std::size_t> open = {link};
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      reached[at] = true;
      open.insert(open.end(), below_[at].begin(), below_[at].end());
    }
    return reached;
  }

  std::size_t find_link(const std::string& name, const char* what) const {
    const auto found = link_index_.find(name);
    if (found == link_index_.end())
      text_.fail(0, std::string("no link \"") + name + "\" for the " + what + "; there are " +
                        listed(links_, [](const Link& l) { return l.name; }));
    return found->second;
  }
  std::size_t choose_base(std::size_t root) {
    const std::size_t base = options_.base.empty() ? root : find_link(options_.base, "base");
    const auto reached = carried_by(base);
    for (UrdfFileJoint& j : joints_) j.inside = reached[j.parent];
    return base;
  }
  void choose_chain(std::size_t base) {
    if (options_.tip.empty()) return;
    for (UrdfFileJoint& j : joints_) j.on_chain = false;
    const std::size_t tip = find_link(options_.tip, "tip");
    std::size_t moved = links_.size();  // the link that the chain's first moving joint carries
    for (std::size_t at = tip; at != base;) {
      if (links_[at].joint < 0)
        text_.fail(*links_[tip].xml, "the tip does not hang on the base \"" + links_[base].name + '"');
      UrdfFileJoint& joint = joints_[std::size_t(links_[at].joint)];
      joint.on_chain = true;
      if (!joint.fixed() && !options_.locked.contains(joint.name)) moved = at;
      at = joint.parent;
    }
    const auto reached = moved < links_.size() ? carried_by(moved) : std::vector<bool>(links_.size());
    for (UrdfFileJoint& j : joints_) j.carried = j.on_chain || reached[j.parent];
  }

  const UrdfText& text_;
  const UrdfOptions& options_;
  std::vector<Link> links_;
  std::vector<UrdfFileJoint> joints_;
  std::vector<std::vector<std::size_t>> below_;  // per link, its children
  std::map<std::string, std::size_t, std::less<>> link_index_;
  std::size_t base_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
