// SPDX-License-Identifier: BSD-3-Clause
// Parts of a resolver that watch over energy: a scene names them; none by default.
#pragma once

#include <tuple>

#include "skinctl/passivity/energy_tank.hpp"
#include "skinctl/passivity/passivity_observer.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The parts that keep a resolver passive, in any order: `Passivity(EnergyTank(...),
/// PassivityObserver(...))`. None by default; a part that is not named costs neither time nor memory.
template <class... Parts>
class Passivity {
 public:
  template <class Part>
  static constexpr bool has = (std::is_same_v<Part, Parts> || ...);

  /// The memory of the parts; trivially copyable.
  template <std::size_t N>
  struct Memory : Parts::template Memory<N>... {
    template <class Part>
    [[nodiscard]] SKINCTL_INLINE auto& of() noexcept {
      return static_cast<typename Part::template Memory<N>&>(*this);
    }
    template <class Part>
    [[nodiscard]] SKINCTL_INLINE const auto& of() const noexcept {
      return static_cast<const typename Part::template Memory<N>&>(*this);
    }
  };

  explicit constexpr Passivity(const Parts&... parts) : parts_(parts...) {}

  template <class Part>
  [[nodiscard]] SKINCTL_INLINE const Part& get() const noexcept {
    return std::get<Part>(parts_);
  }
  template <std::size_t N>
  [[nodiscard]] Memory<N> start() const noexcept {
    return Memory<N>{get<Parts>().template start<N>()...};
  }

 private:
  [[no_unique_address]] std::tuple<Parts...> parts_;
};
template <class... Parts>
Passivity(const Parts&...) -> Passivity<Parts...>;

SKINCTL_END_NAMESPACE
