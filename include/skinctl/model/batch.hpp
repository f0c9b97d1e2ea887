// SPDX-License-Identifier: BSD-3-Clause
// Many robots of one model, computed side by side in lanes: rollouts, candidates of an optimisation, fingers.
#pragma once

#include <span>
#include <vector>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `W` robots of the model `M` as one model that computes in lanes: lane k has the numbers of robot k. Typed
/// constants of `M` stay typed, so zeros cost nothing here either.
template <RobotModel M, Real T, std::size_t W>
class SideBySide {
 public:
  using scalar = Lane<T, W>;
  static constexpr std::size_t joints = M::joints;
  static constexpr auto parents = M::parents;
  static constexpr auto kinds = M::kinds;

  /// Lane k holds `robots[k]`; the last robot also fills the remaining lanes.
  explicit SideBySide(std::span<const M> robots) {
    require(!robots.empty(), "robots side by side", 0.0, ">= 1");
    const auto of = [&](std::size_t lane) -> const M& {
      return robots[lane < robots.size() ? lane : robots.size() - 1];
    };
    const auto store = [&]<std::size_t Ix>(std::integral_constant<std::size_t, Ix>) {
      for (std::size_t p = 0; p < std::size_t(LinkParameter::count); ++p) {
        T x[W];
        for (std::size_t k = 0; k < W; ++k) x[k] = static_cast<T>(numbers_of<Ix, T>(of(k)).numbers[p]);
        links_[Ix].numbers[p] = scalar::load(x);
      }
    };
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      (store(std::integral_constant<std::size_t, Ix>{}), ...);
    }(std::make_index_sequence<joints>{});
    T x[W], y[W], z[W];
    for (std::size_t k = 0; k < W; ++k) {
      const Xyz<T> g = dense<T>(of(k).template gravity<T>());
      x[k] = g.x, y[k] = g.y, z[k] = g.z;
    }
    gravity_ = {scalar::load(x), scalar::load(y), scalar::load(z)};
  }

  template <std::size_t Ix, LinkParameter P, Scalar U>
  SKINCTL_INLINE constexpr auto number() const noexcept {
    static_assert(std::same_as<U, scalar>, "robots side by side compute in lanes");
    using One = decltype(std::declval<const M&>().template number<Ix, P, T>());
    if constexpr (is_known<One>) {
      return One{};
    } else {
      return scalar(links_[Ix][P]);
    }
  }
  template <Scalar U>
  SKINCTL_INLINE constexpr auto gravity() const noexcept {
    static_assert(std::same_as<U, scalar>, "robots side by side compute in lanes");
    using One = decltype(std::declval<const M&>().template gravity<T>());
    return Triple{along<decltype(One::x)>(gravity_.x), along<decltype(One::y)>(gravity_.y),
                  along<decltype(One::z)>(gravity_.z)};
  }

 private:
  template <class One>
  static SKINCTL_INLINE constexpr auto along(const scalar& g) noexcept {
    if constexpr (is_known<One>) {
      return One{};
    } else {
      return g;
    }
  }
  std::array<LinkParameters<scalar>, joints> links_;
  Xyz<scalar> gravity_;
};

/// The robots of a batch that share the lanes of one group, with the transfer of their numbers to and from
/// lanes.
template <Real T, std::size_t W>
class LaneGroup {
 public:
  using scalar = std::conditional_t<W == 1, T, Lane<T, W>>;

  SKINCTL_INLINE LaneGroup(std::size_t first, std::size_t count) noexcept : first_(first), count_(count) {}
  [[nodiscard]] std::size_t first() const noexcept { return first_; }  ///< the robot in lane 0
  [[nodiscard]] std::size_t count() const noexcept { return count_; }  ///< robots; the last fills up

  /// Joint numbers of this group's robots, from those of all robots.
  template <class V>
  [[nodiscard]] SKINCTL_INLINE auto read(const V& all) const noexcept {
    using Row = std::remove_cvref_t<decltype(all[0])>;
    static_assert(std::is_same_v<typename Row::scalar, T>,
                  "one joint vector of the batch's scalar per robot");
    SKINCTL_EXPECTS(std::size(all) >= first_ + count_, "one joint vector per robot");
    return JointVector<typename Row::kind, Row::size(), scalar>::generate(
        [&](std::size_t i)
            SKINCTL_INLINE_LAMBDA { return gather([&](std::size_t k) { return all[k][i]; }); });
  }
  /// Writes results from the lanes to this group's robots: joint numbers, matrices, poses.
  template <class Result, class Out>
  SKINCTL_INLINE void write(const Result& lanes, Out&& all) const noexcept {
    SKINCTL_EXPECTS(std::size(all) >= first_ + count_, "one result per robot");
    for (std::size_t k = 0; k < count_; ++k) take(lanes, k, all[first_ + k]);
  }

