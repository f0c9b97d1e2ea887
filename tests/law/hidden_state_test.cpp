// Laws that hide state are found; others are not accused.
//
// Promise: a Memory with a pointer and a law with a mutable member are refused
// Tried: pointers among numbers, arrays and structs; copies that are not constexpr, virtual functions,
// strings, optional, private and derived fields. Not found: what a class with private members hides from GCC

#include "skinctl/law/detail/hidden_state.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

using namespace skinctl::detail;

namespace {

struct Numbers {
  double a = 0;
  std::array<double, 6> b{};
  std::uint8_t c = 0;
  bool d = false;
};
struct Nested {
  Numbers n;
  double rows[3][2] = {};
};
struct PointsFirst {
  const double* p = nullptr;
};
struct PointsLast {
  double a = 0;
  std::array<float, 4> b{};
  int* p = nullptr;
};
struct NotSaid {
  double a = 0;
  std::optional<double> b;
};
static_assert(!HasPointerField<Numbers> && !HasPointerField<Nested> && !HasPointerField<NotSaid>);
static_assert(HasPointerField<PointsFirst> && HasPointerField<PointsLast>);

struct Plain {
  double gain = 1;
};
struct Hides {
  double gain = 1;
  mutable double sum = 0;
};
struct Base {};
struct HidesLast : Base {
  double gains[3] = {1, 2, 3};
  Numbers numbers;
  const char* name = "";
  mutable Numbers seen;
};
struct Private {
  constexpr double get() const { return x; }

 private:
  double x = 0;
};
struct HoldsPrivate : Base {
  double gain = 1;
  Private p;
  double more = 2;
};
struct HoldsOptional : Base {
  std::optional<double> gain;
  double more = 2;
};
struct OptionalLast : Base {
  double gain = 1;
  std::optional<double> more;
};
struct HoldsBoth : Private {
  std::array<double, 6> gains{};
  bool on = false;
};
struct CopiesSlowly {  // its copy is no constant expression
  double gain = 1;
  constexpr CopiesSlowly() = default;
  CopiesSlowly(const CopiesSlowly& o) : gain(o.gain) {}
};
struct NoDefault {
  explicit NoDefault(double g) : gain(g) {}
  double gain;
};
struct Named {
  std::string name;
};
struct Virtual {
  virtual ~Virtual() = default;
};
static_assert(!HasMutableMember<Plain> && !HasMutableMember<CopiesSlowly> && !HasMutableMember<NoDefault>);
static_assert(!HasMutableMember<Named> && !HasMutableMember<Virtual>);
static_assert(!HasMutableMember<Base> && !HasMutableMember<Private> && !HasMutableMember<HoldsPrivate>);
static_assert(!HasMutableMember<HoldsOptional> && !HasMutableMember<OptionalLast> &&
              !HasMutableMember<HoldsBoth>);
static_assert(!HasMutableMember<Numbers> && !HasMutableMember<Nested> && !HasMutableMember<PointsLast>);
static_assert(HasMutableMember<Hides> && HasMutableMember<HidesLast>);

}  // namespace

TEST_CASE("Hidden state: pointers and mutable members are found when the law is compiled") {
  CHECK(HasPointerField<PointsLast>);
  CHECK_FALSE(HasPointerField<Nested>);
}
