// SPDX-License-Identifier: BSD-3-Clause
// Limits of speed for contact with people: force, power, separation.
#pragma once

#include <array>
#include <bit>

#include "skinctl/dynamics/energy.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/limits/link_contact.hpp"
#include "skinctl/tactile/cell_mass.hpp"
#include "skinctl/tactile/contact.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Memory of contact limits: the time for which each contact has been above its quasi-static limit [s].
template <std::size_t Links, Real T>
struct ContactMemory {
  T above[Links == 0 ? 1 : Links] = {};
};

/// The factor in [0, 1] for all joint speeds, and the contacts found.
template <Real T>
struct ContactVerdict {
  T scale = T(1);
  Status status;   ///< `contact_slowed`; `contact_force` or `contact_power`, at which the guard stops
  T force = T(0);  ///< the largest force of a contact [N]
  T power = T(0);  ///< the largest power of a contact [W]
  T blow = T(0);   ///< upper bound of the transient force of the commanded motion [N]
};

namespace detail {
template <std::size_t... Ix>
inline constexpr bool distinct_links =
    static_cast<std::size_t>(std::popcount((link_bit<Ix> | ...))) == sizeof...(Ix);
}  // namespace detail

/// Limits of contact for some links of a robot: power and force, and separation, in the form of ISO/TS 15066
/// with the user's own numbers. **Not a safety-rated function**: see `BodyRegion`, with F_t, F_q, k, m_H, P.
///
/// For each of these links, with the commanded joint velocities u:
/// - **Before a contact.** No point of the link is faster than `v = |v_o| + |w| reach`, v_o of its origin,
///   and no impact, in any direction n, has more energy than the robot: m_n v_n^2 <= e = u'Mu. So no
///   transient force exceeds `sqrt(k e m_H v^2 / (e + m_H v^2))`, which is kept below F_t. Where the skin
///   detects nobody, the speed of separation is allowed if it is higher. With `cells` it is the largest
///   `v_n sqrt(k mu)` of the cells that move outwards with v_n, mu reduced from the mass felt at the cell,
///   `1/(u'J M^-1 J'u)`, and m_H: what no cell covers is not counted. With `deceleration` a the robot reacts
///   instead of being slowed for its mass: v is allowed if it comes to rest from it before the region is
///   pressed with F_t, `k v reaction + k v^2 / (2 a) <= F_t`.
/// - **During a contact** with F, the push of all contacts on the link within 60 degrees of this one: the
///   effective mass along F is `|F|^2 / (tau' M^-1 tau)`, `tau = J'F`, and `-tau.u / |F|` the speed into the
///   contact, which is kept below `sqrt((F_t^2 - F^2) / (mu k))` (the energy that the region can still take),
///   `(F_q - F) / (k reaction)` (no more than F_q before the robot reacts) and `P / F`. With a `deceleration`
///   the first two are the speed v from which it comes to rest at F_q: `v_0 reaction + v^2 / (2 a) <= (F_q -
///   F) / k`, v_0 the larger of v and the measured speed. Motion out of the contact is not slowed by these.
/// - **Excess**: F above F_t, or above F_q for longer than `first`, is `contact_force`; more power than
///   allowed at the measured velocities is `contact_power`. The guard stops.
///
/// Contacts are where force readings are held (see `PressedAreas`), so opposite pushes on one link are two.
/// Wrenches without cells give one contact for each link: there they cancel. Rotors are not in M: add their
/// inertia to the model's links if they matter.
template <RobotModel M, Real T, std::size_t... Ix>
class ContactLimits {
 public:
  static_assert(sizeof...(Ix) > 0, "name at least one link");
  static_assert(((Ix < M::joints) && ...), "contact limits for a link that the model does not have");
  static_assert(detail::distinct_links<Ix...>,
                "two contact limits for one link: give it those of the more delicate region");
  using Kind = LinkContacts;
  static constexpr Precedence precedence = Precedence::contact;
  static constexpr bool of_the_drive = true;
  static constexpr LinkMask links = (link_bit<Ix> | ...);
  static constexpr std::size_t count = sizeof...(Ix);
  static constexpr std::size_t joints = M::joints;
  using Memory = ContactMemory<count, T>;
  using Verdict = ContactVerdict<T>;
  /// Measured distance of the nearest body from each link, in the order of the links given [m].
  using Distances = std::array<T, count>;

