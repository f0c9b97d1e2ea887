// SPDX-License-Identifier: BSD-3-Clause
// The contacts of two touches, one after the other.
#pragma once

#include <cstddef>
#include <span>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Two lists of contacts as one. Valid as long as both are.
template <class First, class Second>
class BothContacts {
 public:
  class Iterator {
   public:
    Iterator(const BothContacts& all, std::size_t i) noexcept : all_(all), i_(i) {}
    [[nodiscard]] decltype(auto) operator*() const noexcept { return all_[i_]; }
    Iterator& operator++() noexcept {
      ++i_;
      return *this;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) noexcept { return a.i_ == b.i_; }

   private:
    const BothContacts& all_;
    std::size_t i_;
  };

  BothContacts(const First& first, const Second& second) noexcept : first_(first), second_(second) {}
  [[nodiscard]] std::size_t size() const noexcept { return first_.size() + second_.size(); }
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }
  [[nodiscard]] const auto& operator[](std::size_t i) const noexcept {
    return i < first_.size() ? first_[i] : second_[i - first_.size()];
  }
  [[nodiscard]] Iterator begin() const noexcept { return {*this, 0}; }
  [[nodiscard]] Iterator end() const noexcept { return {*this, size()}; }

 private:
  First first_;
  Second second_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
