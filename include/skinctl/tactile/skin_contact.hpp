// SPDX-License-Identifier: BSD-3-Clause
// Contacts as a skin feels them: clusters of pressed cells, each with an identity that lasts.
#pragma once

#include <array>
#include <span>

#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/pressed_area.hpp"
#include "skinctl/tactile/region.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Pressed cells of one link that hang together over the cell graph, as one area. Along the link's axes,
/// about the link's origin.
template <Real T = double>
struct SkinContact : PressedArea<T> {
  std::uint32_t id = 0;       ///< identity of the contact while it lasts, from 1, unique in the skin
  std::size_t cells = 0;      ///< number of cells
  std::size_t strongest = 0;  ///< index of the cell with the largest push
  RegionMask regions = 0;     ///< regions with a cell in the contact
  T peak = T(0);              ///< push on the strongest cell [N]
  T area = T(0);              ///< surface of the pressed cells [m^2]
  /// Outward unit vector along the link's axes: against the force; of the strongest cell if grasped around.
  Xyz<T> normal = {T(0), T(0), T(0)};
  Nanoseconds began{};  ///< end of the interval in which it was first felt
};

/// A cell's part of the memory of a `ContactFinder`.
struct ContactRow {
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  std::uint32_t frame_number = 0;  ///< frame that last pressed the cell; one more once it has been visited
  std::uint32_t label = none;      ///< label of its contact in the frame `frame_number`
  std::uint32_t next = none;       ///< index of the cell below this one on the stack
  float push = 0;                  ///< push in the frame `frame_number` [N]
};

/// The memory of a `ContactFinder` for `Cells` cells and up to `Most` contacts: 16 bytes a cell. Trivially
/// copyable; `SkinContactMemory{}` has felt nothing.
template <std::size_t Cells, std::size_t Most, Real T = double>
struct SkinContactMemory {
  std::array<ContactRow, Cells> rows{};
  std::array<SkinContact<T>, Most> list{};
  std::array<std::uint32_t, Most> label{};     ///< label of each contact's cells
  std::array<T, Regions::most> region_push{};  ///< sum of the pushes on each region's cells [N]
  std::size_t count = 0;
  std::size_t left_out = 0;  ///< contacts beyond `Most`: the weakest
  std::uint32_t frame_number = 0, last_id = 0;

  [[nodiscard]] std::span<const SkinContact<T>> contacts() const noexcept { return {list.data(), count}; }
};

/// Finds the contacts of a skin, frame by frame. Immutable.
///
/// **Clusters.** Depth first over the cell graph. Cells are stamped with the number of the frame, an even
/// one, and the stack is a chain through their rows, so nothing is cleared or allocated: time is bounded by
/// the pressed cells and their edges.
///
/// **Identity.** A contact continues the one to which its strongest cell belonged a frame before; if that
/// cell was not pressed then, the strongest cell that was; else a neighbour of the strongest. Of two contacts
/// that continue one, the one with more push keeps the identity, the other gets a new one. Contacts that
/// merge keep the identity of the strongest cell.
template <Real T = double>
class ContactFinder {
 public:
  /// Throws `ConfigurationError` if the graph has another number of cells, or joins cells of two links.
  SKINCTL_COLD ContactFinder(std::span<const CellPlace> places, CellGraph graph) : graph_(std::move(graph)) {
    require(graph_.size() == places.size(), "ContactFinder: cells of the graph", double(graph_.size()),
            "those of the skin");
    const std::vector<double> pitch = patch_pitches(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (const auto j : graph_.neighbours(i))
        require(places[i].link == places[j].link, "ContactFinder: neighbour on another link", double(j),
                "cells of one link");
      const CellPlace& c = places[i];
      const Xyz<double> moment = cross(c.place, c.normal);
      const double p = pitch[c.patch], hexagon = p - p == 0 ? 0.8660254037844386 * p * p : 0;
      const auto number = [](double x) { return static_cast<float>(x); };
      const Xyz<double>&q = c.place, &z = c.normal;
      cells_.push_back({{number(-moment.x), number(-moment.y), number(-moment.z)},
                        {number(q.x), number(q.y), number(q.z)},
                        {number(-z.x), number(-z.y), number(-z.z)},
                        number(hexagon),
                        static_cast<std::uint32_t>(c.link),
                        0});
    }
  }