  /// Throws `ConfigurationError` for a number that is out of its range, or was not given.
  SKINCTL_COLD explicit ContactLimits(const M& model, const LinkContact<Ix>&... link)
      : model_(model), at_{Link(link)...} {}

  [[nodiscard]] const M& model() const noexcept { return model_; }

  /// The distances that follow from the strongest proximity reading in [0, 1] of each link.
  [[nodiscard]] SKINCTL_INLINE Distances distances(const std::array<T, count>& nearest) const noexcept {
    Distances d;
    for (std::size_t k = 0; k < count; ++k) d[k] = at_[k].range * (T(1) - nearest[k]);
    return d;
  }

  /// The allowed share of the joint velocities `u`, as a limit of a scene.
  template <class Going, class Seen>
  [[nodiscard]] SKINCTL_INLINE SpeedShare<T> share(Memory& memory, const Going& going, const Seen& seen,
                                                   const JointVelocity<joints, T>& u) const noexcept {
    const auto verdict = judge(memory, going.measured, u, seen.pressed(),
                               distances({seen.template max_proximity<Ix>()...}), going.passed);
    return {verdict.scale, verdict.status};
  }

  /// The allowed share of the joint velocities `u`, and the contacts found.
  ///
  /// @param measured  the robot's state, for the contacts and their power.
  /// @param touch     the pressed areas, or wrenches on the links; a link without skin does not compile.
  /// @param dt        seconds since the last call.
  /// A NaN in a wrench counts as too much force, a NaN distance as zero.
  template <class Touch>
  [[nodiscard]] SKINCTL_NOINLINE Verdict judge(Memory& memory, const State<joints, T>& measured,
                                               const JointVelocity<joints, T>& u, const Touch& touch,
                                               const Distances& distance, const T& dt) const noexcept {
    static_assert((Touch::links & links) == links, "contact limits for a link without skin: nothing is felt");
    Verdict out;
    const JointAngles<M, T> angles(model_, measured.q);
    const MassFactors<M, T> mass(mass_matrix(model_, angles));
    const Poses<M, closure<M>(links), T> poses(model_, angles);
    const T energy = T(2) * kinetic_energy(model_, angles, u);
    const auto contacts = contacts_of(model_, measured.q, touch);
    std::size_t k = 0;
    const auto one = [&](auto link) {
      constexpr std::size_t i = link.value;
      const auto J = jacobian<i>(poses);
      const auto V = J * u;
      T v = length(V.linear) + at_[k].reach * length(V.angular), hit(0);
      if (at_[k].cells.size() > 0) {
        const auto X = poses.template get<i>();
        const auto turned = [&](const Xyz<T>& x) SKINCTL_INLINE_LAMBDA {
          return Xyz<T>{dot(X.axis_x(), x), dot(X.axis_y(), x), dot(X.axis_z(), x)};
        };
        const Xyz<T> linear = turned(V.linear), angular = turned(V.angular);
        const LinkMobility<T> A(operational_mobility(J, mass), X);
        hit = at_[k].cells.hardest(A, linear, angular, T(at_[k].region.mass));
        v = at_[k].cells.fastest(linear, angular);
      } else if (v > T(0) && energy > T(0)) {
        // Energies in series: e b / (e + b); a region that cannot give way takes e.
        hit = T(1) / (T(1) / energy + T(1) / (T(at_[k].region.mass) * v * v));
      } else if (!(v - v == T(0))) {
        hit = v;
      }
      before(at_[k], v, hit, distance[k], out);
      T most(0);
      for (const auto& c : contacts) {
        if (c.link != i) continue;
        Xyz<T> push{T(0), T(0), T(0)};
        JointTorque<joints, T> tau;  // a contact whose normal is unknown stands alone
        for (const auto& d : contacts) {
          if (&d != &c && (d.link != i || !(dot(c.normal, d.normal) >= T(same_side)))) continue;
          push = push + d.force * d.normal;
          for (std::size_t j = 0; j < joints; ++j) tau[j] = tau[j] - at_[k].newton * d.force * d.row[j];
        }
        const T sum = length(push), F = at_[k].newton * (sum > c.force ? sum : c.force);
        if (F > most) most = F;
        during(at_[k], F, tau, mass, u, measured.dq, out);
      }
      if constexpr (detail::HoldsWrenches<Touch>) {
        const auto w = touch.template wrench<i>();
        const T sum = w.force.x + w.force.y + w.force.z + w.moment.x + w.moment.y + w.moment.z;
        if (!(sum - sum == T(0))) most = std::numeric_limits<T>::infinity();
      }
      lasting(at_[k], memory.above[k], most, dt, out);
      ++k;
    };
    (one(std::integral_constant<std::size_t, Ix>{}), ...);
    if (out.scale < T(1)) out.status |= Reason::contact_slowed;
    return out;
  }

