// Random bits in every field of the samples, against the rules as the documentation states them.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <map>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Sometimes what a cell sends, sometimes any bits.
float some_number(float lower, float upper) {
  const auto bits = *rc::gen::arbitrary<std::uint32_t>();
  if (*rc::gen::inRange(0, 8) == 0)
    return std::bit_cast<float>(*rc::gen::resize(1000, rc::gen::arbitrary<std::uint32_t>()) * 2654435761u);
  return lower + (upper - lower) * float(bits % 1025u) / 1024.0f;
}
CellSample some_sample(Nanoseconds from, Nanoseconds to) {
  CellSample s;
  s.cell = *rc::gen::element(1u, 2u, 3u, 4u, 0u, 16383u, 0xFFFFFFFFu);
  const int kind = *rc::gen::inRange(0, 10);
  const Nanoseconds step(*rc::gen::inRange<std::int64_t>(0, 10000000));
  s.time = kind == 0
               ? *rc::gen::element<Nanoseconds>(Nanoseconds::min(), Nanoseconds::max(), 0ns, -1ns, from, to)
           : kind == 1 ? Nanoseconds(*rc::gen::arbitrary<std::int64_t>())
           : kind == 2 ? to + step
           : kind == 3 ? from - 30 * step
                       : from + (to > from ? step % (to - from + 1ns) : 0ns);
  for (float& f : s.force) f = some_number(0, 1);
  s.proximity = some_number(0, 1);
  for (float& a : s.acceleration) a = some_number(-20, 20);
  s.temperature = some_number(20, 40);
  return s;
}

/// The rules again, one by one.
class Rules {
 public:
  explicit Rules(const SkinSettings& settings) : settings_(settings) {}
  Status judge(const CellSample& s, Nanoseconds to) {
    const float read[4] = {s.force[0], s.force[1], s.force[2], s.proximity};
    const float rest[4] = {s.acceleration[0], s.acceleration[1], s.acceleration[2], s.temperature};
    for (const float x : read)
      if (!std::isfinite(x)) return Reason::sample_not_finite;
    for (const float x : rest)
      if (!std::isfinite(x)) return Reason::sample_not_finite;
    for (const float x : read)
      if (x < 0 || x > 1) return Reason::sample_out_of_range;
    if (s.cell < 1 || s.cell > 4) return Reason::sample_unknown;
    const auto last = last_.find(s.cell);
    const Nanoseconds time = std::min(s.time, to);
    if (last != last_.end() && time <= last->second) return Reason::time_backwards;
    if (s.time == Nanoseconds::min()) return Reason::time_backwards;
    if (count(s.time) - count(to) > count(settings_.max_ahead)) return Reason::sample_out_of_range;
    if (count(to) - count(time) >= count(settings_.max_age)) return Reason::sample_stale;
    last_[s.cell] = time;
    return {};
  }
  bool all_heard(Nanoseconds to) const {
    for (std::uint32_t id = 1; id <= 4; ++id) {
      const auto last = last_.find(id);
      if (last == last_.end() || to - last->second >= settings_.max_age) return false;
    }
    return true;
  }

 private:
  static long double count(Nanoseconds t) { return static_cast<long double>(t.count()); }
  SkinSettings settings_;
  std::map<std::uint32_t, Nanoseconds> last_;
};

template <class T>
void check_bits() {
  Random rng = seeded(1);
  const SkinSettings settings;
  const Skin<ur5::Model, T, Patch<1, 3>, Patch<4, 1>> skin(random_patch<1, 3>(rng, 1),
                                                           random_patch<4, 1>(rng, 4), settings);
  using W = typename decltype(skin)::Wrenches;
  const Nanoseconds start = *rc::gen::element<Nanoseconds>(0ns, 1ns, -1s, 1000000000s);
  auto memory = skin.start(start), clean = skin.start(start);
  Rules rules(settings);
  Nanoseconds from = start;
  for (int cycle = 0; cycle < 40; ++cycle) {
    const Nanoseconds to = from + *rc::gen::element<Nanoseconds>(2ms, 8ms, 1ms, 1ns, 0ns, 60ms, 300ms);
    const auto count = *rc::gen::inRange<std::size_t>(0, 12);
    std::vector<CellSample> samples, good;
    Status expected;
    for (std::size_t k = 0; k < count; ++k) {
      samples.push_back(some_sample(from, to));
      const Status bad = rules.judge(samples.back(), to);
      expected |= bad;
      if (!bad.any()) good.push_back(samples.back());
    }
    if (from == to) expected |= Reason::interval_empty;
    if (!rules.all_heard(to)) expected |= Reason::sample_stale;
    W means[2], clean_means[2];
    const Status status = skin.receive(memory, samples, from, to, 2, means);
    skin.receive(clean, good, from, to, 2, clean_means);
    RC_ASSERT(status.bits() == expected.bits());
    RC_ASSERT(memory == clean);
    RC_ASSERT(skin.recomputed(memory) == memory);
    for (std::size_t j = 0; j < 2; ++j) {
      RC_ASSERT(means[j] == clean_means[j]);
      for (const auto& row : means[j].data)
        for (const T& x : row) RC_ASSERT(std::isfinite(x));
    }
    from = to;
  }
}

}  // namespace

TEST_CASE(
    "Skin: over random bits, what the rules refuse changes nothing and is reported, the rest is finite") {
  CHECK(rc::check("double", [] { check_bits<double>(); }));
  CHECK(rc::check("float", [] { check_bits<float>(); }));
}