  [[nodiscard]] const CellGraph& graph() const noexcept { return graph_; }
  /// Puts the cells with these indices into region `k`.
  SKINCTL_COLD void join_region(std::size_t k, std::span<const std::size_t> cells) {
    for (const std::size_t i : cells) {
      require(k < Regions::most && i < cells_.size(), "ContactFinder: cell of a region", double(i),
              "a cell of the skin");
      cells_[i].regions |= RegionMask(1) << k;
    }
  }

  /// Finds the contacts at `now`, and puts them into `m`.
  ///
  /// @param each   calls `f(i, push)` for each pressed cell with its push [N]; it is called twice.
  /// @param areas  receives the contacts, each split by the direction of its pushes: a hand around an arm
  ///               pushes from several sides.
  template <class Memory, class Each, class Areas>
  void find(Memory& m, Nanoseconds now, const Each& each, Areas& areas) const noexcept {
    if ((m.frame_number += 2) == 0) m.rows = {}, m.frame_number = 2;
    m.region_push = {};
    m.left_out = 0;
    each([&](std::size_t i, const T& push) SKINCTL_INLINE_LAMBDA {
      ContactRow& row = m.rows[i];
      if (row.frame_number + 1 != m.frame_number) row.label = ContactRow::none;
      row.frame_number = m.frame_number, row.push = static_cast<float>(push);
    });
    Found<std::tuple_size_v<decltype(m.list)>> found;
    std::uint32_t label = 0;
    each([&](std::size_t i, const T&) SKINCTL_INLINE_LAMBDA {
      if (m.rows[i].frame_number != m.frame_number) return;
      const std::size_t k = found.place_for(m.left_out);
      auto& f = found.list[k];
      f.label = label;
      flood(m, static_cast<std::uint32_t>(i), label++, f, areas);
    });
    found.settle(m.left_out);
    inherit(m, now, found);
  }

 private:
  static constexpr std::uint32_t bottom = ContactRow::none - 1;
  struct Cell {
    float moment[3];  ///< moment about the link's origin for one newton [m]
    float place[3];   ///< origin of the cell on the link [m]
    float force[3];   ///< inward unit vector: force for one newton
    float area;
    std::uint32_t link;
    RegionMask regions;
  };
  template <class Number, std::size_t N>
  static SKINCTL_INLINE Xyz<T> vector(const Number (&x)[N]) noexcept {
    return {T(x[0]), T(x[1]), T(x[2])};
  }
  using Side = PressedArea<T>;
  /// The sides of a contact: sums over cells that are pushed from about the same side, `place` times push.
  struct Sides {
    static constexpr std::size_t most = 4;
    Side list[most] = {};
    std::size_t count = 0, last = 0;

    /// The side of a push along `force`: that of the last one, another one, or a new one while there is room.
    SKINCTL_INLINE Side& of(const Xyz<T>& force) noexcept {
      if (count > 0 && list[last].same_side(force)) return list[last];
      std::size_t k = 0;
      while (k < count && (k == last || !list[k].same_side(force))) ++k;
      if (k == count) k = count < most ? count++ : most - 1;
      last = k;
      return list[k];
    }
  };
  /// The strongest `Most` contacts of a frame, and one to be compared with them.
  template <std::size_t Most>
  struct Found {
    struct One {
      SkinContact<T> contact;
      std::uint32_t label = 0, heir = ContactRow::none;
    };
    detail::Unwritten<One, Most + 1> room;
    One* list = room.data;
    std::size_t count = 0;

