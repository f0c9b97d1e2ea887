#include "examples/packing_oranges/world.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "examples/packing_oranges/tool.hpp"
#include "skinctl/io/formatted.hpp"

namespace packing {
namespace {
using skinctl::Xyz;

constexpr double tick = 0.001;
constexpr double solid = 0.5;          // d of solimp: between free and rigid
constexpr double finger_reach = 0.16;  // from the flange to the point between the fingers
constexpr double orange_mass = 0.18;

constexpr int the_thing = 1000;   // among the numbers of oranges
constexpr std::size_t parts = 5;  // of an arm, as contacts tell them apart: its fingertips, and all else

// Collision classes. The links of an arm do not meet each other: its limits keep them apart.
constexpr int is_table = 1, is_orange = 2, is_arm[arms] = {4, 8}, is_obstacle = 16;
constexpr int meets_arm[arms] = {is_table | is_orange | is_obstacle | is_arm[1],
                                 is_table | is_orange | is_obstacle | is_arm[0]};

std::string list(std::initializer_list<double> values) {
  std::string out;
  for (const double v : values) out += skinctl::formatted("%.12g ", v);
  out.pop_back();
  return out;
}
std::string list(const Xyz<double>& v) {
  return list({v.x, v.y, v.z});
}
std::string name(const char* what, std::size_t arm, std::size_t i) {
  return std::string(what) + static_cast<char>('a' + arm) + std::to_string(i);
}
std::string collides(int type, int with) {
  return " contype='" + std::to_string(type) + "' conaffinity='" + std::to_string(with) + "'";
}

void write_gripper(std::string& xml, std::size_t arm, double flange) {
  const std::string meets = collides(is_arm[arm], meets_arm[arm]);
  xml += "<body name='" + name("palm", arm, 0) + "' pos='" + list({0, 0, flange}) + "'><site name='" +
         name("wrist", arm, 0) + "'/><geom type='box' size='0.035 0.06 0.025' pos='0 0 0.03' mass='0.5'" +
         meets + "/>";
  for (std::size_t f = 0; f < 2; ++f) {
    const double way = f == 0 ? 1 : -1;
    xml += "<body name='" + name("finger", arm, f) + "' pos='" + list({0, 0, finger_reach}) +
           "'><joint name='" + name("slide", arm, f) + "' type='slide' axis='" + list({0, way, 0}) +
           "' armature='0.3'/><geom type='box' size='0.012 0.006 0.022' pos='" + list({0, way * 0.006, 0}) +
           "' mass='0.08'" + meets + "/></body>";
  }
  xml += "</body>";
}

std::string inertial(const LinkBody& l) {
  const auto& I = l.inertia;
  return "<inertial mass='" + list({l.mass}) + "' pos='" + list(l.com) + "' fullinertia='" +
         list({I[0], I[1], I[2], I[3], I[4], I[5]}) + "'/>";
}
std::string placed(const LinkBody& l) {
  return "pos='" + list(l.p) + "' xyaxes='" + list(l.x) + " " + list(l.y) + "'";
}
// What the maker does not publish is as the simulated Allegro hand of this library has it.
constexpr double rotor = 2e-4, viscous = 0.01, coulomb = 0.015;  // [kg m^2], [N m s/rad], [N m]
constexpr double finger_radius = 0.0098;

void write_hand(std::string& xml, std::size_t arm, const HandBody& h) {
  const std::string meets = collides(is_arm[arm], meets_arm[arm]);
  xml += "<body name='" + name("palm", arm, 0) + "' " + placed(h.palm) + ">" + inertial(h.palm) +
         "<geom type='box' size='0.012 0.055 0.0475' pos='-0.012 0 -0.0475'" + meets + "/>";
  for (std::size_t i = 0; i < 16; ++i) {
    xml += "<body name='" + name("knuckle", arm, i) + "' " + placed(h.links[i]) + "><joint name='" +
           name("finger", arm, i) + "' type='hinge' axis='0 0 1' limited='true' range='" +
           list({h.lower[i], h.upper[i]}) + "' armature='" + list({rotor}) + "' damping='" + list({viscous}) +
           "' frictionloss='" + list({coulomb}) + "'/>" + inertial(h.links[i]);
    const bool last = i % 4 == 3;
    const Xyz<double> to = last ? h.tips[i / 4] : h.links[i + 1].p;
    if (norm(to) > 0.01 && i % 4 > 0)
      xml += "<geom type='capsule' size='" + list({finger_radius}) + "' fromto='0 0 0 " + list(to) + "'" +
             meets + "/>";
    if (!last) continue;
    xml += "<body name='" + name("tip", arm, i / 4) + "' pos='" + list(to) + "'><geom type='sphere' size='" +
           list({tip_radius}) + "' mass='1e-6'" + meets + "/></body></body></body></body></body>";
  }
  xml += "</body>";
}

void write_arm(std::string& xml, std::size_t arm, const ArmBody& body) {
  xml += "<body name='" + name("base", arm, 0) + "' pos='" + list(body.X_WB.origin()) + "' xyaxes='" +
         list(body.X_WB.axis_x()) + " " + list(body.X_WB.axis_y()) + "'>";
  for (std::size_t i = 0; i < 6; ++i) {
    const LinkBody& l = body.links[i];
    xml += "<body name='" + name("link", arm, i) + "' " + placed(l) + "><joint name='" +
           name("joint", arm, i) + "' type='hinge' axis='0 0 1' armature='" + list({i < 3 ? 2.0 : 0.5}) +
           "'/>" + inertial(l);
    const skinctl::Capsule<>& s = body.shapes[i];
    // The shoulder stands on the table: it does not meet it.
    const int meets = i < 2 ? meets_arm[arm] & ~is_table : meets_arm[arm];
    if (s.radius > 0)
      xml += "<geom type='capsule' size='" + list({s.radius}) + "' fromto='" + list(s.from) + " " +
             list(s.to) + "'" + collides(is_arm[arm], meets) + "/>";
  }
  if (body.hand)
    write_hand(xml, arm, *body.hand);
  else
    write_gripper(xml, arm, body.flange);
  for (std::size_t i = 0; i < 6; ++i) xml += "</body>";
  xml += "</body>";
}

// A wooden tray on a wooden table, and what it holds.
constexpr double tray_mass = 1.5, tray_friction = 0.4;  // [kg], of its weight

/// Walls, and where it moves a bottom, and two slides, which hold it by friction.
void write_tray(std::string& xml, std::size_t k, const Tray& t, bool moves) {
  xml += "<body name='" + name("tray", 0, k) + "' pos='" + list({t.x, t.y, 0}) + "'>";
  if (moves) {
    xml += "<inertial mass='" + list({tray_mass}) + "' pos='0 0 0.03' diaginertia='0.03 0.03 0.05'/>";
    for (const char* axis : {"1 0 0", "0 1 0"})
      xml += std::string("<joint type='slide' axis='") + axis + "' damping='5' frictionloss='" +
             list({tray_friction * tray_mass * 9.81}) + "'/>";
  }
  const auto add = [&](double x, double y, double hx, double hy, double height) {
    xml += "<geom type='box' pos='" + list({x, y, height / 2}) + "' size='" + list({hx, hy, height / 2}) +
           "'" + collides(is_table, 0) + "/>";
  };
  constexpr double half = 0.004;
  for (const double side : {-1.0, 1.0}) {
    add(side * (t.half_x + half), 0, half, t.half_y, t.wall);
    add(0, side * (t.half_y + half), t.half_x + 2 * half, half, t.wall);
  }
  if (moves) add(0, 0, t.half_x, t.half_y, tray_bottom);
  xml += "</body>";
}

std::string thing_text(const Thing& t, double friction) {
  if (t.shape == Thing::Shape::none) return "";
  constexpr const char* shapes[] = {"", "sphere", "cylinder", "box"};
  const Xyz<double> size = t.shape == Thing::Shape::cylinder ? Xyz<double>{t.half.x, t.half.z, 0} : t.half;
  return std::string("<body name='thing' pos='5 1 1'><freejoint/><geom name='thing' type='") +
         shapes[static_cast<std::size_t>(t.shape)] + "' size='" + list(size) + "' mass='" + list({t.mass}) +
         "' priority='1' condim='6' friction='" + list({friction, 0.01, 0.0005}) + "' solimp='" +
         list({solid, solid, 0.001, 0.5, 2}) + "'" + collides(is_orange, is_table) + "/></body>";
}

/// Oranges that a wrist presses on the table: a contact as stiff as the orange, like that of a finger.
std::string press_text(const WorldSettings& settings, const std::string& soft) {
  std::string xml = "<contact>";
  for (std::size_t k = 0; k < arms * slots; ++k)
    if (k % slots < settings.room)
      xml += "<pair geom1='table' geom2='orange" + std::to_string(k) + "' condim='6' friction='" +
             list({settings.friction, settings.friction, 0.01, 0.0005, 0.0005}) + "' solimp='" + soft + "'/>";
  xml += "</contact><sensor>";
  for (std::size_t arm = 0; arm < arms; ++arm) xml += "<force site='" + name("wrist", arm, 0) + "'/>";
  return xml + "</sensor>";
}

/// Bread and tool, in the places of oranges.
std::string kitchen_text(std::size_t k, const WorldSettings& settings) {
  const std::string id = std::to_string(k);
  const std::string common = " priority='1' condim='6' friction='" + list({settings.friction, 0.01, 0.0005}) +
                             "' solimp='" + list({solid, solid, 0.001, 0.5, 2}) + "'" +
                             collides(is_orange, is_table | is_orange) + "/>";
  std::string xml = "<body name='orange" + id + "' pos='" + list({5 + 0.3 * static_cast<double>(k), 0, 1}) +
                    "'><freejoint/><geom name='orange" + id + "' ";
  if (!is_tool(k))
    return xml + "type='cylinder' size='" + list({bread_radius, bread_half}) + "' mass='" +
           list({bread_mass}) + "'" + common + "</body>";
  xml += "type='box' size='" + list(handle_half) + "' mass='" + list({handle_mass}) + "'" + common;
  return xml + "<geom type='box' size='" + list(blade_half) + "' pos='" +
         list({handle_half.x + blade_half.x, 0, 0}) + "' mass='" + list({blade_mass}) + "'" + common +
         "</body>";
}

/// Two tables above the floor, between which the robot drives.
void write_tables(std::string& xml) {
  constexpr double thick = 0.02, floor = -0.75;
  xml += "<geom name='floor' type='plane' size='5 5 0.1' pos='" + list({0, 0, floor}) + "'" +
         collides(is_table, 0) + "/>";
  for (const double y : {0.0, second_table})
    xml += std::string("<geom ") + (y > 0 ? "" : "name='table' ") + "type='box' size='" +
           list({table_half_x, table_half_y, thick}) + "' pos='" + list({0, y, -thick}) + "'" +
           collides(is_table, 0) + "/>";
}
/// A frame on wheels that stands astride the tables, with an arm on each side.
constexpr const char* robot_body =
    "<body name='robot'><inertial mass='180' pos='0 0 -0.4' diaginertia='20 60 70'/>"
    "<joint name='wheels0' type='slide' axis='1 0 0'/><joint name='wheels1' type='slide' axis='0 1 0'/>"
    "<joint name='wheels2' type='hinge' axis='0 0 1'/>";

std::string world_text(const std::array<ArmBody, arms>& bodies, const WorldSettings& settings) {
  const Thing& thing = settings.thing;
  std::string xml =
      "<mujoco><compiler angle='radian' balanceinertia='true'/><size njmax='600' nconmax='150'/>"
      "<option timestep='0.001' cone='elliptic' impratio='100' gravity='0 0 -9.81'/><worldbody>";
  if (settings.drives)
    write_tables(xml);
  else
    xml += "<geom name='table' type='plane' size='2 2 0.1'" + collides(is_table, 0) + "/>";
  const Trays stand = trays_at_first(settings.drives, settings.kitchen);
  for (std::size_t k = 0; k < tray_count; ++k) write_tray(xml, k, stand[k], settings.trays_move);
  if (settings.drives) xml += robot_body;
  for (std::size_t arm = 0; arm < arms; ++arm) write_arm(xml, arm, bodies[arm]);
  if (settings.drives) xml += "</body>";
  xml +=
      "<body name='obstacle' mocap='true' pos='0 0 9'><geom name='obstacle' type='capsule' size='0.04 0.2'" +
      collides(is_obstacle, 0) + "/></body>";
  const std::string soft = list({solid, solid, 0.001, 0.5, 2});
  for (std::size_t k = 0; k < arms * slots; ++k)
    if (settings.kitchen && k % slots < settings.room)
      xml += kitchen_text(k, settings);
    else if (k % slots < settings.room)
      xml += "<body name='orange" + std::to_string(k) + "' pos='" +
             list({5 + 0.2 * static_cast<double>(k), 0, 1}) + "'><freejoint/><geom name='orange" +
             std::to_string(k) + "' type='sphere' size='0.038' mass='" + list({orange_mass}) +
             "' priority='1' condim='6' friction='" + list({settings.friction, 0.01, 0.0005}) + "' solimp='" +
             soft + "'" + collides(is_orange, is_table | is_orange) + "/></body>";
  xml += thing_text(thing, settings.friction) + "</worldbody><equality>";
  for (std::size_t arm = 0; arm < arms; ++arm)
    if (!bodies[arm].hand)
      xml += "<joint joint1='" + name("slide", arm, 0) + "' joint2='" + name("slide", arm, 1) +
             "' polycoef='0 1 0 0 0' solref='0.004 1'/>";
  return xml + "</equality>" + (settings.binary ? press_text(settings, soft) : "") + "</mujoco>";
}
}  // namespace

struct World::Bodies {
  struct Arm {
    std::array<int, 6> q{}, v{}, body{};  // addresses of the joints, and the links' bodies
    std::array<int, 2> slide_q{}, slide_v{};
    std::vector<int> tip;       // bodies: of both fingers, or of the four of a hand ...
    std::vector<double> holds;  // ... and how much each takes part in a grasp
    int palm = 0;
    bool has_hand = false;
    std::array<int, 16> finger_q{}, finger_v{};
    skinctl::JointTorque<16> torque, next_torque;
    std::array<double, 4> true_tips{};
    Phalanges phalanges;
    std::array<double, 4> tips{};                                // readings
    Xyz<double> grasps{0, 0, finger_reach};                      // the point between the fingers, in the palm
    std::array<double, 6> inertia{};                             // of each joint, at home
    std::array<double, 6> q0{}, v0{}, q1{}, v1{}, q_r{}, v_r{};  // the interpolation under way
    double at = 0;                                               // time since the last command
    double slide_inertia = 0;
    Gripper gripper;
    skinctl::GripperState state;
    double feels = 0;    // force of a finger, their mean: what they hold, and walls
    double reading = 0;  // of the force sensor
    Xyz<double> wrist{0, 0, 0}, wrist_bias{0, 0, 0},
        wrist_reading{0, 0, 0};  // the wrist's: true, smoothed; ...
    bool moves_trays = false;
    int pushed = -1;  // body
    Xyz<double> push_at{0, 0, 0}, push{0, 0, 0}, push_turns{0, 0, 0};
    std::array<Xyz<double>, 4> push_tips{};  // in the world's axes
    Xyz<double> tip_velocity{0, 0, 0};       // of the first one, a millisecond ago
    ArmRecord record;
    struct Felt {
      int body;
      Xyz<double> at, force;  // in its frame
    };
    std::vector<Felt> felt;
    std::int64_t felt_since = 0;
  };
  struct Slot {
    int q = 0, v = 0, body = 0, geom = 0;
    int geoms = 1;  // the first of which is `geom`
    int pair = -1;  // with the table
    bool there = false, frozen = true;
    std::array<double, 7> rests{};
    skinctl::Nanoseconds touched{-1};
  };

