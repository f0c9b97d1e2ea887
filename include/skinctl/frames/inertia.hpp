// Mass, centre of mass and moments of inertia of a rigid body.
#pragma once

#include <array>

#include "skinctl/core/contract.hpp"
#include "skinctl/frames/momentum.hpp"
#include "skinctl/frames/symmetric.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Inertia of the body to which frame `Body` is fixed: its mass, its centre of mass as seen from frame `At`,
/// and its moments of inertia about the centre of mass along the axes of `At`. Massless by default.
///
/// Physical consistency is enforced: a mass >= 0 and principal moments that satisfy the triangle inequality
/// `I_1 + I_2 >= I_3`, to within the rounding of `T`. Anything else throws `ConfigurationError` at
/// construction.
template <Frame Body, Frame At = Body, Real T = double>
class Inertia {
 public:
  using scalar = T;
  using Parameters = std::array<T, 10>;

  constexpr Inertia() noexcept = default;

  /// @param mass           [kg], >= 0.
  /// @param centre         centre of mass in `At` [m].
  /// @param about_centre   moments about the centre of mass along the axes of `At` [kg m^2].
  Inertia(const T& mass, const Xyz<T>& centre, const Symmetric<T>& about_centre)
      : mass_(mass), centre_(centre), about_centre_(about_centre) {
    check();
  }
  /// The same from Eigen, 3x1 and 3x3 of scalar `T`.
  template <VectorExpression V, VectorExpression M>
    requires(std::same_as<typename V::Scalar, T> && std::same_as<typename M::Scalar, T>)
  Inertia(const T& mass, const V& centre, const M& about_centre)
      : Inertia(mass, as_xyz(centre), as_symmetric(about_centre)) {}
  /// Without the check, for published tables whose rounding breaks the triangle inequality (some makers print
  /// only the largest moment of a wrist). Kinetic energy stays positive as long as mass and moments are.
  [[nodiscard]] static constexpr Inertia unchecked(const T& mass, const Xyz<T>& centre,
                                                   const Symmetric<T>& about_centre) noexcept {
    Inertia M;
    M.mass_ = mass;
    M.centre_ = centre;
    M.about_centre_ = about_centre;
    return M;
  }
  /// From the ten numbers in which the equations of motion are linear: `m, m c_x, m c_y, m c_z, I_xx, I_xy,
  /// I_xz, I_yy, I_yz, I_zz`, with the moments about the *origin* of `At`. A mass of 0 with `m c` other than
  /// 0 is refused.
  [[nodiscard]] static Inertia from_parameters(const Parameters& p) {
    const Xyz<T> first{p[1], p[2], p[3]};
    const Symmetric<T> about_origin{p[4], p[7], p[9], p[5], p[6], p[8]};
    if (p[0] == T(0)) {
      require(first == Xyz<T>{T(0), T(0), T(0)}, "Inertia: mass", 0.0, "> 0 kg where m c is not 0");
      return Inertia(T(0), first, about_origin);
    }
    const Xyz<T> centre{first.x / p[0], first.y / p[0], first.z / p[0]};
    Inertia M = unchecked(p[0], centre, about_origin - p[0] * unit_mass_at(centre));
    M.check(about_origin.trace());
    return M;
  }
  /// A point mass [kg] at `centre` [m].
  [[nodiscard]] static Inertia point(const T& mass, const Xyz<T>& centre) {
    return Inertia(mass, centre, {});
  }
  /// A solid ball about the origin: mass [kg], radius [m].
  [[nodiscard]] static Inertia sphere(const T& mass, const T& radius) {
    const T i = T(2) * mass * radius * radius / T(5);
    return Inertia(mass, {}, {i, i, i});
  }
  /// A solid box about the origin: mass [kg], edges along x, y and z [m].
  [[nodiscard]] static Inertia box(const T& mass, const T& x, const T& y, const T& z) {
    const T k = mass / T(12);
    return Inertia(mass, {}, {k * (y * y + z * z), k * (z * z + x * x), k * (x * x + y * y)});
  }
  /// A solid cylinder about the origin with its axis along z: mass [kg], radius and length [m].
  [[nodiscard]] static Inertia cylinder_z(const T& mass, const T& radius, const T& length) {
    const T across = mass * (T(3) * radius * radius + length * length) / T(12);
    return Inertia(mass, {}, {across, across, mass * radius * radius / T(2)});
  }

  /// From the 6x6 matrix of `as_eigen`: its mass, first moments and moments about the origin are read. Throws
  /// as the constructor does.
  template <VectorExpression E>
  [[nodiscard]] static Inertia from_eigen(const E& values) {
    static_assert(std::is_same_v<typename E::Scalar, T>, "other scalar: M.cast<T>()");
    const Mat6<T> M = values;
    return from_parameters(
        {M(0, 0), M(1, 5), M(2, 3), M(0, 4), M(3, 3), M(3, 4), M(3, 5), M(4, 4), M(4, 5), M(5, 5)});
  }

