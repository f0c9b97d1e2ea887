#include "examples/teach/recording.hpp"

#include <cmath>
#include <fstream>
#include <stdexcept>

#include "examples/support/text.hpp"

namespace teach {
namespace {
using namespace skinctl;
using examples::text;

template <class X>
std::string pose(const X& X_AB) {
  const Xyz<double> p = X_AB.origin(), r = log_so3(X_AB.axes());
  return text("%.9g %.9g %.9g %.9g %.9g %.9g", p.x, p.y, p.z, r.x, r.y, r.z);
}

/// The numbers of a line.
class Line {
 public:
  explicit Line(std::string_view rest) : rest_(rest) {}
  double number() {
    double x = 0;
    good_ = good_ && examples::take_number(rest_, x) && std::abs(x) < 1e6;
    return good_ ? x : 0;
  }
  std::string word() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(' '), rest_.size()));
    const auto end = std::min(rest_.find(' '), rest_.size());
    std::string out(rest_.substr(0, end));
    rest_.remove_prefix(end);
    return out;
  }
  template <class X>
  X pose() {
    const double p[3] = {number(), number(), number()}, r[3] = {number(), number(), number()};
    return X::trusted(exp_so3(Xyz<double>{r[0], r[1], r[2]}), {p[0], p[1], p[2]});
  }
  [[nodiscard]] bool ends() { return good_ && word().empty(); }
  [[nodiscard]] bool good() const { return good_; }

 private:
  std::string_view rest_;
  bool good_ = true;
};
bool is_name(const std::string& name) {
  for (const char c : name)
    if (!(std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-')) return false;
  return !name.empty() && name.size() <= 40;
}
Nanoseconds instant(double t) {
  return nanoseconds(t) + 1ns;
}
/// Takes a line; what is wrong with it, or nothing.
const char* take(Recording& out, Line line) {
  auto& d = out.shown;
  const std::string what = line.word();
  if (what == "thing") {
    const double kind = line.number();
    const std::string name = line.word(), container = line.word();
    if (!(kind >= 1 && kind < 64 && kind == std::floor(kind))) return "a thing has a class from 1 to 63";
    if (!is_name(name)) return "a thing has a name of letters, digits, _ and -, at most 40";
    if (d.kinds.size() == 64) return "more than 64 things";
    if ((!container.empty() && container != "container") || !line.ends())
      return "not: thing CLASS NAME [container]";
    const auto k = static_cast<ObjectClass>(kind);
    const auto [at, is_new] = out.classes.names.try_emplace(k, name);
    if (!is_new && at->second != name) return "the class has two names";
    if (!container.empty()) out.classes.containers |= std::uint64_t(1) << k;
    d.kinds.push_back(k);
  } else if (what == "hand") {
    ShownSample<> x;
    x.time = instant(line.number());
    x.X_WH = line.pose<Transform<World, Tool>>();
    x.force = line.number();
    x.opening = line.number();
    if (!line.ends()) return "not: hand TIME X Y Z RX RY RZ FORCE OPENING";
    if (x.opening < 0) x.opening = std::numeric_limits<double>::quiet_NaN();
    if (x.time < 0ns || (!d.hand.empty() && x.time <= d.hand.back().time))
      return "its time is not after the last one's";
    d.hand.push_back(x);
  } else if (what == "seen") {
    Detection<> x;
    x.time = instant(line.number());
    const double thing = line.number();
    x.X_WO = line.pose<ObjectPose<>>();
    if (!line.ends()) return "not: seen TIME THING X Y Z RX RY RZ";
    if (!(thing >= 0 && thing < static_cast<double>(d.kinds.size()) && thing == std::floor(thing)))
      return "no such thing";
    if (x.time < 0ns || (!d.seen.empty() && x.time < d.seen.back().time))
      return "its time is before the last one's";
    x.object = static_cast<std::uint8_t>(thing);
    d.seen.push_back(x);
  } else {
    return "neither thing, hand nor seen";
  }
  return nullptr;
}
}  // namespace

std::string Classes::name(ObjectClass kind) const {
  const auto at = names.find(kind);
  return kind == 0 ? "the world" : at != names.end() ? at->second : text("thing_%d", int(kind));
}

void write(const Recording& recording, const std::string& file) {
  std::ofstream out(file);
  const auto& d = recording.shown;
  for (const auto kind : d.kinds)
    out << "thing " << int(kind) << ' ' << recording.classes.name(kind)
        << (((recording.classes.containers >> kind) & 1u) != 0 ? " container\n" : "\n");
  for (const auto& x : d.hand)
    out << text("hand %.6f ", seconds<double>(x.time - 1ns)) << pose(x.X_WH)
        << text(" %.9g %.9g\n", x.force, x.opening >= 0 ? x.opening : -1.0);
  for (const auto& x : d.seen)
    out << text("seen %.6f %d ", seconds<double>(x.time - 1ns), int(x.object)) << pose(x.X_WO) << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

Recording read(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  Recording out;
  std::string line;
  std::size_t number = 0;
  const auto wrong = [&](const char* why) {
    throw std::runtime_error(file + ", line " + std::to_string(number) + ": " + why);
  };
  while (std::getline(in, line)) {
    if (++number > 1'000'000) wrong("too long a recording");
    if (line.empty() || line[0] == '#') continue;
    if (line.size() > 300) wrong("too long a line");
    if (const char* why = take(out, Line(line))) wrong(why);
  }
  if (out.shown.hand.empty()) wrong("no line of the hand");
  return out;
}

}  // namespace teach
