// All skills of a robot as one law: which of them acts is chosen while it runs, without a jump.
#pragma once

#include <cmath>

#include "skinctl/fusion/blended.hpp"
#include "skinctl/skills/detail/rate_bound.hpp"
#include "skinctl/skills/detail/settled.hpp"
#include "skinctl/skills/skill_request.hpp"

SKINCTL_BEGIN_NAMESPACE

/// How a set of skills hands over.
struct SkillSettings {
  Nanoseconds hand_over = 100_ms;   ///< the torque moves to the next skill in this time, or longer ...
  Nanoseconds longest = 2_s;        ///< ... where it has far to go, but never in more than this
  double most_rate = 1000;          ///< of every joint's torque while something hands over [N m/s]
  double touched = 1;               ///< skin's joint torque from which the robot counts as touched [N m]
  OppositionSettings opposition{};  ///< when skin and tracking count as opposed
};

namespace detail {
/// The goals that laws take, each type once.
template <class Found, class... L>
struct GoalTypes;
template <class... G>
struct GoalTypes<SkillRequest<G...>> {
  using type = SkillRequest<G...>;
};
template <class... G, class L, class... Rest>
struct GoalTypes<SkillRequest<G...>, L, Rest...> : GoalTypes<SkillRequest<G...>, Rest...> {};
template <class... G, class L, class... Rest>
  requires(requires { typename L::Goal; } && !(std::is_same_v<G, typename L::Goal> || ...))
struct GoalTypes<SkillRequest<G...>, L, Rest...> : GoalTypes<SkillRequest<G..., typename L::Goal>, Rest...> {
};
}  // namespace detail

/// A set of skills, made by `skill_set(library, controllers...)`. It is a law like any other: a `Cycle` runs,
/// records and replays it, and `Input::goal` brings its requests.
///
/// - Its controllers are one sum that blends; a skill is a row of weights. So a skill more costs a row, every
///   controller is computed only while a skill loads it, and gravity is held once and whole throughout.
/// - A change moves the shares by a quintic. Controllers that come start at the state at hand with share
///   zero, controllers that stay go on: torque and rate begin where they were. The time is as configured, and
///   longer where the change would move the torque faster than `most_rate`.
/// - While anything hands over (a change, a controller that has got another goal or is pushed by the skin),
/// no
///   joint's torque moves faster than `most_rate`, whatever the controllers ask for, beside what the skin
///   itself does: a touch is answered at once. What the torque then lacks is carried on until it has caught
///   up, and is the last share.
/// - A request during a change waits for its end; of several the last counts.
/// - A finished skill holds, or goes on to its `next`; a failed one falls back to the first of the set.
///
/// @tparam Names  `Behaviours<...>`: the compile-time names of the skills, in the order of their indices.
template <class Names, class Fusion>
class SkillSet;
template <class... Behaviour>
struct Behaviours {
  static constexpr std::size_t count = sizeof...(Behaviour);
  /// `count` if it is none of them.
  template <class B>
  static constexpr std::size_t index = [] {
    constexpr bool found[] = {std::is_same_v<B, Behaviour>...};
    std::size_t i = 0;
    while (i < count && !found[i]) ++i;
    return i;
  }();
};

template <class... Behaviour, Sum P, class... L>
class SkillSet<Behaviours<Behaviour...>, Fused<P, L...>> {
 public:
  using Names = Behaviours<Behaviour...>;
  using Fusion = Fused<P, L...>;
  using Blend = Blended<Fusion>;
  using Goal = typename detail::GoalTypes<SkillRequest<>, L...>::type;
  static constexpr std::size_t controllers = Fusion::terms;
  static constexpr std::size_t terms = controllers + 1;  ///< and what is carried over
  static constexpr std::size_t skills = Names::count;
  static constexpr Needs needs = Blend::needs;
  static constexpr Role role = Fusion::role;
  static constexpr const char* name = "skills";
  static constexpr bool complete_sum = true;
  static_assert(Fusion::gravity_laws == 1, "a set of skills holds gravity: give it a gravity controller");
  static_assert(skills > 0 && skills < 256);
  static constexpr std::size_t joints = detail::joints_of_laws<L...>();
  static_assert(joints > 0 || Fusion::tracking_laws == 0,
                "a tracking controller says for how many joints it is: static constexpr std::size_t joints");