 private:
  template <class F>
  SKINCTL_INLINE scalar gather(F f) const noexcept {
    if constexpr (W == 1) {
      return f(first_);
    } else if (count_ == W) [[likely]] {
      return [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
        return scalar(typename scalar::Vector{f(first_ + K)...});
      }(std::make_index_sequence<W>{});
    } else {
      T x[W];
      for (std::size_t k = 0; k < W; ++k) x[k] = f(first_ + (k < count_ ? k : count_ - 1));
      return scalar::load(x);
    }
  }
  SKINCTL_INLINE static T number(const scalar& x, std::size_t k) noexcept {
    if constexpr (W == 1) {
      return static_cast<void>(k), x;
    } else {
      return x[k];
    }
  }
  SKINCTL_INLINE static Xyz<T> number(const Xyz<scalar>& v, std::size_t k) noexcept {
    return {number(v.x, k), number(v.y, k), number(v.z, k)};
  }
  template <class Result, class One>
  SKINCTL_INLINE static void take(const Result& lanes, std::size_t k, One& out) noexcept {
    static_assert(std::size(decltype(Result::data){}) == std::size(decltype(One::data){}), "sizes differ");
    for (std::size_t i = 0; i < std::size(lanes.data); ++i) out.data[i] = number(lanes.data[i], k);
  }
  template <Frame A, Frame B>
  SKINCTL_INLINE static void take(const Transform<A, B, scalar>& X, std::size_t k,
                                  Transform<A, B, T>& out) noexcept {
    out = Transform<A, B, T>::trusted({number(X.axis_x(), k), number(X.axis_y(), k), number(X.axis_z(), k)},
                                      number(X.origin(), k));
  }

  std::size_t first_, count_;
};

/// Robots of one model that move independently: every algorithm that is templated on its scalar runs on
/// `native_lanes<T>` of them at once, through the same templates as a single robot.
///
///     const ModelBatch robots(ur5::Model{}, q.size());
///     robots.for_each_group([&](const auto& model, const auto& group) {
///       group.write(inverse_dynamics(model, group.read(q), group.read(dq), group.read(ddq)), tau);
///     });
///
/// Results agree with those of single robots to a few units in the last place (fused multiply-adds may
/// differ); a NaN stays in its own lane. A result for all lanes together, such as `positive_definite`, holds
/// for the group. On targets without vectors a group is one robot.
template <RobotModel M, Real T = double>
class ModelBatch {
 public:
  static constexpr std::size_t lanes = native_lanes<T>;
  using Group = LaneGroup<T, lanes>;
  /// The model that `for_each_group` passes: `M` itself where all its numbers are in its type.
  using GroupModel = std::conditional_t<std::is_empty_v<M> || lanes == 1, M, SideBySide<M, T, lanes>>;

  /// `count` equal robots.
  ModelBatch(const M& model, std::size_t count) : size_(count) { models_.push_back(make({&model, 1})); }
  /// Robots with individual numbers: calibrations, payloads, candidates. Allocates; copies the numbers.
  explicit ModelBatch(std::span<const M> robots) : size_(robots.size()), stride_(1) {
    models_.reserve((size_ + lanes - 1) / lanes);
    for (std::size_t k = 0; k < size_; k += lanes)
      models_.push_back(make(robots.subspan(k, lanes < size_ - k ? lanes : size_ - k)));
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }

  /// Calls `f(model, group)` for all robots, group by group. Does not allocate.
  template <class F>
  void for_each_group(F&& f) const {
    for (std::size_t k = 0, g = 0; k < size_; k += lanes, g += stride_)
      f(models_[g], Group(k, lanes < size_ - k ? lanes : size_ - k));
  }

 private:
  static GroupModel make(std::span<const M> robots) {
    if constexpr (std::same_as<GroupModel, M>) {
      return robots[0];
    } else {
      return GroupModel(robots);
    }
  }
  std::vector<GroupModel> models_;
  std::size_t size_, stride_ = 0;
};
template <RobotModel M>
ModelBatch(const M&, std::size_t) -> ModelBatch<M, typename detail::ScalarOf<M>::type>;
template <RobotModel M>
ModelBatch(std::span<const M>) -> ModelBatch<M, typename detail::ScalarOf<M>::type>;
template <RobotModel M>
ModelBatch(const std::vector<M>&) -> ModelBatch<M, typename detail::ScalarOf<M>::type>;

SKINCTL_END_NAMESPACE
