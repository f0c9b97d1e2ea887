// Promise: what wraps or sums touches leaves nothing out: each member of the table through each wrapper
// and sum
// Tried: skins, wrist sensors, motors and wrappers of wrappers; two skins of which both have an id are
// refused

#include "skinctl/tactile/touch.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "skinctl/clearance/own_view_skin.hpp"
#include "skinctl/tactile/contact_skin.hpp"
#include "skinctl/tactile/detail/touch_fault.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/tactile/touch_sum.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/tactile/weighted_skin.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"
#include "tests/support/touched_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Model = ur5::Model;
using Row = LinkWrenches<Model, link_bit<2>>;

/// A touch with nothing that is optional.
template <int Number = 0>
struct Bare : sensor_sums::Summand {
  using Memory = struct Nothing {};
  using Wrenches = Row;
  Memory start(Nanoseconds) const noexcept { return {}; }
  Status receive(Memory&, std::span<const CellSample>, Nanoseconds, Nanoseconds, std::size_t parts,
                 Row* means) const noexcept {
    for (std::size_t j = 0; j < parts; ++j) means[j] = {};
    return {};
  }
  Row wrenches(const Memory&) const noexcept { return {}; }
};
template <int Number>
struct Felt {
  int number = Number;
};
template <int Number>
struct Sensing {
  int input = Number;
};
/// A touch with all that is optional. Its numbers are `Number` and what follows.
template <int Number>
struct Full : sensor_sums::Summand {
  struct Memory {
    Felt<0> felt[2] = {{Number}, {Number + 1}};
  };
  using Wrenches = Row;
  using Touch = TouchWrenches<Row>;
  using Sensed = Sensing<Number>;
  using Found = Felt<0>;
  static constexpr double size_of = Number;

  static Row row(double value) noexcept {
    Row out;
    out.data[0][0] = value;
    return out;
  }
  Memory start(Nanoseconds) const noexcept { return {}; }
  template <class Means>
  Status receive(Memory&, std::span<const CellSample>, const Sensed& sensed, const State<6>&, Nanoseconds,
                 Nanoseconds, std::size_t parts, Means* means) const noexcept {
    for (std::size_t j = 0; j < parts; ++j) {
      if constexpr (std::is_same_v<Means, Touch>) {
        means[j] = {row(sensed.input), row(0.5)};
      } else {
        means[j] = row(sensed.input + 0.5);
      }
    }
    return Reason::sample_stale;
  }
  Row wrenches(const Memory&) const noexcept { return row(Number + 0.5); }
  Touch touch(const Memory&) const noexcept { return {row(Number), row(0.5)}; }
  Row pressed(const Memory&, const auto&) const noexcept { return row(10 * Number); }
  std::span<const Found> contacts(const Memory& m) const noexcept { return m.felt; }
  std::size_t size() const noexcept { return 2; }
  std::size_t index(std::uint32_t id) const noexcept { return id - 10 * Number < 2 ? id - 10 * Number : 2; }
  Coverage coverage(const Memory&) const noexcept { return {1, 2, Number}; }
  double noticed(const Memory&, std::size_t i) const noexcept { return Number + 0.1 * double(i); }
  template <std::size_t I>
  double max_proximity(const Memory&) const noexcept {
    return 0.1 * Number;
  }
  template <class F>
  void each_cell(F&& f, std::size_t) const {
    f(2, Xyz<double>{Number, 0, 0}, Xyz<double>{0, 0, 0}, 1.0);
  }
  template <class F>
  void each_point(F&& f) const {
    f(2, Xyz<double>{0, Number, 0}, Xyz<double>{0, 0, 0}, 1.0);
  }
  double gain_everywhere() const noexcept { return Number; }
  bool understands(const Full& other) const noexcept { return &other == this; }
  Row beyond(const Row& found, const auto&, const auto&) const noexcept {
    Row out = found;
    out.data[0][1] = 7;
    return out;
  }
};
/// A wrapper that changes nothing.
template <class S>
struct Passing : WrappedTouch<Passing<S>, S> {
  struct Memory : S::Memory {};
  explicit Passing(const S& s) : WrappedTouch<Passing, S>(s) {}
  Status take(Memory& m, const auto& given, auto* means, auto&&... front) const noexcept {
    return this->take_on(m, given, means, front...);
  }
};