 private:
  struct Link {
    BodyRegion region;
    T reach, reaction, newton, range, deceleration;
    bool reacts;
    std::optional<Separation> separation;
    CellMasses<T> cells;

    template <std::size_t L>
    explicit Link(const LinkContact<L>& c)
        : region(c.region),
          reach(T(c.reach)),
          reaction(seconds<T>(c.reaction_time)),
          newton(T(c.newton)),
          range(T(c.range)),
          deceleration(T(c.deceleration)),
          reacts(c.deceleration == c.deceleration),
          separation(c.separation),
          cells(c.cells, L) {
      c.region.check();
      require(c.reach >= 0 && c.reach <= 100, "LinkContact: reach", c.reach, "0 to 100 m");
      require(c.reaction_time > 0ns && c.reaction_time <= 10s, "LinkContact: reaction_time",
              seconds<double>(c.reaction_time), "> 0, <= 10 s");
      require(c.newton > 0 && c.newton <= 1e6, "LinkContact: newton", c.newton, "> 0, <= 1e6");
      require(c.range >= 0 && c.range <= 100, "LinkContact: range", c.range, "0 to 100 m");
      if (reacts)
        require(c.deceleration > 0 && c.deceleration <= 1e4, "LinkContact: deceleration", c.deceleration,
                "> 0, <= 1e4 m/s^2");
      require(c.cells.empty() || cells.size() > 0, "LinkContact: cells on link", double(L), "at least one");
      if (!c.separation) return;
      c.separation->check();
      require(c.range > 0, "LinkContact: range", c.range, "> 0 m with a separation");
    }
  };

  static constexpr double same_side = 0.5;  ///< cosine between normals of contacts that are one push: 60 deg
  static SKINCTL_INLINE T length(const Xyz<T>& x) noexcept {
    using std::sqrt;
    return sqrt(dot(x, x));
  }
  static SKINCTL_INLINE T least(const T& x, const T& y) noexcept { return y < x ? y : x; }

  /// Judges a link before a contact at up to the speed `v`; `hit` is twice the energy of the collision [J].
  static SKINCTL_INLINE void before(const Link& link, const T& v, const T& hit, const T& distance,
                                    Verdict& out) noexcept {
    using std::sqrt;
    const auto& r = link.region;
    const T k = T(r.stiffness);
    T blow = sqrt(k * hit), scale(1);
    if (link.reacts) {
      blow = k * v * (link.reaction + v / (T(2) * link.deceleration));
      if (!(blow <= T(r.blow))) {
        const T most = speed_to_stop(T(T(r.blow) / k), link.reaction, link.deceleration);
        scale = most < v ? T(most / v) : T(0);  // 0 for NaN
      }
    } else if (!(blow <= T(r.blow))) {
      scale = blow > T(r.blow) ? T(T(r.blow) / blow) : T(0);
    }
    if (blow > out.blow) out.blow = blow;
    if (blow <= T(r.blow)) return;
    if (link.separation) {
      const T apart = speed_of_separation(*link.separation, distance) / v;
      if (apart > scale) scale = apart;
    }
    out.scale = least(out.scale, scale);
  }

