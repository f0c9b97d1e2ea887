// SPDX-License-Identifier: BSD-3-Clause
// An expression of laws in words: `0.6 skin_joint + 0.4 spline_joint + gravity`.
#pragma once

#include <charconv>
#include <iosfwd>
#include <string_view>

#include "skinctl/fusion/blended.hpp"
#include "skinctl/fusion/null_space.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Text of up to 255 characters, without allocation; the remainder is cut off.
class LawText {
 public:
  [[nodiscard]] std::string_view view() const noexcept { return {text_, size_}; }
  [[nodiscard]] const char* c_str() const noexcept { return text_; }

  LawText& operator<<(std::string_view s) noexcept {
    for (const char c : s)
      if (size_ + 1 < sizeof text_) text_[size_++] = c;
    return *this;
  }
  /// Adds a number with six significant digits.
  LawText& operator<<(double x) noexcept {
    char number[32];
    const auto written = std::to_chars(number, number + sizeof number, x, std::chars_format::general, 6);
    return *this << std::string_view(number, static_cast<std::size_t>(written.ptr - number));
  }
  friend bool operator==(const LawText& a, std::string_view b) noexcept { return a.view() == b; }
  template <class Traits>
  friend auto& operator<<(std::basic_ostream<char, Traits>& out, const LawText& text) {
    return out.write(text.text_, static_cast<std::ptrdiff_t>(text.size_));
  }

 private:
  char text_[256] = {};
  std::size_t size_ = 0;
};

namespace detail {
template <class L>
void describe_to(LawText& out, const L&) noexcept {
  if constexpr (LawTable<L>::is_gated) out << (L::gate == TouchGate::touched ? "touched: " : "untouched: ");
  out << LawTable<L>::name;
}
template <std::size_t Link, class A, class B>
void describe_to(LawText& out, const NullSpace<Link, A, B>& law) noexcept {
  out << "(";
  describe_to(out, law.first());
  out << " over ";
  describe_to(out, law.second());
  out << ")";
}
template <Sum P, class... L>
void describe_to(LawText& out, const Fused<P, L...>& sum,
                 const std::array<double, sizeof...(L)>& weights) noexcept {
  if constexpr (P == Sum::weighted) out << "weighted(";
  if constexpr (P == Sum::plain) out << "plain(";
  std::size_t i = 0;
  bool first = true;
  const auto one = [&](const auto& law) {
    const double weight = weights[i++];
    if (weight == 0.0) return;
    if (!first) out << " + ";
    first = false;
    if (weight != 1.0) out << weight << " ";
    describe_to(out, law);
  };
  std::apply([&](const auto&... law) { (one(law), ...); }, sum.laws());
  if constexpr (P != Sum::normalised) out << ")";
}
template <Sum P, class... L>
void describe_to(LawText& out, const Fused<P, L...>& sum) noexcept {
  describe_to(out, sum, sum.weights());
}
template <class F>
void describe_to(LawText& out, const Blended<F>& blend) noexcept {
  out << "blended(";
  describe_to(out, blend.sum(), blend.first());
  out << ")";
}
}  // namespace detail

/// The expression of a law or sum, for logs: a law's `name`, weights other than 1 before it; laws of weight 0
/// are left out.
template <LawMembers L>
[[nodiscard]] LawText describe(const L& law) noexcept {
  LawText out;
  detail::describe_to(out, law);
  return out;
}
/// The expression of a sum with other weights than its own.
template <Sum P, class... L>
[[nodiscard]] LawText describe(const Fused<P, L...>& sum,
                               const std::array<double, sizeof...(L)>& weights) noexcept {
  LawText out;
  detail::describe_to(out, sum, weights);
  return out;
}

SKINCTL_END_NAMESPACE