/// Which rows of the table a touch has.
template <class S>
constexpr unsigned rows() {
  using Table = TouchTable<S>;
  using Touch = typename Table::Touch;
  constexpr bool found[] = {Table::is_sensor,
                            Table::tells_apart,
                            Table::template knows_pressed<Touch>,
                            Table::finds_contacts,
                            Table::has_coverage,
                            Table::has_cells,
                            Table::has_cell_list,
                            Table::has_points,
                            Table::feels_everywhere,
                            Table::template tells_max_proximity<2>,
                            detail::HasUnderstands<S>};
  unsigned bits = 0;
  for (unsigned k = 0; k < std::size(found); ++k) bits |= found[k] ? 1u << k : 0u;
  return bits;
}
constexpr unsigned all_rows = (1u << 11) - 1, sensed_row = 1, contacts_row = 8, understands_row = 1u << 10;
template <class S>
constexpr bool in_order = detail::fault_in_touch<S, State<6>>() == detail::TouchFault::none;

template <std::size_t First = 1>
auto two_cells() {
  return open_skin(Patch<2, 2>(
      {cell_at<2>(First, {-0.2, 0, 0.06}, {0, 0, 1}), cell_at<2>(First + 1, {-0.2, 0, -0.06}, {0, 0, -1})},
      open_gains));
}
using Plain = decltype(two_cells());
using OwnPlain = OwnViewSkin<Plain, Model>;
using Wrist = WristSensor<5, Model>;
using Motors = MotorTouch<Model>;
template <class A, class B>
using Sum = TouchSources<A, B>;
}  // namespace

TEST_CASE("Touch: a wrapper has each row of what it wraps, a sum each row of either") {
  static_assert(rows<Bare<>>() == 0 && rows<Full<1>>() == all_rows && in_order<Bare<>> && in_order<Full<1>>);
  static_assert(rows<Passing<Full<1>>>() == all_rows && rows<Passing<Passing<Full<1>>>>() == all_rows);
  static_assert(in_order<Passing<Full<1>>>);
  static_assert(rows<Sum<Full<1>, Bare<>>>() == all_rows && rows<Sum<Bare<>, Full<1>>>() == all_rows);
  static_assert(rows<Sum<Bare<1>, Bare<2>>>() == understands_row);
  static_assert(rows<Sum<Full<1>, Full<2>>>() == all_rows);
  static_assert(in_order<Sum<Full<1>, Bare<>>> && in_order<Sum<Bare<1>, Bare<2>>> &&
                in_order<Sum<Full<1>, Full<2>>>);

  constexpr unsigned skin = rows<Plain>();
  static_assert(in_order<Plain> && in_order<Wrist> && in_order<Motors>);
  static_assert(rows<ContactSkin<Plain>>() == (skin | contacts_row) && in_order<ContactSkin<Plain>>);
  static_assert(rows<WeightedSkin<Plain>>() == (skin | sensed_row) && in_order<WeightedSkin<Plain>>);
  static_assert(rows<OwnPlain>() == (skin | sensed_row) && in_order<OwnPlain>);
  static_assert(rows<TrustedSkin<Plain>>() == skin && in_order<TrustedSkin<Plain>>);
  static_assert(rows<ContactSkin<TrustedSkin<Plain>>>() == (skin | contacts_row));
  static_assert(rows<ContactSkin<OwnPlain>>() == (skin | contacts_row | sensed_row));
  static_assert(rows<WeightedSkin<ContactSkin<OwnPlain>>>() == (skin | contacts_row | sensed_row));
  static_assert(in_order<WeightedSkin<ContactSkin<OwnPlain>>> && in_order<ContactSkin<TrustedSkin<Plain>>>);
  static_assert(rows<Passing<WeightedSkin<Plain>>>() == (skin | sensed_row));
  static_assert(rows<Sum<Plain, Wrist>>() == (skin | rows<Wrist>()));
  static_assert(rows<Sum<ContactSkin<Plain>, Sum<Wrist, Motors>>>() ==
                (skin | contacts_row | rows<Wrist>() | rows<Motors>()));
  static_assert(in_order<Sum<ContactSkin<Plain>, Sum<Wrist, Motors>>>);
}

