#include <bit>
#include <chrono>
#include <cmath>
#include <list>
#include <sstream>
#include <utility>

#include "examples/simulated_ur5/faults.hpp"

namespace simulated_ur5 {
namespace {

std::size_t size_of(const std::string& type) {
  const std::map<std::string, std::size_t> sizes{
      {"BOOL", 1},   {"UINT8", 1},     {"UINT32", 4},    {"INT32", 4},         {"UINT64", 8},
      {"DOUBLE", 8}, {"VECTOR3D", 24}, {"VECTOR6D", 48}, {"VECTOR6INT32", 24}, {"VECTOR6UINT32", 24}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');) out.push_back(word);
  return out;
}

bool is_data(const Bytes& p, const RtdeLayout& layout) {
  return p.size() > 3 && p[2] == 85 && layout.size() != 0 && p.size() == layout.size();
}

}  // namespace

void RtdeLayout::asked(const Bytes& p) {
  if (p.size() > 11 && p[2] == 79) names_.assign(p.begin() + 11, p.end());
}
void RtdeLayout::answered(const Bytes& p) {
  if (p.size() < 5 || p[2] != 79) return;
  const auto names = split(names_), types = split(std::string(p.begin() + 4, p.end()));
  std::size_t at = 4;
  offset_.clear();
  for (std::size_t k = 0; k < std::min(names.size(), types.size()); ++k) {
    offset_[names[k]] = at;
    at += size_of(types[k]);
  }
  size_ = at;
}
double RtdeLayout::number(const Bytes& p, const std::string& name, std::size_t element) const {
  std::uint64_t bits = 0;
  const std::size_t at = offset_.at(name) + 8 * element;
  for (std::size_t k = 0; k < 8; ++k) bits = bits << 8 | p.at(at + k);
  return std::bit_cast<double>(bits);
}
void RtdeLayout::set(Bytes& p, const std::string& name, std::size_t element, double value) const {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const std::size_t at = offset_.at(name) + 8 * element;
  for (std::size_t k = 0; k < 8; ++k) p.at(at + k) = static_cast<std::uint8_t>(bits >> (56 - 8 * k));
}

namespace change {

/// Applies `f(package, layout)` to data packages.
template <class F>
Change each(F f) {
  return [f](Bytes p, const RtdeLayout& layout) mutable {
    if (is_data(p, layout)) f(p, layout);
    return std::vector<Bytes>{std::move(p)};
  };
}
Change not_a_number(std::size_t joint) {
  return each([joint](Bytes& p, const RtdeLayout& l) { l.set(p, "actual_q", joint, std::nan("")); });
}
Change frozen_clock() {
  return each([stamp = -1.0](Bytes& p, const RtdeLayout& l) mutable {
    if (stamp < 0) stamp = l.number(p, "timestamp");
    l.set(p, "timestamp", 0, stamp);
  });
}
Change clock_back(double seconds) {
  return each([seconds](Bytes& p, const RtdeLayout& l) {
    l.set(p, "timestamp", 0, l.number(p, "timestamp") - seconds);
  });
}
Change clock_rate(double rate) {
  return each([rate, from = -1.0](Bytes& p, const RtdeLayout& l) mutable {
    const double t = l.number(p, "timestamp");
    if (from < 0) from = t;
    l.set(p, "timestamp", 0, from + rate * (t - from));
  });
}
Change stuck(std::size_t joint) {
  return each([joint, q = std::nan("")](Bytes& p, const RtdeLayout& l) mutable {
    if (std::isnan(q)) q = l.number(p, "actual_q", joint);
    l.set(p, "actual_q", joint, q);
    l.set(p, "actual_qd", joint, 0);
  });
}
Change late(std::size_t packages) {
  return each([packages, before = std::list<Bytes>()](Bytes& p, const RtdeLayout& l) mutable {
    before.push_back(p);
    if (before.size() > packages + 1) before.pop_front();
    for (const char* name : {"actual_q", "actual_qd"})
      for (std::size_t i = 0; i < 6; ++i) l.set(p, name, i, l.number(before.front(), name, i));
  });
}
Change repeated() {
  return [](Bytes p, const RtdeLayout&) { return std::vector<Bytes>{p, p}; };
}
Change reordered() {
  return [held = Bytes(), n = 0](Bytes p, const RtdeLayout& layout) mutable {
    if (!is_data(p, layout)) return std::vector<Bytes>{p};
    if (++n % 3 == 1) {
      held = std::move(p);
      return std::vector<Bytes>{};
    }
    if (held.empty()) return std::vector<Bytes>{p};
    return std::vector<Bytes>{std::move(p), std::exchange(held, Bytes())};
  };
}
Change truncated(std::size_t missing) {
  return each([missing](Bytes& p, const RtdeLayout&) {
    p.resize(p.size() - std::min(missing, p.size() - 4));
    p[0] = static_cast<std::uint8_t>(p.size() >> 8);
    p[1] = static_cast<std::uint8_t>(p.size());
  });
}
Change garbled() {
  return [](Bytes p, const RtdeLayout&) {
    for (std::size_t k = 0; k < p.size(); ++k) p[k] = static_cast<std::uint8_t>(0xff - k);
    return std::vector<Bytes>{std::move(p)};
  };
}
Change lost(double share) {
  return [share, x = std::uint32_t(1)](Bytes p, const RtdeLayout& layout) mutable {
    x = x * 1664525u + 1013904223u;
    const bool gone = is_data(p, layout) && static_cast<double>(x >> 8) < share * 16777216.0;
    return gone ? std::vector<Bytes>{} : std::vector<Bytes>{std::move(p)};
  };
}

Change stalled(double duration, double rest_after) {
  using Clock = std::chrono::steady_clock;
  const auto time = [](double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  };
  return [held = std::vector<Bytes>(), until = Clock::time_point(), wait = time(duration),
          rest = time(rest_after)](Bytes p, const RtdeLayout&) mutable {
    if (until == Clock::time_point()) until = Clock::now() + wait;
    held.push_back(std::move(p));
    if (Clock::now() < until) return std::vector<Bytes>{};
    std::vector<Bytes> out = std::exchange(held, {});
    if (rest > Clock::duration::zero()) {
      const auto later = out.begin() + static_cast<std::ptrdiff_t>(out.size() / 4);
      held.assign(later, out.end());
      out.erase(later, out.end());
      until += std::exchange(rest, {});
    }
    return out;
  };
}

}  // namespace change

}  // namespace simulated_ur5
