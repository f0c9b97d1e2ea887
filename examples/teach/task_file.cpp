#include "examples/teach/task_file.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace teach {
namespace {
using namespace skinctl;
using Json = nlohmann::ordered_json;

constexpr const ActivityRule* rules[] = {
    &activity::Look::rule,  &activity::ReachAbove::rule, &activity::Reach::rule, &activity::Take::rule,
    &activity::Carry::rule, &activity::Squeeze::rule,    &activity::Find::rule,  &activity::Put::rule,
    &activity::Use::rule,   &activity::Release::rule};
struct Named {
  const char* name;
  std::uint8_t number;
};
constexpr Named edges[] = {{"finish", finish}, {"ask", ask_person}, {"nowhere", nowhere}};
struct NamedFact {
  const char* name;
  Facts fact;
};
constexpr NamedFact facts[] = {
    {"seen", fact::seen},       {"above", fact::above},  {"around", fact::around}, {"in_hand", fact::in_hand},
    {"carried", fact::carried}, {"good", fact::good},    {"bad", fact::bad},       {"there", fact::there},
    {"placed", fact::placed},   {"marked", fact::marked}};

Json edge(std::uint8_t to) {
  for (const auto& e : edges)
    if (e.number == to) return e.name;
  return int(to);
}
Json numbers(const Xyz<double>& v) {
  return Json::array({v.x, v.y, v.z});
}
Json names_of(Facts set) {
  Json out = Json::array();
  for (const auto& f : facts)
    if (set.has(f.fact)) out.push_back(f.name);
  return out;
}

[[noreturn]] void wrong(const std::string& why) {
  throw std::runtime_error("no task: " + why);
}
/// A whole number from 0 to `most`.
std::uint8_t small(const Json& j, const char* name, int most) {
  if (!j.is_number_integer() && !j.is_number_unsigned()) wrong(std::string(name) + " is not a whole number");
  const double x = j.get<double>();
  if (!(x >= 0 && x <= most)) wrong(std::string(name) + " is out of its range");
  return static_cast<std::uint8_t>(x);
}
std::uint8_t edge_of(const Json& j) {
  if (!j.is_string()) return small(j, "an edge", 251);
  for (const auto& e : edges)
    if (j == e.name) return e.number;
  wrong("an edge is a number, finish, ask or nowhere");
}
Facts facts_named(const Json& j) {
  Facts out{};
  if (!j.is_array() || j.size() > 32) wrong("facts are a list of names");
  for (const auto& name : j) {
    Facts one{};
    for (const auto& f : facts)
      if (name == f.name) one = f.fact;
    if (!one.any()) wrong("there is no such fact");
    out = out | one;
  }
  return out;
}
double number(const Json& j) {
  if (!j.is_number()) wrong("not a number");
  const double x = j.get<double>();
  if (!(std::abs(x) <= 1e6)) wrong("a number is too large");
  return x;
}
Xyz<double> vector(const Json& j) {
  if (!j.is_array() || j.size() != 3) wrong("not three numbers");
  return {number(j[0]), number(j[1]), number(j[2])};
}
TaughtWay way(const Json& j) {
  TaughtWay out;
  if (!j.is_array() || j.size() > TaughtWay::capacity) wrong("a way is a list of at most 32 corners");
  for (const auto& corner : j) out.corners[out.size++] = vector(corner);
  return out;
}
Step step(const Json& j, Activities own) {
  Step s;
  for (const auto& known : {Activities(rules), own})
    for (const auto* rule : known)
      if (j.at("does") == rule->name) s.does = rule;
  if (s.does == nullptr) wrong("there is no such activity");
  s.role = small(j.at("role"), "role", 63);
  if (j.contains("place")) s.place = small(j.at("place"), "place", int(Task::max_places) - 1);
  if (j.contains("border")) s.border = small(j.at("border"), "border", int(Task::max_borders) - 1);
  s.done = edge_of(j.at("done"));
  s.failed = edge_of(j.at("failed"));
  s.no = edge_of(j.at("no"));
  s.needs = facts_named(j.at("needs"));
  return s;
}
Classes classes(const Json& j) {
  Classes out;
  if (!j.is_array() || j.size() > 64) wrong("classes are a list");
  for (const auto& c : j) {
    const auto kind = small(c.at("class"), "class", 63);
    const auto name = c.at("name").get<std::string>();
    if (name.empty() || name.size() > 40 || name.find_first_of("<>&\"'\n\\") != std::string::npos)
      wrong("a class has no such name");
    out.names[kind] = name;
    if (c.at("container").get<bool>()) out.containers |= std::uint64_t(1) << kind;
  }
  return out;
}
NamedTask parsed(const Json& j, Activities own) {
  NamedTask out;
  Task& t = out.task;
  t.name = "taught";
  if (j.at("format") != "skinctl task 1") wrong("its format is another one");
  out.classes = classes(j.at("classes"));
  if (!j.at("steps").is_array() || j.at("steps").size() > Task::capacity) wrong("too many steps");
  if (!j.at("places").is_array() || j.at("places").size() > Task::max_places) wrong("too many places");
  if (!j.at("borders").is_array() || j.at("borders").size() > Task::max_borders) wrong("too many borders");
  if (j.contains("begins")) t.begins = facts_named(j.at("begins"));
  for (const auto& s : j.at("steps")) t.steps[t.size++] = step(s, own);
  for (const auto& p : j.at("places")) {
    if (p.contains("way")) out.ways[t.place_count] = way(p.at("way"));
    t.places[t.place_count++] = {
        small(p.at("mark"), "mark", 63),
        Transform<ObjectFrame, Tool>::trusted(exp_so3(vector(p.at("rotation"))), vector(p.at("position")))};
  }
  for (const auto& b : j.at("borders")) t.borders[t.border_count++] = number(b);
  if (const TaskFault fault = check(t); fault.any())
    wrong("step " + std::to_string(int(fault.step)) + ": " + describe(fault.error));
  for (std::size_t i = 0; i < t.size; ++i) {
    const Step& s = t.steps[i];
    const bool anywhere = s.does == &activity::Look::rule || !own.empty();
    if (!anywhere && s.place >= t.place_count) wrong("step " + std::to_string(i) + " has no place");
  }
  return out;
}
}  // namespace

