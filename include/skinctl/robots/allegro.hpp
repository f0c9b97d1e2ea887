// SPDX-License-Identifier: BSD-3-Clause
// Wonik Allegro hand, right and left: four fingers of four joints on a palm.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/model/placement.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace allegro {

/// Right or left hand. The left is the right mirrored at y = 0, with two peculiarities of the maker's
/// description: the first joints of its three fingers rotate about +z as on the right hand (a mirrored motion
/// has them negated), and the products of inertia of the links are not mirrored.
enum class Side { right, left };

/// The hand as one tree of 16 joints: finger f (0 index, 1 middle, 2 ring, 3 thumb) has the joints 4f to 4f +
/// 3.
struct Tree {
  static constexpr std::size_t joints = 16;
  static constexpr std::array<int, 16> parents = {-1, 0, 1, 2, -1, 4, 5, 6, -1, 8, 9, 10, -1, 12, 13, 14};
  static constexpr auto kinds = all_of_kind<16>(JointKind::revolute);
};

/// One finger of four joints. The constants that all four fingers share are typed, so that four fingers
/// compute side by side in lanes.
struct Finger : Chain<4> {
  template <std::size_t Ix, LinkParameter P>
  static constexpr auto known() noexcept {
    using enum LinkParameter;
    if constexpr (Ix == 1 && P == cos_alpha) {
      return TypedConstant<0>{};
    } else if constexpr (Ix == 1 && P == sin_alpha) {
      return TypedConstant<-1>{};
    } else if constexpr (Ix == 3 && P == cos_alpha) {
      return TypedConstant<1>{};
    } else if constexpr (Ix == 3 && (P == sin_alpha || P == p_x || P == p_z || P == offset)) {
      return TypedConstant<0>{};
    } else if constexpr (Ix == 2 && (P == p_x || P == offset)) {
      return TypedConstant<0>{};
    } else if constexpr (P == c_x || P == c_z || (Ix < 3 && P == c_y)) {
      return TypedConstant<0>{};
    } else {
      return;
    }
  }
};

