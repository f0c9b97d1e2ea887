#include "skinctl/sensing/sample_span.hpp"

#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "skinctl/cycle/input.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"

using namespace skinctl;

namespace {

using Cells = SampleSpan<CellSample>;
template <class From>
constexpr bool from = std::is_constructible_v<Cells, From> && std::is_assignable_v<Cells&, From>;

// Of an owner only what has a name; of a view whatever stands elsewhere.
template <class Owner>
constexpr bool by_name_only = from<Owner&> && from<const Owner&> && !from<Owner> && !from<const Owner>;
static_assert(by_name_only<std::vector<CellSample>>);
static_assert(by_name_only<std::array<CellSample, 3>>);
static_assert(from<CellSample (&)[3]> && from<const CellSample (&)[3]>);
static_assert(from<std::span<CellSample>> && from<std::span<const CellSample>> &&
              from<std::span<CellSample, 3>>);
static_assert(from<const std::span<const CellSample>&> && from<Cells&> && from<Cells> && from<const Cells&>);
static_assert(!from<std::vector<WrenchSample>&> && !from<std::vector<float>&>);

static_assert(std::is_same_v<decltype(CycleInput<6>::samples), Cells>);
static_assert(std::is_same_v<decltype(WristInput::wrenches), SampleSpan<WrenchSample>>);
static_assert(std::is_trivially_copyable_v<Cells> && sizeof(Cells) == sizeof(std::span<const CellSample>));

}  // namespace

TEST_CASE("sample span: it looks at what it was made from, and is a span wherever one is asked for") {
  std::vector<CellSample> named(4);
  CycleInput<6> input;
  CHECK(input.samples.empty());
  input.samples = named;
  CHECK(input.samples.data() == named.data());
  CHECK(input.samples.size() == 4);
  input.samples = std::span(named).first(2);
  CHECK(input.samples.size() == 2);
  input.samples = {&named[3], 1};
  CHECK(input.samples.data() == &named[3]);
  const std::span<const CellSample> plain = input.samples;
  CHECK(plain.data() == &named[3]);
  Cells copy = input.samples;
  copy = copy.subspan(1);
  CHECK(copy.empty());
  input.samples = {};
  CHECK(input.samples.empty());
}