  struct Wheels {
    std::array<int, 3> q{}, v{};                          // addresses of x, y and yaw
    std::array<double, 3> inertia{}, velocity{}, goal{};  // the goal: of the servo, where it really is
    std::array<double, 3> told{}, told_velocity{};
    std::array<double, 3> slips{};  // on this drive, a metre
    bool stood = false;             // they slip by other shares on the next drive
  };

  WorldSettings settings;
  Trays stand = trays_at_first(settings.drives, settings.kitchen);  // at first
  Wheels wheels;
  mjModel* model = nullptr;
  mjData* data = nullptr;
  std::array<Arm, arms> arm;
  std::array<Slot, arms * slots> slot;
  std::vector<int> owner;          // of each geom: parts * arm + (1 on: fingertip), or -1
  std::vector<int> orange_of;      // of each geom, or -1
  std::vector<int> link_of;        // of each body: the link of a hand's finger, or -1
  int thing_q = -1, thing_v = -1;  // addresses
  std::array<double, 7> thing_rests{5, 1, 1, 1, 0, 0, 0};
  bool thing_held = true;                                  // by a person
  std::array<int, tray_count> tray{}, tray_v{};            // bodies; dofs of the first of two slides, or -1
  std::array<Xyz<double>, tray_count> pulled{};            // by a person
  std::array<std::uint64_t, arms> at_wall{};               // milliseconds without a break
  int table = -1;                                          // geom
  int obstacle = -1, obstacle_at = 0;                      // geom, and its place among the moved bodies
  std::array<bool, arms> meets_other{}, meets_obstacle{};  // a millisecond ago
  std::mt19937_64 random, slips;
  std::normal_distribution<double> normal, across;
  std::int64_t ticks = 0;