    std::size_t place_for(std::size_t& left_out) noexcept {
      if (count > Most) settle(left_out);
      return count++;
    }
    /// Drops the weakest if there is one too many.
    void settle(std::size_t& left_out) noexcept {
      if (count <= Most) return;
      std::size_t weakest = 0;
      for (std::size_t k = 1; k < count; ++k)
        if (list[k].contact.pushed < list[weakest].contact.pushed) weakest = k;
      list[weakest] = list[--count];
      ++left_out;
    }
  };

  template <class Memory, class One, class Areas>
  void flood(Memory& m, std::uint32_t seed, std::uint32_t label, One& out, Areas& areas) const noexcept {
    Sides sides;
    SkinContact<T>& c = out.contact = {};
    c.link = cells_[seed].link, c.strongest = seed;
    out.heir = ContactRow::none;
    float inherits = 0;
    m.rows[seed].next = bottom, m.rows[seed].frame_number = m.frame_number + 1;
    const std::uint32_t frame = m.frame_number;
    for (std::uint32_t top = seed; top != bottom;) {
      const std::uint32_t i = top;
      ContactRow& row = m.rows[i];
      const Cell& cell = cells_[i];
      top = row.next;
      for (const std::uint32_t j : graph_.neighbours(i)) {
        ContactRow& other = m.rows[j];
        if (other.frame_number != frame) continue;
        other.frame_number = frame + 1, other.next = top;
        top = j;
      }
      if (row.label != ContactRow::none && row.push > inherits) inherits = row.push, out.heir = row.label;
      row.label = label;
      const T push = static_cast<T>(row.push);
      if (push > c.peak) c.peak = push, c.strongest = i;
      const Xyz<T> force = vector(cell.force);
      Side& side = sides.of(force);
      side.force = side.force + push * force;
      side.pushed = side.pushed + push;
      side.moment = side.moment + push * vector(cell.moment);
      side.place = side.place + push * vector(cell.place);
      c.area = c.area + T(cell.area);
      ++c.cells;
      c.regions |= cell.regions;
      for (RegionMask rest = cell.regions; rest != 0; rest &= rest - 1) {
        T& sum = m.region_push[static_cast<std::size_t>(std::countr_zero(rest))];
        sum = sum + push;
      }
    }
    for (std::size_t k = 0; k < sides.count; ++k) {
      Side side = sides.list[k];
      side.link = c.link;
      side.place = (T(1) / side.pushed) * side.place;
      c.add(side);
      areas.add(side);
    }
    using std::sqrt;
    const T size = sqrt(dot(c.force, c.force));
    c.normal = size > T(0.5) * c.pushed ? T(T(-1) / size) * c.force : -vector(cells_[c.strongest].force);
    if (out.heir == ContactRow::none)  // it moved on by a whole cell
      for (const std::uint32_t j : graph_.neighbours(c.strongest))
        if (m.rows[j].frame_number + 1 == m.frame_number && m.rows[j].push > inherits)
          inherits = m.rows[j].push, out.heir = m.rows[j].label;
  }

  template <class Memory, class F>
  void inherit(Memory& m, Nanoseconds now, F& found) const noexcept {
    for (std::size_t k = 0; k < found.count; ++k) {
      const auto& f = found.list[k];
      bool keeps = f.heir != ContactRow::none;
      for (std::size_t l = 0; l < found.count && keeps; ++l) {
        const auto& g = found.list[l];
        if (l == k || g.heir != f.heir) continue;
        keeps = g.contact.pushed < f.contact.pushed || (g.contact.pushed == f.contact.pushed && k < l);
      }
      std::size_t before = 0;
      while (before < m.count && m.label[before] != f.heir) ++before;
      auto& c = found.list[k].contact;
      if (keeps && before < m.count) {
        c.id = m.list[before].id, c.began = m.list[before].began;
      } else {
        if (++m.last_id == 0) m.last_id = 1;
        c.id = m.last_id, c.began = now;
      }
    }
    m.count = found.count;
    for (std::size_t k = 0; k < found.count; ++k)
      m.list[k] = found.list[k].contact, m.label[k] = found.list[k].label;
  }

  CellGraph graph_;
  std::vector<Cell> cells_;
};

SKINCTL_END_NAMESPACE