  [[nodiscard]] constexpr const T& mass() const noexcept { return mass_; }
  [[nodiscard]] constexpr const Xyz<T>& centre() const noexcept { return centre_; }
  [[nodiscard]] constexpr const Symmetric<T>& about_centre() const noexcept { return about_centre_; }
  /// Moments about the origin of `At` (Steiner).
  [[nodiscard]] constexpr Symmetric<T> about_origin() const noexcept {
    return about_centre_ + mass_ * unit_mass_at(centre_);
  }
  /// The ten numbers of `from_parameters`.
  [[nodiscard]] constexpr Parameters parameters() const noexcept {
    const Xyz<T> first = mass_ * centre_;
    const Symmetric<T> I = about_origin();
    return {mass_, first.x, first.y, first.z, I.xx, I.xy, I.xz, I.yy, I.yz, I.zz};
  }
  /// The same inertia as that of `Other`, to which the body is rigidly fixed (a payload on a link). This is
  /// not checked.
  template <Frame Other>
  [[nodiscard]] constexpr Inertia<Other, At, T> part_of() const noexcept {
    return Inertia<Other, At, T>::unchecked(mass_, centre_, about_centre_);
  }
  template <Real U>
  [[nodiscard]] constexpr Inertia<Body, At, U> cast() const noexcept {
    return Inertia<Body, At, U>::unchecked(static_cast<U>(mass_), skinctl::cast<U>(centre_),
                                           about_centre_.template cast<U>());
  }

  /// The 6x6 matrix from a twist of `Body` to its momentum, about the origin and along the axes of `At`,
  /// linear rows first: `[m 1, -m [c]x; m [c]x, I_o]`.
  [[nodiscard]] friend Mat6<T> as_eigen(const Inertia& M) noexcept {
    const T m = M.mass(), o(0);
    const Xyz<T> h = m * M.centre();
    const Symmetric<T> I = M.about_origin();
    Mat6<T> out;
    out << m, o, o, o, h.z, -h.y,        //
        o, m, o, -h.z, o, h.x,           //
        o, o, m, h.y, -h.x, o,           //
        o, -h.z, h.y, I.xx, I.xy, I.xz,  //
        h.z, o, -h.x, I.xy, I.yy, I.yz,  //
        -h.y, h.x, o, I.xz, I.yz, I.zz;
    return out;
  }

  /// The inertia of two parts of one body together.
  SKINCTL_INLINE constexpr Inertia operator+(const Inertia& M) const noexcept {
    const T mass = mass_ + M.mass_;
    const T share = mass > T(0) ? T(M.mass_ / mass) : T(0);
    const Xyz<T> apart = M.centre_ - centre_;
    return unchecked(mass, centre_ + share * apart,
                     about_centre_ + M.about_centre_ + mass_ * share * unit_mass_at(apart));
  }
  /// Momentum of the body that moves with `V`, about the point and along the axes of this inertia.
  template <Frame A>
  SKINCTL_INLINE constexpr Momentum<Body, A, At, At, T> operator*(
      const Twist<Body, A, At, At, T>& V) const noexcept {
    const Xyz<T> linear = mass_ * (V.linear + cross(V.angular, centre_));
    return {linear, about_centre_ * V.angular + cross(centre_, linear)};
  }
  /// `1/2 m v_c^2 + 1/2 omega . I_c omega` [J], as seen from the reference frame of `V`; never negative.
  template <Frame A>
  friend SKINCTL_INLINE constexpr T kinetic_energy(const Inertia& M,
                                                   const Twist<Body, A, At, At, T>& V) noexcept {
    const Xyz<T> v_c = V.linear + cross(V.angular, M.centre_);
    return T(0.5) * (M.mass_ * dot(v_c, v_c) + dot(V.angular, M.about_centre_ * V.angular));
  }

  // clang-format off
  template <EigenExpression E> void operator=(const E&) = delete;  // from Eigen: Inertia<...>::from_eigen(M)
  template <EigenExpression E> operator E() const = delete;  // to Eigen: as_eigen(x)
  template <class Q> void operator+(const Q&) const = delete;  // other body or frame: part_of, X_AB * M
  template <class Q> void operator*(const Q&) const = delete;  // inertia and twist differ in body, point or axes
  friend void kinetic_energy(const Inertia&, const AnyTwist auto&) = delete;  // they differ in body, point or axes
  // clang-format on

 private:
  void check(const T& magnitude = T(0)) const {
    require(mass_ >= T(0) && mass_ <= (std::numeric_limits<T>::max)(), "Inertia: mass", double(mass_),
            ">= 0 kg");
    const Xyz<T>& c = centre_;
    require(dot(c, c) <= (std::numeric_limits<T>::max)(), "Inertia: centre of mass |c|^2", double(dot(c, c)),
            "finite m^2");
    const Xyz<T> moments = eigenvalues(about_centre_);
    const T size = magnitude > moments.z ? magnitude : moments.z;
    const T excess = moments.x + moments.y - moments.z;
    require(excess >= -tolerance<T> * size && size <= (std::numeric_limits<T>::max)(),
            "Inertia: I_1 + I_2 - I_3", double(excess),
            ">= 0 kg m^2 (I_1 <= I_2 <= I_3, the principal moments)");
  }

  T mass_{0};
  Xyz<T> centre_{T(0), T(0), T(0)};
  Symmetric<T> about_centre_;
};

/// The same body as seen from A: `X_AB` moves the centre of mass and turns the moments.
template <class Body, class A, class B, class T>
[[nodiscard]] SKINCTL_INLINE constexpr Inertia<Body, A, T> transformed(
    const Transform<A, B, T>& X_AB, const Inertia<Body, B, T>& M) noexcept {
  return Inertia<Body, A, T>::unchecked(M.mass(), detail::moved(X_AB.origin(), X_AB.axes(), M.centre()),
                                        rotated(X_AB.axes(), M.about_centre()));
}

SKINCTL_END_NAMESPACE
