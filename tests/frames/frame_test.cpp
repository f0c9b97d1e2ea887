#include "skinctl/frames/frame.hpp"

#include <doctest/doctest.h>

#include <type_traits>

using namespace skinctl;

namespace {
struct Table : FrameTag {};
struct NamedTable : FrameTag {
  int number;
};
struct NoFrame {};
}  // namespace

static_assert(Frame<World> && Frame<Base> && Frame<Flange> && Frame<Tool> && Frame<Root> && Frame<Cell>);
static_assert(Frame<Link<0>> && Frame<Link<63>>);
static_assert(Frame<Table>, "one line makes a frame");
static_assert(!Frame<NamedTable>, "a frame is a name and holds nothing");
static_assert(!Frame<NoFrame> && !Frame<int> && !Frame<Table&> && !Frame<const Table>);
static_assert(!std::is_same_v<Link<1>, Link<2>>);

TEST_CASE("Frame: a link knows its place among the joints, counted from 0") {
  CHECK(Link<5>::index == 5);
}