  struct Memory {
    typename Blend::Memory blend;
    detail::RateBound<joints> bound;
    Goal request;  ///< the accepted one: its goals are there for the skills of a sequence
    Goal waiting;  ///< the one that waits for the end of a change
    Switches commanded, reported;
    std::uint32_t reporting = 0;  ///< switches that have ever been reported
    double touch = 0;             ///< norm of what the skin's laws contributed last [N m]
    Nanoseconds since = 0;        ///< the skill's start
    Nanoseconds held = 0;         ///< for how long its finish condition has held
    std::uint8_t skill = 0;
    Phase phase = Phase::loading;
    bool waits = false;  ///< for the end of a change
  };

  /// @param skills  the first is the one to start with and to fall back to. Throws `ConfigurationError` for
  ///                numbers out of their range.
  SkillSet(const Fusion& sum, const std::array<Skill<controllers>, skills>& rows,
           const SkillSettings& settings = {})
      : blend_(sum.opposed_by(settings.opposition), rows[0].weights, BlendSettings{settings.hand_over, {}}),
        skills_(rows),
        settings_(settings) {
    require(settings.most_rate > 0 && settings.most_rate <= 1e9, "most_rate", settings.most_rate,
            "> 0 N m/s");
    require(settings.longest >= settings.hand_over, "longest", static_cast<double>(settings.longest) * 1e-9,
            ">= hand_over, in s");
    for (const auto& s : rows) {
      const auto& c = s.conditions;
      require(s.next < skills, "next", s.next, "the index of a skill");
      require(c.hold >= 0 && c.timeout >= 0, "hold or timeout", static_cast<double>(c.hold) * 1e-9, ">= 0 s");
      require(c.still > 0 && c.still <= 1e3, "still", c.still, "> 0 rad/s");
      require(c.most_touch >= 0 && c.most_touch <= 1e9, "most_touch", c.most_touch, ">= 0 N m");
      for (std::size_t i = 0; i < controllers; ++i)
        require(
            Fusion::roles[i] == Role::gravity ? s.weights[i] == 1 : s.weights[i] >= 0 && s.weights[i] <= 1e6,
            "weight of a controller", s.weights[i], "0 to 1e6, and 1 for gravity");
    }
    require(rows[0].conditions.timeout == 0 && rows[0].conditions.most_touch == 0,
            "failure of the first skill", 1, "none: others fall back to it");
  }
  [[nodiscard]] const Fusion& sum() const noexcept { return blend_.sum(); }
  [[nodiscard]] const Skill<controllers>& skill(std::size_t i) const noexcept { return skills_[i]; }
  template <class B>
  [[nodiscard]] const Skill<controllers>& skill() const noexcept {
    return skills_[index<B>()];
  }
  /// The index of a behaviour's skill.
  template <class B>
  [[nodiscard]] static constexpr std::uint8_t index() noexcept {
    constexpr std::size_t i = Names::template index<B>;
    static_assert(i < skills, "no such skill in this set: its recipe or one of its controllers is missing");
    return static_cast<std::uint8_t>(i);
  }
  /// The skill that acts, or that the torque moves to.
  [[nodiscard]] const Skill<controllers>& now(const Memory& m) const noexcept { return skills_[m.skill]; }
  /// How the discrete controls shall stand.
  [[nodiscard]] static const Switches& commanded(const Memory& m) noexcept { return m.commanded; }