  /// Judges a link whose strongest contact has had the force `F` [N] for `dt` more seconds.
  static SKINCTL_INLINE void lasting(const Link& link, T& above, const T& F, const T& dt,
                                     Verdict& out) noexcept {
    const auto& r = link.region;
    if (F > out.force) out.force = F;
    above = F > T(r.force) ? T(above + dt) : T(0);
    if (!(F <= T(r.blow)) || above > seconds<T>(r.first)) out.status |= Reason::contact_force;
  }

  /// Judges a link during a contact with the force `F` > 0 [N], which gives the torque `tau` at the joints.
  static SKINCTL_INLINE void during(const Link& link, const T& F, const JointTorque<joints, T>& tau,
                                    const MassFactors<M, T>& mass, const JointVelocity<joints, T>& u,
                                    const JointVelocity<joints, T>& dq, Verdict& out) noexcept {
    using std::sqrt;
    const auto& r = link.region;
    const T taken = -power(tau, dq);
    if (taken > out.power) out.power = taken;
    if (!(taken <= T(r.power))) out.status |= Reason::contact_power;
    const T given = -power(tau, u);
    if (!(given > T(0))) return;
    const auto ddq = mass.solve(tau);
    T give(0);  // acceleration along F per force
    for (std::size_t i = 0; i < joints; ++i) give = give + tau[i] * ddq[i];
    give = give / (F * F);
    const T v = given / F;
    const T both = T(1) / T(r.mass) + give, k = T(r.stiffness);
    T most;
    if (link.reacts) {
      // Until the answer arrives the robot moves at the speed it has, or at the one allowed now.
      const T room = (T(r.force) - F) / k, in = taken > T(0) ? T(taken / F) : T(0);
      const T after = room - in * link.reaction;
      most = speed_to_stop(room, link.reaction, link.deceleration);
      most = least(most, after > T(0) ? T(sqrt(T(2) * link.deceleration * after)) : T(0));
    } else {
      const T rest = T(r.blow) * T(r.blow) - F * F, room = T(r.force) - F;
      most = rest > T(0) ? T(sqrt(rest * both / k)) : T(0);
      most = least(most, room > T(0) ? T(room / (k * link.reaction)) : T(0));
    }
    most = least(most, T(r.power) / F);
    if (most < v) out.scale = least(out.scale, T(most / v));
  }

  [[no_unique_address]] M model_;
  Link at_[count];
};
template <RobotModel M, std::size_t... Ix>
ContactLimits(const M&, const LinkContact<Ix>&...) -> ContactLimits<M, double, Ix...>;

/// `ContactLimits` with a named scalar: `contact_limits<float>(model, ...)`.
template <Real T = double, RobotModel M, std::size_t... Ix>
[[nodiscard]] auto contact_limits(const M& model, const LinkContact<Ix>&... link) {
  static_assert(detail::distinct_links<Ix...>,
                "two contact limits for one link: give it those of the more delicate region");
  if constexpr (detail::distinct_links<Ix...>) return ContactLimits<M, T, Ix...>(model, link...);
}

/// The `ContactLimits` that the contacts of all links make together.
template <RobotModel M, std::size_t N, Real T, std::size_t... Ix>
[[nodiscard]] auto part_for(const M& model, const JointLimits<N, T>&, const LinkContact<Ix>&... link) {
  return contact_limits<T>(model, link...);
}

SKINCTL_END_NAMESPACE