  Bodies(const std::array<ArmBody, arms>& bodies, const WorldSettings& s, std::uint64_t seed)
      : settings(s), random(seed), slips(seed + 1) {
    const std::string xml = world_text(bodies, settings);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    char error[500] = "";
    if (mj_makeEmptyFileVFS(files.get(), "world.xml", static_cast<int>(xml.size())) != 0)
      throw std::runtime_error("MuJoCo: no room for the model");
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    model = mj_loadXML("world.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model == nullptr) throw std::runtime_error(error);
    data = mj_makeData(model);
    find(bodies);
    mj_forward(model, data);
    weigh();
    mj_step1(model, data);
    if (!settings.binary) return;
    std::uniform_real_distribution<double> bias(-settings.wrist_bias, settings.wrist_bias);
    for (Arm& m : arm) m.gripper = Gripper(true), m.wrist_bias = {bias(random), bias(random), bias(random)};
  }
  ~Bodies() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  [[nodiscard]] int id(int kind, const std::string& of) const { return mj_name2id(model, kind, of.c_str()); }
  void find(const std::array<ArmBody, arms>& bodies) {
    owner.assign(static_cast<std::size_t>(model->ngeom), -1);
    obstacle = id(mjOBJ_GEOM, "obstacle");
    table = id(mjOBJ_GEOM, "table");
    obstacle_at = model->body_mocapid[id(mjOBJ_BODY, "obstacle")];
    for (std::size_t k = 0; k < tray_count; ++k) {
      tray[k] = id(mjOBJ_BODY, name("tray", 0, k));
      tray_v[k] = settings.trays_move ? model->body_dofadr[tray[k]] : -1;
    }
    for (std::size_t i = 0; settings.drives && i < 3; ++i) {
      const int joint = id(mjOBJ_JOINT, "wheels" + std::to_string(i));
      wheels.q[i] = model->jnt_qposadr[joint], wheels.v[i] = model->jnt_dofadr[joint];
    }
    orange_of = owner;
    for (std::size_t a = 0; a < arms; ++a) {
      Arm& m = arm[a];
      for (std::size_t i = 0; i < 6; ++i) {
        const int joint = id(mjOBJ_JOINT, name("joint", a, i));
        m.q[i] = model->jnt_qposadr[joint];
        m.v[i] = model->jnt_dofadr[joint];
        m.body[i] = id(mjOBJ_BODY, name("link", a, i));
        data->qpos[m.q[i]] = m.q0[i] = m.q1[i] = m.q_r[i] = bodies[a].home[i];
      }
      m.palm = id(mjOBJ_BODY, name("palm", a, 0));
      m.has_hand = bodies[a].hand.has_value();
      if (m.has_hand) {
        find_hand(m, a, *bodies[a].hand);
        continue;
      }
      m.holds = {1, 1};
      for (std::size_t f = 0; f < 2; ++f) {
        const int joint = id(mjOBJ_JOINT, name("slide", a, f));
        m.slide_q[f] = model->jnt_qposadr[joint];
        m.slide_v[f] = model->jnt_dofadr[joint];
        m.tip.push_back(id(mjOBJ_BODY, name("finger", a, f)));
        data->qpos[m.slide_q[f]] = gripper_range.opening / 2;
      }
    }
    for (int g = 0; g < model->ngeom; ++g)
      for (std::size_t a = 0; a < arms; ++a) {
        const int body = model->geom_bodyid[g];
        if ((model->geom_contype[g] & is_arm[a]) == 0) continue;
        const auto& tips = arm[a].tip;
        const auto tip = std::find(tips.begin(), tips.end(), body);
        const auto part = tip == tips.end() ? 0 : 1 + (tip - tips.begin());
        owner[static_cast<std::size_t>(g)] = static_cast<int>(parts * a + static_cast<std::size_t>(part));
      }
    for (std::size_t k = 0; k < slot.size(); ++k) {
      if (k % slots >= settings.room) continue;
      Slot& o = slot[k];
      o.body = id(mjOBJ_BODY, "orange" + std::to_string(k));
      o.geom = id(mjOBJ_GEOM, "orange" + std::to_string(k));
      const int joint = model->body_jntadr[o.body];
      for (int p = 0; p < model->npair; ++p)
        if (model->pair_geom1[p] == o.geom || model->pair_geom2[p] == o.geom) o.pair = p;
      o.q = model->jnt_qposadr[joint];
      o.v = model->jnt_dofadr[joint];
      o.geoms = model->body_geomnum[o.body];
      for (int g = 0; g < o.geoms; ++g) orange_of[static_cast<std::size_t>(o.geom + g)] = static_cast<int>(k);
      for (std::size_t i = 0; i < 7; ++i) o.rests[i] = data->qpos[o.q + static_cast<int>(i)];
      collide(o, false);
    }
    if (settings.thing.shape != Thing::Shape::none) find_thing();
  }
  void find_thing() {
    const int body = id(mjOBJ_BODY, "thing"), geom = id(mjOBJ_GEOM, "thing");
    thing_q = model->jnt_qposadr[model->body_jntadr[body]];
    thing_v = model->jnt_dofadr[model->body_jntadr[body]];
    orange_of[static_cast<std::size_t>(geom)] = the_thing;
    stiffen(geom, body, arm[0].tip[0], settings.thing.stiffness);
  }
  /// The stiffness as a constraint's: it counts the inverse masses of both bodies, as MuJoCo approximates them.
  void stiffen(int geom, int body, int finger, double stiffness) {
    const double A = model->body_invweight0[2 * body] + model->body_invweight0[2 * finger];
    const double stiff = stiffness * A * (1 - solid);
    model->geom_solref[2 * geom] = -stiff;
    model->geom_solref[2 * geom + 1] = -2 * std::sqrt(stiff);
  }
  /// The same of an orange on the table, which does not give way.
  void stiffen_below(const Slot& o, double stiffness) {
    if (o.pair < 0) return;
    const double stiff = stiffness * model->body_invweight0[2 * o.body] * (1 - solid);
    model->pair_solref[2 * o.pair] = -stiff;
    model->pair_solref[2 * o.pair + 1] = -2 * std::sqrt(stiff);
  }
  void find_hand(Arm& m, std::size_t a, const HandBody& hand) {
    link_of.resize(static_cast<std::size_t>(model->nbody), -1);
    for (std::size_t i = 0; i < 16; ++i) {
      link_of[static_cast<std::size_t>(id(mjOBJ_BODY, name("knuckle", a, i)))] = static_cast<int>(i);
      if (i % 4 == 3)
        link_of[static_cast<std::size_t>(id(mjOBJ_BODY, name("tip", a, i / 4)))] = static_cast<int>(i);
    }
    for (std::size_t i = 0; i < 16; ++i) {
      const int joint = id(mjOBJ_JOINT, name("finger", a, i));
      m.finger_q[i] = model->jnt_qposadr[joint];
      m.finger_v[i] = model->jnt_dofadr[joint];
      data->qpos[m.finger_q[i]] = hand.start[i];
    }
    m.holds.assign(hand.takes_part.begin(), hand.takes_part.end());
    m.grasps = hand.grasps;
    // As a stiffness sees them, all fingertips are alike.
    double mean = 0;
    for (std::size_t f = 0; f < 4; ++f) {
      m.tip.push_back(id(mjOBJ_BODY, name("tip", a, f)));
      mean += model->body_invweight0[2 * m.tip[f]] / 4;
    }
    for (const int tip : m.tip) model->body_invweight0[2 * tip] = mean;
  }
  /// The joints' inertias, for the servos.
  void weigh() {
    const auto n = static_cast<std::size_t>(model->nv);
    std::vector<double> mass(n * n);
    mj_fullM(model, mass.data(), data->qM);
    const auto of = [&](int v) { return mass[static_cast<std::size_t>(v) * (n + 1)]; };
    for (Arm& m : arm) {
      for (std::size_t i = 0; i < 6; ++i) m.inertia[i] = of(m.v[i]);
      if (!m.has_hand) m.slide_inertia = of(m.slide_v[0]);
    }
    for (std::size_t i = 0; settings.drives && i < 3; ++i) wheels.inertia[i] = of(wheels.v[i]);
  }
  void collide(const Slot& o, bool on) {
    for (int g = o.geom; g < o.geom + o.geoms; ++g) {
      model->geom_contype[g] = on ? is_orange : 0;
      model->geom_conaffinity[g] = on ? is_table | is_orange : 0;
    }
  }

  /// Where the servo's reference is `t` after the last command.
  void refer(Arm& m, double t, std::array<double, 6>& acceleration) const {
    const double T = settings.period;
    const bool under_way = t < T + tick / 2;
    acceleration.fill(0);
    if (!settings.interpolate) {
      m.q_r = m.q1;
      m.v_r.fill(0);
      return;
    }
    const double s = under_way ? t / T : 1;
    for (std::size_t i = 0; i < 6; ++i) {
      const double d = m.q1[i] - m.q0[i], a = T * m.v0[i], b = T * m.v1[i];
      const double c2 = 3 * d - 2 * a - b, c3 = a + b - 2 * d;
      m.q_r[i] = m.q0[i] + s * (a + s * (c2 + s * c3));
      m.v_r[i] = under_way ? (a + s * (2 * c2 + 3 * s * c3)) / T : 0;
      acceleration[i] = under_way ? (2 * c2 + 6 * s * c3) / (T * T) : 0;
    }
  }
  /// A servo as stiff as wheels with brakes are, critically damped.
  void roll() {
    constexpr double w = 60, stands = 0.01;  // [rad/s]; below this speed [m/s]
    Wheels& b = wheels;
    const double speed = std::hypot(b.velocity[0], b.velocity[1]);
    if (speed < stands) b.stood = true;
    if (speed >= stands && std::exchange(b.stood, false))
      b.slips = {settings.slip * across(slips), settings.slip * across(slips),
                 settings.slip_turn * across(slips)};
    // They roll as the robot really stands, which is not how it stands by what they told.
    const auto turned = [](const std::array<double, 3>& v, double by) {
      return std::array{std::cos(by) * v[0] - std::sin(by) * v[1], std::sin(by) * v[0] + std::cos(by) * v[1],
                        v[2]};
    };
    const double off = data->qpos[b.q[2]] - b.told[2];
    const auto wish = turned(b.velocity, off);
    std::array<double, 3> rolled{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double slip = b.slips[i] * speed, v = wish[i] + slip;
      b.goal[i] += tick * v, rolled[i] = data->qvel[b.v[i]] - slip;
      data->qfrc_applied[b.v[i]] +=
          data->qfrc_bias[b.v[i]] +
          b.inertia[i] * (w * w * (b.goal[i] - data->qpos[b.q[i]]) + 2 * w * (v - data->qvel[b.v[i]]));
    }
    b.told_velocity = turned(rolled, -off);
    for (std::size_t i = 0; i < 3; ++i) b.told[i] += tick * b.told_velocity[i];
  }
  void drive(std::size_t a) {
    Arm& m = arm[a];
    std::array<double, 6> acceleration;
    m.at += tick;
    refer(m, m.at, acceleration);
    const double w = settings.bandwidth;
    for (std::size_t i = 0; i < 6; ++i) {
      const double q = data->qpos[m.q[i]], v = data->qvel[m.v[i]];
      data->qfrc_applied[m.v[i]] +=
          data->qfrc_bias[m.v[i]] +
          m.inertia[i] * (acceleration[i] + w * w * (m.q_r[i] - q) + 2 * w * (m.v_r[i] - v));
    }
    if (m.has_hand)
      drive_hand(m);
    else
      drive_gripper(m);
    if (m.pushed >= 0) {
      double force[3], at[3], moment[3];
      const double f[3] = {m.push.x, m.push.y, m.push.z}, p[3] = {m.push_at.x, m.push_at.y, m.push_at.z};
      const double turns[3] = {m.push_turns.x, m.push_turns.y, m.push_turns.z};
      mju_rotVecMat(force, f, data->xmat + 9 * m.pushed);
      mju_rotVecMat(moment, turns, data->xmat + 9 * m.pushed);
      mju_rotVecMat(at, p, data->xmat + 9 * m.pushed);
      mju_addTo3(at, data->xpos + 3 * m.pushed);
      mj_applyFT(model, data, force, moment, at, m.pushed, data->qfrc_applied);
    }
  }
  void drive_hand(Arm& m) {
    for (std::size_t i = 0; i < 16; ++i) data->qfrc_applied[m.finger_v[i]] += m.torque[i];
    m.torque = m.next_torque;
    for (std::size_t f = 0; f < 4; ++f) {
      const double force[3] = {m.push_tips[f].x, m.push_tips[f].y, m.push_tips[f].z}, none[3] = {};
      mj_applyFT(model, data, force, none, data->xpos + 3 * m.tip[f], m.tip[f], data->qfrc_applied);
    }
  }
  void drive_gripper(Arm& m) {
    const double opening = data->qpos[m.slide_q[0]] + data->qpos[m.slide_q[1]];
    m.reading = std::max(0.0, m.feels + settings.force_noise * normal(random));
    const double half = m.gripper.step(opening, m.reading, tick) / 2;
    constexpr double stiff = 250;
    const double most = settings.opens_gently ? m.gripper.opens_with() : 1e9;
    for (std::size_t f = 0; f < 2; ++f) {
      const double drive = m.slide_inertia * (stiff * stiff * (half - data->qpos[m.slide_q[f]]) -
                                              2 * stiff * data->qvel[m.slide_v[f]]);
      data->qfrc_applied[m.slide_v[f]] += data->qfrc_bias[m.slide_v[f]] + std::min(drive, most);
    }
  }
  /// Forces of the fingers, and who touches whom.
  void look_at_contacts() {
    std::array<std::array<double, parts>, arms> force{};
    for (Arm& m : arm) m.phalanges = {};
    std::array<bool, arms> walls{}, other{}, blocked{};
    std::array<double, arms> on_wall{};
    std::array<std::array<double, parts>, arms> on_tray{};
    std::array<Xyz<double>, arms> push{};
    std::array<double, arms> into_other{}, into_obstacle{};  // how fast, 0 for an arm that is moved into
    for (int c = 0; c < data->ncon; ++c) {
      const mjContact& contact = data->contact[c];
      const auto g1 = static_cast<std::size_t>(contact.geom1), g2 = static_cast<std::size_t>(contact.geom2);
      const int o1 = owner[g1], o2 = owner[g2];
      if (settings.binary && (contact.geom1 == table || contact.geom2 == table))
        press(c, orange_of[contact.geom1 == table ? g2 : g1]);
      if (o1 < 0 && o2 < 0) continue;
      if (o1 >= 0) note(c, static_cast<std::size_t>(o1), contact.geom1, -1);
      if (o2 >= 0) note(c, static_cast<std::size_t>(o2), contact.geom2, 1);
      if (o1 >= 0 && o2 >= 0) {
        other.fill(true);
        for (const int g : {contact.geom1, contact.geom2}) {
          double& into = into_other[static_cast<std::size_t>(owner[static_cast<std::size_t>(g)]) / parts];
          into = std::max(into, speed_into(contact, g));
        }
        continue;
      }
      if (contact.geom1 == obstacle || contact.geom2 == obstacle) {
        const auto a = static_cast<std::size_t>(o1 >= 0 ? o1 : o2) / parts;
        blocked[a] = true;
        into_obstacle[a] =
            std::max(into_obstacle[a], speed_into(contact, o1 >= 0 ? contact.geom1 : contact.geom2));
        continue;
      }
      const auto mine = static_cast<std::size_t>(o1 >= 0 ? o1 : o2), a = mine / parts, part = mine % parts;
      const int orange = orange_of[o1 >= 0 ? g2 : g1];
      if (orange < 0) {
        double f[6];
        mj_contactForce(model, data, c, f);
        on_tray[a][part] += f[0];
        if (arm[a].moves_trays) {
          double F[3];
          mju_rotVecMatT(F, f, contact.frame);
          push[a] = push[a] + (o1 >= 0 ? -1.0 : 1.0) * Xyz<double>{F[0], F[1], F[2]};
          continue;
        }
        walls[a] = true;
        on_wall[a] += f[0];
        continue;
      }
      if (orange == the_thing) feel(arm[a], c, model->geom_bodyid[o1 >= 0 ? g1 : g2]);
      if (part > 0) {
        double f[6];
        mj_contactForce(model, data, c, f);
        force[a][part] += f[0];
        if (orange != the_thing) slot[static_cast<std::size_t>(orange)].touched = now();
      }
    }
    for (std::size_t a = 0; a < arms; ++a) {
      Arm& m = arm[a];
      ArmRecord& r = m.record;
      double sum = 0, fingers = 0, largest = 0, walled = 0;
      int hold = 0;
      for (std::size_t f = 0; f < m.tip.size(); ++f) {
        const double F = force[a][f + 1];
        sum += m.holds[f] * F, fingers += m.holds[f];
        walled += m.holds[f] * on_tray[a][f + 1];
        largest = std::max(largest, F);
        hold += F > 0.2;
        if (m.has_hand) m.true_tips[f] = F;
        if (m.has_hand) m.tips[f] = std::max(0.0, F + settings.force_noise * normal(random));
      }
      r.force = sum / fingers;
      m.feels = (sum + walled) / fingers;
      r.worst_push = std::max(r.worst_push, norm(push[a]));
      r.worst_force = std::max(r.worst_force, largest);
      if (hold > 1) r.worst_grip = std::max(r.worst_grip, largest);
      r.walls += walls[a];
      at_wall[a] = walls[a] ? at_wall[a] + 1 : 0;
      r.longest_at_wall = std::max(r.longest_at_wall, at_wall[a]);
      r.wall_force = std::max(r.wall_force, on_wall[a]);
      r.other_arm += other[a];
      r.obstacle += blocked[a];
      if (other[a] && !meets_other[a]) r.into_arm = into_other[a];
      if (blocked[a] && !meets_obstacle[a]) r.into_obstacle = into_obstacle[a];
      double v[6];
      mj_objectVelocity(model, data, mjOBJ_BODY, m.tip[0], v, 0);
      const Xyz<double> tip{v[3], v[4], v[5]}, change = (1 / tick) * Xyz<double>(tip - m.tip_velocity);
      r.square += dot(change, change);
      ++r.samples;
      m.tip_velocity = tip;
    }
    meets_other = other, meets_obstacle = blocked;
  }
  /// A contact of an arm's link, but its fingers; `sign`: of the contact's force on it.
  void note(int c, std::size_t whose, int geom, double sign) {
    if (whose % parts != 0) return;
    const mjContact& contact = data->contact[c];
    const int body = model->geom_bodyid[geom];
    double f[6], F[3], local[3], way[3], at[3];
    mj_contactForce(model, data, c, f);
    mju_rotVecMatT(F, f, contact.frame);
    mju_rotVecMatT(local, F, data->xmat + 9 * body);
    mju_sub3(way, contact.pos, data->xpos + 3 * body);
    mju_rotVecMatT(at, way, data->xmat + 9 * body);
    arm[whose / parts].felt.push_back(
        {body, {at[0], at[1], at[2]}, {sign * local[0], sign * local[1], sign * local[2]}});
  }
  /// An orange that fingers hold meets the table.
  void press(int c, int orange) {
    if (orange < 0 || orange == the_thing) return;
    const Slot& o = slot[static_cast<std::size_t>(orange)];
    if (o.touched < skinctl::Nanoseconds(0) || now() - o.touched > 2ms) return;
    double f[6];
    mj_contactForce(model, data, c, f);
    double& worst = arm[static_cast<std::size_t>(orange) / slots].record.worst_press;
    worst = std::max(worst, f[0]);
  }
  /// What the force sensors of the wrists read.
  void feel_wrists() {
    constexpr double smooth = 0.004;  // time constant of the sensor's own low pass [s]
    for (std::size_t a = 0; a < arms; ++a) {
      Arm& m = arm[a];
      const double* f = data->sensordata + 3 * a;
      // What the arm does to the hand, as MuJoCo has it; the sensor tells what the hand does to the arm.
      m.wrist = m.wrist - tick / (smooth + tick) * (Xyz<double>{f[0], f[1], f[2]} + m.wrist);
      const auto noise = [&](double of) {
        return of * Xyz<double>{normal(random), normal(random), normal(random)};
      };
      m.wrist_bias = m.wrist_bias + noise(settings.wrist_drift * std::sqrt(tick));
      m.wrist_reading = m.wrist + m.wrist_bias + noise(settings.wrist_noise);
    }
  }
  void feel(Arm& m, int c, int body) {
    double f[6];
    mj_contactForce(model, data, c, f);
    const int link = link_of.empty() ? -1 : link_of[static_cast<std::size_t>(body)];
    (link < 0 ? m.phalanges.palm : m.phalanges.links[static_cast<std::size_t>(link)]) += f[0];
  }
  /// How fast the point of geom `g` at a contact moves into the other side.
  [[nodiscard]] double speed_into(const mjContact& contact, int g) const {
    const int body = model->geom_bodyid[g];
    double v[6], arm_to[3], turned[3];
    mj_objectVelocity(model, data, mjOBJ_BODY, body, v, 0);
    mju_sub3(arm_to, contact.pos, data->xpos + 3 * body);
    mju_cross(turned, v, arm_to);
    mju_addTo3(turned, v + 3);
    const double along = mju_dot3(turned, contact.frame);  // the normal points from geom1 to geom2
    return g == contact.geom1 ? along : -along;
  }
  void load_trays() {
    for (std::size_t k = 0; k < tray_count; ++k) {
      if (tray_v[k] < 0) continue;
      Tray at = stand[k];
      at.x = data->xpos[3 * tray[k]], at.y = data->xpos[3 * tray[k] + 1];
      double mass = tray_mass;
      for (const Slot& o : slot)
        if (o.there && at.holds({data->qpos[o.q], data->qpos[o.q + 1], data->qpos[o.q + 2]}))
          mass += orange_mass;
      for (int i = 0; i < 2; ++i) model->dof_frictionloss[tray_v[k] + i] = tray_friction * mass * 9.81;
    }
  }
  /// Oranges far from every hand rest where they are, at no cost.
  void freeze() {
    for (Slot& o : slot) {
      if (!o.frozen || !o.there) continue;
      bool near = false;
      for (const Arm& m : arm) {
        const double* palm = data->xpos + 3 * m.palm;
        const double x = palm[0] - o.rests[0], y = palm[1] - o.rests[1], z = palm[2] - o.rests[2];
        near = near || x * x + y * y + z * z < 0.28 * 0.28;
      }
      if (near) {
        o.frozen = false;
        collide(o, true);
      }
    }
    for (const Slot& o : slot)
      if (o.frozen && o.body > 0) rest(o);
    if (thing_q >= 0 && thing_held) {
      std::copy(thing_rests.begin(), thing_rests.end(), data->qpos + thing_q);
      std::fill_n(data->qvel + thing_v, 6, 0.0);
    }
  }
  void rest(const Slot& o) const {
    std::copy(o.rests.begin(), o.rests.end(), data->qpos + o.q);
    std::fill_n(data->qvel + o.v, 6, 0.0);
  }
  [[nodiscard]] skinctl::Nanoseconds now() const { return ticks * std::chrono::milliseconds(1); }
};

World::World(const std::array<ArmBody, arms>& bodies, const WorldSettings& settings, std::uint64_t seed)
    : b_(std::make_unique<Bodies>(bodies, settings, seed)) {}
World::~World() = default;

void World::step() {
  Bodies& b = *b_;
  mju_zero(b.data->qfrc_applied, b.model->nv);
  for (std::size_t a = 0; a < arms; ++a) b.drive(a);
  if (b.settings.drives) b.roll();
  for (std::size_t k = 0; k < tray_count; ++k)
    if (b.tray_v[k] >= 0)
      b.data->qfrc_applied[b.tray_v[k]] += b.pulled[k].x,
          b.data->qfrc_applied[b.tray_v[k] + 1] += b.pulled[k].y;
  if (b.settings.loads_trays && b.ticks % 8 == 0) b.load_trays();
  mj_step2(b.model, b.data);
  ++b.ticks;
  b.look_at_contacts();
  if (b.settings.binary) b.feel_wrists();
  b.freeze();
  mj_step1(b.model, b.data);
}
skinctl::Nanoseconds World::now() const {
  return b_->now();
}

void World::command(std::size_t arm, const skinctl::JointPosition<6>& q,
                    const skinctl::JointVelocity<6>& dq) {
  Bodies::Arm& m = b_->arm[arm];
  m.q0 = m.q_r;
  m.v0 = m.v_r;
  for (std::size_t i = 0; i < 6; ++i) m.q1[i] = q[i], m.v1[i] = dq[i];
  m.at = 0;
}
void World::command(std::size_t arm, const skinctl::GripperCommand& goal) {
  b_->arm[arm].gripper.command(goal);
}
void World::command(std::size_t arm, const skinctl::JointTorque<16>& torque) {
  b_->arm[arm].next_torque = torque;
}
skinctl::State<16> World::fingers(std::size_t arm) const {
  const Bodies::Arm& m = b_->arm[arm];
  skinctl::State<16> s;
  s.time = now();
  constexpr double step = 333.3 / 65536 * 3.14159265358979 / 180;
  for (std::size_t i = 0; i < 16; ++i) {
    s.q[i] = step * std::round(b_->data->qpos[m.finger_q[i]] / step);
    s.dq[i] = b_->data->qvel[m.finger_v[i]];
  }
  return s;
}
const std::array<double, 4>& World::true_tips(std::size_t arm) const {
  return b_->arm[arm].true_tips;
}
const std::array<double, 4>& World::tips(std::size_t arm) const {
  return b_->arm[arm].tips;
}
void World::push(std::size_t arm, std::size_t link, const Xyz<double>& at, const Xyz<double>& force,
                 const Xyz<double>& moment) {
  Bodies::Arm& m = b_->arm[arm];
  m.pushed = dot(force, force) + dot(moment, moment) > 0 ? m.body[link] : -1;
  m.push_at = at;
  m.push = force;
  m.push_turns = moment;
}
void World::push_finger(std::size_t arm, std::size_t finger, const Xyz<double>& force) {
  b_->arm[arm].push_tips[finger] = force;
}

void World::put_obstacle(const skinctl::Capsule<>& shape) {
  Bodies& b = *b_;
  double* pos = b.data->mocap_pos + 3 * b.obstacle_at;
  const Xyz<double> middle = 0.5 * (shape.from + shape.to), way = shape.to - shape.from;
  const double length = norm(way);
  const bool there = shape.radius > 0;
  pos[0] = middle.x, pos[1] = middle.y, pos[2] = there ? middle.z : 9;
  const double z[3] = {way.x, way.y, length > 0 ? way.z : 1};
  mju_quatZ2Vec(b.data->mocap_quat + 4 * b.obstacle_at, z);
  double* size = b.model->geom_size + 3 * b.obstacle;
  size[0] = there ? shape.radius : 0.01;
  size[1] = std::max(0.5 * length, 1e-3);  // a capsule without length gives contacts that are no numbers
  b.model->geom_rbound[b.obstacle] = size[0] + size[1];
}

std::vector<World::Contact> World::take_contacts(std::size_t arm, std::size_t link) {
  Bodies::Arm& m = b_->arm[arm];
  const auto passed = static_cast<double>(std::max<std::int64_t>(1, b_->ticks - m.felt_since));
  std::vector<Contact> out;
  for (const auto& f : m.felt)
    if (f.body == m.body[link]) out.push_back({f.at, (1 / passed) * f.force});
  m.felt.clear();
  m.felt_since = b_->ticks;
  return out;
}
void World::drive(const skinctl::JointVelocity<3>& velocity) {
  for (std::size_t i = 0; i < 3; ++i) b_->wheels.velocity[i] = velocity[i];
}
skinctl::State<3> World::wheels() const {
  const Bodies::Wheels& w = b_->wheels;
  skinctl::State<3> s;
  s.time = now();
  const bool drives = b_->settings.drives;
  for (std::size_t i = 0; drives && i < 3; ++i) s.q[i] = w.told[i], s.dq[i] = w.told_velocity[i];
  return s;
}
Standing World::robot() const {
  const Bodies::Wheels& w = b_->wheels;
  const double* q = b_->data->qpos;
  return b_->settings.drives ? Standing{q[w.q[0]], q[w.q[1]], q[w.q[2]]} : Standing{};
}

const Trays& World::first() const {
  return b_->stand;
}
Tray World::tray(std::size_t k) const {
  Tray out = b_->stand[k];
  const double* p = b_->data->xpos + 3 * b_->tray[k];
  out.x = p[0], out.y = p[1];
  return out;
}
Xyz<double> World::tray_velocity(std::size_t k) const {
  const int v = b_->tray_v[k];
  return v < 0 ? Xyz<double>{0, 0, 0} : Xyz<double>{b_->data->qvel[v], b_->data->qvel[v + 1], 0};
}
void World::pull_tray(std::size_t k, const Xyz<double>& force) {
  b_->pulled[k] = force;
}

void World::put_tray(std::size_t k, const Xyz<double>& p) {
  const int q = b_->model->jnt_qposadr[b_->model->body_jntadr[b_->tray[k]]], v = b_->tray_v[k];
  b_->data->qpos[q] = p.x - b_->stand[k].x, b_->data->qpos[q + 1] = p.y - b_->stand[k].y;
  b_->data->qvel[v] = b_->data->qvel[v + 1] = 0;
}
void World::moves_trays(std::size_t arm, bool on) {
  b_->arm[arm].moves_trays = on;
}

skinctl::State<6> World::joints(std::size_t arm) const {
  const Bodies::Arm& m = b_->arm[arm];
  skinctl::State<6> s;
  s.time = now();
  for (std::size_t i = 0; i < 6; ++i) s.q[i] = b_->data->qpos[m.q[i]], s.dq[i] = b_->data->qvel[m.v[i]];
  return s;
}
skinctl::GripperState World::gripper(std::size_t arm) const {
  return b_->arm[arm].gripper.state(now(), b_->arm[arm].reading);
}
skinctl::WrenchSample World::wrist(std::size_t arm) const {
  const auto& f = b_->arm[arm].wrist_reading;
  return {now(), {f.x, f.y, f.z}, {}};
}
Xyz<double> World::hand(std::size_t arm) const {
  const Bodies::Arm& m = b_->arm[arm];
  const double *palm = b_->data->xpos + 3 * m.palm, *R = b_->data->xmat + 9 * m.palm;
  const auto at = [&](int k) {
    return palm[k] + m.grasps.x * R[3 * k] + m.grasps.y * R[3 * k + 1] + m.grasps.z * R[3 * k + 2];
  };
  return {at(0), at(1), at(2)};
}
const ArmRecord& World::record(std::size_t arm) const {
  return b_->arm[arm].record;
}
void World::clear_shake(std::size_t arm) {
  b_->arm[arm].record.square = 0, b_->arm[arm].record.samples = 0;
}

namespace {
skinctl::Transform<skinctl::World, skinctl::Tool> pose_of(const double* p, const double* R) {
  return {{{R[0], R[3], R[6]}, {R[1], R[4], R[7]}, {R[2], R[5], R[8]}}, {p[0], p[1], p[2]}};
}
}  // namespace
void World::put_thing(const skinctl::Transform<skinctl::World, skinctl::Tool>& X) {
  Bodies& b = *b_;
  const auto &x = X.axis_x(), &y = X.axis_y(), &z = X.axis_z(), &p = X.origin();
  const double R[9] = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
  double q[4];
  mju_mat2Quat(q, R);
  b.thing_rests = {p.x, p.y, p.z, q[0], q[1], q[2], q[3]};
  b.thing_held = true;
  b.freeze();
}
void World::pull_thing(const Xyz<double>& force) {
  Bodies& b = *b_;
  double* f = b.data->xfrc_applied + 6 * b.id(mjOBJ_BODY, "thing");
  f[0] = force.x, f[1] = force.y, f[2] = force.z;
}
const World::Phalanges& World::phalanges(std::size_t arm) const {
  return b_->arm[arm].phalanges;
}
void World::let_go_of_thing() {
  b_->thing_held = false;
}
skinctl::Transform<skinctl::World, skinctl::Tool> World::thing() const {
  double R[9];
  mju_quat2Mat(R, b_->data->qpos + b_->thing_q + 3);
  return pose_of(b_->data->qpos + b_->thing_q, R);
}
skinctl::Transform<skinctl::World, skinctl::Tool> World::palm(std::size_t arm) const {
  const int body = b_->arm[arm].palm;
  return pose_of(b_->data->xpos + 3 * body, b_->data->xmat + 9 * body);
}

void World::put(std::size_t k, const Xyz<double>& p, const Orange& orange) {
  Bodies& b = *b_;
  Bodies::Slot& o = b.slot[k];
  o.there = o.frozen = true;
  o.touched = skinctl::Nanoseconds(-1);
  o.rests = {p.x, p.y, p.z + orange.radius, std::cos(orange.yaw / 2), 0, 0, std::sin(orange.yaw / 2)};
  if (!b.settings.kitchen) b.model->geom_size[3 * o.geom] = b.model->geom_rbound[o.geom] = orange.radius;
  b.stiffen(o.geom, o.body, b.arm[k / slots].tip[0], orange.stiffness);
  b.stiffen_below(o, orange.stiffness);
  b.model->geom_friction[3 * o.geom] = b.settings.friction;
  b.collide(o, false);
  b.rest(o);
}
void World::take_out(std::size_t k) {
  Bodies::Slot& o = b_->slot[k];
  o.there = false;
  o.frozen = true;
  o.rests = {5 + 0.2 * static_cast<double>(k), 0, 1, 1, 0, 0, 0};
  b_->collide(o, false);
  b_->rest(o);
}
bool World::there(std::size_t k) const {
  return b_->slot[k].there;
}
bool World::has_tool(std::size_t k) const {
  return b_->settings.kitchen && is_tool(k);
}
std::size_t World::room() const {
  return b_->settings.room;
}
Xyz<double> World::orange(std::size_t k) const {
  const double* p = b_->data->qpos + b_->slot[k].q;
  return {p[0], p[1], p[2]};
}
Xyz<double> World::point(std::size_t k, const Xyz<double>& of_it) const {
  const double p[3] = {of_it.x, of_it.y, of_it.z};
  double out[3];
  mju_rotVecQuat(out, p, b_->data->qpos + b_->slot[k].q + 3);
  return orange(k) + Xyz<double>{out[0], out[1], out[2]};
}
Xyz<double> World::orange_velocity(std::size_t k) const {
  const double* v = b_->data->qvel + b_->slot[k].v;
  return {v[0], v[1], v[2]};
}
skinctl::Nanoseconds World::touched(std::size_t k) const {
  return b_->slot[k].touched;
}
void World::make_slippery(std::size_t k, bool wet) {
  b_->model->geom_friction[3 * b_->slot[k].geom] = wet ? 0.005 : b_->settings.friction;
}

}  // namespace packing