  // Requests, for `Input::goal` or `receive`.
  /// The skill of a behaviour, with goals for its controllers or none.
  template <class B, class... G>
  [[nodiscard]] static Goal start_skill(const G&... goals) noexcept {
    return start_skill(index<B>(), goals...);
  }
  template <class... G>
  [[nodiscard]] static Goal start_skill(std::uint8_t skill, const G&... goals) noexcept {
    Goal out = goal(goals...);
    out.kind = static_cast<unsigned char>(Goal::Kind::start);
    out.skill = skill;
    return out;
  }
  /// Other goals for the controllers of the skill that acts.
  template <class... G>
  [[nodiscard]] static Goal goal(const G&... goals) noexcept {
    Goal out;
    ((out.goals.template of<G>().has = true, out.goals.template of<G>().goal = goals), ...);
    return out;
  }
  /// What the switches report.
  [[nodiscard]] static Goal report(const Switches& reported) noexcept {
    Goal out;
    out.kind = static_cast<unsigned char>(Goal::Kind::report);
    out.reported = reported;
    return out;
  }

  /// The first skill, at the state that is known.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory start(const K& known) const noexcept {
    Memory m{};
    m.blend = blend_.start(known);
    m.commanded = skills_[0].switches;
    const auto e = run(m.blend, known, known.dt(), Opposition::none);
    if constexpr (joints > 0) m.bound.follow(e.torque - skin(e.shares), {}, {});
    return m;
  }

  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> receive(const Memory& memory, const K& known,
                                                      const Goal& request) const noexcept {
    using Kind = typename Goal::Kind;
    Received<Memory> out{memory, {}};
    if (request.kind == static_cast<unsigned char>(Kind::report)) {
      out.memory.reported = out.memory.reported.then(request.reported);
      out.memory.reporting |= request.reported.which;
      return out;
    }
    if (request.kind == static_cast<unsigned char>(Kind::goal)) {
      if (!fits(memory, known, request, memory.skill, out.status)) return {memory, Reason::goal_refused};
      deliver(out.memory, known, request, out.status);
      out.memory.held = 0;
      if (memory.phase == Phase::finished) out.memory.phase = Phase::running;
      return out;
    }
    if (request.kind != static_cast<unsigned char>(Kind::start) || request.skill >= skills)
      return {memory, Reason::goal_refused};
    if (!may_start(memory, skills_[request.skill])) return {memory, Reason::skill_refused};
    if (!Blend::moves(memory.blend)) {
      if (memory.phase == Phase::loading) out.status |= arrive(out.memory, known);
      auto change = begun(out.memory, known, request);
      change.status |= out.status;
      return change;
    }
    out.memory.waiting = request;
    out.memory.waits = true;
    return out;
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const Memory& memory, const K& known) const noexcept {
    return step(memory, known, known.dt(), Opposition::none).torque;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known,
                                              const typename K::scalar& dt,
                                              Opposition opposition) const noexcept {
    return step(memory, known, dt, opposition).memory;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE auto evaluate(const Memory& memory, const K& known,
                                             const typename K::scalar& dt) const noexcept {
    return step(memory, known, dt, Opposition::none);
  }

 private:
  template <std::size_t I>
  using law_at = std::tuple_element_t<I, std::tuple<L...>>;
  template <class F>
  static SKINCTL_INLINE constexpr void each(F&& f) noexcept {
    [&]<std::size_t... I>(std::index_sequence<I...>) SKINCTL_INLINE_LAMBDA {
      (f(std::integral_constant<std::size_t, I>{}), ...);
    }(std::index_sequence_for<L...>{});
  }

  [[nodiscard]] bool may_start(const Memory& m, const Skill<controllers>& s) const noexcept {
    if (s.conditions.untouched && !(m.touch <= settings_.touched)) return false;
    return m.commanded.then(m.reported).stand(s.conditions.needs);
  }
  /// Calls `f(index, goal)` for each controller of a skill for which the request has a goal.
  template <class F>
  void each_goal(const Goal& request, std::uint8_t skill, F&& f) const noexcept {
    each([&](auto i) {
      if constexpr (detail::takes_goals<law_at<i.value>>) {
        const auto& part = request.goals.template of<typename law_at<i.value>::Goal>();
        if (part.has && skills_[skill].weights[i.value] > 0) f(i, part.goal);
      }
    });
  }
  /// Whether controllers of a skill take the request's goals: at least one, and none refuses.
  template <class K>
  [[nodiscard]] SKINCTL_COLD bool fits(const Memory& m, const K& known, const Goal& request,
                                       std::uint8_t skill, Status& status) const noexcept {
    bool taken = false;
    each_goal(request, skill, [&](auto i, const auto& goal) {
      const auto& law = std::get<i.value>(blend_.sum().laws());
      const bool on = Blend::loaded(m.blend, i) && !Blend::comes(m.blend, i);
      status |=
          law.receive(on ? Blend::template memory<i.value>(m.blend) : law.start(known), known, goal).status;
      taken = true;
    });
    return taken && !status.has(Reason::goal_refused);
  }
  /// The request's goals to the controllers that are there; the others get them when they have come.
  template <class K>
  SKINCTL_COLD void deliver(Memory& m, const K& known, const Goal& request, Status& status,
                            bool arrived = false) const noexcept {
    each_goal(request, m.skill, [&](auto i, const auto& goal) {
      if (Blend::comes(m.blend, i)) {
        m.request.goals.template of<std::remove_cvref_t<decltype(goal)>>() =
            request.goals.template of<std::remove_cvref_t<decltype(goal)>>();
      } else if (!arrived || m.blend.from[i].feed_forward == 0) {
        const auto answer = blend_.template receive<i.value>(m.blend, known, goal);
        m.blend = answer.memory;
        status |= answer.status;
      }
    });
  }
  /// The change to another skill begins.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> begun(const Memory& memory, const K& known,
                                                    const Goal& request) const noexcept {
    Received<Memory> out{memory, {}};
    Memory& m = out.memory;
    m.waits = false;
    bool any = false;
    each_goal(request, request.skill, [&](auto, const auto&) { any = true; });
    if (any && !fits(m, known, request, request.skill, out.status)) return out;
    const auto& next = skills_[request.skill];
    m.blend = blend_.change(m.blend, known, Weights<controllers>{next.weights}).memory;
    stretch(m.blend, known);
    m.skill = request.skill;
    m.request = request;
    deliver(m, known, request, out.status);
    m.commanded = m.commanded.then(next.switches);
    m.reported.which &= ~next.switches.which;  // an old report says nothing about what is only beginning
    m.phase = Phase::loading;
    m.since = m.held = 0;
    return out;
  }
  /// Makes a change last long enough that by its quintics the torque moves no faster than `most_rate`: to
  /// what the other skill asks for at this state; and then, where the feedback of a tracking law comes, to
  /// what it holds against the skin. There the torque moves at up to `1.7 |tau_skin| sqrt(lambda / T)`, and
  /// 100 1/s stands for lambda.
  template <class K>
  SKINCTL_COLD void stretch(typename Blend::Memory& m, const K& known) const noexcept {
    auto there = m;
    there.elapsed = clock_end;
    const auto from = run(m, known, known.dt(), Opposition::none);
    const auto to = run(there, known, known.dt(), Opposition::none);
    const auto seconds_for = [&](const auto& way) {
      return static_cast<double>(largest(way)) / settings_.most_rate;
    };
    m.ramp = within(quintic_peak_speed<double> * seconds_for(to.torque - from.torque));
    const double push = 1.7 * seconds_for(skin(to.shares));
    if (m.settle > 0) m.settle = within(100 * push * push);
  }
  [[nodiscard]] Nanoseconds within(double time) const noexcept {
    const Nanoseconds asked = time < 1e6 ? nanoseconds(time) : settings_.longest;
    return asked > settings_.longest     ? settings_.longest
           : asked > settings_.hand_over ? asked
                                         : settings_.hand_over;
  }
  // One function for the loop and for what is asked of it aside: it is the largest part of the code.
  template <class K>
  [[nodiscard]] SKINCTL_NOINLINE auto run(const typename Blend::Memory& m, const K& known,
                                          const typename K::scalar& dt,
                                          Opposition opposition) const noexcept {
    return blend_.evaluate(m, known, dt, opposition);
  }

  /// The controllers that have come get their goals.
  template <class K>
  SKINCTL_COLD Status arrive(Memory& m, const K& known) const noexcept {
    Status status;
    m.phase = Phase::running;
    deliver(m, known, m.request, status, true);
    return status;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<K::joints, typename K::scalar, Memory, terms> step(
      const Memory& memory, const K& known, const typename K::scalar& dt, Opposition given) const noexcept {
    Evaluation<K::joints, typename K::scalar, Memory, terms> out{{}, memory, {}, {}};
    Memory& m = out.memory;
    if (m.phase == Phase::loading && !Blend::moves(m.blend)) [[unlikely]]
      out.status |= arrive(m, known);
    if (m.waits && !Blend::moves(m.blend)) [[unlikely]] {
      const auto change = begun(m, known, m.waiting);
      m = change.memory;
      out.status |= change.status;
    }
    if (m.bound.lags && swaps(m.blend)) [[unlikely]]
      restart(m.blend, known);
    const auto e = run(m.blend, known, dt, given);
    const auto touched = skin(e.shares);
    out.torque = e.torque;
    for (std::size_t i = 0; i < controllers; ++i) out.shares[i] = e.shares[i];
    out.status |= e.status;
    const auto before = m.blend;
    m.blend = e.memory;
    if constexpr (joints > 0) {
      const auto own = e.torque - touched;
      if (m.bound.lags || Blend::moves(before)) [[unlikely]] {
        out.shares[controllers] =
            bounded(m, before, own, e.shares, static_cast<typename K::scalar>(settings_.most_rate) * dt);
        out.torque += out.shares[controllers];
        if (m.bound.lags) out.status |= Reason::hand_over;
      } else {
        m.bound.follow(own, {}, {});
      }
    }
    supervise(m, known, touched, nanoseconds(static_cast<double>(dt)));
    if (m.phase == Phase::finished) out.status |= Reason::skill_finished;
    if (m.phase == Phase::failed) out.status |= Reason::skill_failed;
    return out;
  }
  /// Where the skill stands after `dt`, and what follows from it.
  template <class K, class Torque>
  SKINCTL_NOINLINE void supervise(Memory& m, const K& known, const Torque& touched,
                                  Nanoseconds dt) const noexcept {
    const auto& s = skills_[m.skill];
    const auto& c = s.conditions;
    m.since = later(m.since, dt);
    double square = 0;
    for (const auto& x : touched) square += static_cast<double>(x) * static_cast<double>(x);
    m.touch = std::sqrt(square);
    if (m.phase == Phase::failed || m.phase == Phase::finished) return;
    if (c.most_touch > 0 && m.touch > c.most_touch) return end(m, Phase::failed, 0);
    if (c.timeout > 0 && m.since >= c.timeout) return end(m, Phase::failed, 0);
    if (m.phase == Phase::loading || c.finish == Finish::never) return;
    bool holds = true;
    if (c.finish == Finish::switched) {
      const std::uint32_t reports = s.switches.which & m.reporting;
      holds = m.reported.stand({reports, s.switches.on & reports});
    }
    if (c.finish == Finish::settled)
      each([&](auto i) {
        using Law = law_at<i.value>;
        if constexpr (Law::role == Role::tracking)
          if (s.weights[i.value] > 0)
            holds = holds && detail::settled(std::get<i.value>(blend_.sum().laws()),
                                             Blend::template memory<i.value>(m.blend), known,
                                             static_cast<typename K::scalar>(c.still));
      });
    m.held = holds ? later(m.held, dt) : 0;
    if (holds && m.held >= c.hold) end(m, Phase::finished, s.next);
  }
  template <class Torque>
  [[nodiscard]] static auto largest(const Torque& tau) noexcept {
    auto most = detail::magnitude(tau[0]);
    for (const auto& x : tau)
      if (detail::magnitude(x) > most) most = detail::magnitude(x);
    return most;
  }
  /// What the skin's laws contribute.
  template <class Shares>
  [[nodiscard]] static SKINCTL_INLINE auto skin(const Shares& shares) noexcept {
    std::remove_cvref_t<decltype(shares[0])> sum;
    each([&](auto i) {
      if constexpr (detail::answers_touch<law_at<i.value>>) sum += shares[i.value];
    });
    return sum;
  }
  /// Whether a change is under way that keeps no tracking controller.
  [[nodiscard]] static bool swaps(const typename Blend::Memory& m) noexcept {
    if (!Blend::moves(m)) return false;
    for (std::size_t i = 0; i < controllers; ++i)
      if (Fusion::roles[i] == Role::tracking && m.from[i].feed_forward > 0 && m.to[i].feed_forward > 0)
        return false;
    return true;
  }
  /// While the torque lags, what goes stands at the state at hand, as does what comes: what the torque lacks
  /// would wind it up.
  template <class K>
  SKINCTL_COLD void restart(typename Blend::Memory& m, const K& known) const noexcept {
    each([&](auto i) {
      if constexpr (law_at<i.value>::role == Role::tracking)
        if (m.from[i.value].feed_forward > 0)
          detail::memory_of<i.value>(m.laws) = std::get<i.value>(blend_.sum().laws()).start(known);
    });
  }
  /// What is added to the torque `own` of all but the skin, so that none moves by more than `most`.
  template <class Torque, class Shares, class T>
  [[nodiscard]] SKINCTL_COLD Torque bounded(Memory& m, const typename Blend::Memory& before,
                                            const Torque& own, Shares shares, const T& most) const noexcept {
    // By how much the skin's weights will move its torque until the next cycle, if the touch stays.
    const auto now = blend_.factors(before), next = blend_.factors(m.blend);
    for (std::size_t i = 0; i < controllers; ++i) {
      const double had = now[i].feedback, gets = next[i].feedback;
      shares[i] = static_cast<T>(had > 0 ? (gets - had) / had : 0) * shares[i];
    }
    auto moved = skin(shares);
    if (largest(moved) > most) {
      const T slower = most / largest(moved);
      m.blend.elapsed = before.elapsed + nanoseconds(seconds<double>(m.blend.elapsed - before.elapsed) *
                                                     static_cast<double>(slower));
      moved = slower * moved;
    }
    Torque carried;
    if (m.bound.lags || swaps(before)) carried = m.bound.missing(own, most);
    m.bound.follow(own, carried, moved);
    if (m.bound.lags && m.blend.settle > 0 && m.blend.elapsed >= m.blend.ramp)
      m.blend.elapsed = m.blend.ramp - 1;  // feedback came faster than the torque may: once more
    return carried;
  }
  void end(Memory& m, Phase phase, std::uint8_t next) const noexcept {
    m.phase = phase;
    if (next == m.skill && phase == Phase::finished) return;
    if (phase == Phase::finished && !may_start(m, skills_[next])) {
      m.phase = Phase::failed;
      next = 0;
    }
    m.waiting = m.request;
    m.waiting.kind = static_cast<unsigned char>(Goal::Kind::start);
    m.waiting.skill = next;
    if (m.phase == Phase::failed) m.waiting.goals = {};
    m.waits = true;
  }

  Blend blend_;
  std::array<Skill<controllers>, skills> skills_;
  SkillSettings settings_;
};

SKINCTL_END_NAMESPACE
