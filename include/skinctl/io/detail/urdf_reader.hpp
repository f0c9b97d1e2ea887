// Reads a URDF: XML to joints and bodies.
#pragma once

#include <cstdio>

#include "skinctl/io/detail/urdf_motion.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

inline constexpr std::size_t urdf_size_limit = std::size_t(16) << 20;

class UrdfReader {
 public:
  UrdfReader(std::string_view text, std::string source, const UrdfOptions& options)
      : options_(options), text_(source) {
    urdf_.source = std::move(source);
    parse(text);
  }
  [[nodiscard]] Urdf take() { return std::move(urdf_); }

 private:
  using Element = tinyxml2::XMLElement;
  using Place = UrdfPlace;
  struct Link {
    const Element* xml;
    std::string name;
    int joint = -1;  ///< index into joints_ of the joint that carries it
  };
  /// The links that move with a joint, as one body.
  struct Body {
    LinkInertia inertia{};
    bool given = false;    ///< a link has an `<inertial>`
    std::size_t link = 0;  ///< the link that the joint carries
    const Element* bad{};  ///< a link whose moments of inertia no body has: it counts as a point mass
    double bad_size = 0;   ///< the largest of those moments [kg m^2]
  };

  void parse(std::string_view text) {
    if (text.size() > urdf_size_limit) text_.fail(0, std::to_string(text.size()) + " bytes, allowed: 16 MiB");
    tinyxml2::XMLDocument xml;
    if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      text_.fail(xml.ErrorLineNum(), std::string("no XML, or cut off: ") + xml.ErrorName());
    const Element* robot = xml.RootElement();
    if (robot == nullptr) text_.fail(0, "no XML: it has no element");
    if (std::strcmp(robot->Name(), "robot") != 0) text_.fail(*robot, "no URDF: its root is not <robot>");
    if (const char* name = robot->Attribute("name")) urdf_.name = name;
    read_tree(*robot);
    const std::size_t base = choose_base(root());
    choose_chain(base);
    walk(base, UrdfMotion(text_, joints_, options_));
    if (urdf_.joints.empty())
      text_.fail(*robot, options_.base.empty() && options_.tip.empty() && options_.locked.empty()
                             ? "no joint that moves"
                             : "no joint that moves between base and tip");
    for (std::size_t j = 0; j < urdf_.joints.size(); ++j) finish(j);
    turn_frames();
  }

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
    urdf_.base = links_[base].name;
    const auto reached = carried_by(base);
    for (UrdfFileJoint& j : joints_) j.inside = reached[j.parent];
    return base;
  }
  void choose_chain(std::size_t base) {
    if (options_.tip.empty()) return;
    for (UrdfFileJoint& j : joints_) j.on_chain = false;
    const std::size_t tip = find_link(options_.tip, "tip");
    for (std::size_t at = tip; at != base;) {
      if (links_[at].joint < 0)
        text_.fail(*links_[tip].xml, "the tip does not hang on the base \"" + urdf_.base + '"');
      UrdfFileJoint& joint = joints_[std::size_t(links_[at].joint)];
      joint.on_chain = true;
      at = joint.parent;
    }
  }

  /// The body of a link in its own frame, mass 0 where it has none. `bad`: the fault of its moments.
  LinkInertia inertia(const Element& link, const Element& e, std::string& bad, double& size) {
    const Element* m = e.FirstChildElement("mass");
    const Element* t = e.FirstChildElement("inertia");
    if (m == nullptr) text_.fail(link, "<inertial> has no <mass>");
    if (t == nullptr) text_.fail(link, "<inertial> has no <inertia>");
    LinkInertia in;
    in.mass = text_.number(link, *m, "value");
    if (in.mass < 0) text_.fail(link, "a negative mass");
    in.xx = text_.number(link, *t, "ixx"), in.yy = text_.number(link, *t, "iyy"),
    in.zz = text_.number(link, *t, "izz");
    in.xy = text_.number(link, *t, "ixy", "0"), in.xz = text_.number(link, *t, "ixz", "0"),
    in.yz = text_.number(link, *t, "iyz", "0");
    const double defect = density_defect(make_link({}, in));
    if (defect > makers_density) {
      bad = "moments of inertia that no body has: each principal one is at most the sum of the others";
      for (double x : {in.xx, in.yy, in.zz, in.xy, in.xz, in.yz}) size = std::max(size, std::abs(x));
      in.xx = in.yy = in.zz = in.xy = in.xz = in.yz = 0;
    } else if (defect > rounded_density) {
      char percent[16];
      std::snprintf(percent, sizeof percent, "%.2g", 100 * defect);
      warn(link, std::string("moments of inertia that no body has, by ") + percent +
                     " % of their size: taken as they are");
    }
    const Place X = text_.origin(link, e);
    return seen_from(X.R, X.p, in);
  }
  template <class At>
  void warn(const At& at, const std::string& what) {
    urdf_.warnings.push_back(text_.message(at, what));
  }
  /// Adds a link to the body that a joint carries; the inertia of links that nothing moves does not matter.
  void add_body(const Element& link, int carrier, const Place& X) {
    const Element* e = link.FirstChildElement("inertial");
    if (e == nullptr) return;
    std::string bad;
    double size = 0;
    if (carrier < 0) {
      const std::size_t before = urdf_.warnings.size();
      try {
        inertia(link, *e, bad, size);
      } catch (const ConfigurationError& error) {
        bad = error.what();
        bad.erase(0, text_.message(link, "").size());
      }
      urdf_.warnings.resize(before);
      if (!bad.empty()) warn(link, bad + "; nothing moves this link, so it does not matter");
      return;
    }
    Body& body = bodies_[std::size_t(carrier)];
    const LinkInertia part = seen_from(X.R, X.p, inertia(link, *e, bad, size));
    body.inertia = body.given ? combined(body.inertia, part) : part;
    body.given = true;
    if (bad.empty() || size < body.bad_size) return;
    body.bad = &link;
    body.bad_size = size;
  }

  /// Places the links below `base`.
  void walk(std::size_t base, const UrdfMotion& motion) {
    struct Step {
      std::size_t link;
      int carrier;  ///< of the parent link
      Place X;      ///< of the parent link in the carrier's frame
    };
    std::vector<Step> open = {{base, -1, {}}};
    while (!open.empty()) {
      Step step = open.back();
      open.pop_back();
      const Link& link = links_[step.link];
      if (step.link != base) pass(std::size_t(link.joint), motion, step.carrier, step.X);
      urdf_.frames.push_back({link.name, step.carrier, step.X.R, step.X.p});
      add_body(*link.xml, step.carrier, step.X);
      for (auto child = below_[step.link].rbegin(); child != below_[step.link].rend(); ++child)
        open.push_back({*child, step.carrier, step.X});
    }
  }
  /// From a joint's parent link to its child link.
  void pass(std::size_t index, const UrdfMotion& motion, int& carrier, Place& X) {
    const UrdfFileJoint& j = joints_[index];
    X = product(X, text_.origin(*j.xml, *j.xml));
    if (!j.fixed() && !j.slides() && j.type != "continuous" && j.type != "revolute")
      text_.fail(*j.xml, "type \"" + j.type + "\" is none of revolute, continuous, prismatic, fixed");
    if (const auto position = motion.stands(index)) {
      X = product(X, text_.moved(*j.xml, j.slides(), *position));
      if (!j.fixed()) urdf_.locked.push_back({j.name, *position});
      return;
    }
    UrdfJoint joint;
    joint.name = j.name;
    joint.link = links_[j.child].name;
    joint.parent = carrier;
    joint.line = j.xml->GetLineNum();
    joint.kind = j.slides() ? JointKind::prismatic : JointKind::revolute;
    joint.continuous = j.type == "continuous";
    read_limits(*j.xml, joint);
    const Rotation<double> turn = text_.onto_axis(*j.xml);
    joint.placed.R = X.R * turn;
    joint.placed.p[0] = X.p.x, joint.placed.p[1] = X.p.y, joint.placed.p[2] = X.p.z;
    X = {turn.transpose(), {0, 0, 0}};
    carrier = static_cast<int>(urdf_.joints.size());
    urdf_.joints.push_back(joint);
    bodies_.push_back({.link = j.child});
  }
  void read_limits(const Element& xml, UrdfJoint& joint) {
    const Element* limit = xml.FirstChildElement("limit");
    if (limit == nullptr) return;
    if (!joint.continuous) {
      joint.lower = text_.number(xml, *limit, "lower", "0");
      joint.upper = text_.number(xml, *limit, "upper", "0");
      if (joint.lower > joint.upper) text_.fail(xml, "its lower limit lies above its upper");
    }
    if (limit->Attribute("velocity")) joint.velocity = text_.number(xml, *limit, "velocity");
    if (limit->Attribute("effort")) joint.effort = text_.number(xml, *limit, "effort");
    if (options_.large_limits || joint.kind != JointKind::revolute) return;
    constexpr double two_turns = 12.6, fast = 60;
    const auto question = [&](const char* name, double x, const char* unit) {
      joint.question = std::string(name) + "=\"" + urdf_number(x) + "\" " + unit + " looks like degrees";
    };
    if (!joint.continuous && -joint.lower > two_turns) {
      question("lower", joint.lower, "rad");
    } else if (!joint.continuous && joint.upper > two_turns) {
      question("upper", joint.upper, "rad");
    } else if (limit->Attribute("velocity") && joint.velocity > fast) {
      question("velocity", joint.velocity, "rad/s");
    }
    if (!joint.question.empty()) warn(xml, joint.question);
  }

  /// Refuses a joint that moves no mass.
  void finish(std::size_t j) {
    UrdfJoint& joint = urdf_.joints[j];
    const Body& body = bodies_[j];
    const Element& link = *links_[body.link].xml;
    const LinkInertia& in = body.inertia;
    if (!body.given)
      text_.fail(link, "joint \"" + joint.name +
                           "\" moves it, but neither it nor what is fixed to it has an <inertial>");
    if (!(in.mass > 0))
      text_.fail(link, "joint \"" + joint.name +
                           "\" moves it, but its <inertial> and those fixed to it have no mass");
    if (body.bad != nullptr) {
      // Bad inertia of a sensor's mount is tolerated; that of a link with weight is not.
      const std::string what =
          "moments of inertia that no body has: each principal one is at most the sum of the others";
      if (body.bad_size > 1e-3 * (in.xx + in.yy + in.zz)) text_.fail(*body.bad, what);
      warn(*body.bad, what + "; next to what it is fixed to they do not matter, and count as none");
    }
    bool carries = false;
    for (const UrdfJoint& other : urdf_.joints) carries = carries || other.parent == static_cast<int>(j);
    const double about_axis = in.zz + in.mass * (in.c[0] * in.c[0] + in.c[1] * in.c[1]);
    if (!carries && joint.kind == JointKind::revolute && !(about_axis > 0))
      text_.fail(link,
                 "joint \"" + joint.name + "\" turns it, but it has no moment of inertia about that axis");
    joint.placed.inertia = in;
  }
  /// From the frames with z on their joints to those of the model, which are turned about z.
  void turn_frames() {
    std::vector<int> parents;
    std::vector<PlacedLink> placed;
    for (const UrdfJoint& j : urdf_.joints) parents.push_back(j.parent), placed.push_back(j.placed);
    for (UrdfFrame& f : urdf_.frames) {
      if (f.joint < 0) continue;
      const Angle turn = own_turn(std::size_t(f.joint), placed.size(), parents.data(), placed.data());
      const Rotation<double> R_MP{{turn.cos, -turn.sin, 0}, {turn.sin, turn.cos, 0}, {0, 0, 1}};
      f.p = R_MP * f.p;
      f.R = R_MP * f.R;
    }
  }

  UrdfOptions options_;
  UrdfText text_;
  Urdf urdf_;
  std::vector<Link> links_;
  std::vector<UrdfFileJoint> joints_;
  std::vector<std::vector<std::size_t>> below_;  // per link, its children
  std::map<std::string, std::size_t, std::less<>> link_index_;
  std::vector<Body> bodies_;  // per joint that moves
};

}  // namespace detail
SKINCTL_END_NAMESPACE
