// SPDX-License-Identifier: BSD-3-Clause
// The values that a law takes and gives: its role, its share in a sum, the parts of its torque, what became
// of a request.
#pragma once

#include <type_traits>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The operators of law expressions (`0.6 * skin + gravity`) live in this namespace, and a law finds them by
/// deriving from `Composable`. Errors in expressions of other types do not list them.
namespace expression {
struct Composable {};
}  // namespace expression
using expression::Composable;

/// The role of a law in a sum, eq. (23).
enum class LawRole : unsigned char {
  tracking,  ///< follows a target: feedback is weighted, feed-forwards enter as one convex mean
  reactive,  ///< answers the skin: its weight is not normalised
  gravity    ///< compensates gravity: weight 1, at most once in an expression
};

/// Whether a torque includes G(q). It must not where a gravity law is loaded beside it.
enum class GravityTerm : bool { left_out, included };

/// The factors with which a sum multiplies the two parts of a tracking law.
template <Scalar T>
struct LawShare {
  T feedback = T(1);
  T feed_forward = T(1);
};

/// The two parts of a tracking law's torque [N m], both without G(q), which the sum adds.
template <std::size_t N, Scalar T = double>
struct TorqueParts {
  JointTorque<N, T> feedback;      ///< the reaction to the error, `-K_d S_q`
  JointTorque<N, T> feed_forward;  ///< the torque of the planned motion, `Y_r Theta - G`
};

/// Whether the skin pushes against the tracking laws (end of the paper's section 4.2.1). While it lasts,
/// integrals and clocks stand still; at the release they are reset without a jump.
enum class Opposition : unsigned char { none, lasting, released };

/// A memory after a request (a new goal), and the status of that request.
template <class M>
struct Received {
  M memory;
  Status status;
};

SKINCTL_END_NAMESPACE