TEST_CASE("Touch: each row of a wrapper gives what it gives without, each of a sum is joined by its rule") {
  const Full<1> full;
  const Passing<Full<1>> wrapped(full);
  const Sum<Full<1>, Full<2>> both(full, Full<2>());
  const Sum<Full<2>, Bare<>> one{Full<2>{}, Bare<>{}};
  const Sum<Bare<>, Full<2>> other{Bare<>{}, Full<2>{}};
  const auto m = full.start(0ns);
  const auto w = wrapped.start(0ns);
  const auto b = both.start(0ns);
  const auto o = one.start(0ns);
  const auto p = other.start(0ns);
  using F = TouchTable<Full<1>>;
  using W = TouchTable<Passing<Full<1>>>;
  using B = TouchTable<Sum<Full<1>, Full<2>>>;
  using O = TouchTable<Sum<Full<2>, Bare<>>>;
  using P = TouchTable<Sum<Bare<>, Full<2>>>;

  CHECK(W::touch(wrapped, w) == F::touch(full, m));
  CHECK(B::touch(both, b).first == F::touch(full, m));
  CHECK(B::touch(both, b).second.force.data[0][0] == 2);
  CHECK(P::touch(other, p).second.proximity.data[0][0] == 0.5);
  CHECK(W::pressed(wrapped, w, F::touch(full, m)).data[0][0] == 10);
  CHECK(B::pressed(both, b, B::touch(both, b)).second.data[0][0] == 20);
  CHECK(O::pressed(one, o, O::touch(one, o)).first.data[0][0] == 20);
  CHECK(W::contacts(wrapped, w).size() == 2);
  std::vector<int> found;
  for (const auto& c : B::contacts(both, b)) found.push_back(c.number);
  CHECK(found == std::vector<int>{1, 2, 2, 3});
  CHECK(P::contacts(other, p).size() == 2);
  CHECK(W::coverage(wrapped, w) == F::coverage(full, m));
  const Coverage all = B::coverage(both, b);
  CHECK(all.usable == 2);
  CHECK(all.cells == 4);
  CHECK(all.blind_patches == 3);
  CHECK(B::noticed(both, b, 1) == doctest::Approx(1.1));
  CHECK(B::noticed(both, b, 2) == doctest::Approx(2.0));
  CHECK(B::noticed(both, b, 3) == doctest::Approx(2.1));
  CHECK(W::noticed(wrapped, w, 1) == F::noticed(full, m, 1));
  CHECK(both.coverage(b).usable == 2);
  CHECK(W::max_proximity<2>(wrapped, w) == F::max_proximity<2>(full, m));
  CHECK(B::max_proximity<2>(both, b) == doctest::Approx(0.2));
  CHECK(O::max_proximity<2>(one, o) == doctest::Approx(0.2));  // of those that tell
  CHECK(P::max_proximity<2>(other, p) == doctest::Approx(0.2));
  CHECK(TouchTable<Bare<>>::max_proximity<2>(Bare<>(), {}) == 1);
  CHECK(W::index(wrapped, 11) == 1);
  CHECK(both.size() == 4);
  CHECK(both.index(11) == 1);
  CHECK(both.index(20) == 2);
  CHECK(both.index(30) == 4);
  const auto sum_of = [](auto&& each) {
    double sum = 0;
    each([&](std::size_t, const Xyz<double>& f, const Xyz<double>&, double) { sum += f.x + f.y; });
    return sum;
  };
  CHECK(sum_of([&](auto f) { W::each_cell(wrapped, f, 6); }) == 1);
  CHECK(sum_of([&](auto f) { B::each_cell(both, f, 6); }) == 3);
  CHECK(sum_of([&](auto f) { P::each_cell(other, f, 6); }) == 2);
  CHECK(sum_of([&](auto f) { W::each_point(wrapped, f); }) == 1);
  CHECK(sum_of([&](auto f) { B::each_point(both, f); }) == 3);
  CHECK(sum_of([&](auto f) { O::each_point(one, f); }) == 2);
  CHECK(W::gain_everywhere(wrapped) == 1);
  CHECK(B::gain_everywhere(both) == 2);
  CHECK(P::gain_everywhere(other) == 2);
  CHECK(W::understands(wrapped, wrapped));
  CHECK_FALSE(W::understands(wrapped, Passing<Full<1>>(full)));
  CHECK(B::understands(both, both));
  CHECK_FALSE(O::understands(one, Sum<Full<2>, Bare<>>(one)));

  // What is received passes, and the second counts beyond the first.
  auto received = wrapped.start(0ns);
  Row mean;
  CHECK(
      wrapped.receive(received, {}, Sensing<1>{5}, State<6>{}, 0ns, 1ms, 1, &mean).has(Reason::sample_stale));
  CHECK(mean.data[0][0] == 5.5);
  auto summed = both.start(0ns);
  Sum<Full<1>, Full<2>>::Wrenches means;
  detail::BothSensed<Sensing<1>, Sensing<2>> sensed{{4}, {6}};
  CHECK(both.receive(summed, {}, sensed, State<6>{}, 0ns, 1ms, 1, &means).has(Reason::sample_stale));
  CHECK(means.first.data[0][0] == 4.5);
  CHECK(means.second.data[0][0] == 6.5);
  CHECK(means.second.data[0][1] == 7);
}

