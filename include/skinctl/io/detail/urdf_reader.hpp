// SPDX-License-Identifier: BSD-3-Clause
// Reads a URDF: XML to joints and bodies.
#pragma once

#include <algorithm>
#include <cstdio>

#include "skinctl/io/detail/urdf_links.hpp"
#include "skinctl/io/detail/urdf_masses.hpp"

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
  /// The links that move with a joint, as one body.
  struct Body {
    LinkInertia inertia{};
    bool given = false;    ///< whether a link has an `<inertial>`
    std::size_t link = 0;  ///< the link that the joint carries
    UrdfShapes shapes{};   ///< shapes of its collision geometry
    const Element* bad{};  ///< a link whose moments of inertia no body has: it counts as a point mass
    std::string fault{};   ///< fault of the moments of `bad`
    double bad_size = 0;   ///< the largest moment of inertia of `bad` [kg m^2]
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
    if (const Element* macro = xacro_in(*robot)) {
      const std::string what = "a xacro that was not expanded: `xacro " + urdf_.source +
                               " > robot.urdf` (ROS, or pip install xacro) makes the URDF of it";
      try {
        read(*robot);
      } catch (const ConfigurationError&) {
        text_.fail(*macro, what);
      }
      warn(*macro, what + "; what it describes is missing");
    } else {
      read(*robot);
    }
  }
  void read(const Element& root) {
    const Element* robot = &root;
    const UrdfLinks links(text_, *robot, options_);
    urdf_.base = links[links.base()].name;
    walk(links, UrdfMotion(text_, links.joints(), options_));
    if (urdf_.joints.empty())
      text_.fail(*robot, options_.base.empty() && options_.tip.empty() && options_.locked.empty()
                             ? "no joint that moves"
                             : "no joint that moves between base and tip");
    for (std::size_t j = 0; j < urdf_.joints.size(); ++j) finish(j);
    if (!urdf_.assumed_masses.empty() || options_.total_mass != 0) assume_masses(*robot);
    warn_of_limits(*robot);
    turn_frames();
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
    char percent[16];
    std::snprintf(percent, sizeof percent, "%.2g", 100 * defect);
    const Xyz<double> moments = eigenvalues(Symmetric<double>{in.xx, in.yy, in.zz, in.xy, in.xz, in.yz});
    if (defect > makers_density && !(moments.x >= -0.1 * moments.z - 1e-15)) {
      bad = "moments of inertia that no body has: the smallest principal one is " + urdf_number(moments.x) +
            " kg m^2";
      for (double x : {in.xx, in.yy, in.zz, in.xy, in.xz, in.yz}) size = std::max(size, std::abs(x));
      in.xx = in.yy = in.zz = in.xy = in.xz = in.yz = 0;
    } else if (defect > makers_density) {
      const double change = make_possible(in);
      warn(link, std::string("moments of inertia that no body has, by ") + percent +
                     " % of their size: replaced by the nearest that one has, " + urdf_number(change) +
                     " kg m^2 away");
    } else if (defect > rounded_density) {
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
    if (carrier >= 0) bodies_[std::size_t(carrier)].shapes.add(text_, link, X);
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
    body.fault = bad;
    body.bad_size = size;
  }

  /// Places the links below the base.
  void walk(const UrdfLinks& links, const UrdfMotion& motion) {
    struct Step {
      std::size_t link;
      int carrier;  ///< joint that carries the parent link
      Place X;      ///< pose of the parent link in the carrier's frame
    };
    std::vector<Step> open = {{links.base(), -1, {}}};
    while (!open.empty()) {
      Step step = open.back();
      open.pop_back();
      const UrdfLinks::Link& link = links[step.link];
      if (step.link != links.base()) pass(links, std::size_t(link.joint), motion, step.carrier, step.X);
      urdf_.frames.push_back({link.name, step.carrier, step.X.R, step.X.p});
      add_body(*link.xml, step.carrier, step.X);
      const auto& below = links.below(step.link);
      for (auto child = below.rbegin(); child != below.rend(); ++child)
        open.push_back({*child, step.carrier, step.X});
    }
  }
  /// Moves `carrier` and `X` from a joint's parent link to its child link.
  void pass(const UrdfLinks& links, std::size_t index, const UrdfMotion& motion, int& carrier, Place& X) {
    const UrdfFileJoint& j = links.joints()[index];
    X = product(X, text_.origin(*j.xml, *j.xml));
    if (j.carried && !j.fixed() && !j.slides() && j.type != "continuous" && j.type != "revolute")
      text_.fail(*j.xml, "type \"" + j.type + "\" is none of revolute, continuous, prismatic, fixed");
    if (const auto position = motion.stands(index)) {
      X = product(X, text_.moved(*j.xml, j.slides(), *position));
      if (!j.fixed()) urdf_.locked.push_back({j.name, *position});
      return;
    }
    UrdfJoint joint;
    joint.name = j.name;
    joint.link = links[j.child].name;
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
    read_soft_limits(text_, xml, joint);
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
  }
  /// Adds one warning a file of each kind, however many joints it concerns.
  void warn_of_limits(const Element& robot) {
    std::vector<const UrdfJoint*> questioned, soft;
    for (const UrdfJoint& j : urdf_.joints) {
      if (!j.question.empty()) questioned.push_back(&j);
      if (std::isfinite(j.soft_lower) || std::isfinite(j.soft_upper)) soft.push_back(&j);
    }
    const auto names = [](const std::vector<const UrdfJoint*>& joints) {
      return listed(joints, [](const UrdfJoint* j) { return j->name; });
    };
    if (!questioned.empty())
      warn(robot, "limits of joint " + names(questioned) + ": " + questioned[0]->question +
                      "; limits_of refuses them without UrdfOptions::large_limits");
    if (!soft.empty())
      warn(robot, "soft limits of joint " + names(soft) + ", first " + urdf_number(soft[0]->soft_lower) +
                      " to " + urdf_number(soft[0]->soft_upper) + ": limits_of keeps within them");
  }

  /// Judges the body that joint `j` moves.
  void finish(std::size_t j) {
    UrdfJoint& joint = urdf_.joints[j];
    const Body& body = bodies_[j];
    const LinkInertia& in = body.inertia;
    joint.placed.inertia = in;
    if (!body.given || !(in.mass > 0)) {
      joint.placed.inertia = {};
      urdf_.assumed_masses.push_back({joint.link, 0});
      return;
    }
    if (body.bad != nullptr) {
      // Bad inertia of a sensor's mount is tolerated; that of a link with weight is not.
      if (body.bad_size > 1e-3 * (in.xx + in.yy + in.zz)) text_.fail(*body.bad, body.fault);
      warn(*body.bad, body.fault + "; next to what it is fixed to they do not matter, and count as none");
    }
    bool carries = false;
    for (const UrdfJoint& other : urdf_.joints) carries = carries || other.parent == static_cast<int>(j);
    const double about_axis = in.zz + in.mass * (in.c[0] * in.c[0] + in.c[1] * in.c[1]);
    if (!carries && joint.kind == JointKind::revolute && !(about_axis > 0))
      urdf_.assumed_masses.push_back({joint.link, in.mass});
  }
  /// Estimates the masses that the file does not give, or says which they are.
  void assume_masses(const Element& robot) {
    if (options_.total_mass == 0) {
      warn(robot,
           "no mass that joint moves, or no inertia about its axis: link " +
               listed(urdf_.assumed_masses, [](const UrdfAssumedMass& a) { return a.link; }) +
               "; by position and velocity virtual_inertia does, or UrdfOptions::total_mass estimates it; "
               "by torque the model is refused");
      return;
    }
    UrdfEstimate estimate(urdf_);
    for (const Body& body : bodies_) estimate.add(body.shapes);
    const double total = options_.total_mass;
    if (!(total > 0 && total <= 1e5 && estimate.spread(total)))
      text_.fail(robot, "total_mass " + urdf_number(total) + " kg, allowed: above the " +
                            urdf_number(estimate.given()) + " kg that the file gives, <= 1e5");
    if (!urdf_.assumed_masses.empty()) warn(robot, estimate.words(total));
  }
  /// Turns the frames with z on their joints to those of the model, which are turned about z.
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
  std::vector<Body> bodies_;  // per joint that moves
};

}  // namespace detail
SKINCTL_END_NAMESPACE
