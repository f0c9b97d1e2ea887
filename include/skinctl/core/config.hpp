// SPDX-License-Identifier: BSD-3-Clause
// Macros that every header needs: the namespace, inlining, and the unsupported compiler settings.
#pragma once

#include "skinctl/core/version.hpp"

#if !defined(__cplusplus) || __cplusplus < 202002L
#error "skinctl: needs C++20. Compile with -std=c++20, or ask CMake for cxx_std_20."
#include "skinctl: stops here without -std=c++20"  // a missing include ends the list of errors
#endif
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ < 12
#error \
    "skinctl: needs GCC 12 or Clang 14, as GCC 11 has no __builtin_shufflevector. Ubuntu 22.04 has both: g++-12, clang-14."
#include "skinctl: stops here without GCC 12 or Clang 14"
#endif

// Range reduction and compensated sums need each operation rounded to its type, in the order in which it is
// written; the guard needs NaN.
#if defined(__FAST_MATH__)
#error "skinctl: -ffast-math breaks range reduction, NaN checks and compensated sums. Compile without it."
#elif defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "skinctl: -funsafe-math-optimizations and its parts break range reduction. Compile without them."
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0
#error "skinctl: -ffinite-math-only drops the checks for NaN. Compile without it."
#elif defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#error "skinctl: 80-bit registers break range reduction. Compile with -mfpmath=sse (32 bits: -msse2 as well)."
#endif

/// Files compiled for different instruction sets, versions, or without exceptions hold different code under
/// the same name, and a linker, or a loader of plug-ins, would keep either of them. The inline namespace is
/// named after all of these, `v0_1_avx2_fma`, so that such files do not merge; and after `exact` (see
/// SKINCTL_NO_CONTRACT), whose results differ in their last bits.
#if defined(SKINCTL_NO_CONTRACT) && defined(__cpp_exceptions)
#define SKINCTL_ABI_JOINED(major, minor, set) v##major##_##minor##_##set##_exact
#elif defined(SKINCTL_NO_CONTRACT)
#define SKINCTL_ABI_JOINED(major, minor, set) v##major##_##minor##_##set##_exact_nothrow
#elif defined(__cpp_exceptions)
#define SKINCTL_ABI_JOINED(major, minor, set) v##major##_##minor##_##set
#else
#define SKINCTL_ABI_JOINED(major, minor, set) v##major##_##minor##_##set##_nothrow
#endif
#define SKINCTL_ABI_EXPANDED(major, minor, set) SKINCTL_ABI_JOINED(major, minor, set)
#define SKINCTL_ABI_OF(set) SKINCTL_ABI_EXPANDED(SKINCTL_VERSION_MAJOR, SKINCTL_VERSION_MINOR, set)
#if defined(__AVX512F__)
#define SKINCTL_ABI SKINCTL_ABI_OF(avx512)
#elif defined(__AVX2__) && defined(__FMA__)
#define SKINCTL_ABI SKINCTL_ABI_OF(avx2_fma)
#elif defined(__AVX2__)
#define SKINCTL_ABI SKINCTL_ABI_OF(avx2)
#elif defined(__AVX__)
#define SKINCTL_ABI SKINCTL_ABI_OF(avx)
#elif defined(__SSE4_1__)
#define SKINCTL_ABI SKINCTL_ABI_OF(sse4)
#elif defined(__SSE2__)
#define SKINCTL_ABI SKINCTL_ABI_OF(sse2)
#elif defined(__ARM_NEON)
#define SKINCTL_ABI SKINCTL_ABI_OF(neon)
#else
#define SKINCTL_ABI SKINCTL_ABI_OF(generic)
#endif

/// Begins and ends code whose sums and products keep the order in which they are written, whatever the
/// flags: Clang shows -fassociative-math in no macro.
#if defined(__clang__) && !defined(__wasm__)
#define SKINCTL_IN_ORDER _Pragma("float_control(push)") _Pragma("clang fp reassociate(off)")
#define SKINCTL_ANY_ORDER _Pragma("float_control(pop)")
#elif defined(__clang__)  // which cannot push there: what follows keeps its order as well
#define SKINCTL_IN_ORDER _Pragma("clang fp reassociate(off)")
#define SKINCTL_ANY_ORDER
#else
#define SKINCTL_IN_ORDER
#define SKINCTL_ANY_ORDER
#endif

#define SKINCTL_BEGIN_NAMESPACE \
  SKINCTL_IN_ORDER              \
  namespace skinctl {           \
  inline namespace SKINCTL_ABI {
#define SKINCTL_END_NAMESPACE \
  }                           \
  }                           \
  SKINCTL_ANY_ORDER

/// Forces inlining of operators, lambdas and recursion in the loop. With SKINCTL_NO_FORCED_INLINE the
/// compiler chooses: a scene takes two thirds to nine tenths of the time to compile and gives readable stack
/// traces, and a whole cycle takes 1.04 to 1.15 times as long at -O3, 1.8 to 2.2 times at -O1. The CMake
/// target `skinctl::quick` defines it. Without optimisation nothing is forced: compiling would take three
/// times as long.
#if defined(SKINCTL_NO_FORCED_INLINE) || !defined(__OPTIMIZE__)
#define SKINCTL_INLINE inline
#define SKINCTL_INLINE_LAMBDA
#else
#define SKINCTL_INLINE inline __attribute__((always_inline))
#define SKINCTL_INLINE_LAMBDA __attribute__((always_inline))
#endif
// For functions that run rarely, or once a cycle: inlined, they cost compile time and instruction cache.
// `noclone`, because GCC's clones with split arguments cost 7 % of a cycle.
#if defined(__GNUC__) && !defined(__clang__)
#define SKINCTL_NOINLINE __attribute__((noinline, noclone))
#else
#define SKINCTL_NOINLINE __attribute__((noinline))
#endif
// For functions that run before the loop: compiled for size.
#define SKINCTL_COLD __attribute__((noinline, cold))

/// In the body of an operator: lets the compiler fuse a multiplication with an addition of another operator,
/// as GCC does by default; Clang would otherwise fuse only within one expression. SKINCTL_NO_CONTRACT forbids
/// this fusion; with the compilers' own -ffp-contract=off and GCC's -fno-tree-vectorize beside it every level
/// of optimisation, every instruction set and both compilers give the same bits: the CMake target
/// `skinctl::exact` sets all of them.
#if defined(__clang__) && !defined(SKINCTL_NO_CONTRACT)
#define SKINCTL_CONTRACT _Pragma("clang fp contract(fast)")
#else
#define SKINCTL_CONTRACT
#endif