TEST_CASE("Touch: real skins behind wrappers read the same") {
  const Plain plain = two_cells();
  const OwnView<Model> view(Model{}, plain.places(), {});
  const WeightedSkin skin(ContactSkin(OwnViewSkin(plain, view)));
  using Skin = std::remove_cvref_t<decltype(skin)>;
  auto a = std::make_unique<Plain::Memory>(plain.start(0ns));
  auto b = std::make_unique<Skin::Memory>(skin.start(0ns));
  CellSample samples[2];
  for (std::uint32_t k = 0; k < 2; ++k)
    samples[k] = {.time = 3ms, .cell = k + 1, .force = {0.1f, 0.2f, 0.1f}, .proximity = 0.25f};
  Plain::Touch v[2];
  Skin::Touch w[2];
  CHECK_FALSE(plain.receive(*a, samples, 0ns, 4ms, 2, v).any());
  CHECK_FALSE(skin.receive(*b, samples, {}, State<6>{4ms, {}, {}}, 0ns, 4ms, 2, w).any());
  CHECK(v[1] == w[1]);
  CHECK(TouchTable<Skin>::coverage(skin, *b) == plain.coverage(*a));
  CHECK(TouchTable<Skin>::max_proximity<2>(skin, *b) == plain.max_proximity<2>(*a));
  CHECK(TouchTable<Skin>::contacts(skin, *b).size() == 2);
  CHECK(skin.wrenches(skin.recomputed(*b)) == skin.wrenches(*b));
  CHECK(skin.understands(skin));
}

TEST_CASE("Touch: two skins in one scene; an id that both have is refused, one of neither is reported") {
  const auto a = two_cells<1>();
  const auto b = two_cells<7>();
  CHECK_THROWS_WITH_AS(static_cast<void>(a + two_cells<2>()), doctest::Contains("cell id"),
                       ConfigurationError);
  const auto both = a + b;
  using Both = std::remove_cvref_t<decltype(both)>;
  static_assert(!TouchTable<Both>::is_sensor);
  auto m = std::make_unique<Both::Memory>(both.start(0ns));
  auto alone = std::make_unique<Plain::Memory>(b.start(0ns));
  CellSample samples[4];
  for (std::size_t k = 0; k < 4; ++k)
    samples[k] = {.time = 3ms,
                  .cell = std::uint32_t(k < 2 ? 7 + k : k - 1),
                  .force = {0.1f, 0.1f, 0.1f},
                  .proximity = 0.5f};
  samples[3].force = {}, samples[3].proximity = 0;
  Both::Touch means;
  Plain::Touch mean;
  CHECK(both.receive(*m, samples, 0ns, 4ms, 1, &means) == Status{});
  static_cast<void>(b.receive(*alone, std::span(samples).first(2), 0ns, 4ms, 1, &mean));
  CHECK(means.second == mean);
  CHECK(means.first.force.data[0][2] < 0);
  CHECK(both.coverage(*m).usable == 4);
  samples[0].cell = 99, samples[0].time = 5ms;
  CHECK(both.receive(*m, std::span(samples).first(1), 4ms, 8ms, 1, &means).has(Reason::sample_unknown));
}