namespace detail {

inline constexpr Rotation<double> one{};
/// Axes rotated such that z is the old y axis, or the old -x axis.
inline constexpr Rotation<double> y_to_z{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
inline constexpr Rotation<double> minus_x_to_z{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
inline constexpr Rotation<double> x_to_z{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};
inline constexpr Rotation<double> minus_z_to_z{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};

/// A joint as printed in the URDF, and the rotation `turn` that makes its axis z.
struct Row {
  Rotation<double> turn, R;
  double p[3];
  double mass, xx, xy, xz, yy, yz, zz;
};

}  // namespace detail

/// The palm, in the frame of the hand, from the same description. It moves with the link that carries the
/// hand (`Loaded`).
///
/// The maker's descriptions (V4, V5 and V5 Sense alike) put its centre of mass at z = +0.0475, above the
/// hand's frame and between the fingers: outside of the palm, whose own collision box reaches from z = -0.095
/// to 0. The number is half the height of that box; its sign is taken from the box. A payload with the
/// maker's sign has its centre 41 mm further out: 0.39 N m at a wrist that holds the hand level.
inline constexpr LinkInertia palm{0.4154, {0, 0, -0.0475}, 1e-4, 1e-4, 1e-4};

/// The joints of finger `f` from the maker's description: allegro_right_hand.urdf and allegro_left_hand.urdf
/// of Gepetto/example-robot-data (as of its first commit: a later one replaced inertias by estimates), after
/// the hand's own ROS package (BSD). There the centre of mass of every link lies at its origin, and the tip
/// belongs to the last link. Some products of inertia are physically inconsistent: see `makers_density`.
inline std::array<PlacedLink, 4> finger_links(std::size_t f, Side side = Side::right) {
  using namespace detail;
  const double mirror = side == Side::right ? 1 : -1;
  std::array<Row, 4> rows;
  if (f < 3) {
    const double tilt = mirror * (static_cast<double>(f) - 1) * 0.08726646255;
    const double s = std::sin(tilt), c = std::cos(tilt);
    const double y = f == 1 ? 0.0 : mirror * (f == 0 ? 0.0435 : -0.0435);
    const double z = f == 1 ? 0.0007 : -0.001542;
    // clang-format off
    rows = {
        Row{one, {{1, 0, 0}, {0, c, s}, {0, -s, c}}, {0, y, z}, 0.0119,
            1.01666658333e-06, 0, 0, 6.47677333333e-07, 0, 1.01666658333e-06},
        Row{y_to_z, one, {0, 0, 0.0164}, 0.065,
            7.95654166667e-05, 1.7199e-05, 8.75875e-06, 2.47088833333e-05, 2.413125e-05, 7.95654166667e-05},
        Row{y_to_z, one, {0, 0, 0.054}, 0.0355,
            2.63979183333e-05, 6.67968e-06, 4.783625e-06, 1.34948516667e-05, 9.372e-06, 2.63979183333e-05},
        Row{y_to_z, one, {0, 0, 0.0384}, 0.0096,
            4.701248e-06, 1.255968e-06, 1.2936e-06, 3.649312e-06, 1.7622e-06, 4.701248e-06}};
    // clang-format on
  } else {
    const double sy = std::sin(-1.65806278845), cy = std::cos(-1.65806278845);  // rpy 0, -1.658..., -+pi/2
    const double sz = std::sin(-mirror * 1.5707963259), cz = std::cos(1.5707963259);
    const Rotation<double> Rz{{cz, sz, 0}, {-sz, cz, 0}, {0, 0, 1}}, Ry{{cy, 0, -sy}, {0, 1, 0}, {sy, 0, cy}};
    // clang-format off
    rows = {
        Row{side == Side::right ? minus_x_to_z : x_to_z, Rz * Ry, {-0.0182, mirror * 0.019333, -0.045987}, 0.0176,
            1.89273333333e-5, 7.16716e-06, 5.35568e-06, 1.43008213333e-05, 6.8068e-06, 1.89273333333e-05},
        Row{side == Side::right ? one : minus_z_to_z, one, {-0.027, mirror * 0.005, 0.0399}, 0.0119,
            4.24250866667e-06, 1.032087e-06, 1.603525e-06, 4.52362633333e-06, 1.44808125e-06, 4.24250866667e-06},
        Row{y_to_z, one, {0, 0, 0.0177}, 0.038,
            4.30439933333e-05, 9.57068e-06, 5.1205e-06, 1.44451933333e-05, 1.342825e-05, 4.30439933333e-05},
        Row{y_to_z, one, {0, 0, 0.0514}, 0.0388,
            3.29223173333e-05, 8.042076e-06, 5.2283e-06, 1.47493026667e-5, 1.1283525e-5, 3.29223173333e-05}};
    // clang-format on
  }
  const LinkInertia tip{0.0168, {0, 0, f < 3 ? 0.0267 : 0.0423}, 9.68e-07, 9.68e-07, 9.68e-07};
  std::array<PlacedLink, 4> links;
  Rotation<double> parent = one;
  for (std::size_t i = 0; i < 4; ++i) {
    const Row& row = rows[i];
    LinkInertia inertia{row.mass, {0, 0, 0}, row.xx, row.yy, row.zz, row.xy, row.xz, row.yz};
    if (i == 3) inertia = combined(inertia, tip);
    const Xyz<double> p = turn_back(parent, Xyz<double>{row.p[0], row.p[1], row.p[2]});
    links[i] = {parent.transpose() * row.R * row.turn,
                {p.x, p.y, p.z},
                seen_from(row.turn.transpose(), {0, 0, 0}, inertia)};
    parent = row.turn;
  }
  return links;
}

/// The model of a whole hand as one tree of 16 joints.
template <Scalar T = double>
[[nodiscard]] CalibratedModel<Tree, T> hand(Side side) {
  typename CalibratedModel<Tree, T>::Links links;
  for (std::size_t f = 0; f < 4; ++f) {
    const auto canonical = canonical_links<Chain<4>>(finger_links(f, side));
    for (std::size_t i = 0; i < 4; ++i) links[4 * f + i] = canonical.links[i].template cast<T>();
  }
  return CalibratedModel<Tree, T>(links, {T(0), T(0), T(-9.81)}, makers_density);
}
template <Scalar T = double>
[[nodiscard]] CalibratedModel<Tree, T> right_hand() {
  return hand<T>(Side::right);
}
template <Scalar T = double>
[[nodiscard]] CalibratedModel<Tree, T> left_hand() {
  return hand<T>(Side::left);
}

/// `W` fingers from finger `first` on as lanes of one chain of four joints: `Lane<double, 4>` computes the
/// whole hand at once. `W` = 1 is a single finger on plain scalars.
template <std::size_t W, Real T = double>
[[nodiscard]] auto fingers_of(Side side, std::size_t first = 0) {
  using L = std::conditional_t<W == 1, T, Lane<T, W>>;
  std::array<TurnedLinks<Chain<4>>, W> fingers;
  for (std::size_t k = 0; k < W; ++k)
    fingers[k] = canonical_links<Chain<4>>(finger_links((first + k) % 4, side));
  typename CalibratedModel<Finger, L>::Links links;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t p = 0; p < std::size_t(LinkParameter::count); ++p) {
      T numbers[W];
      for (std::size_t k = 0; k < W; ++k) numbers[k] = static_cast<T>(fingers[k].links[i].numbers[p]);
      if constexpr (W == 1) {
        links[i].numbers[p] = numbers[0];
      } else {
        links[i].numbers[p] = L::load(numbers);
      }
    }
  }
  return CalibratedModel<Finger, L>(links, {L(0), L(0), L(T(-9.81))}, makers_density);
}
template <std::size_t W, Real T = double>
[[nodiscard]] auto right_fingers(std::size_t first = 0) {
  return fingers_of<W, T>(Side::right, first);
}
template <std::size_t W, Real T = double>
[[nodiscard]] auto left_fingers(std::size_t first = 0) {
  return fingers_of<W, T>(Side::left, first);
}

namespace detail {
template <class L, class T, std::size_t... K>
SKINCTL_INLINE L lane_of(const T* x, std::index_sequence<K...>) noexcept {
  return L(typename L::Vector{x[4 * K]...});
}
}  // namespace detail

/// The numbers of the fingers `first` to `first + W - 1`, of those of the hand's 16 joints, as lanes, without
/// a detour through memory.
template <std::size_t W, class Kind, Real T>
[[nodiscard]] SKINCTL_INLINE JointVector<Kind, 4, Lane<T, W>> to_lanes(const JointVector<Kind, 16, T>& v,
                                                                       std::size_t first = 0) noexcept {
  JointVector<Kind, 4, Lane<T, W>> lanes;
  for (std::size_t i = 0; i < 4; ++i)
    lanes[i] = detail::lane_of<Lane<T, W>>(v.data + 4 * first + i, std::make_index_sequence<W>{});
  return lanes;
}

/// Writes lanes back to the joints of the fingers `first` to `first + W - 1`.
template <class Kind, Real T, std::size_t W>
SKINCTL_INLINE void from_lanes(const JointVector<Kind, 4, Lane<T, W>>& lanes, JointVector<Kind, 16, T>& v,
                               std::size_t first = 0) noexcept {
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < W; ++k) v[4 * (first + k) + i] = lanes[i][k];
}

}  // namespace allegro

SKINCTL_END_NAMESPACE