std::string to_json(const NamedTask& named) {
  const Task& t = named.task;
  Json j;
  j["format"] = "skinctl task 1";
  j["classes"] = Json::array();
  for (const auto& [kind, name] : named.classes.names)
    j["classes"].push_back({{"class", int(kind)},
                            {"name", name},
                            {"container", ((named.classes.containers >> kind) & 1u) != 0}});
  if (t.begins.any()) j["begins"] = names_of(t.begins);
  j["steps"] = j["places"] = j["borders"] = Json::array();
  for (std::size_t i = 0; i < t.size; ++i) {
    const Step& s = t.steps[i];
    Json step{{"does", s.does->name}, {"role", int(s.role)}};
    if (s.place != no_place) step["place"] = int(s.place);
    if (s.border != no_border) step["border"] = int(s.border);
    step["done"] = edge(s.done), step["failed"] = edge(s.failed), step["no"] = edge(s.no);
    step["needs"] = names_of(s.needs);
    j["steps"].push_back(step);
  }
  for (std::size_t i = 0; i < t.place_count; ++i) {
    Json place{{"mark", int(t.places[i].mark)},
               {"position", numbers(t.places[i].X_MH.origin())},
               {"rotation", numbers(log_so3(t.places[i].X_MH.axes()))}};
    for (std::size_t k = 0; k < named.ways[i].size; ++k)
      place["way"].push_back(numbers(named.ways[i].corners[k]));
    j["places"].push_back(place);
  }
  for (std::size_t i = 0; i < t.border_count; ++i) j["borders"].push_back(t.borders[i]);
  return j.dump(2) + "\n";
}

std::string to_text(Facts set) {
  std::string out;
  for (const auto& name : names_of(set)) out += (out.empty() ? "" : ", ") + name.get<std::string>();
  return out;
}

Task one_round(Task task) {
  for (std::size_t i = 0; i < task.size; ++i)
    for (std::uint8_t* to : {&task.steps[i].done, &task.steps[i].failed, &task.steps[i].no})
      if (*to == 0) *to = finish;
  return task;
}

NamedTask from_json(const std::string& json, Activities own) {
  if (json.size() > 1'000'000) wrong("more than 1 MB");
  try {
    return parsed(Json::parse(json,
                              [](int level, auto, auto&) {
                                if (level > 8) wrong("nested too deeply");
                                return true;
                              }),
                  own);
  } catch (const Json::exception& error) {
    wrong(error.what());
  }
}

NamedTask load(const std::string& file, Activities own) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file);
  std::string json(1'000'001, '\0');
  in.read(json.data(), static_cast<std::streamsize>(json.size()));
  json.resize(static_cast<std::size_t>(in.gcount()));
  return from_json(json, own);
}

}  // namespace teach
